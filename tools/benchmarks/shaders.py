# SPDX-License-Identifier: Apache-2.0
"""Values and sampling of EON in a compute shader, nanoseconds per call and invocation.

Each invocation calls its function many times, with arguments that change unpredictably from call to call, and stores the
sum. The time of a loop that only adds up the arguments is subtracted. A loop of one pass gives the values of the first
arguments, which are compared with float64. Software devices are measured by processor time, which excludes other work.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import MaterialX as mx
import moderngl
import numpy as np

from mxeon.conformance.specs import diffuse
from mxeon.models.diffuse import eon_brdf
from mxeon.shaders import functions as twins
from tools.benchmarks.rounds import Check, Group, clock_of, figure, interleave
from tools.paper.samplers import SAMPLERS

PRINTED = Path(__file__).with_name("printed.glsl")
CALLS, INVOCATIONS = 256, 2**14
COLUMNS = ("mu_o", "mu_i", "turn", "roughness", "r", "g", "b", "u1", "u2")

# pi f cos in float32, as in the conformance checks.
VALUE = diffuse.VALUE.value
# Listing 1 in float32: 1 - E loses digits, 1.3e-4 in E, and 3.61 x 0.29 x 1.3e-4 x 2 in the value.
EXACT = 3e-4
# [Portsmouth2025], Eq. (14): 6.0e-4 in E, twice 3.61 x 0.288 x 6.0e-4 in the value.
QUARTIC = 1.25e-3
# Weights of samples: a random number stretched over a part, and its rounding with it, tenfold.
WEIGHT = 2e-4
# Share of samples close to a border between parts, which may fall on its other side.
SHARE = 2e-3
# Largest weights of samples away from borders, of the cosine and of transformed cosines; the tolerance
# of a value is in proportion.
LARGEST, LARGEST_LTC = 20.0, 4.0

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
    vec3 sum = vec3(0.0);
    for (int i = 0; i < calls; ++i)
    {
        float S_o = sqrt(1.0 - mu_o * mu_o), S_i = sqrt(1.0 - mu_i * mu_i);
        float x = 2.0 * turn - 1.0;
        vec3 wo = vec3(S_o, 0.0, mu_o), wi = vec3(S_i * x, S_i * sqrt(1.0 - x * x), mu_i);
        float cosine = dot(wo, wi);
        %s
        mu_o = fract(mu_o + 0.6180339); mu_i = fract(mu_i + 0.4142135); turn = fract(turn + 0.7320508);
        u1 = fract(u1 + 0.3247179); u2 = fract(u2 + 0.5698402);
        roughness = fract(roughness + 0.2360679);
        rho = fract(rho + vec3(0.1622776, 0.6457513, 0.3166247));
    }
    sums[3u * k] = sum.x; sums[3u * k + 1u] = sum.y; sums[3u * k + 2u] = sum.z;
}
"""
BASES = {
    "value": "sum += rho * (cosine + mu_o + mu_i + roughness);",
    "draw": "sum += rho * (wo.x + wo.z + u1 + u2 + roughness);",
}  # the loops to subtract


@dataclass(frozen=True)
class Rival:
    statement: str  # GLSL that adds to `sum`
    base: str  # key in BASES
    exact: Callable[[Mapping[str, np.ndarray]], np.ndarray]  # maps columns of arguments to (N, 3)
    tolerance: float


def directions(a):
    """Unit directions from columns of arguments, in float64."""
    mu_o, mu_i, x = a["mu_o"], a["mu_i"], 2.0 * a["turn"] - 1.0
    S_o, S_i = np.sqrt(1.0 - mu_o**2), np.sqrt(1.0 - mu_i**2)
    wi = np.stack([S_i * x, S_i * np.sqrt(1.0 - x * x), mu_i], -1)
    return np.stack([S_o, 0.0 * S_o, mu_o], -1), wi


def value_of(a):
    return eon_brdf(*directions(a), np.stack([a["r"], a["g"], a["b"]], -1), a["roughness"])


def weight_of(name, a):
    """EON times the cosine over the density of the sampler's own sample, 0 below."""
    sampler = next(each for each in SAMPLERS if each.name == name)
    wo, _ = directions(a)
    wi, pdf = sampler.sample(wo, np.stack([a["u1"], a["u2"]], -1), a["roughness"])
    above = wi[:, 2] > 0.0
    wi = np.where(above[:, None], wi, [0.0, 0.0, 1.0])
    share = np.divide(wi[:, 2], pdf, out=np.zeros_like(pdf), where=above)
    rho = np.stack([a["r"], a["g"], a["b"]], -1)
    return eon_brdf(wo, wi, rho, a["roughness"]) * share[:, None]


