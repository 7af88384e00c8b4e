# SPDX-License-Identifier: Apache-2.0
"""Sheen of [MaterialX2026], section `sheen_bsdf`: values in 1/sr and without the cosine.

The node's input `color` is a tint that scales the lobe; its albedos are those at unit color.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `color` (..., C): Tint per channel, in [0, 1]; a number is one channel.
- `roughness` (...): In [0, 1]; that of Zeltner's sheen counts as 0.01 below 0.01.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mxeon.models.core.arguments import checked, checked_numbers, checked_triples, checked_vector
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_most, guarded, largest, least_normal, root
from mxeon.models.core.evaluation import evaluate
from mxeon.models.core.namespaces import NUMPY, any_array, array_namespace
from mxeon.models.core.shapes import lead_shape
from mxeon.models.diffuse.formulas import cosines
from mxeon.models.sheen.conty_kulla import conty_kulla_albedo_dir

__all__ = [
    "conty_kulla_albedo_dir",
    "conty_kulla_brdf",
    "zeltner_albedo_dir",
    "zeltner_brdf",
    "zeltner_matrix",
]

# Roughness that the Zeltner lobe has at least: [MaterialX2026], Zeltner Sheen Model.
ZELTNER_LEAST_ROUGHNESS = 0.01

# Roughness and sum of cosines that divide are at least this, lest a quotient overflow by itself.
LEAST = 1e-300


@any_array
def conty_kulla_brdf(wo: ArrayLike, wi: ArrayLike, color: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the sheen of Conty and Kulla.

        f = color D / (4 (mu_o + mu_i - mu_o mu_i)),
        D = (2 + 1 / roughness) sin(theta_h)^(1 / roughness) / (2 pi)

    Result (..., C): BRDF in 1/sr, at least 0, finite, unbounded at grazing. Roughness 0 has the
    limit of every pair that does not graze on both sides: 0. So has the half vector along the
    normal, at every roughness. Where both directions graze (mu_o + mu_i below 1e-300) there is no
    limit, and f counts as 0. Values beyond float64, which need roughness below 1e-8 or so and such
    a pair, stop at its largest. The text clamps nothing. MaterialX keeps roughness above 0.005 and
    cosines above 1e-6. Accuracy: error below 66 / roughness times 2^-53 of f + 1 / pi.
    [MaterialX2026], section `sheen_bsdf`, Conty-Kulla sheen equations; [ContyKulla2017], Eq. (2).

        >>> conty_kulla_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.017299, 0.069198])
    """
    return _tinted(_conty_kulla_formula, wo, wi, color, roughness)


@any_array
def zeltner_brdf(wo: ArrayLike, wi: ArrayLike, color: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the sheen of Zeltner, Burley and Chiang. It is not reciprocal.

        f = color E(mu_o) a^2 / (pi |M^-1 wi|^4),  M^-1 = (a 0 b; 0 a 0; 0 0 1)

    Result (..., C): BRDF in 1/sr. It has the sign of E, see `zeltner_albedo_dir`. The text states f
    times the cosine; the cosine is that of D_o times |M^-1 wi|, and cancels. The frame of M is
    turned so that wo has azimuth 0. Along the normal b is 0 and any frame serves. Accuracy: as that
    of `conty_kulla_brdf`. [MaterialX2026], Zeltner Sheen Model; [Zeltner2022], whose omega_i is wo
    here.

        >>> zeltner_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.002916, 0.011662])
    """
    return _tinted(_zeltner_formula, wo, wi, color, roughness)


@any_array
def zeltner_albedo_dir(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of the Zeltner sheen at unit color: E of the text, which is exact.

        E = exp(-((mu - m) / s)^2 / 2) / (s sqrt(2 pi)) + o

    - `mu`: Cosine of the polar angle of wo, in [0, 1].

    Result: in [-2.2e-5, 0.745]. The fit falls below 0 for roughness in [0.03, 0.132] away from
    grazing; text and shaders leave it so. This is the integral of `zeltner_brdf` times the cosine,
    not a fit of it: M keeps the sign of z, so the transformed cosine has its whole mass above the
    horizon. [MaterialX2026], Zeltner Sheen Model, Directional Albedo.

        >>> round(float(zeltner_albedo_dir(0.3, 0.5)), 6)
        0.315212
    """
    return _zeltner_albedo(*checked_numbers(mu=mu, roughness=roughness))


