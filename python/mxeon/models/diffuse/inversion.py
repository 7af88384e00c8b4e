# SPDX-License-Identifier: Apache-2.0
"""Reflectance `rho` with which EON has a wanted albedo: the inverse of the albedos in closed form.

Every color in [0, 1] is reached, by one rho in [0, 1], at every roughness; no other color is.

- `roughness` (...): In [0, 1].
- `color` (..., C): Wanted albedo, directional at normal incidence or average, in [0, 1].

Result (..., C): in [0, 1]. Raises `ValueError`, which names the first bad element, if an argument
leaves its range or the shapes do not broadcast.
"""

from __future__ import annotations

from mxeon.models.core.arguments import checked_colors
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import trimmed
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.diffuse.formulas import C1, C2

__all__ = [
    "eon_rho_from_albedo_avg",
    "eon_rho_from_albedo_avg_approx",
    "eon_rho_from_albedo_avg_refit_approx",
    "eon_rho_from_albedo_normal",
    "eon_rho_from_albedo_normal_approx",
    "eon_rho_from_albedo_normal_refit_approx",
]

# [Portsmouth2025], Eqs. (32) and (34); color and roughness in [0, 1]; largest error of rho 4.41e-3,
# where the paper states less than 0.3 %, and 2.84e-3.
NORMAL = (0.258831, 0.98995)
AVERAGE = 0.189468

# Our fits to the same forms, tools/fits/eon_inversion.py; largest error of rho 2.96e-3 and 1.86e-3.
NORMAL_REFIT = (0.2531091, 0.9883170)
AVERAGE_REFIT = 0.1843278


@any_array
def eon_rho_from_albedo_normal(color: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflectance rho that gives EON this directional albedo at normal incidence.

        rho = 2 C d / (b + sqrt(b^2 + 4 c2 r d C)),  b = 1 + (c1 - c2) r C,  d = 1 + c1 r

    Accuracy: relative error below 1e-15. Form: the root of [Portsmouth2025], Eq. (30), with the
    difference in its numerator multiplied out, times 1 + c1 r. Nothing cancels or vanishes at low
    roughness, so that no series is needed. [Portsmouth2025], Eqs. (28) to (31).

        >>> eon_rho_from_albedo_normal([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.219784, 0.835673, 1.      ])
    """
    color, r = _checked(color, roughness)
    b, d = 1.0 + (C1 - C2) * r * color, 1.0 + C1 * r
    sqrt = array_namespace(color, r).sqrt
    rho = 2.0 * color * d / (b + sqrt(b * b + 4.0 * C2 * r * d * color))
    # A color of 1 may be rounded to 1 + 2^-52, which no model takes.
    return trimmed(rho, 1.0)


@any_array
def eon_rho_from_albedo_avg(color: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflectance rho that gives EON this average albedo.

        rho = C d / (C d + (1 + c2 r)(1 - C)),  d = 1 + c1 r

    Accuracy: relative error below 1e-15. [Portsmouth2025], Eqs. (29) and (33).

        >>> eon_rho_from_albedo_avg([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.208598, 0.827676, 1.      ])
    """
    color, r = _checked(color, roughness)
    scaled = color * (1.0 + C1 * r)
    return scaled / (scaled + (1.0 + C2 * r) * (1.0 - color))


@any_array
def eon_rho_from_albedo_normal_approx(color: ArrayLike, roughness: ArrayLike) -> Array:
    """`eon_rho_from_albedo_normal` by the paper's polynomial.

    Accuracy: error at most 4.41e-3, at roughness 1 and color 0.69. The paper states less than
    0.3 %, which holds up to roughness 0.89. A color of 1 gives 1 - 0.0026 r. [Portsmouth2025],
    Eq. (32).

        >>> eon_rho_from_albedo_normal_approx([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.217735, 0.839332, 0.997399])
    """
    return _polynomial(color, roughness, *NORMAL)


@any_array
def eon_rho_from_albedo_normal_refit_approx(color: ArrayLike, roughness: ArrayLike) -> Array:
    """`eon_rho_from_albedo_normal` by a polynomial of the paper's form with new coefficients.

    Accuracy: error at most 2.96e-3, the least that this form can have. A color of 1 gives
    1 - 0.00296 r. tools/fits/eon_inversion.py; the form is [Portsmouth2025], Eq. (32).

        >>> eon_rho_from_albedo_normal_refit_approx([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.216827, 0.838132, 0.997043])
    """
    return _polynomial(color, roughness, *NORMAL_REFIT)


@any_array
def eon_rho_from_albedo_avg_approx(color: ArrayLike, roughness: ArrayLike) -> Array:
    """`eon_rho_from_albedo_avg` by the paper's polynomial.

    Accuracy: error at most 2.84e-3; 0 at colors 0 and 1. [Portsmouth2025], Eq. (34).

        >>> eon_rho_from_albedo_avg_approx([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.207965, 0.830315, 1.      ])
    """
    return _polynomial(color, roughness, AVERAGE, 1.0)


@any_array
def eon_rho_from_albedo_avg_refit_approx(color: ArrayLike, roughness: ArrayLike) -> Array:
    """`eon_rho_from_albedo_avg` by a polynomial of the paper's form with a new coefficient.

    Accuracy: error at most 1.86e-3, the least that this form can have; 0 at colors 0 and 1.
    tools/fits/eon_inversion.py; the form is [Portsmouth2025], Eq. (34).

        >>> eon_rho_from_albedo_avg_refit_approx([0.0, 0.18, 0.8, 1.0], 1.0).round(6)
        array([0.      , 0.207207, 0.829492, 1.      ])
    """
    return _polynomial(color, roughness, AVERAGE_REFIT, 1.0)


def _checked(color: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Checked arguments as float64 arrays: colors (..., C), roughness (..., 1)."""
    (color,), (roughness,) = checked_colors({"color": color}, roughness=roughness)
    return color, roughness


def _polynomial(color: ArrayLike, roughness: ArrayLike, slope: float, zero: float) -> Array:
    """C + slope (zero - C) C r: [Portsmouth2025], Eqs. (32) and (34)."""
    color, r = _checked(color, roughness)
    return color + slope * (zero - color) * color * r
