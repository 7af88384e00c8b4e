# SPDX-License-Identifier: Apache-2.0
"""Specs of the nodes `layer`, `mix`, `add` and `multiply`, which combine two sheen lobes."""

from dataclasses import dataclass, replace

import numpy as np

from mxeon.conformance import samples, spec
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.specs.lobes import FLAT_FRAME, PbrSpec, mode_of
from mxeon.conformance.specs.sheen import ZELTNER_ALBEDO, ZELTNER_THROUGHPUT, ZELTNER_VALUE
from mxeon.conformance.tolerance import ROUNDING, Term, sum_of
from mxeon.models.nodes import combinations
from mxeon.models.nodes.combinations import AMOUNT, AMOUNT_ABOVE, COLORS, FACTOR, MASKS, ROUGHNESS
from mxeon.models.nodes.node import PbrNode
from mxeon.shaders import nodes

PASSES = ZELTNER_THROUGHPUT.term("a throughput between them")
VALUE = sum_of(ZELTNER_VALUE.term("two values", 2.0), PASSES)
# If a mix of `top` with the sum of `top` and `base` covers `base`, the layer's albedo has at most
# the error of the albedo of `top` plus twice the error of the albedo of `base`.
THREE_ALBEDOS = ZELTNER_ALBEDO.term("two albedos, and a throughput between them", 3.0)
ALBEDO = sum_of(THREE_ALBEDOS, quantity=Quantity.ALBEDO)
THIRD = ZELTNER_VALUE.term("a third value"), ZELTNER_THROUGHPUT.term("its throughput")
NESTED_VALUE = sum_of(VALUE.term("two values and a throughput"), *THIRD, exact=True)
ERRORS = {
    "albedo": ALBEDO,
    "throughput": ALBEDO,
    # Both values are the same product with an exact factor, so the values differ by one rounding.
    "factor": sum_of(Term(ROUNDING, "one float32 rounding"), exact=True),
    "frame": sum_of(FLAT_FRAME.term("three lobes in another frame", 3.0)),
}


def over(category: str, *lobes: str, text: str = "") -> nodes.Node:
    return nodes.Node(category, "BSDF", lobes, text)


SHEEN = nodes.Node("sheen_bsdf", "BSDF", text=nodes.input_text("mode", "string", "zeltner"))
LOBES = {"top": SHEEN, "base": SHEEN}
SUM = {"sum": over("add", "top", "base")}
WHITE = nodes.Node(
    "oren_nayar_diffuse_bsdf", "BSDF", text=nodes.input_text("color", "color3", np.ones(3))
)
# Opaque lobes in mixes whose weights are connected to other nodes. MaterialX multiplies the lobes
# by the connected weights.
MASKED = {
    **dict.fromkeys(("white", "other"), WHITE),
    **dict.fromkeys(("inner", "outer"), nodes.Node("multiply", "float")),
    "masked": over("mix", "white", "top", text=nodes.connection_text("mix", "float", "inner")),
    "both": over("mix", "masked", "other", text=nodes.connection_text("mix", "float", "outer")),
    "lobe": over("layer", "both", "base"),
}
# For each row of `mxeon.models.nodes.combinations`, a title and the nodes that combine lobes.
# fmt: off
NETWORKS: dict[str, tuple[str, dict[str, nodes.Node]]] = {
    "layer": ("layer", {"lobe": over("layer", "top", "base")}),
    "mix": ("mix", {"lobe": over("mix", "top", "base")}),
    "add": ("add", {"lobe": over("add", "top", "base")}),
    "multiply_float": ("multiply, in2 float", {"lobe": over("multiply", "top")}),
    "multiply_color3": ("multiply, in2 color3", {"lobe": over("multiply", "top")}),
    "multiply_sum": ("multiply, of a sum", {**SUM, "lobe": over("multiply", "sum")}),
    "mix_sum": ("mix, of a sum", {**SUM, "lobe": over("mix", "sum", "top")}),
    "layer_sum": ("layer, under a mix of a sum",
                  {**SUM, "mixed": over("mix", "sum", "top"), "lobe": over("layer", "mixed", "base")}),
    "mix_layer": ("mix, of a layer under a sum",
                  {**SUM, "layered": over("layer", "sum", "base"), "lobe": over("mix", "layered", "top")}),
    "layer_masked": ("layer, under connected masks", MASKED),
    "layer_colored": ("layer, under a colored sum", {**SUM, "lobe": over("layer", "sum", "base")}),
}
# fmt: on
SINGLE = ("multiply_float", "multiply_color3")  # rows that use only the lobe `top`
COLORED = ("multiply_color3", "multiply_sum")  # rows whose factor is a color


@dataclass(frozen=True, eq=False, kw_only=True)
class CombinedSpec(PbrSpec):
    """A node that combines lobes. All lobes have weight 1."""

    requires = spec.Ability.LOBE | spec.Ability.COMBINATION
    # MaterialX scales a lobe by a mix's connected weight in all nodes that use the lobe.
    plain = ("lobes", "inputs from an image")

    def batches(self, counts: samples.Counts) -> tuple[samples.Batch, ...]:
        """Random and special pairs, without pairs outside the domain."""
        rng, count = samples.generator(), counts.pairs
        wo, wi = samples.directions(rng, count), samples.directions(rng, count)
        special = samples.special_directions(rng)
        return (
            samples.Batch(wo, wi, self.random_inputs(rng, count)),
            samples.Batch(*special, self.random_inputs(rng, len(special[0]))),
        )

    def document(self, inputs: samples.Values | None = None) -> str:
        network = LOBES | NETWORKS[self.model][1]
        return nodes.document_text(
            nodes.network_text(network, spec.ports(self.inputs, inputs)) + nodes.SURFACE
        )


def _spec(row: PbrNode) -> CombinedSpec:
    known = (
        *(spec.Input(name, low=samples.LEAST_SHEEN, change=0.4, default=0.3) for name in ROUGHNESS),
        *(spec.Input(name, change=0.3, default=0.5) for name in (AMOUNT, AMOUNT_ABOVE, *MASKS)),
        *(spec.color(name, edges=()) for name in COLORS),
        spec.color(FACTOR, edges=()) if row.name in COLORED else spec.Input(FACTOR, change=0.3),
    )
    inputs = {each.name: each for each in known}
    if row.name in SINGLE:  # the base's roughness has no effect
        inputs[ROUGHNESS[1]] = replace(inputs[ROUGHNESS[1]], change=None)
    return CombinedSpec(
        **mode_of(row, NETWORKS[row.name][0]),
        inputs=tuple(inputs[name] for name in row.inputs),
        errors={"value": NESTED_VALUE if row.name in combinations.NESTED else VALUE, **ERRORS},
    )


COMBINED_SPECS = tuple(map(_spec, combinations.COMBINATIONS))
