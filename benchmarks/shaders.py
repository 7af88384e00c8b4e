# SPDX-License-Identifier: Apache-2.0
"""Values and sampling in a compute shader, nanoseconds per call on one invocation's share.

Each invocation calls its function many times, with arguments that change from call to call in ways
no compiler foresees, and stores the sum. A loop that adds up the arguments alone is subtracted. A
loop of one pass gives the values of the first arguments, which are compared with float64.
"""

import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import moderngl
import MaterialX as mx
import numpy as np

from benchmarks.rounds import Check, Group, interleave, less, ratio, scaled
from mxeon import albedo, models, sampling, twins

PRINTED = Path(__file__).with_name("printed.glsl")
CALLS, INVOCATIONS = 256, 2**14
COLUMNS = ("mu_o", "mu_i", "turn", "roughness", "r", "g", "b", "u1", "u2")

# What drivers' float32 leaves of pi f cos <= 2: 14 roundings and two fits; as the shader twins'.
VALUE = 2e-6
# Listing 1 in float32: 1 - E loses digits, 1.3e-4 in E, and 3.61 x 0.29 x 1.3e-4 x 2 in the value.
EXACT = 3e-4
# [Portsmouth2025], Eq. (14): 6.0e-4 in E, twice 3.61 x 0.288 x 6.0e-4 in the value.
QUARTIC = 1.25e-3
# Weights of samples: a random number stretched over a part, and its rounding with it, tenfold.
WEIGHT = 2e-4
# Samples beside a border between parts may fall to its other side.
SHARE = 2e-3

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
    vec3 sum = vec3(0.0);
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


@dataclass(frozen=True)
class Rival:
    """A function to time.

    Attributes
    ----------
    name : str
    statement : str
        GLSL that adds to `sum`.
    base : str
        The loop to subtract, by its statement's key in BASES.
    exact : callable or None
        Columns of arguments -> what the statement should add, (N, 3).
    tolerance : float
    share : float
        Of the elements, those that may miss the tolerance.
    """

    name: str
    statement: str
    base: str
    exact: object
    tolerance: float
    share: float = 0.0


# Rivals with these bases add BRDFs, which are compared times pi and the cosine.
BRDFS = ("color", "value", "frame")
BASES = {
    "color": "sum += rho;",
    "value": "sum += rho * (cosine + mu_o + mu_i + roughness);",
    "frame": "sum += rho * (dot(wo, wi) + wo.x + wo.z + wi.x + wi.z + roughness);",
    "albedo": "sum += rho * (mu_o + roughness);",
    "draw": "sum += rho * (wo.x + wo.z + u1 + u2 + roughness);",
    "pdf": "sum += vec3(wo.x + wo.z + wi.x + wi.y + wi.z + roughness);",
}


def frames(a):
    """Directions of columns of arguments, in float64, and unit."""
    mu_o, mu_i, x = a["mu_o"], a["mu_i"], 2.0 * a["turn"] - 1.0
    S_o, S_i = np.sqrt(1.0 - mu_o**2), np.sqrt(1.0 - mu_i**2)
    wi = np.stack([S_i * x, S_i * np.sqrt(1.0 - x * x), mu_i], -1)
    return np.stack([S_o, 0.0 * S_o, mu_o], -1), wi


def _rho(a):
    return np.stack([a["r"], a["g"], a["b"]], -1)


def value_of(brdf, a):
    """The BRDF at columns of arguments."""
    wo, wi = frames(a)
    parameter = () if brdf is models.lambert_brdf else (a["roughness"],)
    return brdf(wo, wi, _rho(a), *parameter)


def albedo_of(a):
    """Directional albedo of EON."""
    return albedo.eon_albedo_dir(a["mu_o"], _rho(a), a["roughness"])


def weight_of(name, a):
    """EON times the cosine over the density of the sampler's own sample."""
    wo, _ = frames(a)
    sampler = next(each for each in sampling.SAMPLERS if each.name == name)
    wi, pdf = sampler.sample(wo, np.stack([a["u1"], a["u2"]], -1), a["roughness"])
    return models.eon_brdf(wo, wi, _rho(a), a["roughness"]) * (wi[:, 2] / pdf)[:, None]


def pdf_of(name, a):
    """pi times the density of the given direction, in three equal channels."""
    sampler = next(each for each in sampling.SAMPLERS if each.name == name)
    return np.pi * np.repeat(sampler.pdf(*frames(a), a["roughness"])[:, None], 3, 1)


def _value(name, call, exact, tolerance=VALUE, base="value"):
    """A BRDF; `value_of` and `checked` compare it times pi and the cosine."""
    statement = f"sum += {call};"
    return Rival(name, statement, base, partial(value_of, exact), tolerance)


def _draw(name, wi, pdf, value, sampler, tolerance=WEIGHT):
    body = f"{{ {wi} sum += {value} * (wi.z / {pdf}); }}"
    return Rival(name, body, "draw", partial(weight_of, sampler), tolerance, SHARE)


