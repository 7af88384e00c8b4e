# SPDX-License-Identifier: Apache-2.0
"""Errors that renderers are known to make in microfacet nodes, and MaterialX's fitted albedos."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from mxeon.models import microfacet
from mxeon.models.core.arrays import Array
from mxeon.models.microfacet import Lobe, Pair, ggx
from mxeon.models.microfacet.ggx import missing_light

# MaterialX 1.39.5 approximates the GGX albedo by A F0 + B F90, where A and B are quotients of
# polynomials in x = mu and y = alpha. The error is up to 0.14 for mu and alpha in [1e-3, 1].
# The rows hold the coefficients of 1, x, y, x y, x^2, y^2, x^2 y, x y^2 and x^2 y^2. The columns
# are the numerators of A and B, followed by the denominators of A and B.
ALBEDO_FIT = np.array(
    [
        [0.1003, 0.9345, 1.0, 1.0],
        [-0.6303, -2.323, -1.765, 0.2281],
        [9.748, 2.229, 8.263, 15.94],
        [-2.038, -3.748, 11.53, -55.83],
        [29.34, 1.424, 28.96, 13.08],
        [-8.245, -0.7684, -7.507, 41.26],
        [-26.44, 1.436, -36.11, 54.9],
        [19.99, 0.2913, 15.86, 300.2],
        [-5.448, 0.6286, 33.37, -285.1],
    ]
)


# Smallest cosine and alpha for which ALBEDO_FIT is evaluated. The shaders of MaterialX 1.39.5 clamp
# the cosine and alpha to M_FLOAT_EPS, 1e-8. Between 1e-8 and 1e-6, the fit changes by less than
# 2e-5.
CLAMP = 1e-6


Factor: TypeAlias = Callable[[Pair], Array]


@dataclass(frozen=True)
class MicrofacetDefect:
    """An error that renderers are known to make in pbrlib's three microfacet nodes."""

    name: str
    title: str
    lobe: Lobe


def averaged_channels(albedo: Array) -> Array:
    """The albedo with every channel replaced by the mean of all channels."""
    return np.broadcast_to(np.mean(albedo, axis=-1, keepdims=True), albedo.shape).copy()


def fitted_albedo(mu: Array, alpha: Array, F0: Array | float, F90: Array | float) -> Array:
    """Directional albedo of GGX with a Schlick curve, by the fit ALBEDO_FIT in MaterialX 1.39.5."""
    x, y = np.broadcast_arrays(mu, alpha)
    powers = np.stack(
        [x**0, x, y, x * y, x * x, y * y, x * x * y, x * y * y, x * x * y * y], axis=-1
    )
    fit = np.einsum("...k,kj->...j", powers, ALBEDO_FIT)
    A, B = (np.clip(fit[..., k] / fit[..., k + 2], 0.0, 1.0) for k in (0, 1))
    albedo: Array = F0 * A + F90 * B
    return albedo


def schlick_average(normal: Array, grazing: Array | float) -> Array:
    """F_ss for exponent 5. MaterialX has used this F_ss for all Schlick curves since June 2026."""
    return normal + (grazing - normal) / 21.0


def _F_half(pair: Pair) -> Array:
    return pair.curve.at(pair.cosine, **pair.material)


def _F_normal(pair: Pair) -> Array:
    return pair.curve.at(np.ones_like(pair.cosine), **pair.material)


def _F_view(pair: Pair) -> Array:
    return pair.curve.at(np.minimum(pair.wo[2], 1.0), **pair.material)


def _F_average(pair: Pair) -> Array:
    ends = (pair.curve.at(np.full_like(pair.cosine, mu), **pair.material) for mu in (1.0, 0.0))
    return schlick_average(*ends)


def _missing_by_fit(pair: Pair) -> Array:
    alpha = np.maximum(ggx.mean_alpha(pair.roughness), CLAMP)
    E = fitted_albedo(np.clip(pair.wo[2], CLAMP, 1.0), alpha, 1.0, 1.0)
    return (1.0 - E) / E


