// SPDX-License-Identifier: Apache-2.0
// The stage's shapes as functions that intersect rays.
//
// STAGE_SHAPE selects the shape: 0 a sphere, 1 a sphere on a plane, 2 a hanging cloth, 3 a ball cut
// open around a core, on a foot, 4 a lock of fibers. World frame: x to the right, y up, z towards
// the viewer. The unit of length is the sphere's radius.

#define STAGE_NEVER 1.0e9
// Offset of a ray's origin from the surface, so that the ray does not hit the same surface again.
#define STAGE_OFFSET 1.0e-3
#define STAGE_NOTHING 0
#define STAGE_SUBJECT 1 // part with the material
#define STAGE_FLOOR 2 // gray part, excluded from the comparison

#define STAGE_FLOOR_RHO 0.35

// The cut through the ball, and the ball's foot.
#define STAGE_CUT_LEFT vec3(0.9205049, 0.0, 0.3907311)
#define STAGE_CUT_RIGHT vec3(-0.4848096, 0.0, 0.8746197)
#define STAGE_CUT_AT 0.04
#define STAGE_CUT_SILL -0.42
#define STAGE_INSIDE 0.86
#define STAGE_CORE 0.52
#define STAGE_FOOT 0.6
#define STAGE_FOOT_TOP -0.8 // The shell covers the foot's top here, so the foot needs no lid.
#define STAGE_GROUND -1.15

#define STAGE_CLOTH_WIDTH 1.5
#define STAGE_CLOTH_HEIGHT 1.12
#define STAGE_CLOTH_DEPTH 0.27
#define STAGE_CLOTH_STEPS 32

// The fibers are rings around an axis along z. Only the tops of the rings are visible.
#define STAGE_BEND -1.9
#define STAGE_FIRST_RING 1.25
#define STAGE_RING_GAP 0.2
#define STAGE_RINGS 7.0
#define STAGE_FIBER 0.085
#define STAGE_FIBER_STEPS 40
#define STAGE_FIBER_NEAR 5.0e-5

struct Hit {
    float t;
    vec3 normal; // Faces the origin of the ray.
    int part;
};

// Replace the nearest hit so far if the new hit is nearer and in front of the ray's origin.
void stage_keep(inout Hit hit, float t, vec3 normal, int part)
{
    if (t > 0.0 && t < hit.t)
        hit = Hit(t, normal, part);
}

// First and last intersections of a ray with a sphere around the origin, or negative numbers.
vec2 stage_sphere(vec3 origin, vec3 direction, float radius)
{
    float ahead = dot(origin, direction);
    vec3 beside = origin - ahead * direction;
    float squared = radius * radius - dot(beside, beside);
    return squared > 0.0 ? vec2(-sqrt(squared), sqrt(squared)) - ahead : vec2(-1.0);
}

void stage_plane(inout Hit hit, vec3 origin, vec3 direction, float height, int part)
{
    if (direction.y < 0.0)
        stage_keep(hit, (height - origin.y) / direction.y, vec3(0.0, 1.0, 0.0), part);
}

#if STAGE_SHAPE == 0 || STAGE_SHAPE == 1
Hit stage_nearest(vec3 origin, vec3 direction)
{
    Hit hit = Hit(STAGE_NEVER, vec3(0.0), STAGE_NOTHING);
    vec2 ends = stage_sphere(origin, direction, 1.0);
    float t = ends.x > 0.0 ? ends.x : ends.y; // The far side, hit from inside.
    vec3 normal = normalize(origin + t * direction);
    stage_keep(hit, t, faceforward(normal, direction, normal), STAGE_SUBJECT);
#if STAGE_SHAPE == 1
    stage_plane(hit, origin, direction, -1.0, STAGE_SUBJECT);
#endif
    return hit;
}
#elif STAGE_SHAPE == 2
// Depth z of the cloth and the slopes of z in x and y. Two waves grow towards the hem.
vec3 stage_cloth(vec2 p)
{
    float depth = 0.125 - 0.06 * p.y;
    float first = 5.2 * p.x + 0.7 * sin(1.6 * p.y + 0.5);
    float second = 9.1 * p.x - 1.3 * p.y + 0.8;
    float wave = sin(first) + 0.35 * sin(second);
    float across = 5.2 * cos(first) + 3.185 * cos(second);
    float down = 1.12 * cos(1.6 * p.y + 0.5) * cos(first) - 0.455 * cos(second);
    return vec3(depth * wave, depth * across, depth * down - 0.06 * wave);
}

