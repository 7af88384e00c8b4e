# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's nodes that combine two lobes: `layer`, `mix`, `add` and `multiply`.

The combined lobes, `top` and `base`, are Zeltner sheens, because values and albedos of this sheen
have closed forms. Rows with nested nodes combine the sum of `top` and `base`, whose albedo may
exceed 1. Names of inputs are paths in the graph. A color that is not an input is white.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.models.core import layering
from mxeon.models.core.arrays import Array
from mxeon.models.core.layering import Bsdf
from mxeon.models.nodes.node import COLORED, Inputs, PbrNode, Scattering, Variant, column
from mxeon.models.sheen import (
    conty_kulla_albedo_dir,
    conty_kulla_brdf,
    zeltner_albedo_dir,
    zeltner_brdf,
)

ROUGHNESS = ("top/roughness", "base/roughness")
COLORS = ("top/color", "base/color")
AMOUNT = "lobe/mix"  # weight of `top`, or of `top` + `base`
AMOUNT_ABOVE = "mixed/mix"  # weight of `top` + `base` in the mix that covers `base`
FACTOR = "lobe/in2"  # factor of `top`, or of `top` + `base`
# The first input is the weight of a white opaque lobe in a mix with `top`. The second input is the
# weight of this mix in a mix with another white opaque lobe.
MASKS = ("inner/in1", "outer/in1")
Albedo = Callable[[Array, Inputs], Array]
Sheen = tuple[Callable[..., Array], Callable[..., Array]]  # BRDF and directional albedo
Combine = Callable[[Bsdf, Bsdf, Inputs], Bsdf]
Finish = Callable[[Bsdf], Bsdf]

ZELTNER = zeltner_brdf, zeltner_albedo_dir
CONTY_KULLA = conty_kulla_brdf, conty_kulla_albedo_dir


def _values(
    combine: Combine, sheen: Sheen = ZELTNER, colored: bool = False
) -> tuple[Callable[[Array, Array, Inputs], Array], Albedo, Albedo]:
    """Value, albedo and E of combined lobes, where 1 - E is the throughput.

    Albedos of `top` and `base` are clamped to 1. If `colored`, light that a color removes passes to
    the base.
    """
    brdf, albedo_dir = sheen

    def both(wo: Array, wi: Array | None, inputs: Inputs) -> Bsdf:
        lobes = []
        for name, color_name in zip(ROUGHNESS, COLORS, strict=True):
            rough, color = inputs[name], inputs.get(color_name, np.ones(3))
            E = np.minimum(albedo_dir(np.minimum(wo[:, 2], 1.0), rough), 1.0)[:, np.newaxis]
            value = E * color if wi is None else brdf(wo, wi, color, rough)
            lobes.append(Bsdf(value, 1.0 - E * (color if colored else np.ones(3))))
        return combine(lobes[0], lobes[1], inputs)

    return (
        lambda wo, wi, inputs: both(wo, wi, inputs).value,
        lambda wo, inputs: both(wo, None, inputs).value,
        lambda wo, inputs: 1.0 - both(wo, None, inputs).throughput,
    )


def _variant(
    title: str,
    combine: Combine,
    sheen: Sheen = ZELTNER,
    colored: bool = False,
    layered: bool = True,
    permitted: bool = False,
) -> Variant[Scattering]:
    """A variant of a combination. If `layered` is false, the value is the node's own value."""
    value, _, taken = _values(combine, sheen, colored)
    return Variant(title, value if layered else None, taken, permitted)


def _combined(
    name: str,
    title: str,
    category: str,
    combine: Combine,
    inputs: tuple[str, ...] = (),
    variants: tuple[Variant[Scattering], ...] = (),
) -> PbrNode:
    value, albedo, taken = _values(combine)
    other = _variant("Conty-Kulla sheens in the lobes' place", combine, CONTY_KULLA)
    if COLORS[0] not in inputs:
        albedo = taken
    else:
        variants = (*variants, _variant(COLORED, combine, colored=True, permitted=True))
    return PbrNode(
        name,
        title,
        category,
        (*ROUGHNESS, *inputs),
        value,
        albedo,
        taken=taken,
        layerable=True,
        reciprocal=False,
        variants=(*variants, other),
    )


def _scaled(top: Bsdf, base: Bsdf, inputs: Inputs) -> Bsdf:
    return layering.multiply(top, column(inputs, FACTOR))


def _sum_mixed(top: Bsdf, base: Bsdf, inputs: Inputs, finish: Finish = lambda lobe: lobe) -> Bsdf:
    return layering.mix(finish(layering.add(top, base)), top, column(inputs, AMOUNT))


