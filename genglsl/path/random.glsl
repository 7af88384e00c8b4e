// SPDX-License-Identifier: Apache-2.0
// Random numbers for path tracers that have no generator.

// One round of pcg4d.
uvec4 path_mixed(uvec4 v)
{
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Four random numbers of 24 bits in [0, 1) from counters, such as pixel, pass and bounce: pcg4d of
// [Jarzynski2020].
vec4 path_random(uvec4 counters)
{
    uvec4 v = path_mixed(counters * 1664525u + 1013904223u);
    v = path_mixed(v ^ (v >> 16u));
    return vec4(v >> 8u) / 16777216.0;
}
