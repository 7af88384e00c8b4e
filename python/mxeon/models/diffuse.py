# SPDX-License-Identifier: Apache-2.0
"""Diffuse models: Lambert, the Oren-Nayar family, Burley's model and diffuse transmission.

BRDFs are reciprocal, in 1/sr and without the cosine. All functions broadcast and accept the ends of
every range. Arrays are processed in blocks on the caller's thread, so memory for temporaries does
not grow with the size of the arguments. If both directions graze the surface and s > 0,
s / max(mu_o, mu_i) has no limit and counts as 0; value times cosine is 0 in this case.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
- `rho` (..., C): Reflectance per channel, in [0, 1]; a number is one channel.
- `sigma` (...): Standard deviation of the facets' slope angle, in radians, in [0, pi/2].
- `roughness` (...): Roughness r of FON, EON or Burley's model, in [0, 1].
- `color` (..., C): Desired albedo, in [0, 1].

Result (..., C): BRDF in 1/sr, which is at least 0 and has no upper bound at grazing angles. The
error is below 1e-14 times the larger of 1 / pi and the largest |s / t| for the same mu_o and
mu_i. Albedos of FON and QON (...) are for unit reflectance, and have to be multiplied by rho.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.

Functions that validate no arguments have the names and the arguments of the shader functions in
`genglsl/lib/eon.glsl` and `genglsl/sampling/oren_nayar_family.glsl`. These functions expect the
channels of `rho` on the first axis.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import checked_colors, checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike, Number, any_array, array_namespace
from mxeon.models.core.evaluation import evaluate

# FON at unit reflectance loses the fraction r c1 / (1 + c1 r) of the light at normal incidence, and
# r (c1 - c2) / (1 + c1 r) on average: [Portsmouth2025], Eqs. (10), (15), (29).
C1 = 0.5 - 2.0 / (3.0 * np.pi)
C2 = 2.0 / 3.0 - 28.0 / (15.0 * np.pi)

# Coefficients of G_F / pi as a polynomial in 1 - mu for mu in [0, 1]: [Portsmouth2025], Eq. (14).
# The largest error is 6.0e-4.
FON_G = (0.0571085289, 0.491881867, -0.332181442, 0.0714429953)


def cosines(wo: Array, wi: Array) -> tuple[Array, Array, Array]:
    """Cosines with the normal, and the tangential part s of dot(wo, wi).

        s = dot(wo, wi) - mu_o mu_i = wo.x wi.x + wo.y wi.y

    `mu_o`, `mu_i` (...): z of wo and wi, clamped to 1 because rounding may make z larger.
    `s` (...): In [-1, 1] up to rounding; not clamped. [Portsmouth2025], below Eq. (3).
    """
    s = wo[..., 0] * wi[..., 0] + wo[..., 1] * wi[..., 1]
    return arrays.cosine(wo[..., 2]), arrays.cosine(wi[..., 2]), s


def of_cosines(formula: Callable[..., Array]) -> Callable[..., Array]:
    """Turn a formula with arguments mu_o, mu_i, s, ... into a function of wo, wi, ..."""
    return lambda wo, wi, *material: formula(*cosines(wo, wi), *material)


def checked_brdf(formula: Callable[..., Array], parameter: str) -> Callable[..., Array]:
    """Turn a formula in mu_o, mu_i, s, rho, parameter into a BRDF that validates its arguments."""

    @any_array
    def brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, value: ArrayLike) -> Array:
        return evaluate(of_cosines(formula), wo, wi, rho, **{parameter: value})

    return brdf


def fon_loss_mu(mu: Array) -> Array:
    """H(mu) = c1 - G_F(mu) / pi: [Portsmouth2025], Eq. (13); FON's albedo is 1 - r A_F H(mu).

        H = mu t (c1 - S t (2 + S) / (3 pi)) + (2 / pi) S atan(t)
        S = sqrt(1 - mu^2),  t = mu / (1 + S)

    Here theta_o is written as pi / 2 - 2 atan(t), and 1 - S as mu t. So the formula has neither a
    division by mu nor a cancellation. Near the normal, H is c1 + O(S^3).
    """

    def loss(mu: Array) -> Array:
        xp = array_namespace(mu)
        S = xp.sqrt((1.0 - mu) * (1.0 + mu))
        t = mu / (1.0 + S)
        return mu * t * (C1 - S * t * (2.0 + S) / (3.0 * np.pi)) + (2.0 / np.pi) * S * xp.atan(t)

    return arrays.except_where(lambda mu: mu >= 1.0, C1, loss, mu, 0.5)


def fon_loss_approx(mu: Array) -> Array:
    """Quartic approximation of H(mu), negative for mu < 0.0014: [Portsmouth2025], Eq. (14)."""
    m = 1.0 - mu
    g1, g2, g3, g4 = FON_G
    return C1 - m * (g1 + m * (g2 + m * (g3 + m * g4)))


def fon_af(roughness: Array) -> Array:
    """A_F = 1 / (1 + c1 r) of [Portsmouth2025], below Eq. (11)."""
    return 1.0 / (1.0 + C1 * roughness)


def fon_lambert(rho: Array, roughness: Array) -> Array:
    """Factor rho A_F / pi of [Portsmouth2025], Eq. (10)."""
    return rho / np.pi * fon_af(roughness)


def qon_aq(sigma: Number, constant: float = 0.33) -> Number:
    """Coefficient A_q of QON: [Portsmouth2025], below Eq. (1)."""
    return 1.0 - 0.5 * sigma**2 / (sigma**2 + constant)


def qon_bq(sigma: Number) -> Number:
    """Coefficient B_q of QON: [Portsmouth2025], below Eq. (1)."""
    return 0.45 * sigma**2 / (sigma**2 + 0.09)


def eon_denominator(rho: Array, roughness: Array) -> Array:
    """D = (1 + c1 r) (1 - rho (1 - <E_FON>)) of [Portsmouth2025], Eq. (18), in [1, 1 + c1]."""
    return 1.0 + C1 * roughness - rho * (roughness * (C1 - C2))


def eon_multiple_ratio(rho: Array, roughness: Array) -> Array:
    """Weight of H(mu_o) H(mu_i) relative to FON's 1 + r s / t_F, from [Portsmouth2025].

        rho r (1 + c2 r) / ((c1 - c2) D)

    This is Eq. (19) divided by Eq. (10). Common powers of r are cancelled, so there is no division
    by 1 - <E_FON>, which is 0 at roughness 0.
    """
    weight = roughness * (1.0 + C2 * roughness) / (C1 - C2)
    return rho * weight / eon_denominator(rho, roughness)


def oren_nayar_quotient(value: Array, divisor: Array) -> Array:
    """`value / divisor`, or 0 if the divisor is so small that the quotient could overflow."""
    xp = array_namespace(value, divisor)
    return value / xp.where(divisor < arrays.least_normal(divisor), np.inf, divisor)


def qon_quotient(mu_o: Array, mu_i: Array, s: Array) -> Array:
    """s / t_q: [Portsmouth2025], Eq. (4)."""
    xp = array_namespace(mu_o, mu_i, s)
    return oren_nayar_quotient(xp.maximum(s, 0.0), xp.maximum(mu_o, mu_i))


def fon_quotient(mu_o: Array, mu_i: Array, s: Array) -> Array:
    """s / t_F: [Portsmouth2025], Eq. (11)."""
    xp = array_namespace(mu_o, mu_i, s)
    return qon_quotient(mu_o, mu_i, s) + xp.minimum(s, 0.0)


def qon_brdf_mu(
    mu_o: Array, mu_i: Array, s: Array, rho: Array, sigma: Array, constant: float = 0.33
) -> Array:
    """rho / pi (A_q + B_q s / t_q): [Portsmouth2025], Eqs. (1), (3)."""
    return rho / np.pi * (qon_aq(sigma, constant) + qon_bq(sigma) * qon_quotient(mu_o, mu_i, s))


def fon_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """rho / pi A_F (1 + r s / t_F): [Portsmouth2025], Eq. (10)."""
    return fon_lambert(rho, roughness) * (1.0 + roughness * fon_quotient(mu_o, mu_i, s))


def eon_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """rho / pi A_F (1 + r s / t_F + weight H(mu_o) H(mu_i)): [Portsmouth2025], Eq. (16)."""
    single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s)
    multi_scatter = eon_multiple_ratio(rho, roughness) * (fon_loss_mu(mu_o) * fon_loss_mu(mu_i))
    return fon_lambert(rho, roughness) * (single_scatter + multi_scatter)


def oren_nayar_angle(y: Array, x: Array) -> Array:
    """Angle whose sine is y and whose cosine is x, as a fraction of a right angle."""
    xp = array_namespace(y, x)
    return (2.0 / np.pi) * xp.atan2(y, x)


def oren_nayar_behind_slope(mu_o: Array, mu_i: Array, S_o: Array, S_i: Array) -> Array:
    """(sin(alpha) - (2 beta / pi)^3) / cos(beta); the limit 6 / pi if both directions graze.

    (2 beta / pi)^3 is 1 - q (3 - 3 q + q^2), where q = 1 - 2 beta / pi, and sin(alpha) is 1 -
    cos(alpha)^2 / (1 + sin(alpha)). The two ones cancel in the difference and are omitted, so no
    digits are lost.
    """
    xp = array_namespace(mu_o, mu_i, S_o, S_i)
    high, low = xp.maximum(mu_o, mu_i), xp.minimum(mu_o, mu_i)
    q = oren_nayar_angle(high, xp.minimum(S_o, S_i))
    rise = q * (3.0 - 3.0 * q + q**2) - low**2 / (1.0 + xp.maximum(S_o, S_i))
    slope = oren_nayar_quotient(rise, high)
    return xp.where(high < arrays.least_normal(high), 6.0 / np.pi, slope)


def oren_nayar_interreflection(rho: Array, sigma: Array) -> Array:
    """Interreflection term of [OrenNayar1994]. [Fujii2013] adds this term to A."""
    return 0.17 * rho * (sigma**2 / (sigma**2 + 0.13))


def oren_nayar_formula(wo: Array, wi: Array, rho: Array, sigma: Array) -> Array:
    """`oren_nayar_brdf` for valid arrays; alpha and beta are fractions of a right angle."""
    xp = array_namespace(wo, wi)
    mu_o, mu_i, s = cosines(wo, wi)
    S_o, S_i = arrays.hypot(wo[..., 0], wo[..., 1]), arrays.hypot(wi[..., 0], wi[..., 1])
    elevation_o, elevation_i = oren_nayar_angle(mu_o, S_o), oren_nayar_angle(mu_i, S_i)
    alpha = 1.0 - xp.minimum(elevation_o, elevation_i)
    beta = 1.0 - xp.maximum(elevation_o, elevation_i)
    cos_phi = oren_nayar_quotient(s, S_o * S_i)
    # The term C2 cos(phi) tan(beta), where sin(beta) cos(phi) is computed as s / sin(alpha).
    behind = oren_nayar_quotient(xp.minimum(s, 0.0), xp.maximum(S_o, S_i))
    behind = behind * oren_nayar_behind_slope(mu_o, mu_i, S_o, S_i)
    # In the term with C3, 1 - cos(phi)^2 is computed as sin(phi)^2.
    cross = wo[..., 0] * wi[..., 1] - wo[..., 1] * wi[..., 0]
    aside = oren_nayar_quotient(cross, S_o * S_i) ** 2 / (1.0 + xp.abs(cos_phi))
    aside = aside * oren_nayar_quotient(S_o + S_i, mu_o + mu_i)
    C3 = 0.125 / 0.45 * qon_bq(sigma) * (alpha * beta) ** 2
    single_scatter = qon_aq(sigma) + qon_bq(sigma) * (qon_quotient(mu_o, mu_i, s) + behind)
    interreflection = oren_nayar_interreflection(rho, sigma) * (1.0 - beta**2 * cos_phi)
    return rho / np.pi * (single_scatter + C3 * aside + interreflection)


def eon_brdf_approx_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """EON with the quartic for H; where the quartic is negative (mu < 0.0014), H is 0."""
    losses = arrays.at_least_0(fon_loss_approx(mu_o)) * arrays.at_least_0(fon_loss_approx(mu_i))
    single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s)
    multi_scatter = eon_multiple_ratio(rho, roughness) * losses
    return fon_lambert(rho, roughness) * (single_scatter + multi_scatter)


@any_array
def lambert_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike) -> Array:
    """Lambert's BRDF f = rho / pi of a smooth diffuse surface, in 1/sr.

    [Portsmouth2025], section 2.1, limit for sigma -> 0.

        >>> lambert_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8]).round(6)
        array([0.063662, 0.254648])
    """
    return evaluate(lambda wo, wi, rho: rho / np.pi, wo, wi, rho)


@any_array
def oren_nayar_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of the full Oren-Nayar model with interreflection, in 1/sr.

        f = rho / pi [C1 + C2 cos(phi) tan(beta) + C3 (1 - |cos(phi)|) tan((alpha + beta) / 2)
                      + 0.17 rho sigma^2 / (sigma^2 + 0.13) (1 - cos(phi) (2 beta / pi)^2)],
        C1 = 1 - 0.5 sigma^2 / (sigma^2 + 0.33),  k = sigma^2 / (sigma^2 + 0.09),
        C2 = 0.45 k (sin(alpha) - (2 beta / pi)^3 where cos(phi) < 0),
        C3 = 0.125 k (4 alpha beta / pi^2)^2

    alpha is the larger polar angle, beta is the smaller polar angle, and phi is the difference of
    the azimuths. For rough dark surfaces and two grazing directions from opposite sides, the
    published fit is negative, down to -0.27 rho / pi. If both directions graze the surface,
    (sin(alpha) - (2 beta / pi)^3) tan(beta) has the limit 6 / pi, while tan((alpha + beta) / 2) has
    no limit and counts as 0. [OrenNayar1994], functional approximation for Gaussian slopes.

        >>> oren_nayar_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.063766, 0.269282])
    """
    return evaluate(oren_nayar_formula, wo, wi, rho, sigma=sigma)


