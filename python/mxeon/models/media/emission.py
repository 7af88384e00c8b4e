# SPDX-License-Identifier: Apache-2.0
"""Emission of surfaces: the EDF nodes of [MaterialX2026], and the power that they emit.

A radiance is per channel, in any unit; the exitance is its integral over the hemisphere times the
cosine, pi times that unit. Directions leave the surface, normal +z; one below the horizon sees the
back of the surface. `measured_edf` has no function here: its values are those of a file.

- `wo` (..., 3): Direction to the viewer, unit vector to 1e-6, normal +z; z may be negative.
- `radiance` (..., C): c per channel, that inside the cone for a conical emitter, in [0, 1e50].
- `inner_angle`, `outer_angle` (...): Full angles of the cones where the falloff starts and where it
  ends, degrees, in [0, 360].
- `color0`, `color90` (..., C): Factors along the normal and at grazing, in [0, 1].
- `exponent` (...): q, in [0, 1e50]; with 0 the factor is `color90` everywhere.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mxeon.models.core.arguments import checked_colors, checked_numbers, checked_sphere
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_least_0, at_most, power
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import broadcastable

HALF_TURN = np.pi / 360.0  # radians of half of a full cone angle in degrees


@any_array
def uniform_edf(wo: ArrayLike, radiance: ArrayLike) -> Array:
    """Radiance of a surface that emits the same in all directions.

        L_e = c

    Result (..., C): in the unit of `radiance`. The equation has no side, so that the back emits as
    much. [MaterialX2026], section `uniform_edf`, Uniform Emission Equation.

        >>> uniform_edf([0.6, 0.0, 0.8], [0.5, 2.0])
        array([0.5, 2. ])
    """
    mu, (c,), _ = _checked(wo, {"radiance": radiance})
    return c + 0.0 * mu[..., np.newaxis]


@any_array
def uniform_exitance(radiance: ArrayLike) -> Array:
    """Radiant exitance of a uniform emitter, pi c.

    Result: pi times the unit of `radiance`. [MaterialX2026], section `uniform_edf`.

        >>> round(float(uniform_exitance(2.0)), 6)
        6.283185
    """
    (c,) = checked_numbers(radiance=radiance)
    return (np.pi * c)[()]


@any_array
def conical_edf(
    wo: ArrayLike, radiance: ArrayLike, inner_angle: ArrayLike, outer_angle: ArrayLike
) -> Array:
    """Radiance of a surface that emits inside a cone around its normal.

        L_e = c smoothstep(c_out, c_in, cos)    if outer_angle > inner_angle
        L_e = c if cos >= c_in, else 0          otherwise

    Result (..., C): in the unit of `radiance`. Below the horizon the cosine counts as 0, as the
    text has it. [MaterialX2026], section `conical_edf`, Conical Falloff Equations.

        >>> conical_edf([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]], [2.0], 60.0, 90.0).round(6)
        array([[2.      ],
               [1.251183]])
    """
    angles = {"inner_angle": inner_angle, "outer_angle": outer_angle}
    mu, (c,), (inner, outer) = _checked(wo, {"radiance": radiance}, **angles)
    falloff = conical_falloff(at_least_0(mu)[..., np.newaxis], inner, outer)
    return c * falloff


def conical_falloff(mu: Array, inner: Array, outer: Array) -> Array:
    """Share of the radiance at cosines `mu`, without checks; 1 in the cone, 0 outside."""
    xp = array_namespace(mu, inner, outer)
    soft = outer > inner
    width = xp.where(soft, cone_width(inner, outer), 1.0)
    t = at_most(at_least_0((mu - cone_cosine(outer)) / width), 1.0)
    return xp.where(soft, t * t * (3.0 - 2.0 * t), xp.where(mu >= cone_cosine(inner), 1.0, 0.0))


@any_array
def conical_exitance(radiance: ArrayLike, inner_angle: ArrayLike, outer_angle: ArrayLike) -> Array:
    """Radiant exitance of a conical emitter, in closed form.

    With a = c_out, b = c_in and h = b - a, the falloff has the integral

        int t^2 (3 - 2 t) mu dmu = h [a (t^3 - t^4 / 2) + h (3 t^4 / 4 - 2 t^5 / 5)],

    between mu = max(a, 0) and b, where mu = a + h t; inside the cone it is (1 - b^2) / 2. The
    exitance is 2 pi c times both, and pi c where the inner cone holds the hemisphere.

    Result (..., C): pi times the unit of `radiance`. h is a product of two sines, so that a narrow
    falloff does not cancel. The integral is our own. [MaterialX2026], section `conical_edf`.

        >>> conical_exitance([1.0], 90.0, 0.0).round(6)  # pi sin^2 of 45 degrees
        array([1.570796])
    """
    angles = {"inner_angle": inner_angle, "outer_angle": outer_angle}
    (c,), (inner, outer) = checked_colors({"radiance": radiance}, **angles)
    a, b = cone_cosine(outer), cone_cosine(inner)
    xp = array_namespace(inner, outer)
    h = xp.where(outer > inner, cone_width(inner, outer), 0.0)
    start = xp.where(h > 0.0, -a / xp.where(h > 0.0, h, 1.0), 1.0)
    start = at_most(at_least_0(start), 1.0)

    def antiderivative(t: Array | float) -> Array:
        return h * (a * t**3 * (1.0 - 0.5 * t) + h * t**4 * (0.75 - 0.4 * t))

    ramp = antiderivative(1.0) - antiderivative(start)
    cone = 0.5 * xp.sin(HALF_TURN * inner) ** 2
    share = xp.where(b <= 0.0, 0.5, cone + ramp)
    return 2.0 * np.pi * c * share


@any_array
def generalized_schlick_edf(
    wo: ArrayLike, base: ArrayLike, color0: ArrayLike, color90: ArrayLike, exponent: ArrayLike
) -> Array:
    """Radiance of another emission, scaled by a Schlick curve.

        L_e = (r_0 + (r_90 - r_0) (1 - cos)^q) L_base

    - `base` (..., C): Radiance of the scaled emission towards `wo`, per channel, in [0, 1e50].

    Result (..., C): in the unit of `base`. The back is seen at |cos|: with a negative cosine the
    curve of the text would leave the range between both factors. [MaterialX2026], section
    `generalized_schlick_edf`, Generalized Schlick Emission Equations.

        >>> generalized_schlick_edf([0.6, 0.0, 0.8], [2.0], [1.0], [0.0], 1.0).round(6)
        array([1.6])
    """
    colors = {"base": base, "color0": color0, "color90": color90}
    mu, (c, r0, r90), (q,) = _checked(wo, colors, exponent=exponent)
    mu = mu[..., np.newaxis]
    height = array_namespace(mu).where(mu < 0.0, -mu, mu)
    return c * (r0 + (r90 - r0) * power(at_least_0(1.0 - height), q))


@any_array
def generalized_schlick_exitance(
    radiance: ArrayLike, color0: ArrayLike, color90: ArrayLike, exponent: ArrayLike
) -> Array:
    """Radiant exitance of a uniform emitter that is scaled by a Schlick curve.

        M = pi c (r_0 + (r_90 - r_0) 2 / ((q + 1) (q + 2)))

    Result (..., C): pi times the unit of `radiance`. [MaterialX2026], section
    `generalized_schlick_edf`; the integral is our own.

        >>> generalized_schlick_exitance([1.0], [0.0], [1.0], 0.0).round(6)
        array([3.141593])
    """
    colors = {"radiance": radiance, "color0": color0, "color90": color90}
    (c, r0, r90), (q,) = checked_colors(colors, exponent=exponent)
    share = 2.0 / ((q + 1.0) * (q + 2.0))
    return np.pi * c * (r0 + (r90 - r0) * share)


def cone_cosine(angle: Array) -> Array:
    """Cosine of half of a full angle in degrees, exactly 0 at 180."""
    return array_namespace(angle).sin(HALF_TURN * (180.0 - angle))


def cone_width(inner: Array, outer: Array) -> Array:
    """c_in - c_out by a product of sines."""
    half = 0.5 * HALF_TURN
    sin = array_namespace(inner, outer).sin
    return 2.0 * sin(half * (outer + inner)) * sin(half * (outer - inner))


def _checked(
    wo: ArrayLike, colors: Mapping[str, ArrayLike], **numbers: ArrayLike
) -> tuple[Array, list[Array], list[Array]]:
    """Cosines of the view, and what `checked_colors` returns, all of which broadcast."""
    directions = checked_sphere("wo", wo)
    vectors, values = checked_colors(colors, **numbers)
    parts = dict(zip(colors, vectors, strict=True))
    plain = {name: value[..., 0] for name, value in zip(numbers, values, strict=True)}
    broadcastable({"wo": directions} | parts, plain)
    (mu,) = broadcastable({}, {"mu": directions[..., 2]})
    return -at_most(-at_most(mu, 1.0), 1.0), vectors, values
