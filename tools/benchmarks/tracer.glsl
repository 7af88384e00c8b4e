// SPDX-License-Identifier: Apache-2.0
// A path tracer: one path per pixel and pass, with the value, sampling and density of the twins.
//
// Stands behind the twins, path_random and two macros: TRACER_SAMPLE(wo, u1, u2, r) and
// TRACER_PDF(wo, wi, r). World frame: x to the right, y up; the
// ball has radius 1 about the origin. The view is orthographic.

#define TRACER_OFFSET 1.0e-4 // From a surface to the origin of the next ray, against its own hit.
#define TRACER_NEVER 1.0e9
#define TRACER_GREY dot(tracer_rho, vec3(1.0 / 3.0)) // The rho that the exact sampler takes.

// The opened ball: where its shell is cut away, and what it stands on.
#define TRACER_CUT_LEFT vec3(0.9396926, 0.0, 0.3420201)
#define TRACER_CUT_RIGHT vec3(-0.3420201, 0.0, 0.9396926)
#define TRACER_CUT_AT 0.05
#define TRACER_INSIDE 0.88
#define TRACER_CORE 0.55
#define TRACER_FOOT 0.62
#define TRACER_FOOT_TOP -0.84
#define TRACER_GROUND -1.2

uniform int tracer_pass;
uniform int tracer_seed;
uniform int tracer_bounces; // Reflections that a path may have.
uniform vec3 tracer_rho;
uniform float tracer_roughness;
uniform vec3 tracer_light; // Unit, towards a distant light of irradiance pi; zero for none.
uniform float tracer_environment; // Radiance from everywhere beyond the objects.
uniform vec3 tracer_eye; // Unit, towards the viewer.
uniform vec3 tracer_frame; // Height of the picture's center, half of its width, its pixels.
uniform float tracer_floor; // Reflectance of a Lambertian floor; no floor below 0.

out vec4 tracer_radiance;

struct Hit {
    float t;
    vec3 normal; // Towards the origin of the ray.
    bool floor;
};

vec4 tracer_random(int dimension)
{
    return path_random(uvec4(gl_FragCoord.xy, tracer_pass, dimension + 65536 * tracer_seed));
}

// Keeps a hit if it is in front and the nearest so far.
void tracer_keep(inout Hit hit, float t, vec3 normal)
{
    if (t > 0.0 && t < hit.t)
        hit = Hit(t, normal, false);
}

// Where a ray meets a sphere about the origin, first and last; behind it if nowhere.
vec2 tracer_sphere(vec3 origin, vec3 direction, float radius)
{
    float ahead = dot(origin, direction);
    vec3 beside = origin - ahead * direction;
    float squared = radius * radius - dot(beside, beside);
    return squared > 0.0 ? vec2(-sqrt(squared), sqrt(squared)) - ahead : vec2(-1.0);
}

bool tracer_cut(vec3 p)
{
    return dot(p, TRACER_CUT_LEFT) > TRACER_CUT_AT && dot(p, TRACER_CUT_RIGHT) > TRACER_CUT_AT;
}

// The ball from outside and, where it is open, from its hollow.
void tracer_ball(inout Hit hit, vec3 origin, vec3 direction)
{
    float t = tracer_sphere(origin, direction, 1.0).x;
    vec3 p = origin + t * direction;
    if (!tracer_cut(p))
        tracer_keep(hit, t, p);
    t = tracer_sphere(origin, direction, TRACER_INSIDE).y;
    p = origin + t * direction;
    if (!tracer_cut(p))
        tracer_keep(hit, t, -p / TRACER_INSIDE);
}

// One of the two plane faces that the cut leaves in the shell; `beyond` bounds it.
void tracer_face(inout Hit hit, vec3 origin, vec3 direction, vec3 normal, vec3 beyond)
{
    float t = (TRACER_CUT_AT - dot(origin, normal)) / dot(direction, normal);
    vec3 p = origin + t * direction;
    float radius = length(p);
    if (radius > TRACER_INSIDE && radius < 1.0 && dot(p, beyond) > TRACER_CUT_AT)
        tracer_keep(hit, t, dot(direction, normal) < 0.0 ? normal : -normal);
}

