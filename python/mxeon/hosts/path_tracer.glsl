// SPDX-License-Identifier: Apache-2.0
// A path tracer for a sphere or the shader ball with the generated code of a material. Each pass
// traces one path per pixel. In the world frame, x points right, y points up, and z points towards
// the viewer. The projection is orthographic.

#define TRACER_OFFSET 2e-4  // A ray starts at this distance from a surface.
#define TRACER_FAR 8.0
#define TRACER_CLOSE 1e-5
#define TRACER_STEPS 160

uniform int tracer_pass;
uniform int tracer_bounces; // maximum number of scattering events in a path
uniform int tracer_size;
uniform bool tracer_ball;
uniform vec3 tracer_light; // direction to a distant light of irradiance pi; zero without a light
uniform sampler2D tracer_environment;
uniform bool tracer_mapped; // whether the environment is a map with texels to draw
uniform sampler2D tracer_drawn; // 256 x 256 indices of texels, repeated in proportion to light
uniform sampler2D tracer_chance; // probability of drawing each texel
uniform mat3 tracer_foot; // rotation from the picture's frame to the shader ball's foot
uniform mat3 tracer_belt; // rotation from the foot's frame to the belt of the shader ball

out vec4 tracer_radiance; // rgb: radiance; a: squared mean of the three channels

vec3 tracer_random(int bounce)
{
    return path_random(uvec4(gl_FragCoord.xy, tracer_pass, bounce)).xyz;
}

// Signed distance to the surface, computed as in mxeon.shaders.shader_ball.
float tracer_distance(vec3 p)
{
    if (!tracer_ball)
    {
        return length(p) - 1.0;
    }
    vec3 upright = tracer_foot * p;
    vec3 q = tracer_belt * (upright - vec3(0.0, 0.2, 0.0));
    float ring = sqrt(0.72 * 0.72 - 0.13 * 0.13);
    float groove = length(vec2(length(q.xz) - ring, abs(q.y) - 0.13)) - 0.035;
    vec2 edge = vec2(length(upright.xz) - 0.5, abs(upright.y + 0.6) - 0.1) + 0.02;
    float foot = min(max(edge.x, edge.y), 0.0) + length(max(edge, 0.0)) - 0.02;
    return min(max(length(q) - 0.72, -groove), foot);
}

// Distance along a ray to the surface, or TRACER_FAR. The ray may start inside the shape.
float tracer_hit(vec3 origin, vec3 direction)
{
    float t = 0.0;
    for (int step = 0; step < TRACER_STEPS && t < TRACER_FAR; ++step)
    {
        float d = abs(tracer_distance(origin + t * direction));
        t += d;
        if (d < TRACER_CLOSE)
        {
            return t;
        }
    }
    return TRACER_FAR;
}

// Outward normal, computed from the distances at the corners of a small tetrahedron.
vec3 tracer_normal(vec3 p)
{
    if (!tracer_ball)
    {
        return normalize(p);
    }
    vec2 e = vec2(1e-3, -1e-3);
    return normalize(e.xyy * tracer_distance(p + e.xyy) + e.yyx * tracer_distance(p + e.yyx)
                     + e.yxy * tracer_distance(p + e.yxy) + e.xxx * tracer_distance(p + e.xxx));
}

Point tracer_point(vec3 position, vec3 normal, vec3 wo)
{
    vec3 east = vec3(normal.z, 0.0, -normal.x);
    vec3 tangent = dot(east, east) > 1e-12 ? normalize(east) : vec3(1.0, 0.0, 0.0);
    vec3 outward = tracer_ball ? tracer_foot * position - vec3(0.0, 0.2, 0.0) : normal;
    float latitude = atan(outward.y, length(outward.xz));
    vec2 texcoord = vec2(0.5 + atan(outward.x, outward.z) / (2.0 * M_PI), 0.5 + latitude / M_PI);
    return Point(position, normal, tangent, texcoord, dot(normal, wo) < 0.0 && !(material_is_thin_walled));
}

// Texture coordinates of a direction; MaterialX rotates the environment by 180 degrees.
vec2 tracer_latlong(vec3 direction)
{
    float longitude = atan(-direction.x, direction.z) / (2.0 * M_PI) + 0.5;
    return vec2(longitude, 0.5 - asin(clamp(direction.y, -1.0, 1.0)) / M_PI);
}