def _sum_layered(top: Bsdf, base: Bsdf, inputs: Inputs, finish: Finish = lambda lobe: lobe) -> Bsdf:
    mixed = layering.mix(finish(layering.add(top, base)), top, column(inputs, AMOUNT_ABOVE))
    return layering.layer(mixed, base)


def _layer_mixed(top: Bsdf, base: Bsdf, inputs: Inputs, finish: Finish = lambda lobe: lobe) -> Bsdf:
    layered = layering.layer(finish(layering.add(top, base)), base)
    return layering.mix(layered, top, column(inputs, AMOUNT))


def _masked(top: Bsdf, base: Bsdf, inputs: Inputs, finish: Finish = lambda lobe: lobe) -> Bsdf:
    white = Bsdf(np.full(top.value.shape, 1.0 / np.pi), np.zeros(1))
    inner = layering.mix(white, top, column(inputs, MASKS[0]))
    return layering.layer(finish(layering.mix(inner, white, column(inputs, MASKS[1]))), base)


def _unscaled(combine: Combine) -> Variant[Scattering]:
    """The permitted variant in which scaling a lobe does not change the lobe's throughput."""
    title = "the throughput of the lobe before it is scaled"
    return _variant(title, combine, layered=False, permitted=True)


def _clamped(combine: Callable[..., Bsdf], layered: bool) -> tuple[Variant[Scattering], ...]:
    """The variant in which the albedo of a sum is clamped to 1.

    MaterialX's `add` clamps the throughput to at least 0. The specification does not define the
    throughput of a sum, but does define layers that reflect more light than arrives. So the variant
    is wrong if the sum lies over a base, that is, if `layered` is true.
    """
    clamped = partial(
        combine, finish=lambda lobe: replace(lobe, throughput=np.maximum(lobe.throughput, 0.0))
    )
    title = "a sum whose throughput is clamped at 0"
    return (_variant(title, clamped, layered=layered, permitted=not layered),)


def _opaque(lobe: Bsdf) -> Bsdf:
    return replace(lobe, throughput=0.0 * lobe.throughput)


# In MaterialX, an opaque lobe hides the layer below at any weight.
HIDING = _variant(
    "opaque lobes that hide their base at any weight", partial(_masked, finish=_opaque)
)
TOP_UNSCALED = _unscaled(lambda top, base, i: top)
BARE = Variant(
    "a base that receives all light",
    _values(lambda top, base, i: layering.add(top, base))[0],
)
COMBINATIONS = (
    _combined(
        "layer", "a layer", "layer", lambda top, base, i: layering.layer(top, base), (), (BARE,)
    ),
    _combined(
        "mix",
        "a mix",
        "mix",
        lambda top, base, i: layering.mix(top, base, column(i, AMOUNT)),
        (AMOUNT,),
    ),
    _combined("add", "a sum", "add", lambda top, base, i: layering.add(top, base)),
    *(
        _combined(f"multiply_{kind}", title, "multiply", _scaled, (FACTOR,), (TOP_UNSCALED,))
        for kind, title in (("float", "a scaled lobe"), ("color3", "a lobe scaled by a color"))
    ),
    _combined(
        "multiply_sum",
        "a sum scaled by a color",
        "multiply",
        lambda top, base, i: _scaled(layering.add(top, base), base, i),
        (FACTOR,),
        (_unscaled(lambda top, base, i: layering.add(top, base)),),
    ),
    _combined(
        "mix_sum",
        "a mix of a sum",
        "mix",
        _sum_mixed,
        (AMOUNT,),
        _clamped(_sum_mixed, layered=False),
    ),
    _combined(
        "layer_sum",
        "a layer under a mix of a sum",
        "layer",
        _sum_layered,
        (AMOUNT_ABOVE,),
        _clamped(_sum_layered, layered=True),
    ),
    _combined(
        "mix_layer",
        "a mix of a layer under a sum",
        "mix",
        _layer_mixed,
        (AMOUNT,),
        _clamped(_layer_mixed, layered=False),
    ),
    _combined(
        "layer_colored",
        "a layer under a colored sum",
        "layer",
        lambda top, base, i: layering.layer(layering.add(top, base), base),
        COLORS,
    ),
    _combined("layer_masked", "a layer under masks", "layer", _masked, MASKS, (HIDING,)),
)
# Names of the rows with nested nodes.
NESTED = ("multiply_sum", "mix_sum", "layer_sum", "mix_layer", "layer_colored", "layer_masked")
