# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the nodes of pbrlib that combine two lobes, or a sum of them."""

from dataclasses import dataclass

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.rows import Port, color
from mxeon.conformance.samples.batch import Values
from mxeon.conformance.samples.edge_cases import LEAST_SHEEN
from mxeon.models.nodes import combinations
from mxeon.models.nodes.combinations import (
    AMOUNT,
    AMOUNT_ABOVE,
    COLORS,
    COMBINATIONS,
    FACTOR,
    ROUGHNESS,
)
from mxeon.shaders.nodes import (
    SURFACE,
    connection_text,
    document_text,
    input_text,
    lobe_text,
    node_text,
    with_input,
)


def node_over(category: str, name: str = "lobe", value: str = "", **lobes: str) -> str:
    """XML of a node over other nodes, by port; a value is what an evaluation sets."""
    ports = "".join(connection_text(port, "BSDF", lobe) for port, lobe in lobes.items())
    return node_text(category, "BSDF", name, ports + value)


TOP, BASE = (lobe_text("sheen_bsdf", {"mode": "zeltner"}, name) for name in ("top", "base"))
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


@dataclass(frozen=True)
class CombinedSubject(BsdfSubject):
    """A node of `mxeon.models.nodes.combinations`."""

    @property
    def title(self) -> str:
        return TITLES.get(self.model, self.node)

    @property
    def drawn(self) -> tuple[Port, ...]:
        """The inputs of the functions, by path: rows of `top` alone have those of both lobes."""
        rough = (Port(name, low=LEAST_SHEEN, change=0.4) for name in ROUGHNESS)
        shares = (Port(name, change=0.3) for name in (AMOUNT, AMOUNT_ABOVE))
        factor = color(FACTOR, edges=()) if self.model in COLORED else Port(FACTOR, change=0.3)
        colors = (color(name, edges=()) for name in COLORS)
        ports = {port.name: port for port in (*rough, *shares, *colors, factor)}
        return tuple(ports[name] for name in self.row.inputs)

    @property
    def ports(self) -> tuple[Port, ...]:
        absent = ROUGHNESS[1:] if self.model in SINGLE else ()
        return tuple(port for port in self.drawn if port.name not in absent)

    @property
    def kind(self) -> str:
        return kinds.NESTED if self.model in combinations.NESTED else kinds.COMBINED

    def document(self, inputs: Values | None = None) -> str:
        text = NODES[self.model]
        types = {port.name: port.kind for port in self.drawn}
        for path in types.keys() & (inputs or {}).keys():
            node, name = path.split("/")
            text = with_input(text, node, name, types[path], (inputs or {})[path])
        return document_text(text + SURFACE)


COMBINED_NODES = tuple(CombinedSubject(row) for row in COMBINATIONS)