vec3 tracer_sky(vec3 direction)
{
    return textureLod(tracer_environment, tracer_latlong(direction), 0.0).rgb;
}

// Probability density with which tracer_towards draws a direction, in 1/sr.
float tracer_sky_pdf(vec3 direction)
{
    vec2 size = vec2(textureSize(tracer_chance, 0));
    float chance = texelFetch(tracer_chance, ivec2(min(tracer_latlong(direction) * size, size - 1.0)), 0).x;
    float area = 2.0 * M_PI * M_PI * sqrt(max(1.0 - direction.y * direction.y, 1e-8)) / (size.x * size.y);
    return tracer_mapped ? chance / area : 0.0;
}

// Draws a texel of the environment, and a direction towards the texel.
vec3 tracer_towards(vec3 u)
{
    int k = int(u.x * 65536.0);
    float texel = texelFetch(tracer_drawn, ivec2(k % 256, k / 256), 0).x;
    vec2 size = vec2(textureSize(tracer_chance, 0));
    vec2 at = (vec2(mod(texel, size.x), floor(texel / size.x)) + u.yz) / size;
    float longitude = 2.0 * M_PI * (at.x - 0.5);
    float polar = M_PI * at.y;
    return vec3(-sin(polar) * sin(longitude), cos(polar), sin(polar) * cos(longitude));
}

bool tracer_is_shadowed(vec3 position, vec3 normal, vec3 wi)
{
    return tracer_hit(position + TRACER_OFFSET * sign(dot(wi, normal)) * normal, wi) < TRACER_FAR;
}

// Direct light from the distant light and the environment, scattered towards wo. Paths also sample
// the environment by the material, so the balance heuristic [Veach1995] weights both samples.
vec3 tracer_lit(Point p, vec3 normal, vec3 wo, vec3 u)
{
    vec3 lit = vec3(0.0);
    if (dot(tracer_light, tracer_light) > 0.0 && !tracer_is_shadowed(p.position, normal, tracer_light))
    {
        lit = M_PI * material_evaluate(p, wo, tracer_light);
    }
    vec3 wi = tracer_towards(u);
    float pdf = tracer_sky_pdf(wi);
    if (pdf > 0.0 && !tracer_is_shadowed(p.position, normal, wi))
    {
        lit += material_evaluate(p, wo, wi) * tracer_sky(wi) / (pdf + material_pdf(p, wo, wi));
    }
    return lit;
}

void main()
{
    // Pictures of the sphere are compared at pixel centers, so rays go through the centers.
    vec2 within = tracer_ball ? tracer_random(-1 - tracer_bounces - 1).xy : vec2(0.5);
    vec2 at = (2.0 * (gl_FragCoord.xy - 0.5 + within) - float(tracer_size)) / float(tracer_size);
    vec3 origin = vec3(at, 2.0);
    vec3 direction = vec3(0.0, 0.0, -1.0);
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    float pdf = 0.0;
    for (int bounce = 0; bounce <= tracer_bounces; ++bounce)
    {
        float t = tracer_hit(origin, direction);
        if (t >= TRACER_FAR)
        {
            // A camera ray that hits nothing stays black, because compositing adds the sky.
            float drawn = bounce == 0 ? 0.0 : pdf > 0.0 ? pdf / (pdf + tracer_sky_pdf(direction)) : 1.0;
            radiance += throughput * tracer_sky(direction) * drawn;
            break;
        }
        vec3 position = origin + t * direction;
        vec3 normal = tracer_normal(position);
        Point p = tracer_point(position, normal, -direction);
        radiance += throughput * (material_emitted(p, -direction) + tracer_lit(p, normal, -direction, tracer_random(-1 - bounce)));
        vec3 wi;
        vec3 weight;
        if (bounce == tracer_bounces || !material_sample(p, -direction, tracer_random(bounce), wi, weight, pdf))
        {
            break;
        }
        throughput *= weight;
        direction = wi;
        origin = position + TRACER_OFFSET * sign(dot(wi, normal)) * normal;
    }
    float mean = dot(radiance, vec3(1.0 / 3.0));
    tracer_radiance = vec4(radiance, mean * mean);
}
