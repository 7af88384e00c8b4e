# SPDX-License-Identifier: Apache-2.0
"""Measures the time of a call of EON from eonlib and from stock MaterialX in a compute shader.

Times are nanoseconds per call in an invocation. Each invocation calls a function many times with
unpredictable arguments, and sums the values. The time of a loop that only adds the arguments is
subtracted. The first value of each invocation is compared with a float64 value.
"""

import re
from functools import partial

import MaterialX as mx
import moderngl
import numpy as np

from mxeon.conformance.specs import diffuse
from mxeon.models.diffuse import eon_brdf
from mxeon.shaders import functions as twins
from tools.benchmarks.rounds import Check, Figure, Group, clock_of, interleave

COUNT, INVOCATIONS = 256, 2**14  # calls per invocation, and number of invocations
KERNEL = """#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Arguments { float arguments[]; };
layout(std430, binding = 1) buffer Sums { float sums[]; };
uniform int calls;
%s
void main()
{
    uint k = gl_GlobalInvocationID.x, n = 7u * k;
    float mu_o = arguments[n], mu_i = arguments[n + 1u], turn = arguments[n + 2u], roughness = arguments[n + 3u];
    vec3 rho = vec3(arguments[n + 4u], arguments[n + 5u], arguments[n + 6u]);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < calls; ++i)
    {
        float S_o = sqrt(1.0 - mu_o * mu_o), S_i = sqrt(1.0 - mu_i * mu_i);
        float x = 2.0 * turn - 1.0;
        vec3 wo = vec3(S_o, 0.0, mu_o), wi = vec3(S_i * x, S_i * sqrt(1.0 - x * x), mu_i);
        float cosine = dot(wo, wi);
        sum += %s;
        mu_o = fract(mu_o + 0.6180339); mu_i = fract(mu_i + 0.4142135); turn = fract(turn + 0.7320508);
        roughness = fract(roughness + 0.2360679);
        rho = fract(rho + vec3(0.1622776, 0.6457513, 0.3166247));
    }
    sums[3u * k] = sum.x; sums[3u * k + 1u] = sum.y; sums[3u * k + 2u] = sum.z;
}
"""
CALLS = {
    "base": "rho * (cosine + mu_o + mu_i + roughness)",
    "stock": "mx_oren_nayar_compensated_diffuse(mu_o, mu_i, cosine, roughness, rho) / EON_PI",
    "eonlib": "eon_brdf_mu(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)",
}
# Tolerances of pi f cos in float32. Stock MaterialX follows Listing 1 of [Portsmouth2025], in which
# digits cancel, so E has errors of 1.3e-4, and the value has errors of 3.61 x 0.29 x 1.3e-4 x 2.
TOLERANCES = {"stock": 3e-4, "eonlib": diffuse.VALUE.value}


def library_source():
    """GLSL of the compared functions, from eonlib and from MaterialX."""
    stock = "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
    text = mx.readFile(mx.getDefaultDataSearchPath().find(stock).asString())
    constants = "\n".join(re.findall(r"^const float FUJII.*$", text, re.MULTILINE))
    functions = re.findall(r"^\w+ mx_oren_nayar_\w+\([^)]*\)\n\{.*?^\}", text, re.MULTILINE | re.S)
    functions = [each for each in functions if "fibonacci" not in each]
    square = "float mx_square(float x) { return x * x; } vec3 mx_square(vec3 x) { return x * x; }"
    macros = "#define M_PI 3.1415926535897932\n#define M_PI_INV (1.0 / M_PI)\n"
    macros += "#define M_FLOAT_EPS 1e-8\n#define mx_acos acos\n#define mx_sqrt sqrt\n"
    return "\n".join([twins.source("glsl"), macros, square, constants, *functions])


def value(arguments):
    """Values pi f cos(theta_i) in float64 for the first arguments of each invocation."""
    mu_o, mu_i, turn, roughness, *rho = np.float64(arguments.T)
    S_o, S_i, x = np.sqrt(1.0 - mu_o**2), np.sqrt(1.0 - mu_i**2), 2.0 * turn - 1.0
    wo = np.stack([S_o, 0.0 * S_o, mu_o], -1)
    wi = np.stack([S_i * x, S_i * np.sqrt(1.0 - x * x), mu_i], -1)
    return np.pi * mu_i[:, None] * eon_brdf(wo, wi, np.stack(rho, -1), roughness)


def measure(rounds=21, invocations=INVOCATIONS, calls=COUNT):
    context = moderngl.create_standalone_context(require=430, backend="egl")
    arguments = np.float32(0.001 + 0.998 * np.random.default_rng(5).random((invocations, 7)))
    context.buffer(arguments.tobytes()).bind_to_storage_buffer(0)
    sums = context.buffer(reserve=12 * invocations)
    sums.bind_to_storage_buffer(1)

    def run(kernel, calls):
        kernel["calls"].value = calls
        kernel.run(invocations // 64)
        context.finish()

    text, exact = library_source(), value(arguments)
    kernels = {name: context.compute_shader(KERNEL % (text, call)) for name, call in CALLS.items()}
    checks = []
    for name, tolerance in TOLERANCES.items():
        run(kernels[name], 1)
        found = np.frombuffer(sums.read(), np.float32).reshape(-1, 3)
        error = np.abs(np.pi * np.float64(arguments[:, 1:2]) * found - exact).max()
        checks.append(Check(f"EON, {name}", float(error), tolerance))
    renderer = context.info["GL_RENDERER"]
    runs = {name: partial(run, each, calls) for name, each in kernels.items()}
    seconds = interleave(runs, rounds, clock_of(renderer))
    stock, eonlib = (seconds[name] - seconds["base"] for name in TOLERANCES)
    factor = 1e9 / (invocations * calls)
    figures = (
        Figure("EON, stock", "ns", factor * stock),
        Figure("EON, eonlib", "ns", factor * eonlib),
        Figure("EON, eonlib / stock", "x", eonlib / stock, 0.7),
    )
    return Group(f"Shaders on {renderer}, ns per call", figures, tuple(checks))