@any_array
def qon_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of the qualitative Oren-Nayar model, in 1/sr.

        f = rho / pi (A + B s / t),  1/t = 0 where s <= 0, else 1 / max(mu_o, mu_i)

    [Portsmouth2025], Eqs. (1)-(4).

        >>> qon_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.06258 , 0.250322])
    """
    return evaluate(of_cosines(qon_brdf_mu), wo, wi, rho, sigma=sigma)


@any_array
def qon_footnote_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of QON with interreflection, in 1/sr.

        f = rho / pi (A + B s / t),  A = 1 - 0.5 sigma^2 / (sigma^2 + 0.57)

    The constant 0.57 in A, instead of QON's 0.33, approximates the effect of interreflection.
    [Portsmouth2025], footnote 1; [OrenNayar1994], qualitative model.

        >>> qon_footnote_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.066596, 0.266385])
    """
    return evaluate(of_cosines(partial(qon_brdf_mu, constant=0.57)), wo, wi, rho, sigma=sigma)


@any_array
def qon_fujii_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of QON with Fujii's coefficients, in 1/sr.

        f = rho / pi (A + 0.17 rho sigma^2 / (sigma^2 + 0.13) + B s / t),
        1/t = 1 where s <= 0, else 1 / max(mu_o, mu_i)

    The coefficients approximate the full model; the second term depends on rho squared.
    [Fujii2013], first proposed formula.

        >>> qon_fujii_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.064005, 0.273106])
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, sigma: Array) -> Array:
        a = qon_aq(sigma) + oren_nayar_interreflection(rho, sigma)
        return rho / np.pi * (a + qon_bq(sigma) * fon_quotient(mu_o, mu_i, s))

    return evaluate(of_cosines(formula), wo, wi, rho, sigma=sigma)


