// SPDX-License-Identifier: Apache-2.0
// The cosine of a distant light, blurred over a unit sphere by the normalized diffusion profile.

#define SUBSURFACE_RINGS 8

// Mean of max(cos(theta), 0) over the circle at the end of a chord from a point whose cosine is mu.
float subsurface_ring(float mu, float chord)
{
    float squared = chord * chord;
    float along = mu * (1.0 - 0.5 * squared);
    float across = sqrt(max((1.0 - mu * mu) * squared * (1.0 - 0.25 * squared), 0.0));
    if (along >= across)
    {
        return along;
    }
    if (along <= -across)
    {
        return 0.0;
    }
    float lit = acos(clamp(-along / across, -1.0, 1.0));
    return (along * lit + sqrt(max(across * across - along * along, 0.0))) / 3.14159265358979;
}

// Mean over one exponential of the profile, at the middles of parts of equal light, and its share.
vec2 subsurface_exponential(float mu, float reach)
{
    float share = 1.0 - exp(-2.0 / max(reach, 1e-6));  // the sphere ends at a distance of 2
    float sum = 0.0;
    for (int i = 0; i < SUBSURFACE_RINGS; i++)
    {
        float u = (float(i) + 0.5) / float(SUBSURFACE_RINGS);
        sum += subsurface_ring(mu, min(-reach * log(1.0 - u * share), 2.0));
    }
    return vec2(sum / float(SUBSURFACE_RINGS), share);
}

// The blurred cosine; `reach` is the mean free path over the radius of the sphere.
float subsurface_blur(float mu, float reach)
{
    vec2 near = subsurface_exponential(mu, reach);
    vec2 far = subsurface_exponential(mu, 3.0 * reach);
    return (near.x * near.y + 3.0 * far.x * far.y) / (near.y + 3.0 * far.y);
}
