# SPDX-License-Identifier: Apache-2.0
"""The two sheen models of [MaterialX2026], section `sheen_bsdf`.

BRDFs are in 1/sr and without the cosine. The node's input `color` is a tint that multiplies the
BRDF. Albedos are for color 1.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `mu` (...): Cosine of the polar angle of wo, in [0, 1].
- `color` (..., C): Tint per channel, in [0, 1]; a number is one channel.
- `roughness` (...): In [0, 1]. Zeltner's sheen raises a smaller roughness to 0.01.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.

The directional albedo of the Conty-Kulla sheen is an integral over the half vector, where l is the
latitude above the surface and phi is the azimuth relative to wo. The integral over phi has a closed
form, which is used where nothing cancels. The integral over l is computed by quadrature:

    E = integral of D(l) w mu_i / (mu_i + mu_o - mu_i mu_o) cos(l) dphi dl,
    w = wo . wh = mu_o sin(l) + s_o cos(l) cos(phi),  mu_i = 2 w sin(l) - mu_o

The integrand has no kink where wh is the normal. Let sin(2 delta) = mu_o. If l >= pi/2 - delta, the
light is above the horizon for all phi. If delta <= l <= pi/2 - delta, the light is above the
horizon where tan(phi / 2)^2 <= sin(2 (l - delta)) / sin(2 (l + delta)).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, guarded, root
from mxeon.models.core.evaluation import evaluate, evaluate_number
from mxeon.models.diffuse import cosines

# Smallest roughness of the Zeltner lobe: [MaterialX2026], Zeltner Sheen Model.
ZELTNER_LEAST_ROUGHNESS = 0.01

# Smallest roughness or sum of cosines that is used as a divisor, so that quotients do not overflow.
LEAST_DIVISOR = 1e-300


@any_array
def conty_kulla_brdf(wo: ArrayLike, wi: ArrayLike, color: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the sheen of Conty and Kulla.

        f = color D / (4 (mu_o + mu_i - mu_o mu_i)),
        D = (2 + 1 / roughness) sin(theta_h)^(1 / roughness) / (2 pi)

    f is 0 at roughness 0. At any roughness, f is 0 for a half vector along the normal. If both
    directions graze the surface (mu_o + mu_i below 1e-300), f has no limit and counts as 0. f is
    clamped to float64's largest number. The specification clamps nothing; MaterialX clamps
    roughness to at least 0.005 and cosines to at least 1e-6. Accuracy: the error is below
    (f + 1 / pi) 2^-53 times 66 / roughness. [MaterialX2026], Conty-Kulla sheen equations;
    [ContyKulla2017], Eq. (2).

        >>> conty_kulla_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.017299, 0.069198])
    """
    return evaluate(_conty_kulla_formula, wo, wi, color, "color", roughness=roughness)


@any_array
def zeltner_brdf(wo: ArrayLike, wi: ArrayLike, color: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the sheen of Zeltner, Burley and Chiang; negative where E is negative.

        f = color E(mu_o) a^2 / (pi |M^-1 wi|^4),  M^-1 = (a 0 b; 0 a 0; 0 0 1)

    f is not reciprocal. E is `zeltner_albedo_dir`. The specification's equation is for f times the
    cosine, so the cosine in the specification's D_o is omitted here. M is defined in the frame in
    which wo has azimuth 0. If wo is the normal, the azimuth of the frame has no effect, because b
    is 0. Accuracy: the error is below (f + 1 / pi) 2^-53 times 66 / roughness. [MaterialX2026],
    Zeltner Sheen Model; [Zeltner2022], where wo is called omega_i.

        >>> zeltner_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.002916, 0.011662])
    """
    return evaluate(_zeltner_formula, wo, wi, color, "color", roughness=roughness)


@any_array
def zeltner_albedo_dir(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of the Zeltner sheen for color 1, in [-2.2e-5, 0.745].

        E = exp(-((mu - m) / s)^2 / 2) / (s sqrt(2 pi)) + o

    E is negative for roughness in [0.03, 0.132], except near grazing. Neither the specification nor
    shaders clamp E. The matrix M keeps the sign of z, so no part of the transformed cosine lies
    below the horizon, and E is exactly the integral of `zeltner_brdf` times the cosine.
    [MaterialX2026], Zeltner Sheen Model, section Directional Albedo.

        >>> round(float(zeltner_albedo_dir(0.3, 0.5)), 6)
        0.315212
    """
    return _zeltner_albedo(*arguments.checked_numbers(mu=mu, roughness=roughness))