def _compensated(F: Factor, lost: Factor) -> Factor:
    """Compensation factor that uses `F` as F_ss and `lost` as (1 - E_ss) / E_ss."""
    return lambda pair: 1.0 + F(pair) * lost(pair)


# Compensation factors of MaterialX 1.39.5 (`fitted_half`) and later versions (`averaged_fitted`).
fitted_half = _compensated(_F_half, _missing_by_fit)
averaged_fitted = _compensated(_F_average, _missing_by_fit)


def _separable(pair: Pair) -> Array:
    """Uncorrelated visibility G1(wo) G1(wi) / (4 mu_o mu_i) with alpha = sqrt(alpha_x alpha_y)."""
    alpha = ggx.mean_alpha(pair.roughness)
    mu_o, mu_i = pair.wo[2], pair.wi[2]
    length_o, length_i = (mu + ggx.smith_lambda(mu, alpha) for mu in (mu_o, mu_i))
    return ggx.reciprocal(length_o * length_i)


def _at_the_mean(pair: Pair) -> Array:
    """G2 / (4 mu_o mu_i) with alpha = sqrt(alpha_x alpha_y), as in the June 2026 specification."""
    return ggx.visibility(pair.wo[2], pair.wi[2], ggx.mean_alpha(pair.roughness))


def _june(pair: Pair) -> Array:
    """Compensation factor of the June 2026 specification, with E_ss at sqrt(alpha_x alpha_y)."""
    lost = missing_light(pair.wo[2], ggx.mean_alpha(pair.roughness))
    return 1.0 + pair.curve.average(**pair.material) * lost


UNCOMPENSATED = "no energy compensation"
AND_FIT, AVERAGE_BY_ENDS = "and MaterialX's fit of E_ss", "the average F0 + (F90 - F0) / 21"
MEAN_ALPHA = "Smith at the geometric mean"
# Wrong compensations. Rows have a name, a title, and functions for F_ss and for (1 - E_ss) / E_ss.
COMPENSATIONS = (
    ("half", "F at the half vector", _F_half, microfacet.missing),
    ("f0", "F along the normal", _F_normal, microfacet.missing),
    ("f0_fitted", f"F along the normal {AND_FIT}", _F_normal, _missing_by_fit),
    ("view", "F at the view direction", _F_view, microfacet.missing),
    ("fitted", f"F at the half vector {AND_FIT}", _F_half, _missing_by_fit),
    ("average", AVERAGE_BY_ENDS, _F_average, microfacet.missing),
    ("average_fitted", f"{AVERAGE_BY_ENDS} {AND_FIT}", _F_average, _missing_by_fit),
)
MICROFACET_DEFECTS = (
    MicrofacetDefect("no_compensation", UNCOMPENSATED, Lobe(microfacet.uncompensated)),
    *(
        MicrofacetDefect(
            f"compensation_{name}", f"compensation with {title}", Lobe(_compensated(F, lost))
        )
        for name, title, F, lost in COMPENSATIONS
    ),
    MicrofacetDefect(
        "smith_separable", "masking and shadowing uncorrelated", Lobe(visibility=_separable)
    ),
    MicrofacetDefect("smith_mean", MEAN_ALPHA, Lobe(_june, _at_the_mean)),
    MicrofacetDefect("alpha_squared", "roughness squared once more", Lobe(alpha=np.square)),
    MicrofacetDefect("alpha_root", "square root of the roughness as alpha", Lobe(alpha=np.sqrt)),
    MicrofacetDefect("no_factor_4", "no factor 4 in the denominator", Lobe(scale=4.0)),
)
# Microfacet lobes of MaterialX 1.39.5 (FITTED) and of later versions (AVERAGED).
FITTED = Lobe(fitted_half, _at_the_mean)
AVERAGED = Lobe(averaged_fitted, _at_the_mean)
MEAN_TITLE = f"{MEAN_ALPHA}, and MaterialX's compensation"
# The first two lobes are MaterialX's. Each further lobe combines MaterialX's compensation with
# another error. Renderers that copied MaterialX's shaders may have both errors.
FITTED_DEFECTS = (
    MicrofacetDefect("smith_mean_fitted", MEAN_TITLE, FITTED),
    MicrofacetDefect("smith_mean_average", f"{MEAN_TITLE} by F0 and F90", AVERAGED),
    *(
        MicrofacetDefect(
            f"{each.name}_fitted",
            f"{each.title}, and MaterialX's compensation",
            replace(
                each.lobe,
                factor=fitted_half,
                visibility=_at_the_mean
                if each.lobe.visibility is microfacet.visibility
                else each.lobe.visibility,
            ),
        )
        for each in MICROFACET_DEFECTS
        if each.lobe.factor is microfacet.compensation
    ),
)
# Microfacet lobe of BSDL, the library of OSL's closures. BSDL evaluates E_ss at the arithmetic mean
# of both alphas. Only a renderer that uses OSL's closures may match this lobe.
BSDL = MicrofacetDefect(
    "bsdl",
    "BSDL's lobe: compensation with F at the half vector",
    Lobe(
        _compensated(_F_half, lambda pair: missing_light(pair.wo[2], pair.roughness.mean(axis=0)))
    ),
)
# Microfacet lobe of Blender's Cycles, whose OSL closures have no energy compensation.
SINGLE = MicrofacetDefect("single", "single scattering alone", Lobe(microfacet.uncompensated))


