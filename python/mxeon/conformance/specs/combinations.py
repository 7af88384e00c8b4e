# SPDX-License-Identifier: Apache-2.0
"""The nodes that combine two lobes, or a sum of them: `layer`, `mix`, `add` and `multiply`."""

from dataclasses import dataclass

from mxeon.conformance.samples import (
    LEAST_SHEEN,
    Batch,
    Counts,
    Values,
    directions,
    generator,
    special_directions,
)
from mxeon.conformance.spec import Input, color
from mxeon.conformance.specs.lobes import CLOSED_ALBEDO, FLAT_FRAME, PbrSpec
from mxeon.conformance.specs.sheen import ZELTNER_VALUE
from mxeon.conformance.tolerance import ROUNDING, Term, Tolerance, sum_of
from mxeon.models.nodes import combinations
from mxeon.models.nodes.combinations import (
    AMOUNT,
    AMOUNT_ABOVE,
    COLORS,
    COMBINATIONS,
    FACTOR,
    ROUGHNESS,
)
from mxeon.models.nodes.node import PbrNode
from mxeon.shaders.nodes import (
    SURFACE,
    connection_text,
    document_text,
    input_text,
    lobe_text,
    node_text,
    with_input,
)

VALUE = sum_of(
    ZELTNER_VALUE.term("two values", 2.0), CLOSED_ALBEDO.term("a throughput between them")
)
# Of a sum in a mix over a base too: the slopes of its albedo by the two are at most 1 and 2.
ALBEDO = sum_of(
    CLOSED_ALBEDO.term("two albedos, and a throughput between them", 3.0), unit="albedo"
)
NESTED_VALUE = Tolerance(
    (
        VALUE.term("two values and a throughput"),
        ZELTNER_VALUE.term("a third value"),
        CLOSED_ALBEDO.term("its throughput"),
    ),
    exact=True,
)
# The same products, of a factor that is exact.
FACTOR_ERROR = Tolerance((Term(ROUNDING, "one float32 rounding"),), exact=True)


def node_over(category: str, name: str = "lobe", value: str = "", **lobes: str) -> str:
    """XML of a node over other nodes, by port; a value is what an evaluation sets."""
    ports = "".join(connection_text(port, "BSDF", lobe) for port, lobe in lobes.items())
    return node_text(category, "BSDF", name, ports + value)


TOP, BASE = (
    lobe_text("sheen_bsdf", {"mode": "zeltner"}, name, {"mode": "string"})
    for name in ("top", "base")
)
SUM = TOP + BASE + node_over("add", "sum", in1="top", in2="base")
HALF_TEXT, ONE_TEXT = input_text("mix", "float", 0.5), input_text("in2", "float", 1.0)
WHITE_TEXT = input_text("in2", "color3", (1.0, 1.0, 1.0))
NODES = {  # XML of each row
    "layer": TOP + BASE + node_over("layer", top="top", base="base"),
    "mix": TOP + BASE + node_over("mix", value=HALF_TEXT, fg="top", bg="base"),
    "add": TOP + BASE + node_over("add", in1="top", in2="base"),
    "multiply_float": TOP + node_over("multiply", value=ONE_TEXT, in1="top"),
    "multiply_color3": TOP + node_over("multiply", value=WHITE_TEXT, in1="top"),
    "multiply_sum": SUM + node_over("multiply", value=WHITE_TEXT, in1="sum"),
    "mix_sum": SUM + node_over("mix", value=HALF_TEXT, fg="sum", bg="top"),
    "layer_sum": SUM
    + node_over("mix", "mixed", HALF_TEXT, fg="sum", bg="top")
    + node_over("layer", top="mixed", base="base"),
    "mix_layer": SUM
    + node_over("layer", "layered", top="sum", base="base")
    + node_over("mix", value=HALF_TEXT, fg="layered", bg="top"),
    "layer_colored": SUM + node_over("layer", top="sum", base="base"),
}
TITLES = {
    "multiply_float": "multiply, in2 float",
    "multiply_color3": "multiply, in2 color3",
    "multiply_sum": "multiply, of a sum",
    "mix_sum": "mix, of a sum",
    "layer_sum": "layer, under a mix of a sum",
    "mix_layer": "mix, of a layer under a sum",
    "layer_colored": "layer, under a colored sum",
}
SINGLE = ("multiply_float", "multiply_color3")  # rows of `top` alone
COLORED = ("multiply_color3", "multiply_sum")  # rows whose factor is a color


@dataclass(frozen=True, eq=False, kw_only=True)
class CombinedSpec(PbrSpec):
    """A node of `mxeon.models.nodes.combinations`, whose weights stay 1."""

    plain = ("lobes",)

    @property
    def drawn(self) -> tuple[Input, ...]:
        """The inputs of the functions, by path: rows of `top` alone have those of both lobes."""
        inputs = {each.name: each for each in _inputs(self.row)}
        return tuple(inputs[name] for name in self.row.inputs)

    def document(self, inputs: Values | None = None) -> str:
        text = NODES[self.model]
        types = {each.name: each.type for each in self.drawn}
        for path in types.keys() & (inputs or {}).keys():
            node, name = path.split("/")
            text = with_input(text, node, name, types[path], (inputs or {})[path])
        return document_text(text + SURFACE)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs and special ones; those outside are judged with the lobes."""
        rng, count = generator(), counts.pairs
        wo, wi = directions(rng, count), directions(rng, count)
        special = special_directions(rng)
        return (
            Batch(wo, wi, self.random_inputs(rng, count)),
            Batch(*special, self.random_inputs(rng, len(special[0]))),
        )


def _inputs(row: PbrNode) -> tuple[Input, ...]:
    factor = color(FACTOR, edges=()) if row.name in COLORED else Input(FACTOR, change=0.3)
    known = (
        *(Input(name, low=LEAST_SHEEN, change=0.4) for name in ROUGHNESS),
        *(Input(name, change=0.3) for name in (AMOUNT, AMOUNT_ABOVE)),
        *(color(name, edges=()) for name in COLORS),
        factor,
    )
    inputs = {each.name: each for each in known}
    return tuple(inputs[name] for name in row.inputs)


def _spec(row: PbrNode) -> CombinedSpec:
    absent = ROUGHNESS[1:] if row.name in SINGLE else ()
    nested = row.name in combinations.NESTED
    errors = {
        "value": NESTED_VALUE if nested else VALUE,
        "albedo": ALBEDO,
        "throughput": ALBEDO,
        "factor": FACTOR_ERROR,
        "frame": sum_of(FLAT_FRAME.term("three lobes in another frame", 3.0)),
    }
    return CombinedSpec.of(
        row,
        tuple(each for each in _inputs(row) if each.name not in absent),
        errors,
        title=TITLES.get(row.name, row.category),
    )


COMBINED_SPECS = tuple(map(_spec, COMBINATIONS))
