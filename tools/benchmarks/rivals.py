# SPDX-License-Identifier: Apache-2.0
"""Functions in GLSL that the shader benchmark times, each with its value in float64.

The names of rows of Table 1 are "<sampler> + <value>", and "EON, <form>" for a value alone.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from mxeon.conformance.accuracy import diffuse as tolerances
from mxeon.models import sampling
from mxeon.models.diffuse import albedo
from mxeon.models.diffuse import brdf as models

# pi f cos in float32: as the conformance checks.
VALUE = tolerances.VALUE.value
# Listing 1 in float32: 1 - E loses digits, 1.3e-4 in E, and 3.61 x 0.29 x 1.3e-4 x 2 in the value.
EXACT = 3e-4
# [Portsmouth2025], Eq. (14): 6.0e-4 in E, twice 3.61 x 0.288 x 6.0e-4 in the value.
QUARTIC = 1.25e-3
# Weights of samples: a random number stretched over a part, and its rounding with it, tenfold.
WEIGHT = 2e-4
# Samples beside a border between parts may fall to its other side.
SHARE = 2e-3
# Largest weights but for that share, to scale the tolerances of values: cosine, and transformed.
LARGEST, LARGEST_LTC = 20.0, 4.0


@dataclass(frozen=True)
class Rival:
    """A function to time."""

    name: str
    statement: str  # GLSL that adds to `sum`
    base: str  # key in BASES of the loop to subtract
    exact: object  # columns of arguments -> what the statement should add, (N, 3)
    tolerance: float
    share: float = 0.0  # of the elements, those that may miss the tolerance
    before: str = ""  # GLSL before the loop: what depends on the material alone


# Rivals with these bases add BRDFs, which are compared times pi and the cosine.
BRDFS = ("color", "value", "frame", "hoisted")
BASES = {
    "color": "sum += rho;",
    "value": "sum += rho * (cosine + mu_o + mu_i + roughness);",
    "hoisted": "sum += rho * (cosine + mu_o + mu_i + roughness);",
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


def _of(brdf, wo, wi, a):
    parameter = () if brdf is models.lambert_brdf else (a["roughness"],)
    return brdf(wo, wi, _rho(a), *parameter)


def value_of(brdf, a):
    """The BRDF at columns of arguments."""
    return _of(brdf, *frames(a), a)


def albedo_of(a):
    """Directional albedo of EON."""
    return albedo.eon_albedo_dir(a["mu_o"], _rho(a), a["roughness"])


def _sampler(name):
    return next(each for each in sampling.SAMPLERS if each.name == name)


def weight_of(name, brdf, a):
    """The BRDF times the cosine over the density of the sampler's own sample, 0 below."""
    wo, _ = frames(a)
    wi, pdf = _sampler(name).sample(wo, np.stack([a["u1"], a["u2"]], -1), a["roughness"])
    above = wi[:, 2] > 0.0
    wi = np.where(above[:, None], wi, [0.0, 0.0, 1.0])
    share = np.divide(wi[:, 2], pdf, out=np.zeros_like(pdf), where=above)
    return _of(brdf, wo, wi, a) * share[:, None]


def pdf_of(name, a):
    """pi times the density of the given direction, in three equal channels."""
    density = _sampler(name).pdf(*frames(a), a["roughness"])
    return np.pi * np.repeat(density[:, None], 3, 1)


def _value(name, call, exact, tolerance=VALUE, base="value", before=""):
    """A BRDF; `value_of` and the benchmark compare it times pi and the cosine."""
    exact = partial(value_of, exact)
    return Rival(name, f"sum += {call};", base, exact, tolerance, before=before)


def _draw(name, draw, pdf, value, sampler, tolerance=WEIGHT, brdf=models.eon_brdf):
    """Sample, density and value together; a sample below the horizon counts 0."""
    body = f"{{ {draw} sum += {value} * (wi.z / {pdf}); }}"
    if sampler == "ltc":
        body = f"{{ {draw} if (wi.z > 0.0) sum += {value} * (wi.z / {pdf}); }}"
    return Rival(name, body, "draw", partial(weight_of, sampler, brdf), tolerance, SHARE)


TWIN = "{}(wo, wi, rho, roughness)"
OURS = "eon_brdf_mu(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)"
OURS_OF = "hoisted_eon(mu_o, mu_i, cosine - mu_o * mu_i, single, multiple, roughness)"
PAPER = "printed_{}(mu_o, mu_i, cosine - mu_o * mu_i, rho, roughness)"
PAPER_OF = "printed_quartic_of(mu_o, mu_i, cosine - mu_o * mu_i, scale, tint, roughness, A)"
STOCK = "mx_oren_nayar_compensated_diffuse(mu_o, mu_i, cosine, roughness, rho) / EON_PI"
MATERIAL_OURS = """
    vec3 single = fon_scale(rho, roughness);
    vec3 multiple = single * eon_multiple_weight(rho, roughness);"""
MATERIAL_PAPER = """
    float A = 1.0 / (1.0 + EON_C1 * roughness);
    vec3 scale = rho * (1.0 / EON_PI) * A, tint = printed_tint(rho, roughness, A);"""

