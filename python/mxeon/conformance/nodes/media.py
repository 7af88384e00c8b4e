# SPDX-License-Identifier: Apache-2.0
"""Subjects of the VDF nodes: a medium below a surface that lets light through."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.rows import COMPONENTS, Port, RowSubject, broadcast_inputs, color, draw
from mxeon.conformance.samples.batch import Array, Batch, Candidate, Values
from mxeon.models.nodes.media import AMOUNT, COMBINED_MEDIA, FACTOR, MEDIA, Medium, Value
from mxeon.shaders.nodes import (
    SURFACE,
    connection_text,
    document_text,
    input_text,
    lobe_text,
    node_text,
)

LEAST, LARGEST = 1e-3, 16.0  # coefficients, 1/m: of 1e-3 and 1 - 1e-7 of the light
LARGEST_FACTOR = 3.0  # of a multiple
INTERFACE = lobe_text("dielectric_bsdf", {"weight": 1.0, "scatter_mode": "T"}, "top")
SOURCES = {  # names of the media that a node takes, by its port
    "mix": {"fg": "first", "bg": "second"},
    "add": {"in1": "first", "in2": "second"},
    "multiply": {"in1": "first"},
}
PORTS = connection_text("top", "BSDF", "top") + connection_text("base", "VDF", "medium")


@dataclass(frozen=True)
class MediumSubject(RowSubject[Value]):
    """A row of `mxeon.models.nodes.media`."""

    row: Medium

    kind: ClassVar[str] = kinds.MEDIUM

    @property
    def title(self) -> str:
        if not self.combined:
            return self.node
        scaled = f", in2 {self.ports[-1].kind}" if FACTOR in self.inputs else ""
        return f"{self.node}, VDF{scaled}"

    @property
    def combined(self) -> bool:
        """Whether it combines media."""
        return self.row in COMBINED_MEDIA

    @property
    def ports(self) -> tuple[Port, ...]:
        """The inputs that its transmittance depends on, by path."""
        factor = (
            replace(color(FACTOR, edges=()), high=LARGEST_FACTOR)
            if self.row.name.endswith("_color3")
            else Port(FACTOR, high=LARGEST_FACTOR, change=0.3)
        )
        others = {AMOUNT: Port(AMOUNT, change=0.3), FACTOR: factor}
        # A coefficient: from one that hardly shows to one that hides nearly all.
        usual = Port("", "vector3", LEAST, LARGEST, change=(0.9, 0.1, 0.6), logarithmic=True)
        return tuple(others.get(name, replace(usual, name=name)) for name in self.row.inputs)

    def document(self, inputs: Values | None = None) -> str:
        sources = SOURCES.get(self.node, {})
        ports = {name: "" for name in ("medium", *sources.values())}
        for port in self.ports:
            node, _, name = port.name.rpartition("/")
            value = np.full(COMPONENTS[port.kind], 0.5)
            ports[node or "medium"] += input_text(name, port.kind, value)
        ports["medium"] += "".join(
            connection_text(port, "VDF", name) for port, name in sources.items()
        )
        media = [
            node_text("anisotropic_vdf", "VDF", name, ports[name]) for name in sources.values()
        ]
        media.append(node_text(self.node, "VDF", "medium", ports["medium"]))
        layer = node_text("layer", "BSDF", "lobe", PORTS)
        return document_text(INTERFACE + "".join(media) + layer + SURFACE)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random coefficients, of which an eighth is 0, shares and factors, float32 numbers.

        The text gives the anisotropy of a medium no part in what passes.
        """
        inputs = draw(rng, count, self.ports)
        for port in self.ports:
            if port.kind == "vector3":
                inputs[port.name][::8] = 0.0
        if not self.combined and len(self.inputs) > 1:
            inputs |= draw(rng, count, [Port("anisotropy", low=-0.9, high=0.9)])
        return inputs

    def values(self, function: Value, batch: Batch) -> Array:
        return np.asarray(function(broadcast_inputs(batch)))

    @property
    def others(self) -> tuple[Candidate, ...]:
        return ()


MEDIUM_NODES = tuple(MediumSubject(row) for row in (*MEDIA, *COMBINED_MEDIA))
