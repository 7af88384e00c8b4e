# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: each output of the utility nodes of pbrlib."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.rows import COMPONENTS, Port, RowSubject
from mxeon.conformance.samples.batch import Array, Batch, Candidate, Changes, Values
from mxeon.models.nodes.utilities import UTILITIES, UtilityNode
from mxeon.models.nodes.utilities import Values as Outputs
from mxeon.shaders.nodes import connection_text, document_text, input_text, node_text

NAME, COLOR = "value", "color"  # of the node in its document, and of its conversion to a color
TYPES = {(): "float", (2,): "vector2", (3,): "color3"}  # types of the inputs by shape
SHARES = (0.0, 1e-4, 1e-3, 0.5, 0.98, 0.99, 0.9999, 1.0)  # edges of most inputs
PIGMENTS = (0.01, 0.5, 1.0)
TEMPERATURES = (800.0, 1000.0, 1667.0, 2222.0, 4000.0, 6504.0, 25000.0)
BEYOND = (-1.0, 0.0, 0.5, 1.0, 2.0, 1e3)  # of an input that may leave its range
COLD = (-1.0, 0.0, 1.0, 800.0, 25000.0, 1e9)  # temperatures of the same
# Inputs with a range or a change of their own. A change is from the default of a document.
PORTS = {
    port.name: port
    for port in (
        Port(
            "temperature",
            "float",
            TEMPERATURES[0],
            TEMPERATURES[-1],
            TEMPERATURES,
            2000.0,
            logarithmic=True,
            default=5000.0,
        ),
        Port("scale_TT", high=3.0, edges=(0.0, 0.5, 1.0), change=0.7, default=0.5),
        Port("scale_TRT", high=3.0, edges=(0.0, 1.0, 2.0), change=1.5, default=2.0),
        Port("eumelanin_color", "color3", 0.01, 1.0, PIGMENTS, 0.25, default=0.5),
        Port("pheomelanin_color", "color3", 0.01, 1.0, PIGMENTS, 0.25, default=0.7),
    )
}


@dataclass(frozen=True)
class UtilitySubject(RowSubject[Outputs]):
    """An output of a node of `mxeon.models.nodes.utilities`."""

    row: UtilityNode
    output: str

    kind: ClassVar[str] = kinds.UTILITY

    @property
    def closure(self) -> bool:
        """Whether it is a renderer's closure: it computes a value, which none does."""
        return False

    @property
    def title(self) -> str:
        if len(self.row.outputs) == 1:
            return self.row.category
        return f"{self.row.category}, {self.output}"

    @property
    def ports(self) -> tuple[Port, ...]:
        return tuple(
            PORTS.get(name, Port(name, self._kind(name), edges=SHARES, change=0.25, default=0.5))
            for name in self.row.inputs
        )

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(  # one scale belongs to one lobe
            name
            for name in self.row.inputs
            if not name.startswith("scale_") or name.endswith(self.output.removeprefix("roughness"))
        )

    @property
    def changes(self) -> dict[str, Changes]:
        before = {port.name: _filled(port, port.default) for port in self.ports}
        return {
            port.name: (before, {**before, port.name: _filled(port, port.change)})
            for port in self.ports
            if port.name in self.inputs
        }

    def document(self, inputs: Values | None = None) -> str:
        values = {**self.row.inputs, **(inputs or {})}
        ports = "".join(
            input_text(name, self._kind(name), values[name]) for name in self.row.inputs
        )
        kind, single = self.row.outputs[self.output], len(self.row.outputs) == 1
        text = node_text(self.node, kind if single else "multioutput", NAME, ports)
        source, port = NAME, "" if single else self.output
        if kind != "color3":
            text += node_text("convert", "color3", COLOR, connection_text("in", kind, NAME, port))
            source, port = COLOR, ""
        text += node_text(
            "uniform_edf", "EDF", "lobe", connection_text("color", "color3", source, port)
        )
        surface = connection_text("edf", "EDF", "lobe")
        return document_text(text + node_text("surface", "surfaceshader", "shading", surface))

    def outside_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values at the ends of the ranges and beyond them."""
        return {
            name: rng.choice(COLD if name == "temperature" else BEYOND, (count, *self._shape(name)))
            for name in self.row.inputs
        }

    def values(self, function: Outputs, batch: Batch) -> Array:
        """The output as a color, whose missing channels are 0, (N, 3)."""
        output = np.asarray(function(self._whole(batch))[self.output])
        color = np.zeros((len(batch.wo), 3))
        color[:, : output.shape[-1]] = output
        return color

    @property
    def others(self) -> tuple[Candidate, ...]:
        return ()

    def _whole(self, batch: Batch) -> dict[str, Array]:
        """All inputs with a row for each element."""
        count, whole = len(batch.wo), {}
        for name, default in self.row.inputs.items():
            value = np.asarray(batch.inputs.get(name, default), np.float64)
            whole[name] = np.broadcast_to(value, (count, *self._shape(name)))
        return whole

    def _kind(self, name: str) -> str:
        return TYPES[self._shape(name)]

    def _shape(self, name: str) -> tuple[int, ...]:
        return np.shape(self.row.inputs[name])


def _filled(port: Port, value: ArrayLike | None) -> ArrayLike:
    """A number in each component of a port."""
    filled: list[float] | float = np.full(COMPONENTS[port.kind], value).tolist()
    return filled


UTILITY_SUBJECTS = tuple(UtilitySubject(row, output) for row in UTILITIES for output in row.outputs)
