# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the EDF nodes of pbrlib, those that combine EDFs, and surfaces that emit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.rows import COMPONENTS, Port, RowSubject, broadcast_inputs, color, draw
from mxeon.conformance.samples.batch import Array, Batch, Values, rounded
from mxeon.models.nodes.emissions import (
    AMOUNT,
    BASE,
    COMBINED_EMISSIONS,
    EMISSIONS,
    FACTOR,
    FIRST,
    SECOND,
    Emission,
    Value,
)
from mxeon.shaders.nodes import connection_text, document_text, input_text, node_text, vector_text

EMITTED = connection_text("edf", "EDF", "emission")
EMITTING_TEXT = node_text("surface", "surfaceshader", "shading", EMITTED)
SURFACE_COLOR = (0.2, 0.5, 2.0)  # radiance of a surface
BLACK_LOBE = '  <oren_nayar_diffuse_bsdf name="lobe" type="BSDF" />\n'
LEAST_FALLOFF = 1.0  # degrees of full angle between the cones
EXPONENTS = (1.0, 8.0)
BLUE, ORANGE = (0.2, 0.5, 0.8), (2.0, 0.4, 0.1)  # radiances of the materials in pictures
INNER, OUTER = "inner_angle", "outer_angle"
# In pictures the falloff takes half of the sphere, so that it is not steep.
PORTS = {
    port.name: port
    for port in (
        *(color(name, BLUE, ORANGE, edges=()) for name in ("color", BASE, FIRST)),
        color(SECOND, (0.9, 0.1, 0.3), (0.1, 0.2, 0.3), edges=()),
        Port(AMOUNT, change=0.3, materials=(0.25, 0.75), default=0.5),
        color("color0", (0.1, 0.4, 0.9), (0.8, 0.5, 0.2), edges=()),
        color("color90", (0.9, 0.8, 0.6), (1.0, 1.0, 1.0), edges=()),
        Port("exponent", "float", *EXPONENTS, change=2.0, materials=(5.0, 2.0), default=5.0),
        Port(INNER, change=20.0, materials=(60.0, 0.0), default=60.0),
        Port(OUTER, change=150.0, materials=(140.0, 150.0), default=90.0),
        Port("normal", "vector3", change=(0.0, 0.6, 0.8)),
    )
}
FACTORS = {  # of an emission, by the last word of the row's name
    "float": Port(FACTOR, change=0.3, materials=(0.9, 0.5)),
    "color3": color(FACTOR, (0.9, 0.6, 0.3), (0.5, 0.5, 0.5), edges=()),
}


@dataclass(frozen=True)
class EmissionSubject(RowSubject[Value]):
    """A row of `mxeon.models.nodes.emissions`."""

    row: Emission
    connections: str = ""  # XML of the ports of the node that are connected
    sources: tuple[str, ...] = ()  # names of the uniform emissions that it takes

    @property
    def closure(self) -> bool:
        return self.row.name != "conical"

    @property
    def title(self) -> str:
        if not self.combined:
            return self.node
        scaled = f", in2 {self.drawn[-1].kind}" if FACTOR in self.row.inputs else ""
        return f"{self.node}, EDF{scaled}"

    @property
    def combined(self) -> bool:
        """Whether it combines emissions."""
        return self.row in COMBINED_EMISSIONS

    @property
    def drawn(self) -> tuple[Port, ...]:
        ports = PORTS | {FACTOR: FACTORS.get(self.row.name.rsplit("_", 1)[-1], FACTORS["float"])}
        return tuple(ports[name] for name in self.row.inputs)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (*self.drawn, *((PORTS["normal"],) if self.row.name == "conical" else ()))

    @property
    def kind(self) -> str:
        powered = {"conical": kinds.CONE_EMISSION, "schlick_emission": kinds.POWER_EMISSION}
        return powered.get(self.row.name, kinds.EMISSION)

    def document(self, inputs: Values | None = None) -> str:
        return document_text(self.emission_text(inputs) + EMITTING_TEXT, "look")

    def emission_text(self, inputs: Values | None = None) -> str:
        """XML of the node and of those that it takes, with a value of each input."""
        types = {port.name: port.kind for port in self.ports}
        values = {
            port.name: np.broadcast_to(port.default, COMPONENTS[port.kind]) for port in self.drawn
        } | dict(inputs or {})
        ports = {name: "" for name in ("emission", *self.sources)}
        axis = ""
        for path, value in values.items():
            node, _, name = path.rpartition("/")
            if name == "normal":  # of which MaterialX ignores a value
                axis = vector_text("axis", value)
                ports["emission"] += connection_text("normal", "vector3", "axis")
            else:
                ports[node or "emission"] += input_text(name, types[path], value)
        nodes = (node_text("uniform_edf", "EDF", name, ports[name]) for name in self.sources)
        return (
            axis
            + "".join(nodes)
            + node_text(self.node, "EDF", "emission", ports["emission"] + self.connections)
        )

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        inputs = draw(rng, count, self.drawn)
        if self.row.name == "conical":
            inputs |= random_cones(rng, count)
        return inputs

    def values(self, function: Value, batch: Batch) -> Array:
        """Radiance, (N, 3), of views whose cosines do not exceed 1 by a rounding."""
        return function(np.clip(batch.wo, -1.0, 1.0), broadcast_inputs(batch))

    def exitance(self, batch: Batch) -> Array:
        return self.row.exitance(broadcast_inputs(batch))


