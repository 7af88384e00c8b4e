// SPDX-License-Identifier: Apache-2.0
// Radiance of the part with the material: the model's value times the light, plus the model's
// albedo times the surroundings. STAGE_VALUE and STAGE_ALBEDO evaluate the model.

uniform highp sampler2D stage_surface;
uniform highp sampler2D stage_place;
uniform highp sampler2D stage_lit;
uniform highp sampler2D stage_irradiance;
// Table of albedos by angle, for models without a closed form.
uniform highp sampler2D stage_albedos;
uniform mat3 stage_camera;
uniform vec4 stage_frame;
uniform vec3 stage_light_view; // Unit vector towards the light, in the viewer's frame.
uniform vec3 stage_eye_view;
uniform float stage_intensity; // Irradiance of a surface facing the light, divided by pi.
uniform vec3 stage_rho;
uniform float stage_parameter; // Roughness or sigma.

out vec4 stage_radiance;

// Both directions in the frame of the normal, with the viewer in the x-z plane. The sine of the
// view is the length of a cross product, because a difference from the normal would cancel.
void stage_local(vec3 normal, vec3 view, vec3 light, out vec3 wo, out vec3 wi)
{
    vec3 beside = cross(normal, view);
    float S_o = length(beside);
    vec3 any = cross(normal, abs(normal.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
    vec3 y = S_o > 0.0 ? beside / S_o : normalize(any);
    wo = vec3(S_o, 0.0, clamp(dot(view, normal), 0.0, 1.0));
    wi = vec3(dot(light, cross(y, normal)), dot(light, y), dot(light, normal));
}

// Interpolate the table of albedos linearly between angles.
vec3 stage_tabulated(float mu)
{
    float at = clamp(mu, 0.0, 1.0) * 255.0;
    int low = min(int(at), 254);
    vec3 first = texelFetch(stage_albedos, ivec2(low, 0), 0).xyz;
    vec3 second = texelFetch(stage_albedos, ivec2(low + 1, 0), 0).xyz;
    return mix(first, second, at - float(low));
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(stage_surface, at, 0);
    stage_radiance = vec4(0.0);
    if (surface.w != 1.0)
        return;
    vec4 place = texelFetch(stage_place, at, 0);
    vec3 normal = normalize(surface.xyz);
    vec3 view = normalize(stage_eye_view - place.xyz);
    vec3 wo;
    vec3 wi;
    stage_local(normal, view, stage_light_view, wo, wi);
    float lit = stage_intensity * texture(stage_lit, gl_FragCoord.xy / stage_frame.xy).x;
    vec3 rho = stage_rho;
    float r = stage_parameter;
    if (wi.z > 0.0 && lit > 0.0)
        stage_radiance.xyz = EON_PI * lit * wi.z * STAGE_VALUE;
    float mu = wo.z;
    vec3 incoming = texture(stage_irradiance, stage_latlong(stage_camera * normal)).xyz;
    stage_radiance.xyz += place.w * incoming * (STAGE_ALBEDO);
    stage_radiance.w = 1.0;
}