@any_array
def fon_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the Fujii Oren-Nayar model, in 1/sr.

        f = rho / pi A (1 + roughness s / t),  1/t = 1 where s <= 0, else 1 / max(mu_o, mu_i)

    [Portsmouth2025], Eqs. (10), (11).

        >>> fon_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.07235 , 0.289399])
    """
    return evaluate(of_cosines(fon_brdf_mu), wo, wi, rho, roughness=roughness)


@any_array
def eon_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the energy-preserving Oren-Nayar model, in 1/sr.

        f = rho / pi A (1 + r s / t + rho r (1 + c2 r) / ((c1 - c2) D) H(mu_o) H(mu_i)),
        D = 1 + c1 r - rho r (c1 - c2),  H = c1 - G_F / pi

    This is Eq. (19) with 1 - E_FON = r A H. Common powers of r are cancelled, so EON at roughness 0
    is exactly Lambert's BRDF. [Portsmouth2025], Eqs. (16)-(19).

        >>> eon_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.073621, 0.310981])
    """
    return evaluate(of_cosines(eon_brdf_mu), wo, wi, rho, roughness=roughness)


@any_array
def eon_brdf_approx(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of EON, with FON's albedo approximated by a quartic, in 1/sr.

        f as in `eon_brdf`,  G_F / pi = g1 m + g2 m^2 + g3 m^3 + g4 m^4,  m = 1 - mu

    Accuracy: the result is within 1.25e-3 / pi of `eon_brdf`. For mu < 0.0014, where the quartic
    makes H negative, H is 0. The paper's Listing 1 instead keeps 1 - E_FON above 1e-7. The result
    of Listing 1 differs by less than 1.4e-7 / pi for roughness > 1e-5, and is not Lambert's BRDF at
    roughness 0. [Portsmouth2025], Eqs. (14), (16)-(19).

        >>> eon_brdf_approx([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.073622, 0.311002])
    """
    return evaluate(of_cosines(eon_brdf_approx_mu), wo, wi, rho, roughness=roughness)


@any_array
def burley_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of Burley's diffuse model, in 1/sr.

        f = rho / pi (1 + k (1 - mu_o)^5) (1 + k (1 - mu_i)^5),
        k = F_D90 - 1 = 2 roughness (wi . wh)^2 - 1 / 2,  (wi . wh)^2 = (1 + wo . wi) / 2

    Result (..., C): 1/sr, in [0, 25/4 / pi]. Accuracy: the error is below (f + 1 / pi) 2^-53 times
    66 / roughness. [MaterialX2026], section `burley_diffuse_bsdf`, where the roughness is called
    sigma; [Burley2012], section 5.3.

        >>> burley_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.063985, 0.255939])
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
        k = roughness * (1.0 + mu_o * mu_i + s) - 0.5
        return rho / np.pi * (1.0 + k * (1.0 - mu_o) ** 5) * (1.0 + k * (1.0 - mu_i) ** 5)

    return evaluate(of_cosines(formula), wo, wi, rho, roughness=roughness)


@any_array
def burley_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of Burley's diffuse model in closed form; up to 1.558 rho near mu = 0.

        E(mu) = rho (1 + n (h + 2 r mu / 3) + h / 21 + r mu / 84 + n Q),
        n = (1 - mu)^5,  h = r - 1/2,
        Q = (h^2 + r^2 (1 - mu^2) / 2) / 21 + h r mu / 42 + r^2 (3 mu^2 - 1) / 504

    The BRDF is a polynomial in mu_i and cos(phi). The integrals of 2 mu_i^k (1 - mu_i)^5 for k = 1,
    2, 3 are 1/21, 1/84, 1/252. Accuracy: the absolute error is below 1e-12. [MaterialX2026],
    section Directional Albedo.

        >>> burley_albedo_dir(0.0, 1.0, 1.0).round(6)
        array([1.55754])
    """
    (rho,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    h, n = r - 0.5, (1.0 - m) ** 5
    both = (h**2 + 0.5 * r**2 * (1.0 - m) * (1.0 + m)) / 21.0
    both = both + h * r * m / 42.0 + r**2 * (3.0 * m**2 - 1.0) / 504.0
    unit = 1.0 + n * (h + 2.0 / 3.0 * r * m) + h / 21.0 + r * m / 84.0 + n * both
    return rho * unit


@any_array
def translucent_btdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike) -> Array:
    """BTDF f = rho / pi of Lambertian transmission, in 1/sr; the integral of f |mu_i| is rho.

    - `wi` (..., 3): Direction to the light, unit vector to 1e-6, z <= 0.
    - `rho` (..., C): Diffuse transmittance per channel, in [0, 1]; a number is one channel.

    [MaterialX2026], section `translucent_bsdf`, Lambertian transmittance equation.

        >>> translucent_btdf([0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.2, 0.8]).round(6)
        array([0.063662, 0.254648])
    """
    light = arguments.checked_transmitted("wi", arguments.checked_triples("wi", wi))
    xp = array_namespace(light)
    mirrored = xp.stack([light[..., 0], light[..., 1], -light[..., 2]], axis=-1)
    return evaluate(lambda wo, wi, rho: rho / np.pi, wo, mirrored, rho)


@any_array
def fon_loss(mu: ArrayLike) -> Array:
    """Energy that FON loses at unit reflectance, divided by the roughness and by the factor A.

        H(mu) = c1 - G_F(mu) / pi,  1 - E_FON = roughness A H

    Result (...): 0 at mu = 0, up to c1 = 1/2 - 2 / (3 pi) at normal incidence. Accuracy: the
    relative error is below 2e-15 for all mu. [Portsmouth2025], Eqs. (12), (13).

        >>> fon_loss([0.0, 0.5, 1.0]).round(6)
        array([0.      , 0.173441, 0.287793])
    """
    (mu,) = checked_numbers(mu=mu)
    return fon_loss_mu(mu)


@any_array
def fon_albedo_dir(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of FON at unit reflectance.

        E(mu) = 1 - roughness A H(mu),  A = 1 / (1 + c1 roughness)

    Accuracy: the relative error is below 1e-15. [Portsmouth2025], Eqs. (12), (13).

        >>> fon_albedo_dir([0.0, 1.0], 1.0).round(6)
        array([1.      , 0.776522])
    """
    mu, r = checked_numbers(mu=mu, roughness=roughness)
    return 1.0 - r * fon_loss_mu(mu) * fon_af(r)


@any_array
def fon_albedo_dir_approx(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of FON at unit reflectance, approximated by a quartic.

        E(mu) ~ (1 + roughness (g1 m + g2 m^2 + g3 m^3 + g4 m^4)) A,  m = 1 - mu

    Result (...): positive. For mu < 0.0014, the result exceeds 1 by up to 3.6e-4. Accuracy: the
    absolute error is below 6.1e-4. [Portsmouth2025], Eq. (14).

        >>> fon_albedo_dir_approx([0.0, 1.0], 1.0).round(6)
        array([1.000356, 0.776522])
    """
    mu, r = checked_numbers(mu=mu, roughness=roughness)
    return 1.0 - r * fon_loss_approx(mu) * fon_af(r)


@any_array
def fon_albedo_avg(roughness: ArrayLike) -> Array:
    """Average albedo of FON at unit reflectance.

        <E> = (1 + c2 roughness) / (1 + c1 roughness),  c2 = 2/3 - 28 / (15 pi)

    Result (...): in (0, 1]. [Portsmouth2025], Eqs. (15), (29).

        >>> fon_albedo_avg([0.0, 1.0]).round(6)
        array([1.      , 0.832811])
    """
    (r,) = checked_numbers(roughness=roughness)
    return (1.0 + C2 * r) * fon_af(r)


@any_array
def eon_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of EON. The albedo is exactly 1 where rho is 1.

        E(mu) = rho (1 - (1 - rho) roughness H(mu) / D),
        D = 1 + c1 roughness - rho roughness (c1 - c2)

    Accuracy: the relative error is below 1e-15. [Portsmouth2025], Eq. (28), where 1 - E_FON is
    roughness A H.

        >>> eon_albedo_dir([0.0, 1.0], [0.5, 1.0], 1.0).round(6)
        array([[0.5     , 1.      ],
               [0.439034, 1.      ]])
    """
    (rho,), (r, mu) = checked_colors({"rho": rho}, roughness=roughness, mu=mu)
    return eon_albedo(fon_loss_mu(mu), rho, r)


@any_array
def eon_albedo_dir_approx(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of EON, with FON's albedo approximated by a quartic.

        E(mu) as in `eon_albedo_dir`,  H = c1 - (g1 m + g2 m^2 + g3 m^3 + g4 m^4),  m = 1 - mu

    Result (..., C): in [0, 1]. For mu < 0.0014, the result exceeds rho by up to 1e-4. Accuracy: the
    absolute error is below 1.7e-4. [Portsmouth2025], Eqs. (14), (28).

        >>> eon_albedo_dir_approx([0.0, 1.0], [0.5, 1.0], 1.0).round(6)
        array([[0.500097, 1.      ],
               [0.439034, 1.      ]])
    """
    (rho,), (r, mu) = checked_colors({"rho": rho}, roughness=roughness, mu=mu)
    return eon_albedo(fon_loss_approx(mu), rho, r)


@any_array
def eon_albedo_avg(rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Average albedo of EON.

        <E> = rho (1 + c2 roughness) / D = rho <E_FON> / (1 - rho (1 - <E_FON>)),
        D = 1 + c1 roughness - rho roughness (c1 - c2)

    This is the average of [Portsmouth2025], Eq. (28). Eq. (33) is the inverse.

        >>> eon_albedo_avg([0.5, 1.0], 1.0).round(6)
        array([0.45439, 1.     ])
    """
    (rho,), (r,) = checked_colors({"rho": rho}, roughness=roughness)
    return eon_albedo(C1 - C2, rho, r)


def eon_albedo(loss: Array | float, rho: Array, r: Array) -> Array:
    """Directional or average albedo of EON, for FON's albedo 1 - r A `loss`."""
    return rho * (1.0 - (1.0 - rho) * r * loss / eon_denominator(rho, r))


@any_array
def qon_albedo_dir(mu: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of QON at unit reflectance.

        E(mu) = A + B G(mu) / pi,  G = pi (c1 - H(mu)) + 2/3 sqrt(1 - mu^2)

    Result (...): positive. Near mu = 0, the result is up to 1.02 for sigma < 0.6. Accuracy: the
    relative error is below 1e-15. [Portsmouth2025], Eqs. (5), (8).

        >>> qon_albedo_dir([0.0, 1.0], 0.5).round(6)
        array([0.949924, 0.784483])
    """
    mu, sigma = checked_numbers(mu=mu, sigma=sigma)
    g_over_pi = C1 - fon_loss_mu(mu) + 2.0 / (3.0 * np.pi) * arrays.root((1.0 - mu) * (1.0 + mu))
    return qon_aq(sigma) + qon_bq(sigma) * g_over_pi


@any_array
def qon_albedo_avg(sigma: ArrayLike) -> Array:
    """Average albedo of QON at unit reflectance.

        <E> = A + (2/3 - 64 / (45 pi)) B

    Result (...): in (0, 1]. [Portsmouth2025], Eq. (9).

        >>> qon_albedo_avg(0.5).round(6)
        np.float64(0.855278)
    """
    (sigma,) = checked_numbers(sigma=sigma)
    return qon_aq(sigma) + (2.0 / 3.0 - 64.0 / (45.0 * np.pi)) * qon_bq(sigma)


@any_array
def eon_rho_from_albedo_normal(color: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflectance rho for which EON has the albedo `color` at normal incidence.

        rho = 2 C d / (b + sqrt(b^2 + 4 c2 r d C)),  b = 1 + (c1 - c2) r C,  d = 1 + c1 r

    Accuracy: the relative error is below 1e-15. rho is the positive root of c2 r rho^2 + b rho = C
    d, written without a difference. At low roughness, nothing cancels and the divisor is not 0, so
    the paper's series is not needed. [Portsmouth2025], Eqs. (28) to (31).

        >>> eon_rho_from_albedo_normal([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.219784, 0.835673, 1.      ])
    """
    (color,), (r,) = checked_colors({"color": color}, roughness=roughness)
    b, d = 1.0 + (C1 - C2) * r * color, 1.0 + C1 * r
    sqrt = array_namespace(color, r).sqrt
    rho = 2.0 * color * d / (b + sqrt(b * b + 4.0 * C2 * r * d * color))
    # For a color of 1, rounding may make rho 1 + 2^-52, which the models would reject.
    return arrays.trimmed(rho, 1.0)


@any_array
def eon_rho_from_albedo_avg(color: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflectance rho for which EON has the average albedo `color`.

        rho = C d / (C d + (1 + c2 r)(1 - C)),  d = 1 + c1 r

    Accuracy: the relative error is below 1e-15. [Portsmouth2025], Eqs. (29) and (33).

        >>> eon_rho_from_albedo_avg([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.208598, 0.827676, 1.      ])
    """
    (color,), (r,) = checked_colors({"color": color}, roughness=roughness)
    scaled = color * (1.0 + C1 * r)
    return scaled / (scaled + (1.0 + C2 * r) * (1.0 - color))


# The functions below contain known errors of renderers, so that checks can recognize these errors.
# Functions whose name ends in `_mu` do not validate arguments.
FLOOR = 0.1  # smallest reflectance for which Babylon.js evaluates EON


def eon_clamped_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """EON with dot(wo, wi) clamped to at least 1e-8 before s is computed.

        s = max(dot(wo, wi), 1e-8) - mu_o mu_i

    The result is too bright where dot(wo, wi) < 0, and correct elsewhere. MaterialX's GLSL clamps
    dot(wo, wi) for other nodes and passes the clamped value to EON.
    """
    s = array_namespace(s).maximum(s + mu_o * mu_i, 1e-8) - mu_o * mu_i
    return eon_brdf_mu(mu_o, mu_i, s, rho, roughness)


def burley_schlick_brdf_mu(
    mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array
) -> Array:
    """Burley's diffuse model with a wrong retro-reflection term R.

        f = rho / pi ((1 - F_o / 2) (1 - F_i / 2) + R (F_o + F_i + F_o F_i (R - 1))),
        R = 1/2 + 2 roughness F_i^2,  F = (1 - mu)^5

    f is not reciprocal. f equals Lambert's BRDF at roughness 0, and Burley's BRDF where mu_o and
    mu_i are 1. The GLSL of three-gpu-pathtracer has this R; Burley's R is 2 roughness (wi . wh)^2.
    """
    F_o, F_i = (1.0 - mu_o) ** 5, (1.0 - mu_i) ** 5
    smooth = (1.0 - 0.5 * F_o) * (1.0 - 0.5 * F_i)
    R = 0.5 + 2.0 * roughness * F_i**2
    return rho / np.pi * (smooth + R * (F_o + F_i + F_o * F_i * (R - 1.0)))


def eon_rho_cubed_brdf_mu(
    mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array
) -> Array:
    """EON whose multiple-scattering lobe has rho^3 instead of rho^2.

    The result is correct where rho is 0 or 1, and else too dark. The OSL closure of Blender's
    Cycles multiplies the lobe by the albedo once too often.
    """
    single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s)
    weight = rho * eon_multiple_ratio(rho, roughness)
    multi_scatter = weight * (fon_loss_mu(mu_o) * fon_loss_mu(mu_i))
    return fon_lambert(rho, roughness) * (single_scatter + multi_scatter)


def fon_white_lobe_brdf_mu(
    mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array
) -> Array:
    """FON plus the multiple-scattering lobe of a white surface.

    The result is correct where rho is 1, and else too bright. MaterialX's MDL target does not tint
    this lobe, so a black surface with roughness 1 reflects 0.22 of the light.
    """
    losses = fon_loss_mu(mu_o) * fon_loss_mu(mu_i)
    white = roughness * fon_af(roughness) / (np.pi * (C1 - C2)) * losses
    return fon_brdf_mu(mu_o, mu_i, s, rho, roughness) + white


def eon_floor_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """EON with the error f = rho f_EON(max(rho, 0.1)) / max(rho, 0.1).

    The result is too bright where rho lies between 0 and 0.1, and correct elsewhere. Babylon.js
    9.35.0 divides EON by a reflectance that is clamped to at least 0.1. Like Babylon.js, this
    function uses the paper's quartic for FON's albedo.
    """
    floor = array_namespace(rho).maximum(rho, FLOOR)
    return rho / floor * eon_brdf_approx_mu(mu_o, mu_i, s, floor, roughness)


def qon_tinted_twice_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, sigma: Array) -> Array:
    """QON multiplied by the reflectance a second time.

    The thin-walled lobe of OpenPBR in MaterialX 1.39.5 has this error (issue 3027 of MaterialX).
    """
    return rho * qon_brdf_mu(mu_o, mu_i, s, rho, sigma)


@any_array
def qon_tinted_twice_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    return color * color * qon_albedo_dir(m, s)


@any_array
def eon_rho_cubed_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo E = rho (E_EON + (1 - rho) E_FON) of `eon_rho_cubed_brdf_mu`."""
    (color,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    return color * (eon_albedo_dir(mu, rho, roughness) + (1.0 - color) * fon_albedo_dir(m, r))


@any_array
def fon_white_lobe_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo E = 1 - (1 - rho) E_FON of `fon_white_lobe_brdf_mu`; not 0 at rho 0."""
    (color,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    return 1.0 - (1.0 - color) * fon_albedo_dir(m, r)


@any_array
def qon_fitted_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of QON, approximated as in MaterialX by a quotient of polynomials.

    The error is up to 0.068 at rho 1. The coefficients and the clamp to 1 are from
    `mx_microfacet_diffuse.glsl` in MaterialX 1.39.5.
    """
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    over = 1.0 - 0.4297 * s - 0.7632 * m * s + 1.4385 * s**2
    under = 1.0 - 0.6076 * s - 0.4993 * m * s + 2.0315 * s**2
    return arrays.at_most(over / under, 1.0) * color