def zeltner_matrix(mu: Array, roughness: Array) -> tuple[Array, Array]:
    """Entries a and b of M^-1: [MaterialX2026], Zeltner Sheen Model, Fitted Coefficients."""
    x, y = mu, array_namespace(mu, roughness).maximum(roughness, ZELTNER_LEAST_ROUGHNESS)
    a = (2.58126 * x + 0.813703 * y) * y / (1.0 + 0.310327 * x**2 + 2.60994 * x * y)
    slope = 0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y**2
    return a, root(1.0 - x) * (y - 1.0) * y**3 / slope


def _tinted(
    lobe: Callable[[Array, Array, Array, Array], Array],
    wo: ArrayLike,
    wi: ArrayLike,
    color: ArrayLike,
    roughness: ArrayLike,
) -> Array:
    """Values of a lobe over broadcast arguments, times the tint."""
    color = checked_vector("color", color)
    vectors = {"wo": checked_triples("wo", wo), "wi": checked_triples("wi", wi), "color": color}
    lead_shape(vectors, {"roughness": checked("roughness", roughness)})
    return evaluate(lobe, wo, wi, color, roughness=roughness)


def _conty_kulla_formula(wo: Array, wi: Array, tint: Array, roughness: Array) -> Array:
    """Conty and Kulla's lobe, (C, ...), on valid arrays."""
    xp = array_namespace(wo, wi, roughness)
    least = max(LEAST, least_normal(wo))  # that of float32 is larger
    mu_o, mu_i, _ = cosines(wo, wi)
    flat = xp.square(wo[..., 0] + wi[..., 0]) + xp.square(wo[..., 1] + wi[..., 1])
    upright = xp.square(mu_o + mu_i)
    total = flat + upright
    divisor = mu_o + mu_i - mu_o * mu_i
    # Leave out the limits that are 0, the last one of which NumPy finds as the exponential of -inf.
    counted = (roughness > 0.0) & (divisor >= least)
    smooth = counted & (flat > 0.0)
    roughness, flat = guarded(roughness, smooth, 1.0), guarded(flat, smooth, 1.0)
    upright, total = guarded(upright, smooth, 1.0), guarded(total, smooth, 2.0)
    divisor = guarded(divisor, smooth, 1.0)
    shape = 0.5 / xp.maximum(roughness, least)
    with np.errstate(divide="ignore", over="ignore"):
        ratio = flat / xp.maximum(total, least)
        # Each form of log(sin(theta_h)^2) where it does not cancel.
        small = ratio < 0.5
        above = guarded(upright / xp.maximum(total, least), ~small, 0.5)
        log_sine = xp.where(small, xp.log(ratio), xp.log1p(-above))
        lobe = (1.0 + shape) * xp.exp(shape * log_sine) / (4.0 * np.pi * xp.maximum(divisor, least))
    counted = smooth if xp is not NUMPY else counted
    return tint * xp.where(counted, at_most(lobe, largest(wo)), 0.0)


def _zeltner_formula(wo: Array, wi: Array, tint: Array, roughness: Array) -> Array:
    """Zeltner's lobe, (C, ...), on valid arrays."""
    # Turn the light into the frame where wo has azimuth 0.
    xp = array_namespace(wo, wi, roughness)
    mu_o, mu_i, s = cosines(wo, wi)
    sine = root(xp.square(wo[..., 0]) + xp.square(wo[..., 1]))
    turned = sine > 0.0
    x = xp.where(turned, s, wi[..., 0]) / xp.where(turned, sine, 1.0)
    cross = wo[..., 0] * wi[..., 1] - wo[..., 1] * wi[..., 0]
    y = xp.where(turned, cross, wi[..., 1]) / xp.where(turned, sine, 1.0)
    a, b = zeltner_matrix(mu_o, roughness)
    length = xp.square(a * x + b * mu_i) + xp.square(a * y) + xp.square(mu_i)
    return tint * (_zeltner_albedo(mu_o, roughness) * xp.square(a / length) / np.pi)


def _zeltner_albedo(mu: Array, roughness: Array) -> Array:
    """E of the text: [MaterialX2026], Zeltner Sheen Model, Directional Albedo."""
    xp = array_namespace(mu, roughness)
    x, y = mu, xp.maximum(roughness, ZELTNER_LEAST_ROUGHNESS)
    s = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y))
    m = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y**2))) / (0.046391 + y)
    o = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y))
    albedo: Array = xp.exp(-0.5 * xp.square((x - m) / s)) / (s * np.sqrt(2.0 * np.pi)) + o
    return albedo
