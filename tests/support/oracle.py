# SPDX-License-Identifier: Apache-2.0
"""The published equations of the diffuse models in 50 digits, without `mxeon.models.diffuse`.

Each function takes one pair of directions and one color channel. Numbers are mpmath numbers, and
directions are triples of mpmath numbers.
"""

import mpmath as mp

mp.mp.dps = 50
half = mp.mpf(1) / 2


def decimal(text):
    """Constant with exactly the published decimal digits."""
    return mp.mpf(text)


def s_of(wo, wi):
    return sum(a * b for a, b in zip(wo, wi, strict=True)) - wo[2] * wi[2]


def qon_quotient(wo, wi):
    """Quotient s / t of QON, [Portsmouth2025], Eq. (4)."""
    s = s_of(wo, wi)
    return s / max(wo[2], wi[2]) if s > 0 else mp.mpf(0)


def fon_quotient(wo, wi):
    """Quotient s / t of FON, [Portsmouth2025], Eq. (11)."""
    s = s_of(wo, wi)
    return s / max(wo[2], wi[2]) if s > 0 else s


def fraction(sigma, weight, constant):
    return decimal(weight) * sigma**2 / (sigma**2 + decimal(constant))


def lambert(wo, wi, rho):
    return rho / mp.pi


def qon(wo, wi, rho, sigma):
    a, b = 1 - fraction(sigma, "0.5", "0.33"), fraction(sigma, "0.45", "0.09")
    return rho / mp.pi * (a + b * qon_quotient(wo, wi))


def qon_footnote(wo, wi, rho, sigma):
    a, b = 1 - fraction(sigma, "0.5", "0.57"), fraction(sigma, "0.45", "0.09")
    return rho / mp.pi * (a + b * qon_quotient(wo, wi))


def qon_fujii(wo, wi, rho, sigma):
    a = 1 - fraction(sigma, "0.5", "0.33") + rho * fraction(sigma, "0.17", "0.13")
    return rho / mp.pi * (a + fraction(sigma, "0.45", "0.09") * fon_quotient(wo, wi))


def oren_nayar(wo, wi, rho, sigma):
    """BRDF of [OrenNayar1994]: the terms with C1, C2 and C3, and interreflection."""
    theta_o, theta_i = (mp.atan2(mp.hypot(w[0], w[1]), w[2]) for w in (wo, wi))
    alpha, beta = max(theta_o, theta_i), min(theta_o, theta_i)
    cosine = mp.cos(mp.atan2(wo[1], wo[0]) - mp.atan2(wi[1], wi[0]))
    c1 = 1 - fraction(sigma, "0.5", "0.33")
    c2 = fraction(sigma, "0.45", "0.09")
    c2 *= mp.sin(alpha) - (0 if cosine >= 0 else (2 * beta / mp.pi) ** 3)
    c3 = fraction(sigma, "0.125", "0.09") * (4 * alpha * beta / mp.pi**2) ** 2
    first = c1 + cosine * c2 * mp.tan(beta) + (1 - abs(cosine)) * c3 * mp.tan((alpha + beta) / 2)
    second = fraction(sigma, "0.17", "0.13") * (1 - cosine * (2 * beta / mp.pi) ** 2)
    return (rho * first + rho**2 * second) / mp.pi


def fon_af(r):
    """Coefficient A_F of FON, [Portsmouth2025], below Eq. (11)."""
    return 1 / (1 + (half - 2 / (3 * mp.pi)) * r)


def fon(wo, wi, rho, r):
    return rho / mp.pi * (fon_af(r) + r * fon_af(r) * fon_quotient(wo, wi))


def g_q(mu):
    """Function G_Q, [Portsmouth2025], Eq. (8), with its limit at grazing."""
    if mu == 0:
        return mp.pi / 2
    theta, S = mp.acos(mu), mp.sqrt(1 - mu**2)
    return S * (theta - S * mu) + mp.mpf(2) / 3 * (S / mu) * (1 - S**3)


def g_f(mu):
    """Function G_F, [Portsmouth2025], Eq. (13)."""
    return g_q(mu) - mp.mpf(2) / 3 * mp.sqrt(1 - mu**2)


def g_f_approx(mu):
    """Approximation of G_F, [Portsmouth2025], Eq. (14)."""
    printed = ("0.0571085289", "0.491881867", "-0.332181442", "0.0714429953")
    return mp.pi * sum(decimal(g) * (1 - mu) ** k for k, g in enumerate(printed, start=1))


def qon_albedo_dir(mu, rho, sigma):
    """Directional albedo of QON, [Portsmouth2025], Eq. (5)."""
    a, b = 1 - fraction(sigma, "0.5", "0.33"), fraction(sigma, "0.45", "0.09")
    return rho * (a + b / mp.pi * g_q(mu))


def fon_albedo_dir(mu, rho, r, g=g_f):
    """Directional albedo of FON, [Portsmouth2025], Eq. (12)."""
    return rho * (fon_af(r) + r * fon_af(r) / mp.pi * g(mu))


def fon_albedo_avg(rho, r):
    """Average albedo of FON, [Portsmouth2025], Eq. (15)."""
    return rho * (fon_af(r) + (mp.mpf(2) / 3 - 28 / (15 * mp.pi)) * r * fon_af(r))


def eon_albedo_dir(mu, rho, r):
    """Directional albedo of EON, [Portsmouth2025], Eq. (28)."""
    e, average = fon_albedo_dir(mu, 1, r), fon_albedo_avg(1, r)
    return rho * ((1 - rho) * e + rho * average) / ((1 - rho) + rho * average)


def eon_albedo_avg(rho, r):
    """Average albedo of EON, [Portsmouth2025], Eq. (33) solved for C."""
    return rho * fon_albedo_avg(1, r) / (1 - rho * (1 - fon_albedo_avg(1, r)))


def eon(wo, wi, rho, r, g=g_f):
    """BRDF of EON, [Portsmouth2025], Eqs. (16) and (19), for r > 0."""
    average = fon_albedo_avg(1, r)
    losses = [max(mp.mpf(0), 1 - fon_albedo_dir(w[2], 1, r, g)) for w in (wo, wi)]
    factor = rho**2 / mp.pi * average / (1 - rho * (1 - average))
    return fon(wo, wi, rho, r) + factor * losses[0] * losses[1] / (1 - average)


def eon_approx(wo, wi, rho, r):
    return eon(wo, wi, rho, r, g_f_approx)