@dataclass(frozen=True)
class AbsentSubject:
    """A node of which it is only asked whether the target has an implementation."""

    title: str  # name in reports, and category
    node: str
    text: str  # XML of a document's nodes that use it

    kind: ClassVar[str] = kinds.ABSENT
    model: ClassVar[str] = kinds.ABSENT
    closure: ClassVar[bool] = True
    libraries: ClassVar[tuple[str, ...]] = ("stock",)  # no library of ours has one

    def document(self, inputs: Values | None = None) -> str:
        return document_text(self.text)


# A node that its document defines, without an implementation: a surface that is not lit.
UNIMPLEMENTED = AbsentSubject(
    "a node without an implementation",
    "mxeon_absent",
    """  <nodedef name="ND_mxeon_absent" node="mxeon_absent">
    <output name="out" type="EDF" />
  </nodedef>
"""
    + node_text("mxeon_absent", "EDF", "emission")
    + EMITTING_TEXT,
)


@dataclass(frozen=True)
class SurfaceSubject:
    """The node `surface` with an emission, in the dark."""

    title: str  # name in reports
    lit: bool  # whether it has a BSDF beside

    node: ClassVar[str] = "surface"
    kind: ClassVar[str] = kinds.EMITTING_SURFACE
    model: ClassVar[str] = kinds.EMITTING_SURFACE
    closure: ClassVar[bool] = True
    libraries: ClassVar[tuple[str, ...]] = ("stock",)  # no library of ours has one

    def document(self, inputs: Values | None = None) -> str:
        emission = node_text(
            "uniform_edf", "EDF", "emission", input_text("color", "color3", SURFACE_COLOR)
        )
        lobe = connection_text("bsdf", "BSDF", "lobe") if self.lit else ""
        opacity = input_text("opacity", "float", (inputs or {}).get("opacity", 1.0))
        surface = node_text("surface", "surfaceshader", "shading", lobe + EMITTED + opacity)
        return document_text((BLACK_LOBE if self.lit else "") + emission + surface)


def random_cones(rng: np.random.Generator, count: int) -> dict[str, Array]:
    """Angles of cones: half of them with a falloff, of at least LEAST_FALLOFF degrees."""
    inner, wide = 360.0 * rng.random(count), rng.random(count) < 0.5
    inner = np.where(wide, inner * (1.0 - LEAST_FALLOFF / 360.0), inner)
    more = LEAST_FALLOFF * ((360.0 - inner) / LEAST_FALLOFF) ** rng.random(count)
    outer = np.where(wide, inner + more, inner * rng.random(count))
    angles = rounded([inner, outer])
    return {INNER: angles[:, 0], OUTER: angles[:, 1]}


def _connected(**sources: str) -> str:
    return "".join(connection_text(port, "EDF", node) for port, node in sources.items())


BOTH = ("first", "second")
_MIX, _ADD, *_SCALED = COMBINED_EMISSIONS
_CURVED = _connected(base="base")
EDFS = tuple(
    EmissionSubject(row, *((_CURVED, ("base",)) if BASE in row.inputs else ())) for row in EMISSIONS
)
COMBINED_EDFS = (
    EmissionSubject(_MIX, _connected(fg="first", bg="second"), BOTH),
    EmissionSubject(_ADD, _connected(in1="first", in2="second"), BOTH),
    *(EmissionSubject(row, _connected(in1="first"), BOTH[:1]) for row in _SCALED),
)
ABSENT_NODES = (
    AbsentSubject(
        "measured_edf", "measured_edf", node_text("measured_edf", "EDF", "emission") + EMITTING_TEXT
    ),
)
SURFACE_NODES = (
    SurfaceSubject("surface, an EDF alone", lit=False),
    SurfaceSubject("surface, a BSDF and an EDF", lit=True),
)