VALUES = (
    _value("Lambert", "rho / EON_PI", models.lambert_brdf, base="color"),
    _value("FON", TWIN.format("fon_brdf"), models.fon_brdf, base="frame"),
    _value("QON", TWIN.format("qon_brdf"), models.qon_brdf, base="frame"),
    _value("full Oren-Nayar", TWIN.format("oren_nayar_brdf"), models.oren_nayar_brdf, base="frame"),
    _value("EON, quartic", PAPER.format("quartic"), models.eon_brdf, QUARTIC),
    _value("EON, printed", PAPER.format("exact"), models.eon_brdf, EXACT),
    _value("EON, stock", STOCK, models.eon_brdf, EXACT),
    _value("EON, eonlib", OURS, models.eon_brdf),
    _value("EON, quartic (hoisted)", PAPER_OF, models.eon_brdf, QUARTIC, "hoisted", MATERIAL_PAPER),
    _value(
        "EON, eonlib (hoisted, not shipped)",
        OURS_OF,
        models.eon_brdf,
        VALUE,
        "hoisted",
        MATERIAL_OURS,
    ),
    Rival(
        "environment, quartic",
        "sum += printed_environment(mu_o, rho, roughness);",
        "albedo",
        albedo_of,
        QUARTIC,
    ),
    Rival(
        "environment, stock",
        "sum += mx_oren_nayar_compensated_diffuse_dir_albedo(mu_o, roughness, rho);",
        "albedo",
        albedo_of,
        EXACT,
    ),
    Rival(
        "environment, eonlib",
        "sum += eon_albedo_dir(mu_o, rho, roughness);",
        "albedo",
        albedo_of,
        VALUE,
    ),
)

DRAWN = "printed_{}(min(wo.z, 1.0), min(wi.z, 1.0), dot(wo, wi) - wo.z * wi.z, rho, roughness)"
COSINE = "wi = cosine_sample(u1, u2);", "cosine_pdf(wi)"
MIXTURE = "vec4 w = printed_sample(wo, u1, u2, roughness); wi = w.xyz;", "w.w"
EON = "wi = eon_sample(wo, u1, u2, 1.0, roughness);", "eon_pdf(wo, wi, 1.0, roughness)"
LOBE = "wi = {0}_sample(wo, u1, u2, roughness);", "{0}_pdf(wo, wi, roughness)"


def _lobe(name):
    return tuple(text.format(name) for text in LOBE)


def _cosine(model, brdf):
    value = TWIN.format(brdf.__name__)
    return _draw(f"cosine + {model}", *COSINE, value, "cosine", LARGEST * VALUE + WEIGHT, brdf)


# Lambert is not among them: its weight is rho, and the compiler would leave the direction out.
SAMPLING = (
    _cosine("FON", models.fon_brdf),
    _cosine("QON", models.qon_brdf),
    _cosine("full Oren-Nayar", models.oren_nayar_brdf),
    _draw("cosine + quartic", *COSINE, DRAWN.format("quartic"), "cosine", LARGEST * QUARTIC),
    _draw("cosine + printed", *COSINE, DRAWN.format("exact"), "cosine", LARGEST * EXACT),
    _cosine("eonlib", models.eon_brdf),
    _draw(
        "LTC, d = 0 + quartic", *_lobe("ltc0"), DRAWN.format("quartic"), "ltc0", LARGEST * QUARTIC
    ),
    _draw("LTC + quartic", *_lobe("ltc"), DRAWN.format("quartic"), "ltc", LARGEST_LTC * QUARTIC),
    _draw(
        "CLTC alone + quartic",
        *_lobe("cltc"),
        DRAWN.format("quartic"),
        "cltc",
        LARGEST_LTC * QUARTIC,
    ),
    _draw("CLTC + quartic", *MIXTURE, DRAWN.format("quartic"), "eon_cltc", LARGEST_LTC * QUARTIC),
    _draw("CLTC + printed", *MIXTURE, DRAWN.format("exact"), "eon_cltc", LARGEST_LTC * EXACT),
    _draw(
        "CLTC + eonlib", *MIXTURE, TWIN.format("eon_brdf"), "eon_cltc", LARGEST_LTC * VALUE + WEIGHT
    ),
    _draw("exact + eonlib", *EON, TWIN.format("eon_brdf"), "eon"),
    Rival(
        "pdf, CLTC",
        "sum += vec3(EON_PI * eon_cltc_pdf(wo, wi, roughness));",
        "pdf",
        partial(pdf_of, "eon_cltc"),
        2e-5,
    ),
    Rival(
        "pdf, exact",
        "sum += vec3(EON_PI * eon_pdf(wo, wi, 1.0, roughness));",
        "pdf",
        partial(pdf_of, "eon"),
        2e-5,
    ),
)
RIVALS = VALUES + SAMPLING

GOALS = (
    ("EON, eonlib", "EON, quartic", 0.9),
    ("EON, eonlib", "EON, stock", 0.7),
    ("EON, eonlib (hoisted, not shipped)", "EON, quartic", 0.65),
    ("EON, eonlib (hoisted, not shipped)", "EON, quartic (hoisted)", None),
    ("environment, eonlib", "environment, stock", None),
    ("environment, eonlib", "environment, quartic", None),
    ("exact + eonlib", "CLTC + quartic", None),
    ("exact + eonlib", "CLTC + printed", None),
    ("exact + eonlib", "cosine + quartic", None),
    ("pdf, exact", "pdf, CLTC", 0.5),
)