// Signed distance in z from the cloth to a point, positive in front of the cloth.
float stage_before_cloth(vec3 p)
{
    return p.z - stage_cloth(p.xy).x;
}

// March through the slab that contains the cloth, then bisect the step that crosses the cloth.
Hit stage_nearest(vec3 origin, vec3 direction)
{
    Hit hit = Hit(STAGE_NEVER, vec3(0.0), STAGE_NOTHING);
    vec3 size = vec3(STAGE_CLOTH_WIDTH, STAGE_CLOTH_HEIGHT, STAGE_CLOTH_DEPTH);
    vec3 inverse = 1.0 / (direction + vec3(equal(direction, vec3(0.0))) * 1.0e-6);
    vec3 near = -origin * inverse - abs(inverse) * size;
    vec3 far = -origin * inverse + abs(inverse) * size;
    float from = max(max(near.x, near.y), max(near.z, 0.0));
    float step = (min(min(far.x, far.y), far.z) - from) / float(STAGE_CLOTH_STEPS);
    if (step <= 0.0)
        return hit;
    float side = sign(stage_before_cloth(origin + from * direction));
    for (int k = 0; k < STAGE_CLOTH_STEPS; ++k) {
        from += step;
        if (side * stage_before_cloth(origin + from * direction) < 0.0) {
            for (int half_step = 0; half_step < 11; ++half_step) {
                step *= 0.5;
                float behind = side * stage_before_cloth(origin + from * direction);
                from += behind < 0.0 ? -step : step;
            }
            vec3 cloth = stage_cloth((origin + from * direction).xy);
            stage_keep(hit, from, side * normalize(vec3(-cloth.yz, 1.0)), STAGE_SUBJECT);
            return hit;
        }
    }
    return hit;
}
#elif STAGE_SHAPE == 4
// xyz: vector from the core of the nearest fiber; w: distance from the fiber's surface.
vec4 stage_fiber(vec3 p)
{
    vec2 across = p.xy - vec2(0.0, STAGE_BEND);
    float ring = length(across);
    float index = clamp(round((ring - STAGE_FIRST_RING) / STAGE_RING_GAP), 0.0, STAGE_RINGS - 1.0);
    float beside = ring - STAGE_FIRST_RING - STAGE_RING_GAP * index;
    vec3 core = vec3(beside * across / ring, p.z);
    return vec4(core, length(core) - STAGE_FIBER);
}

// Sphere tracing starts in the plane in front of the fibers. Each step along the ray is the
// distance to the nearest fiber.
Hit stage_nearest(vec3 origin, vec3 direction)
{
    Hit hit = Hit(STAGE_NEVER, vec3(0.0), STAGE_NOTHING);
    if (direction.z >= 0.0)
        return hit;
    float t = max((STAGE_FIBER - origin.z) / direction.z, 0.0);
    for (int k = 0; k < STAGE_FIBER_STEPS; ++k) {
        vec4 fiber = stage_fiber(origin + t * direction);
        if (fiber.w < STAGE_FIBER_NEAR) {
            stage_keep(hit, t, normalize(fiber.xyz), STAGE_SUBJECT);
            return hit;
        }
        t += fiber.w;
    }
    return hit;
}
#else
// Distances of a point in the cut from the two upright faces and from the sill of the cut.
vec3 stage_in_cut(vec3 p)
{
    return vec3(dot(p, STAGE_CUT_LEFT) - STAGE_CUT_AT, dot(p, STAGE_CUT_RIGHT) - STAGE_CUT_AT,
                p.y - STAGE_CUT_SILL);
}

bool stage_cut(vec3 p)
{
    return all(greaterThan(stage_in_cut(p), vec3(0.0)));
}

// A plane face of the cut through the shell, seen from the cut. `other` excludes the face itself
// from the test of bounds.
void stage_face(inout Hit hit, vec3 origin, vec3 direction, vec3 normal, float height, vec3 other)
{
    float t = (height - dot(origin, normal)) / dot(direction, normal);
    vec3 p = origin + t * direction;
    float radius = length(p);
    bool bounded = all(greaterThan(stage_in_cut(p) + other, vec3(0.0)));
    if (dot(direction, normal) < 0.0 && bounded && radius > STAGE_INSIDE && radius < 1.0)
        stage_keep(hit, t, normal, STAGE_SUBJECT);
}