TWIN = "{}(wo, wi, rho, roughness)"
OURS = "eon_brdf_mu(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)"
PAPER = "printed_{}(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)"
STOCK = "mx_oren_nayar_compensated_diffuse(mu_o, mu_i, cosine, roughness, rho) / EON_PI"
DRAWN = "printed_quartic(min(wo.z, 1.0), min(wi.z, 1.0), dot(wo, wi) - wo.z * wi.z, rho, roughness)"
EXACTLY = "eon_brdf(wo, wi, rho, roughness)"
RIVALS = (
    _value("Lambert", "rho / EON_PI", models.lambert_brdf, base="color"),
    _value("FON", TWIN.format("fon_brdf"), models.fon_brdf, base="frame"),
    _value("QON", TWIN.format("qon_brdf"), models.qon_brdf, base="frame"),
    _value("full Oren-Nayar", TWIN.format("oren_nayar_brdf"), models.oren_nayar_brdf, base="frame"),
    _value("EON, quartic", PAPER.format("quartic"), models.eon_brdf, QUARTIC),
    _value("EON, printed", PAPER.format("exact"), models.eon_brdf, EXACT),
    _value("EON, stock", STOCK, models.eon_brdf, EXACT),
    _value("EON, eonlib", OURS, models.eon_brdf),
    Rival("environment, quartic", "sum += printed_environment(mu_o, rho, roughness);", "albedo",
          albedo_of, QUARTIC),
    Rival("environment, stock",
          "sum += mx_oren_nayar_compensated_diffuse_dir_albedo(mu_o, roughness, rho);", "albedo",
          albedo_of, EXACT),
    Rival("environment, eonlib", "sum += eon_albedo_dir(mu_o, rho, roughness);", "albedo",
          albedo_of, VALUE),
    _draw("cosine + quartic", "wi = cosine_sample(u1, u2);", "cosine_pdf(wi)", DRAWN, "cosine",
          20 * QUARTIC),
    _draw("CLTC + quartic", "vec4 w = printed_sample(wo, u1, u2, roughness); wi = w.xyz;", "w.w",
          DRAWN, "eon_cltc", 4 * QUARTIC),
    _draw("exact + eonlib", "wi = eon_sample(wo, u1, u2, 1.0, roughness);",
          "eon_pdf(wo, wi, 1.0, roughness)", EXACTLY, "eon"),
    Rival("pdf, CLTC", "sum += vec3(EON_PI * eon_cltc_pdf(wo, wi, roughness));", "pdf",
          partial(pdf_of, "eon_cltc"), 2e-5),
    Rival("pdf, exact", "sum += vec3(EON_PI * eon_pdf(wo, wi, 1.0, roughness));", "pdf",
          partial(pdf_of, "eon"), 2e-5),
)
HOISTED = ("EON, quartic", "EON, stock", "EON, eonlib")
GOALS = (
    ("EON, eonlib", "EON, quartic", 0.9),
    ("EON, eonlib", "EON, stock", 0.7),
    ("EON, eonlib (hoisted)", "EON, quartic (hoisted)", None),
    ("EON, eonlib (hoisted)", "EON, quartic", 0.65),
    ("environment, eonlib", "environment, stock", None),
    ("environment, eonlib", "environment, quartic", None),
    ("exact + eonlib", "CLTC + quartic", 0.75),
    ("exact + eonlib", "cosine + quartic", None),
    ("pdf, exact", "pdf, CLTC", 0.5),
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

    def kernel(self, statement, material=MATERIAL):
        """The compiled loop around a statement."""
        return self.context.compute_shader(KERNEL % (self.source, statement, STEP + material))

    def run(self, kernel, calls=CALLS):
        """The sums of so many calls, as raw memory of the device, complete."""
        self._given.bind_to_storage_buffer(0)
        self._sums.bind_to_storage_buffer(1)
        kernel["calls"].value = calls
        kernel.run(self.invocations // 64)
        self.context.finish()

    def values(self, kernel):
        """What one call adds, (N, 3)."""
        self.run(kernel, calls=1)
        return np.frombuffer(self._sums.read(), np.float32).reshape(-1, 3)


def checked(device, rival, kernel):
    """The check of a rival's values: the largest error but for its share."""
    error = np.abs(device.values(kernel) - rival.exact(device.columns)).max(axis=1)
    error = error * np.pi * device.columns["mu_i"] if rival.base in BRDFS else error
    worst = np.sort(error)[-1 - int(rival.share * error.size)]
    return Check(rival.name, float(worst), rival.tolerance)


def measure(rounds=21, invocations=INVOCATIONS, calls=CALLS):
    """The `Group` of all rivals."""
    device = Device(invocations)
    timed = {each.name: each for each in RIVALS}
    kernels = {name: device.kernel(each.statement) for name, each in timed.items()}
    checks = tuple(checked(device, timed[name], kernel) for name, kernel in kernels.items())
    for name in HOISTED:
        kernels[f"{name} (hoisted)"] = device.kernel(timed[name].statement, "")
        timed[f"{name} (hoisted)"] = timed[name]
    bases = {key: device.kernel(text) for key, text in BASES.items()}
    bases["hoisted"] = device.kernel(BASES["value"], "")
    runs = {n: partial(device.run, k, calls) for n, k in (bases | kernels).items()}
    seconds = interleave(runs, rounds)
    base = {n: "hoisted" if n.endswith("(hoisted)") else each.base for n, each in timed.items()}
    net = {name: less(seconds[name], seconds[base[name]]) for name in timed}
    factor = 1e9 / (invocations * calls)
    figures = [scaled(name, "ns", values, factor) for name, values in net.items()]
    figures += [ratio(f"{a} / {b}", net[a], net[b], goal) for a, b, goal in GOALS]
    title = f"Shaders on {device.context.info['GL_RENDERER']}, ns per call, all cores"
    return Group("shaders", title, tuple(figures), checks)
