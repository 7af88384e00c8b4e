# SPDX-License-Identifier: Apache-2.0
"""Roughnesses and absorption of hair from what an artist sets.

Result (..., 3): per radius of the fiber, in [0, inf). Raises `ValueError`, which names the first
bad element, if an argument leaves its range or the shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked, checked_triples
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import lead_shape

# Absorption of the pigments in red, green and blue, per radius of the fiber.
EUMELANIN = (0.419, 0.697, 1.37)
PHEOMELANIN = (0.187, 0.4, 1.05)


@any_array
def chiang_hair_roughness(
    longitudinal: ArrayLike,
    azimuthal: ArrayLike,
    scale_tt: ArrayLike = 0.5,
    scale_trt: ArrayLike = 2.0,
) -> tuple[Array, Array, Array]:
    """Longitudinal variance and azimuthal scale of the lobes R, TT and TRT.

        v = (0.726 l + 0.812 l^2 + 3.7 l^20)^2,  s = 0.265 a + 1.194 a^2 + 5.372 a^22;
        R (v, s), TT (scale_tt^2 v, s), TRT (scale_trt^2 v, s)

    - `longitudinal`, `azimuthal` (...): Roughnesses l and a, in [0, 1].
    - `scale_tt`, `scale_trt` (...): In [0, 1e50].

    `r`, `tt`, `trt` (..., 2): Variance v and logistic scale s of each lobe, before the factor
    sqrt(pi / 8) of the model. [MaterialX2026], Hair Roughness Conversion Equations; [Chiang2016],
    the fits of both roughnesses.

        >>> r, tt, trt = chiang_hair_roughness(0.1, 0.2)
        >>> r.round(6), tt.round(6), trt.round(6)
        (array([0.006516, 0.10076 ]), array([0.001629, 0.10076 ]), array([0.026063, 0.10076 ]))
    """
    values = {
        "longitudinal": longitudinal,
        "azimuthal": azimuthal,
        "scale_tt": scale_tt,
        "scale_trt": scale_trt,
    }
    numbers = {name: checked(name, value) for name, value in values.items()}
    shape, xp = lead_shape({}, numbers), array_namespace(*numbers.values())
    long, azim, *scales = (xp.broadcast_to(value, shape) for value in numbers.values())
    v = xp.square(0.726 * long + 0.812 * long**2 + 3.7 * long**20)
    s = 0.265 * azim + 1.194 * azim**2 + 5.372 * azim**22
    tt, trt = (xp.stack([scale * scale * v, s], axis=-1) for scale in scales)
    return xp.stack([v, s], axis=-1), tt, trt


@any_array
def deon_hair_absorption_from_melanin(
    melanin_concentration: ArrayLike,
    melanin_redness: ArrayLike,
    eumelanin_color: ArrayLike,
    pheomelanin_color: ArrayLike,
) -> Array:
    """Absorption coefficient of a mix of both melanins.

        sigma_a = m ((1 - redness) (-log eumelanin) + redness (-log pheomelanin)),
        m = -log(1 - concentration)

    - `melanin_concentration`, `melanin_redness` (...): In [0, 1) and in [0, 1].
    - `eumelanin_color`, `pheomelanin_color` (..., 3): Share of light that a fiber's radius of the
      pigment leaves, in (0, 1].

    The paper has the sum of both pigments, each with its own amount. How a concentration in [0, 1]
    and a redness make these amounts, the specification does not say: the equation is that of its
    implementations. [dEon2011], the absorption of the pigments; [MaterialX2026],
    deon_hair_absorption_from_melanin.

        >>> colors = np.exp(-np.array(EUMELANIN)), np.exp(-np.array(PHEOMELANIN))
        >>> deon_hair_absorption_from_melanin(0.25, 0.5, *colors).round(6)
        array([0.087168, 0.157794, 0.348095])
    """
    values = {
        "melanin_concentration": melanin_concentration,
        "melanin_redness": melanin_redness,
    }
    colors = {"eumelanin_color": eumelanin_color, "pheomelanin_color": pheomelanin_color}
    numbers = {name: checked(name, value) for name, value in values.items()}
    vectors = {name: _color(name, value) for name, value in colors.items()}
    lead_shape(vectors, numbers)
    concentration, redness = (value[..., np.newaxis] for value in numbers.values())
    xp = array_namespace(concentration, redness)
    eumelanin, pheomelanin = (-xp.log(value) for value in vectors.values())
    mix = (1.0 - redness) * eumelanin + redness * pheomelanin
    return -xp.log1p(-concentration) * mix


@any_array
def chiang_hair_absorption_from_color(
    hair_color: ArrayLike, azimuthal_roughness: ArrayLike
) -> Array:
    """Absorption coefficient of hair that looks of a color after all its scattering.

        sigma_a = (log(color) / (5.969 - 0.215 b + 2.532 b^2 - 10.73 b^3 + 5.574 b^4 + 0.245 b^5))^2

    - `hair_color` (..., 3): Scattering color, in (0, 1].
    - `azimuthal_roughness` (...): b, in [0, 1].

    [Chiang2016], the fit of the absorption; [MaterialX2026], chiang_hair_absorption_from_color.

        >>> chiang_hair_absorption_from_color([0.5, 0.2, 0.1], 0.2).round(6)
        array([0.013569, 0.073156, 0.149739])
    """
    color = _color("hair_color", hair_color)
    roughness = checked("azimuthal_roughness", azimuthal_roughness)
    lead_shape({"hair_color": color}, {"azimuthal_roughness": roughness})
    xp, b = array_namespace(color), roughness[..., np.newaxis]
    fit = 5.969 - b * (0.215 - b * (2.532 - b * (10.73 - b * (5.574 + b * 0.245))))
    return xp.square(xp.log(color) / fit)


def _color(name: str, value: ArrayLike) -> Numbers:
    """A color of the range that its name has."""
    return checked_triples(name, checked(name, value))