def burley_albedo(wo: Array, inputs: Mapping[str, Array]) -> Array:
    """Albedo of Burley's diffuse model as in mx_burley_diffuse_dir_albedo; error up to 0.0174."""
    x, r = np.minimum(wo[:, 2], 1.0), inputs["roughness"]
    smooth = 0.97619 - 0.488095 * (1.0 - x) ** 5
    rough = 1.55754 + (-2.02221 + (2.56283 - 1.06244 * x) * x) * x
    return np.asarray(((1.0 - r) * smooth + r * rough)[:, np.newaxis] * inputs["color"])


def conty_kulla_albedo(wo: Array, inputs: Mapping[str, Array]) -> Array:
    """Conty-Kulla albedo as in mx_imageworks_sheen_dir_albedo_analytic, without the color, (N, 3).

    The error is up to 0.0705 for mu and roughness in [0.01, 1], and 0.74 at roughness 0.001.
    """
    x, y = np.minimum(wo[:, 2], 1.0), inputs["roughness"]
    above = 13.673 - 68.78018 * x + 799.08825 * y - 905.00061 * x * y
    above += 60.28956 * x * x + 1086.96473 * y * y
    below = 1.0 + 61.57746 * x + 442.78211 * y + 2597.49308 * x * y
    below += 121.81241 * x * x + 3045.55075 * y * y
    return np.repeat(np.clip(above / below, 0.0, 1.0)[:, np.newaxis], 3, axis=-1)


def layer_albedo(
    wo: Array, inputs: Mapping[str, Array], F0: Array, F90: Array | float, F: Array
) -> Array:
    """MaterialX's approximate albedo of a microfacet lobe that covers another lobe, (N, 3).

    - `F`: Reflectance in the compensation factor.
    """
    mu, alpha = _arguments(wo, inputs)
    A, B = (fitted_albedo(mu, alpha, *ends)[:, np.newaxis] for ends in ((1.0, 0.0), (0.0, 1.0)))
    return np.broadcast_to((F0 * A + F90 * B) * fitted_compensation(wo, inputs, F), wo.shape)


def fitted_compensation(wo: Array, inputs: Mapping[str, Array], F: Array) -> Array:
    """Compensation factor 1 + F (1 - E_ss) / E_ss with E_ss from ALBEDO_FIT, (N, 1 or 3)."""
    E_ss = fitted_albedo(*_arguments(wo, inputs), 1.0, 1.0)[:, np.newaxis]
    return 1.0 + F * (1.0 - E_ss) / E_ss


def _arguments(wo: Array, inputs: Mapping[str, Array]) -> tuple[Array, Array]:
    """Cosine of wo's polar angle and geometric mean of the alphas, clamped to at least CLAMP."""
    alpha = np.sqrt(np.maximum(inputs["roughness"], CLAMP).prod(axis=-1))
    return np.clip(wo[:, 2], CLAMP, 1.0), alpha
