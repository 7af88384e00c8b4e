# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: each output of the utility nodes of pbrlib."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from mxeon.conformance.nodes.subject import Changes
from mxeon.conformance.samples.batch import Array, Batch, Candidate
from mxeon.models.pbrlib.utilities import UTILITIES, UtilityNode, Values
from mxeon.shaders.nodes import document_text, input_text, node_text

VALUES, OSL_VALUES = "utility values", "utility values in OSL"  # kinds of probes
NAME, COLOR = "value", "color"  # of the node in its document, and of its conversion to a color
KINDS = {(): "float", (2,): "vector2", (3,): "color3"}  # types of the inputs by shape
SHARE = (0.0, 1.0)
RANGES: dict[str, tuple[float, float]] = {  # of an input's random values
    "temperature": (800.0, 25000.0),
    "scale_TT": (0.0, 3.0),
    "scale_TRT": (0.0, 3.0),
    "eumelanin_color": (0.01, 1.0),
    "pheomelanin_color": (0.01, 1.0),
}
EDGES: dict[str, tuple[float, ...]] = {  # of half of an input's special values
    "temperature": (800.0, 1000.0, 1667.0, 2222.0, 4000.0, 6504.0, 25000.0),
    "scale_TT": (0.0, 0.5, 1.0),
    "scale_TRT": (0.0, 1.0, 2.0),
    "eumelanin_color": (0.01, 0.5, 1.0),
    "pheomelanin_color": (0.01, 0.5, 1.0),
}
SHARES = (0.0, 1e-4, 1e-3, 0.5, 0.98, 0.99, 0.9999, 1.0)  # of the other inputs
BEYOND = (-1.0, 0.0, 0.5, 1.0, 2.0, 1e3)  # of an input that may leave its range
COLD = (-1.0, 0.0, 1.0, 800.0, 25000.0, 1e9)  # temperatures of the same
CHANGED: dict[str, Any] = {"temperature": 2000.0, "scale_TT": 0.7, "scale_TRT": 1.5}
BASE: dict[str, float] = {
    "temperature": 5000.0,
    "pheomelanin_color": 0.7,
    "scale_TT": 0.5,
    "scale_TRT": 2.0,
}


@dataclass(frozen=True)
class UtilitySubject:
    """An output of a node of `mxeon.models.pbrlib.utilities`.

    Attributes
    ----------
    row : UtilityNode
    output : str
    """

    row: UtilityNode
    output: str

    kind: ClassVar[str] = VALUES
    libraries: ClassVar[tuple[str, ...]] = ()
    closure: ClassVar[bool] = False  # it computes a value, which no renderer's closure does

    @property
    def title(self) -> str:
        """Name in reports."""
        if len(self.row.outputs) == 1:
            return self.row.category
        return f"{self.row.category}, {self.output}"

    @property
    def node(self) -> str:
        """Category of the node."""
        return self.row.category

    @property
    def model(self) -> str:
        """Name of its row."""
        return self.row.category

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs that the output depends on."""
        return tuple(name for name in self.row.inputs if self._depends(name))

    @property
    def changes(self) -> dict[str, Changes]:
        """For each input: inputs without and with a change of it alone, which must be seen."""
        base = {name: BASE.get(name, 0.5) for name in self.row.inputs}
        changes: dict[str, Changes] = {}
        for name in self.inputs:
            start, value = (
                np.full(self._shape(name), number).tolist()
                for number in (base[name], CHANGED.get(name, 0.25))
            )
            before = {
                **{each: np.full(self._shape(each), base[each]) for each in base},
                name: start,
            }
            changes[name] = before, {**before, name: value}
        return changes

    def document(self, inputs: Mapping[str, Any] | None = None) -> str:
        """MaterialX text of a material that emits this output, with these inputs."""
        values = {**self.row.inputs, **(inputs or {})}
        ports = "".join(
            input_text(name, KINDS[self._shape(name)], values[name]) for name in self.row.inputs
        )
        kind, single = self.row.outputs[self.output], len(self.row.outputs) == 1
        text = node_text(self.node, kind if single else "multioutput", NAME, ports)
        source, port = NAME, "" if single else self.output
        if kind != "color3":
            text += node_text("convert", "color3", COLOR, _connected("in", kind, NAME, port))
            source, port = COLOR, ""
        text += node_text("uniform_edf", "EDF", "lobe", _connected("color", "color3", source, port))
        surface = _connected("edf", "EDF", "lobe")
        return document_text(text + node_text("surface", "surfaceshader", "shading", surface))

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values inside the ranges, float32 numbers; a fifth of most lie on an end."""
        inputs = {}
        for name in self.row.inputs:
            low, high = RANGES.get(name, SHARE)
            share = np.clip(1.25 * rng.random((count, *self._shape(name))) - 0.125, 0.0, 1.0)
            if name == "temperature":
                inputs[name] = low * (high / low) ** share
            else:
                inputs[name] = low + (high - low) * share
        return _rounded(inputs)

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values of which half lie on an edge."""
        inputs = self.random_inputs(rng, count)
        for name, values in inputs.items():
            picked = rng.choice(EDGES.get(name, SHARES), values.shape)
            inputs[name] = np.where(rng.random(values.shape) < 0.5, picked, values)
        return _rounded(inputs)

    def outside_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values at the ends of the ranges and beyond them."""
        return {
            name: rng.choice(COLD if name == "temperature" else BEYOND, (count, *self._shape(name)))
            for name in self.row.inputs
        }

    def expected(self, batch: Batch) -> Array:
        """The output as a color, whose missing channels are 0, (N, 3)."""
        return self._of(self.row.values, batch)

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """The row's own function, and its variants."""
        own = Candidate(f"the equations of {self.row.category}", partial(self._of, self.row.values))
        others = (
            Candidate(each.title, partial(self._of, each.values), each.permitted)
            for each in self.row.variants
        )
        return (own, *others)

    def _of(self, values: Values, batch: Batch) -> Array:
        """The output of a function, as a color."""
        output = np.asarray(values(self._whole(batch))[self.output])
        color = np.zeros((len(batch.wo), 3))
        color[:, : output.shape[-1]] = output
        return color

    def _whole(self, batch: Batch) -> dict[str, Array]:
        """All inputs with a row for each element."""
        count, whole = len(batch.wo), {}
        for name, default in self.row.inputs.items():
            value = np.asarray(batch.inputs.get(name, default), np.float64)
            whole[name] = np.broadcast_to(value, (count, *self._shape(name)))
        return whole

    def _shape(self, name: str) -> tuple[int, ...]:
        return np.shape(self.row.inputs[name])

    def _depends(self, name: str) -> bool:
        """Whether the output depends on an input: one scale belongs to one lobe."""
        return not name.startswith("scale_") or name.endswith(self.output.removeprefix("roughness"))


def _rounded(inputs: Mapping[str, Array]) -> dict[str, Array]:
    """The inputs as float32 numbers."""
    return {name: each.astype(np.float32).astype(np.float64) for name, each in inputs.items()}


def _connected(name: str, kind: str, node: str, output: str = "") -> str:
    """XML of an input that is connected to a node's output."""
    port = f' output="{output}"' if output else ""
    return f'    <input name="{name}" type="{kind}" nodename="{node}"{port} />\n'


UTILITY_SUBJECTS = tuple(UtilitySubject(row, output) for row in UTILITIES for output in row.outputs)
