# SPDX-License-Identifier: Apache-2.0
"""Directional and average albedos of the Oren-Nayar family, in closed form and by quadrature.

Those of QON are in `qon_albedo`. The albedos of FON are those at unit reflectance: multiply by rho. All functions broadcast
and work on the closed domain; of numbers alone, those without channels return a number. H is
`fon_loss`.

- `mu` (...): Cosine of the polar angle, in [0, 1].
- `roughness` (...): In [0, 1].
- `rho` (..., C): Reflectance per channel, in [0, 1]; a number is one channel.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from mxeon.models.core.arguments import checked_colors, checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import any_array
from mxeon.models.diffuse import formulas
from mxeon.models.diffuse.formulas import C1, C2, fon_a


@any_array
def fon_loss(mu: ArrayLike) -> Array:
    """Energy that FON loses at unit reflectance, divided by roughness and by the factor A.

        H(mu) = c1 - G_F(mu) / pi,  1 - E_FON = roughness A H

    Result (...): in [0, c1]: 0 at grazing, c1 = 1/2 - 2 / (3 pi) at normal incidence. Accuracy:
    relative error below 2e-15 on all of [0, 1]. [Portsmouth2025], Eqs. (12), (13).

        >>> fon_loss([0.0, 0.5, 1.0]).round(6)
        array([0.      , 0.173441, 0.287793])
    """
    (mu,) = checked_numbers(mu=mu)
    return formulas.fon_loss(mu)


@any_array
def fon_albedo_dir(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of FON at unit reflectance.

        E(mu) = 1 - roughness A H(mu),  A = 1 / (1 + c1 roughness)

    Result (...): in (0, 1]. Accuracy: relative error below 1e-15. [Portsmouth2025], Eqs. (12),
    (13).

        >>> fon_albedo_dir([0.0, 1.0], 1.0).round(6)
        array([1.      , 0.776522])
    """
    mu, r = checked_numbers(mu=mu, roughness=roughness)
    return 1.0 - r * formulas.fon_loss(mu) * fon_a(r)


@any_array
def fon_albedo_dir_approx(mu: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of FON at unit reflectance, with a quartic.

        E(mu) ~ (1 + roughness (g1 m + g2 m^2 + g3 m^3 + g4 m^4)) A,  m = 1 - mu

    Result (...): positive; above 1, by up to 3.6e-4, for mu < 0.0014. Accuracy: absolute error
    below 6.1e-4. [Portsmouth2025], Eq. (14).

        >>> fon_albedo_dir_approx([0.0, 1.0], 1.0).round(6)
        array([1.000356, 0.776522])
    """
    mu, r = checked_numbers(mu=mu, roughness=roughness)
    return 1.0 - r * formulas.fon_loss_approx(mu) * fon_a(r)


@any_array
def fon_albedo_avg(roughness: ArrayLike) -> Array:
    """Average albedo of FON at unit reflectance.

        <E> = (1 + c2 roughness) / (1 + c1 roughness),  c2 = 2/3 - 28 / (15 pi)

    Result (...): in (0, 1]. [Portsmouth2025], Eqs. (15), (29).

        >>> fon_albedo_avg([0.0, 1.0]).round(6)
        array([1.      , 0.832811])
    """
    (r,) = checked_numbers(roughness=roughness)
    return (1.0 + C2 * r) * fon_a(r)


@any_array
def eon_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of EON.

        E(mu) = rho (1 - (1 - rho) roughness H(mu) / D),
        D = 1 + c1 roughness - rho roughness (c1 - c2)

    Result (..., C): in [0, rho]; exactly 1 where rho is 1. Accuracy: relative error below 1e-15.
    The form is Eq. (28) with 1 - E_FON = roughness A H. [Portsmouth2025], Eq. (28).

        >>> eon_albedo_dir([0.0, 1.0], [0.5, 1.0], 1.0).round(6)
        array([[0.5     , 1.      ],
               [0.439034, 1.      ]])
    """
    (rho,), (r, mu) = checked_colors({"rho": rho}, roughness=roughness, mu=mu)
    return eon_albedo(formulas.fon_loss(mu), rho, r)


@any_array
def eon_albedo_dir_approx(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of EON, with the quartic for the albedo of FON.

        E(mu) as in `eon_albedo_dir`,  H = c1 - (g1 m + g2 m^2 + g3 m^3 + g4 m^4),  m = 1 - mu

    Result (..., C): in [0, 1]; above rho, by up to 1e-4, for mu < 0.0014. Accuracy: absolute error
    below 1.7e-4. [Portsmouth2025], Eqs. (14), (28).

        >>> eon_albedo_dir_approx([0.0, 1.0], [0.5, 1.0], 1.0).round(6)
        array([[0.500097, 1.      ],
               [0.439034, 1.      ]])
    """
    (rho,), (r, mu) = checked_colors({"rho": rho}, roughness=roughness, mu=mu)
    return eon_albedo(formulas.fon_loss_approx(mu), rho, r)


@any_array
def eon_albedo_avg(rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Average albedo of EON.

        <E> = rho (1 + c2 roughness) / D = rho <E_FON> / (1 - rho (1 - <E_FON>)),
        D = 1 + c1 roughness - rho roughness (c1 - c2)

    Result (..., C): in [0, rho]. [Portsmouth2025], Eqs. (15), (28), averaged; inverse of Eq. (33).

        >>> eon_albedo_avg([0.5, 1.0], 1.0).round(6)
        array([0.45439, 1.     ])
    """
    (rho,), (r,) = checked_colors({"rho": rho}, roughness=roughness)
    return eon_albedo(C1 - C2, rho, r)


def eon_albedo(loss: Array | float, rho: Array, r: Array) -> Array:
    """Albedo of EON where FON loses r A loss."""
    return rho * (1.0 - (1.0 - rho) * r * loss / formulas.eon_denominator(rho, r))
