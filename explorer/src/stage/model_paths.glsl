// SPDX-License-Identifier: Apache-2.0
// Wraps a model in the interface that path tracing expects of generated materials. STAGE_VALUE,
// STAGE_SAMPLE and STAGE_PDF evaluate and sample the model.

uniform vec3 stage_rho;
uniform float stage_parameter; // Roughness or sigma of the model
uniform float stage_roughness; // Roughness for the sampler.

#define material_is_thin_walled true

struct Point {
    vec3 position;
    vec3 normal;
    vec3 tangent;
    vec2 texcoord;
    bool inside;
};

// Directions in the frame whose third axis is the normal.
mat3 stage_axes(Point p)
{
    return mat3(p.tangent, cross(p.normal, p.tangent), p.normal);
}

vec3 stage_view(Point p, vec3 wo)
{
    wo = wo * stage_axes(p);
    return vec3(wo.xy, clamp(wo.z, 0.0, 1.0));
}

vec3 stage_value(vec3 wo, vec3 wi)
{
    vec3 rho = stage_rho;
    float r = stage_parameter;
    return wi.z > 0.0 ? wi.z * STAGE_VALUE : vec3(0.0);
}

vec3 material_evaluate(Point p, vec3 wo, vec3 wi)
{
    return stage_value(stage_view(p, wo), wi * stage_axes(p));
}

bool material_sample(Point p, vec3 wo, vec3 u, out vec3 wi, out vec3 weight, out float pdf)
{
    float r = stage_roughness;
    float rho = dot(stage_rho, vec3(1.0 / 3.0));
    wo = stage_view(p, wo);
    wi = STAGE_SAMPLE;
    pdf = wi.z > 0.0 ? STAGE_PDF : 0.0;
    weight = stage_value(wo, wi) / pdf;
    wi = normalize(stage_axes(p) * wi);
    return pdf > 0.0;
}

vec3 material_emitted(Point p, vec3 wo)
{
    return vec3(0.0);
}