def _value(call, tolerance):
    return Rival(f"sum += {call};", "value", value_of, tolerance)


def _draw(draw, pdf, value, sampler, tolerance):
    """Sample, density and value together."""
    body = f"{{ {draw} sum += {value} * (wi.z / {pdf}); }}"
    return Rival(body, "draw", partial(weight_of, sampler), tolerance)


EON = "eon_brdf(wo, wi, rho, roughness)"
DRAWN = "printed_quartic(min(wo.z, 1.0), min(wi.z, 1.0), dot(wo, wi) - wo.z * wi.z, rho, roughness)"
COSINE = "wi = cosine_sample(u1, u2);", "cosine_pdf(wi)"
MIXTURE = "vec4 w = printed_sample(wo, u1, u2, roughness); wi = w.xyz;", "w.w"
OWN = "wi = eon_sample(wo, u1, u2, 1.0, roughness);", "eon_pdf(wo, wi, 1.0, roughness)"
RIVALS = {
    "EON, quartic": _value(
        "printed_quartic(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)", QUARTIC
    ),
    "EON, stock": _value(
        "mx_oren_nayar_compensated_diffuse(mu_o, mu_i, cosine, roughness, rho) / EON_PI", EXACT
    ),
    "EON, eonlib": _value("eon_brdf_mu(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)", VALUE),
    "cosine + quartic": _draw(*COSINE, DRAWN, "cosine", LARGEST * QUARTIC),
    "CLTC + quartic": _draw(*MIXTURE, DRAWN, "eon_cltc", LARGEST_LTC * QUARTIC),
    "CLTC + eonlib": _draw(*MIXTURE, EON, "eon_cltc", LARGEST_LTC * VALUE + WEIGHT),
    "exact + eonlib": _draw(*OWN, EON, "eon", WEIGHT),
}
GOALS = (
    ("EON, eonlib", "EON, quartic", 0.9),
    ("EON, eonlib", "EON, stock", 0.7),
    ("exact + eonlib", "CLTC + quartic", None),
    ("exact + eonlib", "cosine + quartic", None),
)


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

    def kernel(self, statement):
        """The compiled loop around a statement."""
        return self.context.compute_shader(KERNEL % (self.source, statement))

    def run(self, kernel, calls=CALLS):
        """The sums over `calls` calls, as raw device memory, after completion."""
        self._given.bind_to_storage_buffer(0)
        self._sums.bind_to_storage_buffer(1)
        kernel["calls"].value = calls
        kernel.run(self.invocations // 64)
        self.context.finish()

    def checked(self, name, kernel):
        """The check of a rival's values: the largest error, except for the share of samples."""
        rival = RIVALS[name]
        self.run(kernel, calls=1)
        values = np.frombuffer(self._sums.read(), np.float32).reshape(-1, 3)
        error = np.abs(values - rival.exact(self.columns)).max(axis=1)
        if rival.base == "value":
            error, share = error * np.pi * self.columns["mu_i"], 0.0
        else:
            share = SHARE
        worst = np.sort(error)[-1 - int(share * error.size)]
        return Check(name, float(worst), rival.tolerance)


def measure(rounds=21, invocations=INVOCATIONS, calls=CALLS):
    device = Device(invocations)
    kernels = {name: device.kernel(each.statement) for name, each in RIVALS.items()}
    bases = {name: device.kernel(text) for name, text in BASES.items()}
    checks = tuple(device.checked(name, kernel) for name, kernel in kernels.items())
    runs = {n: partial(device.run, k, calls) for n, k in (bases | kernels).items()}
    renderer = device.context.info["GL_RENDERER"]
    seconds = interleave(runs, rounds, clock_of(renderer))
    net = {name: seconds[name] - seconds[each.base] for name, each in RIVALS.items()}
    factor = 1e9 / (invocations * calls)
    figures = [figure(name, "ns", factor * values) for name, values in net.items()]
    figures += [figure(f"{a} / {b}", "x", net[a] / net[b], goal) for a, b, goal in GOALS]
    return Group("shaders", f"Shaders on {renderer}, ns per call", tuple(figures), checks)
