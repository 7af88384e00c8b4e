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
from mxeon.models.core.edges import angle, arcsine, at_least_0, at_most, guarded, root
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import NUMPY, any_array, array_namespace, like

# Above this cosine the closed form of the inner integral cancels, and Gauss-Legendre serves.
STEEP = 0.25

BLOCK = 2**8  # elements at once
ALONG = 1e-8  # distance from 1 of a cosine that counts as the normal's for derivatives

# Roughness above 0 that divides is at least this, lest the quotient overflow.
LEAST = 1e-300


@any_array
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
    numbers = dict(
        zip(("mu", "roughness"), checked_numbers(mu=mu, roughness=roughness), strict=True)
    )
    return evaluate_material(_albedo, {}, numbers, 1, BLOCK)[..., 0][()]


def _albedo(mu: Array, roughness: Array) -> Array:
    """Albedo of a block, shape (1, ...)."""
    xp = array_namespace(mu, roughness)
    if xp is NUMPY:
        mu, roughness = np.broadcast_arrays(mu, roughness)
        albedo = np.zeros((1, *mu.shape))
        for steep in (False, True):
            rows = ((mu > STEEP) == steep) & (roughness > 0.0)
            albedo[:, rows] = _integral(mu[rows], np.maximum(roughness[rows], LEAST), steep)
        return albedo
    above, rough = mu > STEEP, roughness > 0.0
    r = guarded(roughness, rough, 1.0)
    # Along the normal by a line through two cosines: their angles have no derivative there.
    step = xp.where(mu > 1.0 - ALONG, ALONG, 0.0)
    near, far = (_integral(guarded(mu - k * step, above, STEEP), r, True) for k in (1.0, 2.0))
    high = 2.0 * near - far
    low = _integral(guarded(mu, ~above, STEEP), r, False)
    return xp.where(rough, xp.where(above, high, low), 0.0)[np.newaxis]


def _integral(mu: Array, roughness: Array, steep: bool) -> Array:
    """Albedo for cosines on one side of `STEEP`, roughness above 0."""
    xp, delta = array_namespace(mu, roughness), 0.5 * arcsine(mu)
    x, weight = (like(each, mu) for each in _rule())
    p = 0.5 / roughness
    albedo = 0.0 * mu
    for partial, low, span in (
        (True, delta, 0.5 * np.pi - 2.0 * delta),
        (False, 0.5 * np.pi - delta, delta),
    ):
        # Beyond 10 sqrt(roughness) the density falls below exp(-50) of its largest value.
        width = xp.minimum(span, 10.0 * xp.sqrt(roughness))
        above = width[..., np.newaxis] * x  # latitude above the lower end, and below the upper one
        below = width[..., np.newaxis] * (1.0 - x if xp is not NUMPY else x[::-1])
        below = below + (span - width)[..., np.newaxis]
        latitude = low[..., np.newaxis] + above
        inner = _azimuths(mu[..., np.newaxis], latitude, above, below, partial, steep)
        squared = xp.square(xp.sin(latitude))
        with np.errstate(divide="ignore"):
            logarithm = xp.log1p(-guarded(squared, squared < 1.0, 0.5))
        density = xp.where(squared < 1.0, xp.exp(p[..., np.newaxis] * logarithm), 0.0)
        integrand = xp.sum(density * xp.cos(latitude) * inner * weight, axis=-1)
        albedo = albedo + 2.0 * (1.0 + p) / np.pi * width * integrand
    return albedo


def _azimuths(
    mu: Array, latitude: Array, above: Array, below: Array, partial: bool, steep: bool
) -> Array:
    """Integral of w mu_i / (mu_i + mu_o - mu_i mu_o) over phi from 0 to where the light sets."""
    xp = array_namespace(mu, latitude)
    c, s = xp.sin(latitude), xp.cos(latitude)
    a, b = mu * c, root((1.0 - mu) * (1.0 + mu)) * s
    if partial:
        # tan(phi / 2) = rise / fall; latitude + delta = pi / 2 - below
        rise, fall = root(xp.sin(2.0 * above)), root(xp.sin(2.0 * below))
    else:
        rise, fall = 0.0 * a + 1.0, 0.0 * a
    phi = 2.0 * angle(rise, fall)
    return (
        _azimuths_gauss(mu, c, a, b, phi)
        if steep
        else _azimuths_closed(mu, c, a, b, phi, rise, fall)
    )


def _azimuths_gauss(mu: Array, c: Array, a: Array, b: Array, phi: Array) -> Array:
    """The integral by Gauss-Legendre, where mu_i + mu_o - mu_i mu_o >= `STEEP`."""
    cos, total = array_namespace(phi).cos, 0.0 * a
    for x, weight in zip(*np.polynomial.legendre.leggauss(24), strict=True):
        w = a + b * cos(0.5 * phi * (1.0 + float(x)))
        mu_i = at_least_0(2.0 * c * w - mu)
        total = total + float(weight) * w * mu_i / (mu_i + mu - mu_i * mu)
    return 0.5 * phi * total


def _azimuths_closed(
    mu: Array, c: Array, a: Array, b: Array, phi: Array, rise: Array, fall: Array
) -> Array:
    """The integral in closed form.

    w (2 c w - m) / (k w + m^2) = (w - m / k) / (1 - m) + m^3 / ((1 - m) k) / (k w + m^2),
    k = 2 c (1 - m), m = mu_o; and with t = tan(phi / 2), z = (q - r) t^2 / (q + r),
    the integral of 1 / (q + r cos(phi)) is 2 t / (q + r) atan(sqrt(z)) / sqrt(z).
    """
    xp, k = array_namespace(mu, c), 2.0 * c * (1.0 - mu)
    q, r = k * a + xp.square(mu), k * b
    # Both square roots of z's numerator and denominator, so that t may be infinite.
    near, far = rise * root(xp.abs(q - r)), fall * root(q + r)
    ends, ahead = far > 0.0, q > r
    ratio = xp.where(ends, near / xp.where(ends, far, 1.0), np.inf)
    small, below = ratio < 1e-8, xp.where(ahead, 0.0, at_most(ratio, 1.0 - 1e-16))
    turn = xp.where(ahead, angle(near, far), xp.atanh(below))
    limit = rise / xp.where(small, fall * (q + r), 1.0)
    pole = xp.where(small, limit, turn / xp.where(small, 1.0, root(xp.abs((q - r) * (q + r)))))
    rest = (a * phi + b * xp.sin(phi) - mu / k * phi) / (1.0 - mu)
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
