# SPDX-License-Identifier: Apache-2.0
"""BRDF of Lambert and of the Oren-Nayar family, in 1/sr and without the cosine.

All functions broadcast, are reciprocal, work on the closed domain, and evaluate in blocks, so that
memory beyond arguments and result does not grow. They use the caller's thread alone; `threads` lets
several share a large call. Where both directions graze the surface and s > 0,
s / max(mu_o, mu_i) has no limit and counts as 0; value times cosine is 0 there for any choice.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `rho` (..., C): Reflectance per channel, in [0, 1]; a number is one channel.
- `sigma` (...): Deviation of the facets' slope angle, in radian, in [0, pi/2].
- `roughness` (...): In [0, 1].

Result (..., C): BRDF in 1/sr, at least 0, unbounded at grazing. Accuracy: error below 1e-14 / pi,
or below 1e-14 of the largest value that |s / t| takes at these cosines where that is larger. Raises
`ValueError`, which names the first bad element, if an argument leaves its range or the shapes do
not broadcast.
"""

from __future__ import annotations

from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.evaluation import evaluate
from mxeon.models.core.namespaces import any_array
from mxeon.models.diffuse import formulas


@any_array
def lambert_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike) -> Array:
    """BRDF of a smooth diffuse surface, Lambert's.

        f = rho / pi

    Result (..., C): BRDF in 1/sr, in [0, 1/pi]. [Portsmouth2025], section 2.1, the limit
    sigma -> 0.

        >>> lambert_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8]).round(6)
        array([0.063662, 0.254648])
    """
    return evaluate(formulas.lambert_brdf, wo, wi, rho)


@any_array
def oren_nayar_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of the full Oren-Nayar model, interreflection included.

        f = rho / pi [C1 + C2 cos(phi) tan(beta) + C3 (1 - |cos(phi)|) tan((alpha + beta) / 2)
                      + 0.17 rho sigma^2 / (sigma^2 + 0.13) (1 - cos(phi) (2 beta / pi)^2)],
        C1 = 1 - 0.5 sigma^2 / (sigma^2 + 0.33),  k = sigma^2 / (sigma^2 + 0.09),
        C2 = 0.45 k (sin(alpha) - (2 beta / pi)^3 where cos(phi) < 0),
        C3 = 0.125 k (4 alpha beta / pi^2)^2

    Result (..., C): BRDF in 1/sr, unbounded at grazing. alpha and beta are the larger and the
    smaller polar angle, phi is the azimuth between both. The authors' fit falls below 0, to -0.27
    rho / pi, for rough dark surfaces where both directions graze from opposite sides. It stays as
    they printed it. At grazing, (sin(alpha) - (2 beta / pi)^3) tan(beta) has its limit 6 / pi; the
    tangent after C3 has none and counts as 0. [OrenNayar1994], functional approximation for
    Gaussian slopes, and interreflection.

        >>> oren_nayar_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.063766, 0.269282])
    """
    return evaluate(formulas.oren_nayar_brdf, wo, wi, rho, sigma=sigma)


@any_array
def qon_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of the qualitative Oren-Nayar model.

        f = rho / pi (A + B s / t),  1/t = 0 where s <= 0, else 1 / max(mu_o, mu_i)

    [Portsmouth2025], Eqs. (1)-(4).

        >>> qon_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.06258 , 0.250322])
    """
    return evaluate(formulas.qon_brdf, wo, wi, rho, sigma=sigma)


@any_array
def qon_footnote_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of QON with 0.57 instead of 0.33 in A, which approximates interreflection.

        f = rho / pi (A + B s / t),  A = 1 - 0.5 sigma^2 / (sigma^2 + 0.57)

    [Portsmouth2025], footnote 1; [OrenNayar1994], qualitative model.

        >>> qon_footnote_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.066596, 0.266385])
    """
    return evaluate(formulas.qon_footnote_brdf, wo, wi, rho, sigma=sigma)


@any_array
def qon_fujii_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """BRDF of QON with coefficients that match the full model, and with a tinted A.

        f = rho / pi (A + 0.17 rho sigma^2 / (sigma^2 + 0.13) + B s / t),
        1/t = 1 where s <= 0, else 1 / max(mu_o, mu_i)

    [Fujii2013], first proposed formula.

        >>> qon_fujii_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.064005, 0.273106])
    """
    return evaluate(formulas.qon_fujii_brdf, wo, wi, rho, sigma=sigma)


@any_array
def fon_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the Fujii Oren-Nayar model.

        f = rho / pi A (1 + roughness s / t),  1/t = 1 where s <= 0, else 1 / max(mu_o, mu_i)

    [Portsmouth2025], Eqs. (10), (11).

        >>> fon_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.07235 , 0.289399])
    """
    return evaluate(formulas.fon_brdf, wo, wi, rho, roughness=roughness)


@any_array
def eon_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of the energy-preserving Oren-Nayar model.

        f = rho / pi A (1 + r s / t + rho r (1 + c2 r) / ((c1 - c2) D) H(mu_o) H(mu_i)),
        D = 1 + c1 r - rho r (c1 - c2),  H = c1 - G_F / pi

    Form: Eq. (19) with 1 - E_FON = r A H; the powers of r that vanish with roughness are cancelled,
    so that roughness 0 is Lambert exactly. [Portsmouth2025], Eqs. (16)-(19).

        >>> eon_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.073621, 0.310981])
    """
    return evaluate(formulas.eon_brdf, wo, wi, rho, roughness=roughness)


@any_array
def eon_brdf_approx(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of EON with the quartic for the albedo of FON.

        f as in `eon_brdf`,  G_F / pi = g1 m + g2 m^2 + g3 m^3 + g4 m^4,  m = 1 - mu

    Accuracy: within 1.25e-3 / pi of `eon_brdf`. Below mu = 0.0014 the quartic loses less than
    nothing, and H counts as 0. Listing 1 of the paper keeps 1 - E_FON above 1e-7 instead. That
    differs by less than 1.4e-7 / pi for roughness > 1e-5, and is not Lambert at roughness 0.
    [Portsmouth2025], Eqs. (14), (16)-(19).

        >>> eon_brdf_approx([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.073622, 0.311002])
    """
    return evaluate(formulas.eon_brdf_approx, wo, wi, rho, roughness=roughness)
