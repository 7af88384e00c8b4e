# SPDX-License-Identifier: Apache-2.0
"""Operations whose derivatives are finite at the edges of a domain.

Libraries that differentiate multiply the derivatives of single steps: where a root begins, infinity
times 0. Each function below is the plain operation of NumPy, to the last bit. For other arrays it takes
its value at the edge from a branch of its own, and its derivative there is the one of its docstring.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from mxeon.models.core.arrays import Array, Numbers
from mxeon.models.core.namespaces import NUMPY, array_namespace

INSIDE = 0.5  # an argument at which every formula of a cosine is smooth


def cosine(z: Array) -> Array:
    """Cosine of a direction with this height: 1 where rounding made it larger, 0 where smaller.

    At 1 and at 0 its derivative is that of the height.
    """
    xp = array_namespace(z)
    if xp is NUMPY:
        return xp.minimum(z, 1.0)  # what is negative was refused, or counted as 0
    return xp.where(z > 1.0, 1.0, xp.where(z < 0.0, 0.0, z))


def least_normal(x: Array) -> float:
    """Smallest positive number that has all its digits in the precision of x."""
    return float(_precision(x).tiny)


def largest(x: Array) -> float:
    """Largest number of the precision of x."""
    return float(_precision(x).max)


def _precision(x: Array) -> np.finfo[np.float64]:
    """Limits of the numbers of an array; those that do not say theirs are of float32."""
    return cast("np.finfo[np.float64]", array_namespace(x).finfo(getattr(x, "dtype", np.float32)))


def at_most(x: Array, high: float) -> Array:
    """The smaller of x and a number; where they are equal the derivative is that of x."""
    xp = array_namespace(x)
    return xp.minimum(x, high) if xp is NUMPY else xp.where(x > high, high, x)


def trimmed(x: Array, high: float) -> Array:
    """x, which rounding alone makes larger than a number: cut there, but for the sake of derivatives."""
    xp = array_namespace(x)
    return xp.minimum(x, high) if xp is NUMPY else x


def at_least_0(x: Array) -> Array:
    """The larger of x and 0; where they are equal the derivative is that of x."""
    xp = array_namespace(x)
    return xp.maximum(x, 0.0) if xp is NUMPY else xp.where(x < 0.0, 0.0, x)


def magnitude(x: Array) -> Array:
    """|x|; where x is 0 the derivative is that of x."""
    xp = array_namespace(x)
    return xp.abs(x) if xp is NUMPY else xp.where(x < 0.0, -x, x)


def within(x: Array, low: float = 0.0, high: float = 1.0) -> Array:
    """x kept between two numbers; at either the derivative is that of x."""
    xp = array_namespace(x)
    return np.clip(x, low, high) if xp is NUMPY else xp.where(x < low, low, at_most(x, high))


def root(x: Array) -> Array:
    """Square root; where x is 0 its derivative counts as 0."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return xp.sqrt(x)
    positive = x > 0.0
    return xp.where(positive, xp.sqrt(xp.where(positive, x, 1.0)), 0.0)


def hypot(x: Array, y: Array) -> Array:
    """Length of (x, y); where it is 0 its derivative counts as 0."""
    xp = array_namespace(x, y)
    if xp is NUMPY:
        return xp.hypot(x, y)
    zero = (x == 0.0) & (y == 0.0)
    return xp.where(zero, 0.0, xp.hypot(xp.where(zero, 1.0, x), y))


def arcsine(x: Array) -> Array:
    """Arc sine of x kept in [-1, 1]; where x is at an end or beyond its derivative counts as 0."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return xp.asin(xp.minimum(xp.maximum(x, -1.0), 1.0))
    inside = xp.abs(x) < 1.0
    end = xp.where(x < 0.0, -0.5 * np.pi, 0.5 * np.pi)
    return xp.where(inside, xp.asin(xp.where(inside, x, 0.0)), end)


def arccosine(x: Array) -> Array:
    """Arc cosine of x kept in [-1, 1]; where x is at an end or beyond its derivative counts as 0."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return xp.acos(xp.minimum(xp.maximum(x, -1.0), 1.0))
    return 0.5 * np.pi - arcsine(x)


def angle(y: Array, x: Array) -> Array:
    """Angle of the point (x, y); at the origin it is that of the x axis, and its derivative counts as 0."""
    xp = array_namespace(x, y)
    if xp is NUMPY:
        return xp.atan2(y, x)
    origin = (x == 0.0) & (y == 0.0)
    return xp.atan2(y, xp.where(origin, 1.0, x))


def except_at_1(formula: Callable[[Array], Array], x: Array, value: float) -> Array:
    """formula(x), and `value` with derivative 0 where x is 1 or a rounding more."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return formula(x)
    edge = x >= 1.0
    return xp.where(edge, value, formula(xp.where(edge, INSIDE, x)))


def power(base: Array, exponent: Array) -> Array:
    """base^exponent; where it has an infinite derivative at base 0, that counts as 0."""
    xp = array_namespace(base, exponent)
    if xp is NUMPY:
        return base**exponent
    steep = (base == 0.0) & (exponent < 1.0)
    flat = xp.where(exponent == 0.0, 1.0, 0.0)
    return xp.where(steep, flat, xp.where(steep, 1.0, base) ** exponent)


def cube_root(x: Array) -> Array:
    """Cube root; where x is 0 its derivative counts as 0."""
    return fractional_power(x, 1.0 / 3.0)


def fractional_power(x: Array, exponent: float) -> Array:
    """x^exponent with an exponent in (0, 1); where x is 0 its derivative counts as 0."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return x**exponent
    positive = x > 0.0
    return xp.where(positive, xp.where(positive, x, 1.0) ** exponent, 0.0)


def below_1(x: Array) -> float:
    """Largest number below 1 in the precision of x."""
    return 1.0 - 0.5 * float(_precision(x).eps)


def guarded(x: Array, valid: Numbers, inside: float) -> Array:
    """x, and a number where it is not valid and what follows counts for nothing."""
    xp = array_namespace(x, valid)
    return x if xp is NUMPY else xp.where(valid, x, inside)