def zeltner_matrix(mu: Array, roughness: Array) -> tuple[Array, Array]:
    """Entries a and b of M^-1 by [MaterialX2026], Zeltner Sheen Model, Fitted Coefficients."""
    x, y = mu, array_namespace(mu, roughness).maximum(roughness, ZELTNER_LEAST_ROUGHNESS)
    a = (2.58126 * x + 0.813703 * y) * y / (1.0 + 0.310327 * x**2 + 2.60994 * x * y)
    slope = 0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y**2
    return a, root(1.0 - x) * (y - 1.0) * y**3 / slope


def _conty_kulla_formula(wo: Array, wi: Array, tint: Array, roughness: Array) -> Array:
    xp = array_namespace(wo, wi, roughness)
    # In float32, LEAST_DIVISOR is 0, so the smallest normal number is the limit.
    least = max(LEAST_DIVISOR, arrays.least_normal(wo))
    mu_o, mu_i, _ = cosines(wo, wi)
    flat = xp.square(wo[..., 0] + wi[..., 0]) + xp.square(wo[..., 1] + wi[..., 1])
    upright = xp.square(mu_o + mu_i)
    total = flat + upright
    divisor = mu_o + mu_i - mu_o * mu_i
    # If `flat` is 0, the result is 0. NumPy computes exp(-inf). Other libraries use `where`.
    counted = (roughness > 0.0) & (divisor >= least)
    smooth = counted & (flat > 0.0)
    roughness, flat = guarded(roughness, smooth, 1.0), guarded(flat, smooth, 1.0)
    upright, total = guarded(upright, smooth, 1.0), guarded(total, smooth, 2.0)
    divisor = guarded(divisor, smooth, 1.0)
    shape = 0.5 / xp.maximum(roughness, least)
    with np.errstate(divide="ignore", over="ignore"):
        ratio = flat / xp.maximum(total, least)
        # log(sin(theta_h)^2) has two forms. Each element uses the form without cancellation.
        small = ratio < 0.5
        above = guarded(upright / xp.maximum(total, least), ~small, 0.5)
        log_sine = xp.where(small, xp.log(ratio), xp.log1p(-above))
        lobe = (1.0 + shape) * xp.exp(shape * log_sine) / (4.0 * np.pi * xp.maximum(divisor, least))
    counted = smooth if xp is not arrays.NUMPY else counted
    return tint * xp.where(counted, arrays.at_most(lobe, float(arrays.precision(wo).max)), 0.0)


def _zeltner_formula(wo: Array, wi: Array, tint: Array, roughness: Array) -> Array:
    albedo = _zeltner_albedo(cosines(wo, wi)[0], roughness)
    return tint * (albedo * zeltner_lobe(wo, wi, roughness) / np.pi)


def zeltner_lobe(wo: Array, wi: Array, roughness: Array) -> Array:
    """a^2 / |M^-1 wi|^4, which is pi pdf / mu_i for the density pdf of sampled directions."""
    # Rotate the light into the frame in which wo has azimuth 0.
    xp = array_namespace(wo, wi, roughness)
    mu_o, mu_i, s = cosines(wo, wi)
    sine = root(xp.square(wo[..., 0]) + xp.square(wo[..., 1]))
    turned = sine > 0.0
    x = xp.where(turned, s, wi[..., 0]) / xp.where(turned, sine, 1.0)
    cross = wo[..., 0] * wi[..., 1] - wo[..., 1] * wi[..., 0]
    y = xp.where(turned, cross, wi[..., 1]) / xp.where(turned, sine, 1.0)
    a, b = zeltner_matrix(mu_o, roughness)
    return xp.square(a / (xp.square(a * x + b * mu_i) + xp.square(a * y) + xp.square(mu_i)))


