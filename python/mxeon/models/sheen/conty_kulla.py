# SPDX-License-Identifier: Apache-2.0
"""Directional albedo of the Conty-Kulla sheen: one integral in closed form, one by quadrature.

Over the half vector, at latitude l above the surface and azimuth phi from wo, the albedo is

    E = integral of D(l) w mu_i / (mu_i + mu_o - mu_i mu_o) cos(l) dphi dl,
    w = wo . wh = mu_o sin(l) + s_o cos(l) cos(phi),  mu_i = 2 w sin(l) - mu_o,

which has no kink where wh is the normal. With sin(2 delta) = mu_o, the light is above the horizon
for all phi where l >= pi/2 - delta, and for tan(phi / 2)^2 <= sin(2 (l - delta)) / sin(2 (l + delta))
where delta <= l <= pi/2 - delta.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mxeon.models.core.arguments import checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.tiling import BLOCK

# Above this cosine the closed form of the inner integral cancels, and Gauss-Legendre serves.
STEEP = 0.25

# Roughness above 0 that divides is at least this, lest the quotient overflow.
LEAST = 1e-300


def conty_kulla_albedo_dir(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of the Conty-Kulla sheen at unit color.

        E(mu) = integral of D / (4 (mu + mu_i - mu mu_i)) mu_i over the hemisphere of wi

    - `mu`: Cosine of the polar angle of wo, in [0, 1].
    - `roughness`: In [0, 1].

    Result: at least 0. It exceeds 1 at grazing below a roughness of 0.2099 and has no bound: about
    sqrt(1 / (2 pi roughness)) at mu = 0. Shaders clamp it to 1; the text is silent. Roughness 0 has
    the albedo of its BRDF, 0, also at mu = 0, where the limit is infinite. Accuracy: relative error
    below 1e-11 at mu = 0, absolute below 1e-11 elsewhere, for roughness >= 1e-4. Form: see the
    module. At mu = 1 it is 2^-p / (2 (p + 2)), p = 1 / (2 roughness). Raises `ValueError` if an
    argument leaves its range. [MaterialX2026], sections `sheen_bsdf` and Directional Albedo and
    Energy Conservation.

        >>> round(float(conty_kulla_albedo_dir(1.0, 0.5)), 12)
        0.083333333333
    """
    mu, roughness = np.broadcast_arrays(*checked_numbers(mu=mu, roughness=roughness))
    cosines, shapes = mu.ravel(), np.where(roughness > 0.0, np.maximum(roughness, LEAST), 0.0)
    shapes = shapes.ravel()
    albedo = np.zeros(cosines.shape)
    step = max(1, BLOCK // len(_rule()[0]))
    for steep in (False, True):
        chosen = np.flatnonzero(((cosines > STEEP) == steep) & (shapes > 0.0))
        for start in range(0, len(chosen), step):
            block = chosen[start : start + step]
            albedo[block] = _albedo(cosines[block], shapes[block], steep)
    return albedo.reshape(mu.shape)[()]


def _albedo(mu: Array, roughness: Array, steep: bool) -> Array:
    """Albedo for cosines on one side of `STEEP`, roughness above 0."""
    delta = 0.5 * np.arcsin(mu)
    x, weight = _rule()
    p = 0.5 / roughness
    albedo = np.zeros(mu.shape)
    for partial, low, span in (
        (True, delta, 0.5 * np.pi - 2.0 * delta),
        (False, 0.5 * np.pi - delta, delta),
    ):
        # Beyond 10 sqrt(roughness) the density falls below exp(-50) of its largest value.
        width = np.minimum(span, 10.0 * np.sqrt(roughness))
        above = width[:, None] * x  # latitude above the lower end, and below the upper one
        below = width[:, None] * x[::-1] + (span - width)[:, None]
        latitude = low[:, None] + above
        inner = _azimuths(mu[:, None], latitude, above, below, partial, steep)
        with np.errstate(divide="ignore"):
            density = np.exp(p[:, None] * np.log1p(-np.square(np.sin(latitude))))
        integrand = (density * np.cos(latitude) * inner) @ weight
        albedo += 2.0 * (1.0 + p) / np.pi * width * integrand
    return albedo


def _azimuths(
    mu: Array, latitude: Array, above: Array, below: Array, partial: bool, steep: bool
) -> Array:
    """Integral of w mu_i / (mu_i + mu_o - mu_i mu_o) over phi from 0 to where the light sets."""
    c, s = np.sin(latitude), np.cos(latitude)
    a, b = mu * c, np.sqrt((1.0 - mu) * (1.0 + mu)) * s
    if partial:
        # tan(phi / 2) = rise / fall; latitude + delta = pi / 2 - below
        rise, fall = np.sqrt(np.sin(2.0 * above)), np.sqrt(np.sin(2.0 * below))
    else:
        rise, fall = np.ones_like(a), np.zeros_like(a)
    phi = 2.0 * np.arctan2(rise, fall)
    return (
        _azimuths_gauss(mu, c, a, b, phi)
        if steep
        else _azimuths_closed(mu, c, a, b, phi, rise, fall)
    )


def _azimuths_gauss(mu: Array, c: Array, a: Array, b: Array, phi: Array) -> Array:
    """The integral by Gauss-Legendre, where mu_i + mu_o - mu_i mu_o >= `STEEP`."""
    total = np.zeros_like(a)
    for x, weight in zip(*np.polynomial.legendre.leggauss(24), strict=True):
        w = a + b * np.cos(0.5 * phi * (1.0 + x))
        mu_i = np.maximum(2.0 * c * w - mu, 0.0)
        total += weight * w * mu_i / (mu_i + mu - mu_i * mu)
    return 0.5 * phi * total


def _azimuths_closed(
    mu: Array, c: Array, a: Array, b: Array, phi: Array, rise: Array, fall: Array
) -> Array:
    """The integral in closed form.

    w (2 c w - m) / (k w + m^2) = (w - m / k) / (1 - m) + m^3 / ((1 - m) k) / (k w + m^2),
    k = 2 c (1 - m), m = mu_o; and with t = tan(phi / 2), z = (q - r) t^2 / (q + r),
    the integral of 1 / (q + r cos(phi)) is 2 t / (q + r) atan(sqrt(z)) / sqrt(z).
    """
    k = 2.0 * c * (1.0 - mu)
    q, r = k * a + np.square(mu), k * b
    # Both square roots of z's numerator and denominator, so that t may be infinite.
    near, far = rise * np.sqrt(np.abs(q - r)), fall * np.sqrt(q + r)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = near / far
        turn = np.where(q > r, np.arctan2(near, far), np.arctanh(np.minimum(ratio, 1.0 - 1e-16)))
        pole = np.where(
            ratio < 1e-8, rise / (fall * (q + r)), turn / np.sqrt(np.abs((q - r) * (q + r)))
        )
    rest = (a * phi + b * np.sin(phi) - mu / k * phi) / (1.0 - mu)
    return rest + 2.0 * mu**3 / ((1.0 - mu) * k) * pole


@lru_cache(maxsize=1)
def _rule() -> tuple[Array, Array]:
    """Nodes and weights of the double exponential rule on [0, 1], symmetric.

    Node k from the end is 1 minus node k from the start, to full precision where it is small.
    """
    t = np.arange(-60, 61) * 0.055
    x = 1.0 / (1.0 + np.exp(-np.pi * np.sinh(t)))
    weight = 0.055 * np.pi * np.cosh(t) * x * x[::-1]
    return x, weight / weight.sum()
