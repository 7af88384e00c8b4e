# SPDX-License-Identifier: Apache-2.0
"""Formulas of the Oren-Nayar family on valid float64 arrays, term by term as in the paper.

Names and arguments are those of the shader functions in `genglsl/lib/eon.glsl` and
`genglsl/sampling/oren_nayar_family.glsl`. Directions are (..., 3), everything else (...), but `rho` has its
channels on the first axis, so that it broadcasts against the rest.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array, Number
from mxeon.models.core.edges import at_least_0, cosine, except_at_1, hypot, least_normal
from mxeon.models.core.namespaces import array_namespace

# FON loses r c1 / (1 + c1 r) at normal incidence and r (c1 - c2) / (1 + c1 r) on average:
# [Portsmouth2025], Eqs. (10), (15), (29).
C1 = 0.5 - 2.0 / (3.0 * np.pi)
C2 = 2.0 / 3.0 - 28.0 / (15.0 * np.pi)

# G_F / pi in powers of 1 - mu, mu in [0, 1]: [Portsmouth2025], Eq. (14); largest error 6.0e-4.
FON_G = (0.0571085289, 0.491881867, -0.332181442, 0.0714429953)


def cosines(wo: Array, wi: Array) -> tuple[Array, Array, Array]:
    """Cosines with the normal, and the part of the pair's cosine that lies in the surface.

        s = dot(wo, wi) - mu_o mu_i = wo.x wi.x + wo.y wi.y

    - `wo`, `wi` (..., 3): Unit vectors on or above the horizon.

    `mu_o`, `mu_i` (...): Cosines, in [0, 1]: z, but 1 where a rounded direction has z > 1. `s`
    (...): In [-1, 1] up to rounding; signed, never clamped. [Portsmouth2025], below Eq. (3).
    """
    s = wo[..., 0] * wi[..., 0] + wo[..., 1] * wi[..., 1]
    return cosine(wo[..., 2]), cosine(wi[..., 2]), s


def fon_loss(mu: Array) -> Array:
    """H(mu) = c1 - G_F(mu) / pi: [Portsmouth2025], Eq. (13); FON loses r A_F H(mu).

        H = mu t (c1 - S t (2 + S) / (3 pi)) + (2 / pi) S atan(t)
        S = sqrt(1 - mu^2),  t = mu / (1 + S)

    With theta_o = pi / 2 - 2 atan(t) and 1 - S = mu t nothing divides by mu and nothing cancels.
    Near the normal H is c1 + O(S^3).
    """
    return except_at_1(_fon_loss, mu, C1)


def _fon_loss(mu: Array) -> Array:
    """H(mu), whose steps have no derivative at mu = 1."""
    xp = array_namespace(mu)
    S = xp.sqrt((1.0 - mu) * (1.0 + mu))
    t = mu / (1.0 + S)
    return mu * t * (C1 - S * t * (2.0 + S) / (3.0 * np.pi)) + (2.0 / np.pi) * S * xp.atan(t)


def fon_loss_approx(mu: Array) -> Array:
    """H(mu) with the quartic of [Portsmouth2025], Eq. (14): below 0 where mu < 0.0014."""
    m = 1.0 - mu
    g1, g2, g3, g4 = FON_G
    return C1 - m * (g1 + m * (g2 + m * (g3 + m * g4)))


def fon_a(roughness: Array) -> Array:
    """A_F: [Portsmouth2025], below Eq. (11)."""
    return 1.0 / (1.0 + C1 * roughness)


def fon_scale(rho: Array, roughness: Array) -> Array:
    """rho A_F / pi: [Portsmouth2025], Eq. (10)."""
    return rho / np.pi * fon_a(roughness)


def qon_a(sigma: Number, constant: float = 0.33) -> Number:
    """A_q: [Portsmouth2025], below Eq. (1)."""
    return 1.0 - 0.5 * sigma**2 / (sigma**2 + constant)


def qon_b(sigma: Number) -> Number:
    """B_q: [Portsmouth2025], below Eq. (1)."""
    return 0.45 * sigma**2 / (sigma**2 + 0.09)


def eon_denominator(rho: Array, roughness: Array) -> Array:
    """D = (1 + c1 r) (1 - rho (1 - <E_FON>)), in [1, 1 + c1]: from [Portsmouth2025], Eq. (18)."""
    return 1.0 + C1 * roughness - rho * (roughness * (C1 - C2))


def eon_multiple_weight(rho: Array, roughness: Array) -> Array:
    """Weight of H(mu_o) H(mu_i) beside FON's 1 + r s / t_F: Eq. (19) over Eq. (10).

        rho r (1 + c2 r) / ((c1 - c2) D)

    The powers of r that vanish with the roughness are cancelled: no division by 1 - <E_FON>.
    """
    weight = roughness * (1.0 + C2 * roughness) / (C1 - C2)
    return rho * weight / eon_denominator(rho, roughness)


def oren_nayar_quotient(value: Array, divisor: Array) -> Array:
    """`value / divisor`, and 0 where a divisor >= 0 vanishes: this family has no limit there.

    A divisor below the smallest normal number counts as 0, for the quotient might overflow.
    """
    xp = array_namespace(value, divisor)
    return value / xp.where(divisor < least_normal(divisor), np.inf, divisor)


def qon_quotient(mu_o: Array, mu_i: Array, s: Array) -> Array:
    """s / t_q: [Portsmouth2025], Eq. (4)."""
    xp = array_namespace(mu_o, mu_i, s)
    return oren_nayar_quotient(xp.maximum(s, 0.0), xp.maximum(mu_o, mu_i))


def fon_quotient(mu_o: Array, mu_i: Array, s: Array) -> Array:
    """s / t_F: [Portsmouth2025], Eq. (11)."""
    xp = array_namespace(mu_o, mu_i, s)
    return qon_quotient(mu_o, mu_i, s) + xp.minimum(s, 0.0)


def qon_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, sigma: Array) -> Array:
    """rho / pi (A_q + B_q s / t_q): [Portsmouth2025], Eqs. (1), (3)."""
    return rho / np.pi * (qon_a(sigma) + qon_b(sigma) * qon_quotient(mu_o, mu_i, s))


def fon_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """rho / pi A_F (1 + r s / t_F): [Portsmouth2025], Eq. (10)."""
    return fon_scale(rho, roughness) * (1.0 + roughness * fon_quotient(mu_o, mu_i, s))


def eon_brdf_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """rho / pi A_F (1 + r s / t_F + weight H(mu_o) H(mu_i)): [Portsmouth2025], Eq. (16)."""
    single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s)
    multi_scatter = eon_multiple_weight(rho, roughness) * (fon_loss(mu_o) * fon_loss(mu_i))
    return fon_scale(rho, roughness) * (single_scatter + multi_scatter)


def lambert_brdf(wo: Array, wi: Array, rho: Array) -> Array:
    """rho / pi."""
    return rho / np.pi


def oren_nayar_angle(y: Array, x: Array) -> Array:
    """Angle whose sine is y and whose cosine is x, as a fraction of a right angle."""
    xp = array_namespace(y, x)
    return (2.0 / np.pi) * xp.atan2(y, x)


def oren_nayar_behind_slope(mu_o: Array, mu_i: Array, S_o: Array, S_i: Array) -> Array:
    """(sin(alpha) - (2 beta / pi)^3) / cos(beta), and its limit 6 / pi where both directions graze.

    With q = 1 - 2 beta / pi the cube is 1 - q (3 - 3 q + q^2), and 1 - sin(alpha) is
    cos(alpha)^2 / (1 + sin(alpha)): the ones cancel, not the digits.
    """
    xp = array_namespace(mu_o, mu_i, S_o, S_i)
    high, low = xp.maximum(mu_o, mu_i), xp.minimum(mu_o, mu_i)
    q = oren_nayar_angle(high, xp.minimum(S_o, S_i))
    rise = q * (3.0 - 3.0 * q + q**2) - low**2 / (1.0 + xp.maximum(S_o, S_i))
    slope = oren_nayar_quotient(rise, high)
    return xp.where(high < least_normal(high), 6.0 / np.pi, slope)


def oren_nayar_interreflection(rho: Array, sigma: Array) -> Array:
    """Term that interreflection adds to A: [OrenNayar1994], [Fujii2013]."""
    return 0.17 * rho * (sigma**2 / (sigma**2 + 0.13))


def oren_nayar_brdf(wo: Array, wi: Array, rho: Array, sigma: Array) -> Array:
    """The functional approximation of [OrenNayar1994] for Gaussian slopes, with interreflection.

        f = rho / pi [C1 + C2 cos(phi) tan(beta) + C3 (1 - |cos(phi)|) tan((alpha + beta) / 2)]
            + 0.17 rho^2 / pi sigma^2 / (sigma^2 + 0.13) (1 - (2 beta / pi)^2 cos(phi))
        C1 = A_q,  C2 = B_q (sin(alpha) - (2 beta / pi)^3 where cos(phi) < 0),
        C3 = 0.125 sigma^2 / (sigma^2 + 0.09) (4 alpha beta / pi^2)^2

    alpha is the larger polar angle, beta the smaller; both as fractions of a right angle below.
    """
    xp = array_namespace(wo, wi)
    mu_o, mu_i, s = cosines(wo, wi)
    S_o, S_i = hypot(wo[..., 0], wo[..., 1]), hypot(wi[..., 0], wi[..., 1])
    elevation_o, elevation_i = oren_nayar_angle(mu_o, S_o), oren_nayar_angle(mu_i, S_i)
    alpha = 1.0 - xp.minimum(elevation_o, elevation_i)
    beta = 1.0 - xp.maximum(elevation_o, elevation_i)
    cos_phi = oren_nayar_quotient(s, S_o * S_i)
    # C2 cos(phi) tan(beta), where sin(beta) cos(phi) is s / sin(alpha).
    behind = oren_nayar_quotient(xp.minimum(s, 0.0), xp.maximum(S_o, S_i))
    behind = behind * oren_nayar_behind_slope(mu_o, mu_i, S_o, S_i)
    # C3 and what follows it, where 1 - cos(phi)^2 is (cross / (S_o S_i))^2.
    cross = wo[..., 0] * wi[..., 1] - wo[..., 1] * wi[..., 0]
    aside = oren_nayar_quotient(cross, S_o * S_i) ** 2 / (1.0 + xp.abs(cos_phi))
    aside = aside * oren_nayar_quotient(S_o + S_i, mu_o + mu_i)
    C3 = 0.125 / 0.45 * qon_b(sigma) * (alpha * beta) ** 2
    single_scatter = qon_a(sigma) + qon_b(sigma) * (qon_quotient(mu_o, mu_i, s) + behind)
    interreflection = oren_nayar_interreflection(rho, sigma) * (1.0 - beta**2 * cos_phi)
    return rho / np.pi * (single_scatter + C3 * aside + interreflection)


def qon_brdf(wo: Array, wi: Array, rho: Array, sigma: Array) -> Array:
    """[Portsmouth2025], Eqs. (1), (3), (4)."""
    return qon_brdf_mu(*cosines(wo, wi), rho, sigma)


def qon_footnote_brdf(wo: Array, wi: Array, rho: Array, sigma: Array) -> Array:
    """QON with 0.57 for 0.33 in A_q: [Portsmouth2025], footnote 1."""
    return rho / np.pi * (qon_a(sigma, 0.57) + qon_b(sigma) * qon_quotient(*cosines(wo, wi)))


def qon_fujii_brdf(wo: Array, wi: Array, rho: Array, sigma: Array) -> Array:
    """rho / pi (A_q + 0.17 rho k + B_q s / t_F), k = sigma^2 / (sigma^2 + 0.13): [Fujii2013]."""
    a = qon_a(sigma) + oren_nayar_interreflection(rho, sigma)
    return rho / np.pi * (a + qon_b(sigma) * fon_quotient(*cosines(wo, wi)))


def fon_brdf(wo: Array, wi: Array, rho: Array, roughness: Array) -> Array:
    """[Portsmouth2025], Eqs. (10), (11)."""
    return fon_brdf_mu(*cosines(wo, wi), rho, roughness)


def eon_brdf(wo: Array, wi: Array, rho: Array, roughness: Array) -> Array:
    """[Portsmouth2025], Eqs. (16), (19)."""
    return eon_brdf_mu(*cosines(wo, wi), rho, roughness)


def eon_brdf_approx(wo: Array, wi: Array, rho: Array, roughness: Array) -> Array:
    """EON with the quartic for H, which is kept from falling below 0 where mu < 0.0014."""
    mu_o, mu_i, s = cosines(wo, wi)
    losses = at_least_0(fon_loss_approx(mu_o)) * at_least_0(fon_loss_approx(mu_i))
    single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s)
    multi_scatter = eon_multiple_weight(rho, roughness) * losses
    return fon_scale(rho, roughness) * (single_scatter + multi_scatter)