// An upright cylinder with a lid, seen from outside.
void tracer_foot(inout Hit hit, vec3 origin, vec3 direction)
{
    float a = dot(direction.xz, direction.xz);
    float b = dot(origin.xz, direction.xz);
    float c = dot(origin.xz, origin.xz) - TRACER_FOOT * TRACER_FOOT;
    float t = (-b - sqrt(max(b * b - a * c, 0.0))) / a;
    vec3 p = origin + t * direction;
    if (b * b > a * c && p.y < TRACER_FOOT_TOP && p.y > TRACER_GROUND)
        tracer_keep(hit, t, vec3(p.x, 0.0, p.z) / TRACER_FOOT);
    t = (TRACER_FOOT_TOP - origin.y) / direction.y;
    p = origin + t * direction;
    if (direction.y < 0.0 && dot(p.xz, p.xz) < TRACER_FOOT * TRACER_FOOT)
        tracer_keep(hit, t, vec3(0.0, 1.0, 0.0));
}

// The nearest surface along a ray; its t is TRACER_NEVER if there is none.
Hit tracer_nearest(vec3 origin, vec3 direction)
{
    Hit hit = Hit(TRACER_NEVER, vec3(0.0), false);
    tracer_ball(hit, origin, direction);
    tracer_face(hit, origin, direction, TRACER_CUT_LEFT, TRACER_CUT_RIGHT);
    tracer_face(hit, origin, direction, TRACER_CUT_RIGHT, TRACER_CUT_LEFT);
    float core = tracer_sphere(origin, direction, TRACER_CORE).x;
    tracer_keep(hit, core, (origin + core * direction) / TRACER_CORE);
    tracer_foot(hit, origin, direction);
    float t = (TRACER_GROUND - origin.y) / direction.y;
    if (tracer_floor >= 0.0 && direction.y < 0.0 && t > 0.0 && t < hit.t)
        hit = Hit(t, vec3(0.0, 1.0, 0.0), true);
    return hit;
}

// The normal as the third of three axes, in columns.
mat3 tracer_axes(vec3 normal)
{
    vec3 up = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, -1.0);
    vec3 x = normalize(cross(up, normal));
    return mat3(x, cross(normal, x), normal);
}

vec3 tracer_value(bool floor, vec3 wo, vec3 wi)
{
    if (floor)
        return lambert_brdf(wo, wi, vec3(tracer_floor));
    return eon_brdf(wo, wi, tracer_rho, tracer_roughness);
}

// What the distant light sends towards wo.
vec3 tracer_lit(bool floor, vec3 p, mat3 axes, vec3 wo)
{
    vec3 wi = tracer_light * axes;
    if (wi.z <= 0.0 || tracer_nearest(p, tracer_light).t < TRACER_NEVER)
        return vec3(0.0);
    return EON_PI * wi.z * tracer_value(floor, wo, wi);
}

// Draws wi; returns the weight of the path that goes on there, 0 if it is wasted.
vec3 tracer_drawn(bool floor, vec3 wo, vec2 u, out vec3 wi)
{
    wi = cosine_sample(u.x, u.y);
    float pdf = cosine_pdf(wi);
    if (!floor) {
        wi = TRACER_SAMPLE(wo, u.x, u.y, tracer_roughness);
        pdf = wi.z > 0.0 ? TRACER_PDF(wo, wi, tracer_roughness) : 0.0;
    }
    return pdf > 0.0 ? tracer_value(floor, wo, wi) * wi.z / pdf : vec3(0.0);
}

// Radiance of one path that ends where it leaves the objects or has no reflection left.
vec3 tracer_path(vec3 origin, vec3 direction)
{
    vec3 radiance = vec3(0.0);
    vec3 weight = vec3(1.0);
    for (int bounce = 0; bounce <= tracer_bounces; ++bounce) {
        Hit hit = tracer_nearest(origin, direction);
        if (hit.t == TRACER_NEVER)
            return radiance + tracer_environment * weight;
        if (bounce == tracer_bounces || weight == vec3(0.0))
            break;
        mat3 axes = tracer_axes(hit.normal);
        vec3 wo = -direction * axes;
        wo.z = max(wo.z, 0.0);
        origin += hit.t * direction + TRACER_OFFSET * hit.normal;
        vec3 wi;
        if (tracer_light != vec3(0.0))
            radiance += weight * tracer_lit(hit.floor, origin, axes, wo);
        weight *= tracer_drawn(hit.floor, wo, tracer_random(1 + bounce).xy, wi);
        direction = normalize(axes * wi);
    }
    return radiance;
}

// A ray through a random point of the pixel.
void main()
{
    vec2 at = gl_FragCoord.xy + tracer_random(0).xy;
    at = (2.0 * (at - 0.5) / tracer_frame.z - 1.0) * tracer_frame.y;
    mat3 axes = tracer_axes(tracer_eye);
    vec3 origin = axes * vec3(at, 10.0) + vec3(0.0, tracer_frame.x, 0.0);
    tracer_radiance = vec4(tracer_path(origin, -tracer_eye), 1.0);
}