def _zeltner_albedo(mu: Array, roughness: Array) -> Array:
    """E of [MaterialX2026], Zeltner Sheen Model, section Directional Albedo."""
    xp = array_namespace(mu, roughness)
    x, y = mu, xp.maximum(roughness, ZELTNER_LEAST_ROUGHNESS)
    s = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y))
    m = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y**2))) / (0.046391 + y)
    o = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y))
    albedo: Array = xp.exp(-0.5 * xp.square((x - m) / s)) / (s * np.sqrt(2.0 * np.pi)) + o
    return albedo


# Largest cosine for which the integral over phi is computed in closed form. For larger cosines,
# Gauss-Legendre quadrature is used, because the closed form would cancel.
STEEP = 0.25

SHEEN_BLOCK = 2**8  # elements per block
# Where the cosine differs from 1 by less than ALONG, the albedo is extrapolated, because the
# elevation angle has no derivative along the normal.
ALONG = 1e-8


@any_array
def conty_kulla_albedo_dir(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of the Conty-Kulla sheen for color 1.

        E(mu) = integral of D / (4 (mu + mu_i - mu mu_i)) mu_i over the hemisphere of wi

    For roughness below 0.2099, E exceeds 1 near grazing; E(0) is about sqrt(1 / (2 pi roughness))
    and has no upper bound. Shaders clamp E to 1. The specification mentions no clamp. At roughness
    0, the BRDF and E are 0, even at mu = 0, where the limit for vanishing roughness is infinite.
    Accuracy for roughness >= 1e-4: the relative error is below 1e-11 at mu = 0, and the absolute
    error is below 1e-11 for other mu. E(1) is 2^-p / (2 (p + 2)), where p = 1 / (2 roughness).
    [MaterialX2026], section Directional Albedo.

        >>> round(float(conty_kulla_albedo_dir(1.0, 0.5)), 12)
        0.083333333333
    """
    return evaluate_number(
        _albedo, {}, arguments.checked_all({"mu": mu, "roughness": roughness}), SHEEN_BLOCK
    )


def _albedo(mu: Array, roughness: Array) -> Array:
    xp = array_namespace(mu, roughness)
    if xp is arrays.NUMPY:
        mu, roughness = np.broadcast_arrays(mu, roughness)
        albedo = np.zeros(mu.shape)
        for steep in (False, True):
            rows = ((mu > STEEP) == steep) & (roughness > 0.0)
            albedo[rows] = _integral(mu[rows], np.maximum(roughness[rows], LEAST_DIVISOR), steep)
        return albedo
    above, rough = mu > STEEP, roughness > 0.0
    r = guarded(roughness, rough, 1.0)
    # Near cosine 1, the albedo is extrapolated from two smaller cosines.
    step = xp.where(mu > 1.0 - ALONG, ALONG, 0.0)
    near, far = (_integral(guarded(mu - k * step, above, STEEP), r, True) for k in (1.0, 2.0))
    high = 2.0 * near - far
    low = _integral(guarded(mu, ~above, STEEP), r, False)
    return xp.where(rough, xp.where(above, high, low), 0.0)


def _integral(mu: Array, roughness: Array, steep: bool) -> Array:
    """Albedo for positive roughness; `steep` is True for cosines above STEEP, else False."""
    xp, delta = array_namespace(mu, roughness), 0.5 * arrays.arcsine(mu)
    x, weight = (arrays.like(each, mu) for each in _rule())
    p = 0.5 / roughness
    albedo = 0.0 * mu
    for partial, low, span in (
        (True, delta, 0.5 * np.pi - 2.0 * delta),
        (False, 0.5 * np.pi - delta, delta),
    ):
        # At latitudes above 10 sqrt(roughness), D is below exp(-50) times the largest D.
        width = xp.minimum(span, 10.0 * xp.sqrt(roughness))
        # `above` and `below` are the distances from the lower and the upper end of the interval.
        above = width[..., np.newaxis] * x
        below = width[..., np.newaxis] * (1.0 - x if xp is not arrays.NUMPY else x[::-1])
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
    """Integral of w mu_i / (mu_i + mu_o - mu_i mu_o) over phi, from 0 to where mu_i is 0."""
    xp = array_namespace(mu, latitude)
    c, s = xp.sin(latitude), xp.cos(latitude)
    a, b = mu * c, root((1.0 - mu) * (1.0 + mu)) * s
    if partial:
        # mu_i is 0 at phi = 2 atan(rise / fall), because sin(2 below) is sin(2 (latitude + delta)).
        rise, fall = root(xp.sin(2.0 * above)), root(xp.sin(2.0 * below))
    else:
        rise, fall = 0.0 * a + 1.0, 0.0 * a
    phi = 2.0 * arrays.angle(rise, fall)
    return (
        _azimuths_gauss(mu, c, a, b, phi)
        if steep
        else _azimuths_closed(mu, c, a, b, phi, rise, fall)
    )


def _azimuths_gauss(mu: Array, c: Array, a: Array, b: Array, phi: Array) -> Array:
    """The integral over phi by Gauss-Legendre quadrature, for mu_i + mu_o - mu_i mu_o >= STEEP."""
    cos, total = array_namespace(phi).cos, 0.0 * a
    for x, weight in zip(*np.polynomial.legendre.leggauss(24), strict=True):
        w = a + b * cos(0.5 * phi * (1.0 + float(x)))
        mu_i = arrays.at_least_0(2.0 * c * w - mu)
        total = total + float(weight) * w * mu_i / (mu_i + mu - mu_i * mu)
    return 0.5 * phi * total


def _azimuths_closed(
    mu: Array, c: Array, a: Array, b: Array, phi: Array, rise: Array, fall: Array
) -> Array:
    """The integral over phi in closed form.

    With m = mu_o, c = sin(l) and k = 2 c (1 - m), the integrand is

        w (2 c w - m) / (k w + m^2) = (w - m / k) / (1 - m) + m^3 / ((1 - m) k) / (k w + m^2)

    k w + m^2 has the form q + r cos(phi). With t = tan(phi / 2) and z = (q - r) t^2 / (q + r), the
    integral of 1 / (q + r cos(phi)) is 2 t / (q + r) atan(sqrt(z)) / sqrt(z).
    """
    xp, k = array_namespace(mu, c), 2.0 * c * (1.0 - mu)
    q, r = k * a + xp.square(mu), k * b
    # The square roots of z's numerator and denominator are separate, because t may be infinite.
    near, far = rise * root(xp.abs(q - r)), fall * root(q + r)
    ends, ahead = far > 0.0, q > r
    ratio = xp.where(ends, near / xp.where(ends, far, 1.0), np.inf)
    small, below = ratio < 1e-8, xp.where(ahead, 0.0, arrays.at_most(ratio, arrays.below_1(ratio)))
    turn = xp.where(ahead, arrays.angle(near, far), xp.atanh(below))
    limit = rise / xp.where(small, fall * (q + r), 1.0)
    pole = xp.where(small, limit, turn / xp.where(small, 1.0, root(xp.abs((q - r) * (q + r)))))
    rest = (a * phi + b * xp.sin(phi) - mu / k * phi) / (1.0 - mu)
    return rest + 2.0 * mu**3 / ((1.0 - mu) * k) * pole


@lru_cache(maxsize=1)
def _rule() -> tuple[Array, Array]:
    """Nodes x and weights of a double-exponential rule on [0, 1].

    The reversed array of nodes holds 1 - x without cancellation.
    """
    t = np.arange(-60, 61) * 0.055
    x = 1.0 / (1.0 + np.exp(-np.pi * np.sinh(t)))
    weight = 0.055 * np.pi * np.cosh(t) * x * x[::-1]
    return x, weight / weight.sum()
