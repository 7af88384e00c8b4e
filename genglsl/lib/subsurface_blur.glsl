// SPDX-License-Identifier: Apache-2.0
// The cosine of a distant light, blurred over a unit sphere by the normalized diffusion profile.

// Positive nodes and weights of Gauss's rule over [-1, 1].
#define SUBSURFACE_RINGS 6
#define SUBSURFACE_GAUSS1 vec2(0.93246951, 0.17132449)
#define SUBSURFACE_GAUSS2 vec2(0.66120939, 0.36076157)
#define SUBSURFACE_GAUSS3 vec2(0.23861919, 0.46791393)

// Mean of max(cos(theta), 0), per channel, over the circle on the sphere at the distance `chord`
// from a point with cosine mu.
vec3 subsurface_ring(float mu, vec3 chord)
{
    vec3 squared = chord * chord;
    vec3 along = mu * (1.0 - 0.5 * squared);
    vec3 across = sqrt(max((1.0 - mu * mu) * squared * (1.0 - 0.25 * squared), 0.0));

    // If the terminator cuts the circle, add light, since negative cosines count as 0.
    vec3 height = min(abs(along) / max(across, 1e-30), 1.0);
    vec3 more = across * (sqrt(1.0 - height * height) - height * acos(height));
    return max(along, 0.0) + more / 3.14159265358979;
}

// `reach` is the mean free path divided by the radius. With t = exp(-r / (3 reach)) for the
// distance r, the profile is (1 + t^2) dt.
vec3 subsurface_blur(float mu, vec3 reach)
{
    vec3 least = exp(-2.0 / (3.0 * max(reach, 1e-6)));  // t at r = 2, the diameter
    vec3 light = vec3(0.0);
    vec3 total = vec3(0.0);

    // One ring is enough if `reach` is 0. Compilers do not unroll a loop whose count is an input.
    int rings = max(reach.x, max(reach.y, reach.z)) > 0.0 ? SUBSURFACE_RINGS : 1;
    for (int i = 0; i < rings; i++)
    {
        vec2 node = i == 0 || i == 5 ? SUBSURFACE_GAUSS1
                                     : (i == 1 || i == 4 ? SUBSURFACE_GAUSS2 : SUBSURFACE_GAUSS3);
        vec3 t = mix(least, vec3(1.0), 0.5 + 0.5 * (i < 3 ? node.x : -node.x));
        vec3 share = node.y * (1.0 + t * t);
        light += share * subsurface_ring(mu, min(-3.0 * reach * log(t), 2.0));
        total += share;
    }
    return light / total;
}
