// SPDX-License-Identifier: Apache-2.0

#include "lib/questions.glsl"
#include "../layer_bsdf.glsl"
#include "../add_bsdf.glsl"
#include "../multiply_bsdfF.glsl"
#include "../multiply_bsdfC.glsl"
#include "libraries/pbrlib/genglsl/mx_mix_bsdf.glsl"
#include "libraries/pbrlib/genglsl/mx_layer_vdf.glsl"

// Combinations of two closures for path tracers. A draw chooses either closure.

// Draw or density of two closures, whose weights are scaled by the factors.
void path_combine(vec3 a, vec3 factor_a, vec3 b, vec3 factor_b, inout BSDF result)
{
    if (path_asked != PATH_VALUE)
    {
        result.response = path_either(path_scaled(a, factor_a), path_scaled(b, factor_b));
    }
    path_end(result);
}

void path_layer_bsdf(ClosureData closureData, BSDF top, BSDF base, out BSDF result)
{
    layer_bsdf(closureData, top, base, result);
    if (path_is_asked(closureData))
    {
        path_combine(top.response, vec3(1.0), base.response, max(top.throughput, 0.0), result);
    }
}

void path_layer_vdf(ClosureData closureData, BSDF top, VDF base, out BSDF result)
{
    mx_layer_vdf(closureData, top, base, result);
    if (path_is_asked(closureData))
    {
        path_combine(top.response, base.throughput, vec3(0.0), vec3(0.0), result);
    }
}

void path_mix_bsdf(ClosureData closureData, BSDF fg, BSDF bg, float mixValue, out BSDF result)
{
    mx_mix_bsdf(closureData, fg, bg, mixValue, result);
    if (path_is_asked(closureData))
    {
        path_combine(fg.response, vec3(mixValue), bg.response, vec3(1.0 - mixValue), result);
    }
}

void path_add_bsdf(ClosureData closureData, BSDF in1, BSDF in2, out BSDF result)
{
    add_bsdf(closureData, in1, in2, result);
    if (path_is_asked(closureData))
    {
        path_combine(in1.response, vec3(1.0), in2.response, vec3(1.0), result);
    }
}

void path_multiply_bsdfC(ClosureData closureData, BSDF in1, vec3 in2, out BSDF result)
{
    multiply_bsdfC(closureData, in1, in2, result);
    if (path_is_asked(closureData))
    {
        path_combine(in1.response, clamp(in2, 0.0, 1.0), vec3(0.0), vec3(0.0), result);
    }
}

void path_multiply_bsdfF(ClosureData closureData, BSDF in1, float in2, out BSDF result)
{
    path_multiply_bsdfC(closureData, in1, vec3(in2), result);
}
