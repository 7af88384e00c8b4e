# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's nodes that combine two lobes: `layer`, `mix`, `add` and `multiply`.

Both lobes are Zeltner sheens of unit color, `top` and `base`, whose values and albedos have closed
forms. Inputs go by their paths.
"""

from collections.abc import Callable

import numpy as np

from mxeon.models import layering
from mxeon.models.arrays import Array
from mxeon.models.layering import Bsdf
from mxeon.models.pbrlib.node import Inputs, PbrNode, Variant
from mxeon.models.sheen import zeltner_albedo_dir, zeltner_brdf

ROUGHNESS = ("top/roughness", "base/roughness")
AMOUNT = "lobe/mix"  # share of `top`
FACTOR = "lobe/in2"  # of `top`
Combine = Callable[[Bsdf, Bsdf, Inputs], Bsdf]


def _sheen(wo: Array, wi: Array, roughness: Array) -> Bsdf:
    """A Zeltner sheen of unit color."""
    left = 1.0 - zeltner_albedo_dir(np.minimum(wo[:, 2], 1.0), roughness)
    value = zeltner_brdf(wo, wi, np.ones(3), roughness)
    return Bsdf(value, np.repeat(left[:, np.newaxis], 3, axis=1))


def _albedo(wo: Array, inputs: Inputs, path: str = ROUGHNESS[0]) -> Array:
    """Albedo of the sheen with the roughness of a path."""
    return 1.0 - _sheen(wo, wo, inputs[path]).throughput


def _column(inputs: Inputs, name: str) -> Array:
    """A number or a color of each pair, (N, 1 or 3)."""
    return np.reshape(inputs[name], (len(inputs[name]), -1))


def _combined(
    name: str,
    title: str,
    category: str,
    combine: Combine,
    inputs: tuple[str, ...] = (),
    variants: tuple[Variant, ...] = (),
) -> PbrNode:
    """Row of a node that combines both lobes."""

    def both(wo: Array, wi: Array, inputs: Inputs) -> Bsdf:
        top, base = (_sheen(wo, wi, inputs[path]) for path in ROUGHNESS)
        return combine(top, base, inputs)

    def value(wo: Array, wi: Array, inputs: Inputs) -> Array:
        return both(wo, wi, inputs).value

    def albedo(wo: Array, inputs: Inputs) -> Array:
        if category == "add":  # whose throughput ends at 0, while the sum of its albedos exceeds 1
            return sum((_albedo(wo, inputs, path) for path in ROUGHNESS), np.zeros(wo.shape))
        return 1.0 - both(wo, wo, inputs).throughput

    return PbrNode(
        name,
        title,
        category,
        (*ROUGHNESS, *inputs),
        value,
        albedo,
        layerable=True,
        reciprocal=False,
        variants=variants,
    )


UNSCALED = (Variant("the throughput of the lobe before it is scaled", albedo=_albedo),)
COMBINATIONS = (
    _combined("layer", "a layer", "layer", lambda top, base, i: layering.layer(top, base)),
    _combined(
        "mix",
        "a mix",
        "mix",
        lambda top, base, i: layering.mix(top, base, _column(i, AMOUNT)),
        (AMOUNT,),
    ),
    _combined("add", "a sum", "add", lambda top, base, i: layering.add(top, base)),
    _combined(
        "multiply_float",
        "a multiple",
        "multiply",
        lambda top, base, i: layering.multiply(top, _column(i, FACTOR)),
        (FACTOR,),
        UNSCALED,
    ),
    _combined(
        "multiply_color3",
        "a colored multiple",
        "multiply",
        lambda top, base, i: layering.multiply(top, _column(i, FACTOR)),
        (FACTOR,),
        UNSCALED,
    ),
)
