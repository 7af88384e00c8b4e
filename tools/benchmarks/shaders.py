# SPDX-License-Identifier: Apache-2.0
"""Values and sampling in a compute shader, nanoseconds per call on one invocation's share.

Each invocation calls its function many times, with arguments that change from call to call in ways
no compiler foresees, and stores the sum. A loop that adds up the arguments alone is subtracted. A
loop of one pass gives the values of the first arguments, which are compared with float64. On a
software device processor time is taken, which other work on the machine does not enter.
"""

import re
from functools import partial
from pathlib import Path

import MaterialX as mx
import moderngl
import numpy as np

from mxeon.shaders import functions as twins
from tools.benchmarks.rivals import BASES, BRDFS, GOALS, RIVALS
from tools.benchmarks.rounds import Check, Group, clock_of, interleave, less, ratio, scaled

PRINTED = Path(__file__).with_name("printed.glsl")
CALLS, INVOCATIONS = 256, 2**14
COLUMNS = ("mu_o", "mu_i", "turn", "roughness", "r", "g", "b", "u1", "u2")

STEP = """
    mu_o = fract(mu_o + 0.6180339); mu_i = fract(mu_i + 0.4142135); turn = fract(turn + 0.7320508);
    u1 = fract(u1 + 0.3247179); u2 = fract(u2 + 0.5698402);"""
MATERIAL = """
    roughness = fract(roughness + 0.2360679);
    rho = fract(rho + vec3(0.1622776, 0.6457513, 0.3166247));"""
KERNEL = """#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Arguments { float given[]; };
layout(std430, binding = 1) buffer Sums { float sums[]; };
uniform int calls;
%s
void main()
{
    uint k = gl_GlobalInvocationID.x, n = 9u * k;
    float mu_o = given[n], mu_i = given[n + 1u], turn = given[n + 2u], roughness = given[n + 3u];
    vec3 rho = vec3(given[n + 4u], given[n + 5u], given[n + 6u]);
    float u1 = given[n + 7u], u2 = given[n + 8u];
    vec3 sum = vec3(0.0);%s
    for (int i = 0; i < calls; ++i)
    {
        float S_o = sqrt(1.0 - mu_o * mu_o), S_i = sqrt(1.0 - mu_i * mu_i);
        float x = 2.0 * turn - 1.0;
        vec3 wo = vec3(S_o, 0.0, mu_o), wi = vec3(S_i * x, S_i * sqrt(1.0 - x * x), mu_i);
        float cosine = dot(wo, wi);
        %s
        %s
    }
    sums[3u * k] = sum.x; sums[3u * k + 1u] = sum.y; sums[3u * k + 2u] = sum.z;
}
"""


def library_source():
    """The functions that the rivals call: the twins, the printed forms, and MaterialX's own."""
    ours = twins.source("glsl") + PRINTED.read_text(encoding="utf-8")
    stock = "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
    text = mx.readFile(mx.getDefaultDataSearchPath().find(stock).asString())
    constants = "\n".join(re.findall(r"^const float FUJII.*$", text, re.MULTILINE))
    functions = re.findall(r"^\w+ mx_oren_nayar_\w+\([^)]*\)\n\{.*?^\}", text, re.MULTILINE | re.S)
    kept = [each for each in functions if "fibonacci" not in each]
    square = "float mx_square(float x) { return x * x; } vec3 mx_square(vec3 x) { return x * x; }"
    macros = "#define M_PI 3.1415926535897932\n#define M_PI_INV (1.0 / M_PI)\n"
    macros += "#define M_FLOAT_EPS 1e-8\n#define mx_acos acos\n#define mx_sqrt sqrt\n"
    return "\n".join([ours, macros, square, constants, *kept])


class Device:
    """A compute device with the arguments of all invocations."""

    def __init__(self, invocations=INVOCATIONS):
        self.context = moderngl.create_standalone_context(require=430, backend="egl")
        self.source, self.invocations = library_source(), invocations
        rng = np.random.default_rng(5)
        given = np.float32(0.001 + 0.998 * rng.random((invocations, len(COLUMNS))))
        self.columns = dict(zip(COLUMNS, np.float64(given.T), strict=True))
        self._given = self.context.buffer(given.tobytes())
        self._sums = self.context.buffer(reserve=12 * invocations)

    def kernel(self, statement, before="", step=STEP + MATERIAL):
        """The compiled loop around a statement, after what comes before the loop."""
        return self.context.compute_shader(KERNEL % (self.source, before, statement, step))

    def run(self, kernel, calls=CALLS):
        """The sums of so many calls, as raw memory of the device, complete."""
        self._given.bind_to_storage_buffer(0)
        self._sums.bind_to_storage_buffer(1)
        kernel["calls"].value = calls
        kernel.run(self.invocations // 64)
        self.context.finish()

    def values(self, kernel):
        """Sum that one call adds, (N, 3)."""
        self.run(kernel, calls=1)
        return np.frombuffer(self._sums.read(), np.float32).reshape(-1, 3)


def checked(device, rival, kernel):
    """The check of a rival's values: the largest error but for its share."""
    error = np.abs(device.values(kernel) - rival.exact(device.columns)).max(axis=1)
    error = error * np.pi * device.columns["mu_i"] if rival.base in BRDFS else error
    worst = np.sort(error)[-1 - int(rival.share * error.size)]
    return Check(rival.name, float(worst), rival.tolerance)


def kernels(device):
    """The loops to subtract and those of the rivals, by name; a hoisted material stays the same."""
    bases = {
        name: device.kernel(text, step=STEP if name == "hoisted" else STEP + MATERIAL)
        for name, text in BASES.items()
    }
    found = {
        each.name: device.kernel(
            each.statement, each.before, STEP if each.base == "hoisted" else STEP + MATERIAL
        )
        for each in RIVALS
    }
    return bases, found


def measure(rounds=21, invocations=INVOCATIONS, calls=CALLS):
    """The `Group` of all rivals."""
    device = Device(invocations)
    bases, timed = kernels(device)
    checks = tuple(checked(device, each, timed[each.name]) for each in RIVALS)
    runs = {n: partial(device.run, k, calls) for n, k in (bases | timed).items()}
    renderer = device.context.info["GL_RENDERER"]
    seconds = interleave(runs, rounds, clock_of(renderer))
    net = {each.name: less(seconds[each.name], seconds[each.base]) for each in RIVALS}
    factor = 1e9 / (invocations * calls)
    figures = [scaled(name, "ns", values, factor) for name, values in net.items()]
    figures += [ratio(f"{a} / {b}", net[a], net[b], goal) for a, b, goal in GOALS]
    title = f"Shaders on {renderer}, ns per call"
    return Group("shaders", title, tuple(figures), checks)
