# SPDX-License-Identifier: Apache-2.0
"""Algebra of `layer`, `mix`, `add` and `multiply` on values and throughputs of lobes.

The throughput of a lobe is 1 - E, where E is the directional albedo of the lobe without its color.
The throughput is negative if E exceeds 1. Only `layer` clamps the throughput to at least 0, so that
a sum can be scaled or mixed before. The specification does not define E above 1. Values may include
the cosine or not, because all four operations are linear. Lobes of different shapes broadcast.
"""

from __future__ import annotations

from dataclasses import dataclass

from mxeon.models.core.arguments import checked
from mxeon.models.core.arrays import Array, ArrayLike, any_array, at_least_0, library, like


@dataclass(frozen=True)
class Bsdf:
    """A lobe, or a combination of lobes, for one or many pairs of directions.

    - `value`: BSDF in 1/sr, with or without the cosine.
    - `throughput`: 1 - E per channel, the fraction of the light that reaches the layer below. A
      negative throughput passes no light. An opaque lobe of weight w has throughput 1 - w for any
      albedo.
    """

    value: Array
    throughput: Array


@any_array
def throughput(albedo: ArrayLike) -> Array:
    """Throughput T = 1 - E of a lobe whose directional albedo, weight included, is E (..., C).

    T is negative if the albedo exceeds 1. T exceeds 1 if the albedo is negative; the albedo of
    Zeltner's fit is at least -2.2e-5. E is the albedo of a white lobe, because light that the
    `color` of `sheen_bsdf` or the `tint` of `dielectric_bsdf` removes is absorbed. In
    specifications before August 2026, E includes the color. Raises `ValueError` if an albedo is
    infinite or NaN. [MaterialX2026] of August 2026, Vertical-Layering Transmittance.

        >>> throughput([0.25, 1.5])
        array([ 0.75, -0.5 ])
    """
    return 1.0 - checked("albedo", albedo)


def layer(top: Bsdf, base: Bsdf) -> Bsdf:
    """One lobe layered over another.

        f = f_top + max(T_top, 0) f_base,  T = min(T_top, 0) + max(T_top, 0) T_base

    In the result, 1 - T is the albedo of f: E_top + (1 - E_top) E_base, or E_top if E_top exceeds
    1. [MaterialX2026], section `layer`.

        >>> both = layer(Bsdf(0.1, 0.75), Bsdf(0.2, 0.0))
        >>> float(both.value), float(both.throughput)
        (0.25, 0.0)
    """
    passed = at_least_0(top.throughput)
    left = passed * base.throughput - at_least_0(-top.throughput)
    return Bsdf(top.value + passed * base.value, left)


def mix(fg: Bsdf, bg: Bsdf, amount: ArrayLike) -> Bsdf:
    """A linear blend of two lobes, where `amount` is the weight w of `fg`, in [0, 1].

        f = (1 - w) f_bg + w f_fg,  T = (1 - w) T_bg + w T_fg

    The result is `bg` at w = 0 and `fg` at w = 1, to the last bit. [MaterialX2026], section `mix`.

        >>> both = mix(Bsdf(1.0, 0.0), Bsdf(0.0, 1.0), 0.25)
        >>> float(both.value), float(both.throughput)
        (0.25, 0.75)
    """
    w = _in_library(fg.value, checked("amount", amount))
    return Bsdf((1.0 - w) * bg.value + w * fg.value, (1.0 - w) * bg.throughput + w * fg.throughput)


def add(in1: Bsdf, in2: Bsdf) -> Bsdf:
    """Sum of two lobes. The albedo of the sum may exceed 1.

        f = f_1 + f_2,  T = 1 - (E_1 + E_2) = T_1 + T_2 - 1

    [MaterialX2026], section `add`.

        >>> both = add(Bsdf(0.5, 0.75), Bsdf(0.25, 0.5))
        >>> float(both.value), float(both.throughput)
        (0.75, 0.25)
    """
    return Bsdf(in1.value + in2.value, in1.throughput + in2.throughput - 1.0)


def multiply(in1: Bsdf, weight: ArrayLike) -> Bsdf:
    """A lobe scaled by `weight` s >= 0. The weight is one number, or one number per channel.

        f = s f_1,  T = 1 - s E_1 = 1 - s (1 - T_1)

    Unlike the specification, MaterialX's shaders clamp s to [0, 1] and keep T_1, so a lobe scaled
    to 0 still darkens the layer below. [MaterialX2026], section `multiply`.

        >>> scaled = multiply(Bsdf(1.0, 0.5), 0.5)
        >>> float(scaled.value), float(scaled.throughput)
        (0.5, 0.75)
    """
    s = _in_library(in1.value, checked("weight", weight))
    return Bsdf(s * in1.value, 1.0 - s * (1.0 - in1.throughput))


def _in_library(value: Array, number: Array) -> Array:
    """A number, converted to an array of the library to which `value` belongs."""
    return number if library(number) else like(number, value)