// The shell from outside and, through the opening, from inside.
void stage_shell(inout Hit hit, vec3 origin, vec3 direction)
{
    float t = stage_sphere(origin, direction, 1.0).x;
    vec3 p = origin + t * direction;
    if (!stage_cut(p))
        stage_keep(hit, t, p, STAGE_SUBJECT);
    t = stage_sphere(origin, direction, STAGE_INSIDE).y;
    p = origin + t * direction;
    if (!stage_cut(p))
        stage_keep(hit, t, -p / STAGE_INSIDE, STAGE_SUBJECT);
}

// An upright cylinder, seen from outside.
void stage_foot(inout Hit hit, vec3 origin, vec3 direction)
{
    float a = dot(direction.xz, direction.xz);
    float b = dot(origin.xz, direction.xz);
    float c = dot(origin.xz, origin.xz) - STAGE_FOOT * STAGE_FOOT;
    float t = (-b - sqrt(max(b * b - a * c, 0.0))) / a;
    vec3 p = origin + t * direction;
    if (b * b > a * c && p.y < STAGE_FOOT_TOP && p.y > STAGE_GROUND)
        stage_keep(hit, t, vec3(p.x, 0.0, p.z) / STAGE_FOOT, STAGE_SUBJECT);
}

Hit stage_nearest(vec3 origin, vec3 direction)
{
    Hit hit = Hit(STAGE_NEVER, vec3(0.0), STAGE_NOTHING);
    stage_shell(hit, origin, direction);
    stage_face(hit, origin, direction, STAGE_CUT_LEFT, STAGE_CUT_AT, vec3(9.0, 0.0, 0.0));
    stage_face(hit, origin, direction, STAGE_CUT_RIGHT, STAGE_CUT_AT, vec3(0.0, 9.0, 0.0));
    stage_face(hit, origin, direction, vec3(0.0, 1.0, 0.0), STAGE_CUT_SILL, vec3(0.0, 0.0, 9.0));
    float core = stage_sphere(origin, direction, STAGE_CORE).x;
    stage_keep(hit, core, (origin + core * direction) / STAGE_CORE, STAGE_SUBJECT);
    stage_foot(hit, origin, direction);
    stage_plane(hit, origin, direction, STAGE_GROUND, STAGE_FLOOR);
    return hit;
}
#endif

// Opacity of the floor, which fades into the page, or 1 for other parts.
float stage_opacity(vec3 p)
{
#if STAGE_SHAPE == 1
    return p.y > -0.9999 ? 1.0 : 1.0 - smoothstep(2.1, 4.2, length(p.xz));
#elif STAGE_SHAPE == 3
    return p.y > STAGE_GROUND + 1.0e-4 ? 1.0 : 1.0 - smoothstep(1.7, 3.6, length(p.xz));
#else
    return 1.0;
#endif
}

// Visible share of the surroundings at a point. The share is exact for the sphere, and for planes
// from which the sphere hides the share cosine / d^2. All other shares are rough estimates, which
// path tracing does not use.
float stage_ambient(vec3 p, vec3 normal)
{
#if STAGE_SHAPE == 0 || STAGE_SHAPE == 4
    return 1.0;
#elif STAGE_SHAPE == 2
    return clamp(0.75 + 1.4 * p.z, 0.3, 1.0);
#else
    float down = 0.5 - 0.5 * normal.y;
    float open = 1.0 - 0.6 * down;
#if STAGE_SHAPE == 1
    if (p.y < -0.9999)
        open = 1.0 - pow(dot(p, p), -1.5);
#else
    float radius = length(p);
    if (p.y < STAGE_GROUND + 1.0e-4)
        open = 1.0 + STAGE_GROUND * pow(dot(p, p), -1.5);
    else if (dot(p, normal) < 0.0)
        open = 0.35;
    else if (radius < STAGE_CORE + 1.0e-3)
        open = clamp(0.35 + 0.45 * dot(normal, normalize(STAGE_CUT_LEFT + STAGE_CUT_RIGHT)), 0.12, 1.0);
    else if (radius > 1.0e-3 + 1.0)
        open *= mix(0.9, 0.4, smoothstep(STAGE_GROUND, STAGE_FOOT_TOP, p.y));
    else
        open *= 1.0 - 0.45 * smoothstep(-0.55, -0.85, p.y);
#endif
    return clamp(open, 0.0, 1.0);
#endif
}
