# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the nodes of pbrlib that combine two lobes."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mxeon.conformance.checks.batch import Array
from mxeon.conformance.checks.bsdf.subjects import COMBINED, BsdfSubject
from mxeon.conformance.checks.nodes import Changes
from mxeon.conformance.checks.special import LEAST_SHEEN
from mxeon.models.pbrlib.combinations import AMOUNT, COMBINATIONS, FACTOR, ROUGHNESS
from mxeon.shaders.nodes import SURFACE, document_text, lobe_text, node_text

# XML of the ports of each node, by category; that of a factor is a value, which an evaluation sets.
CONNECTED = '    <input name="{}" type="BSDF" nodename="{}" />\n'
PORTS = {
    "layer": CONNECTED.format("top", "top") + CONNECTED.format("base", "base"),
    "mix": CONNECTED.format("fg", "top") + CONNECTED.format("bg", "base"),
    "add": CONNECTED.format("in1", "top") + CONNECTED.format("in2", "base"),
    "multiply": CONNECTED.format("in1", "top"),
}


@dataclass(frozen=True)
class CombinedSubject(BsdfSubject):
    """A node of `mxeon.models.pbrlib.combinations`."""

    @property
    def title(self) -> str:
        """Name in reports."""
        if self.node != "multiply":
            return self.node
        return f"multiply, in2 {'color3' if self._colored else 'float'}"

    @property
    def inputs(self) -> tuple[str, ...]:
        """Paths of the inputs that its values depend on."""
        names = self.row.inputs
        return names if self.node != "multiply" else (ROUGHNESS[0], FACTOR)

    @property
    def kind(self) -> str:
        """Kind of its probe."""
        return COMBINED

    @property
    def anisotropic(self) -> bool:
        """Whether the roughness has a direction: never."""
        return False

    @property
    def changes(self) -> dict[str, Changes]:
        """For each input: inputs without and with a change of it alone."""
        factor: Any = (0.9, 0.1, 0.6) if self._colored else 0.3
        values = {**dict.fromkeys(ROUGHNESS, 0.4), AMOUNT: 0.3, FACTOR: factor}
        return {name: ({}, {name: values[name]}) for name in self.inputs}

    def document(self, inputs: Any = None) -> str:
        """MaterialX text of a material that is this node over two sheens."""
        ports = PORTS[self.node]
        if self.node == "multiply":
            kind, value = ("color3", "1.0, 1.0, 1.0") if self._colored else ("float", "1.0")
            ports += f'    <input name="in2" type="{kind}" value="{value}" />\n'
        if self.node == "mix":
            ports += '    <input name="mix" type="float" value="0.5" />\n'
        lobes = [lobe_text("sheen_bsdf", {"mode": "zeltner"}, name) for name in ("top", "base")]
        nodes = "".join(lobes[: 1 if self.node == "multiply" else 2])
        return document_text(nodes + node_text(self.node, "BSDF", "lobe", ports) + SURFACE)

    def _random(self, rng: np.random.Generator, count: int, name: str) -> Array:
        colored = name == FACTOR and self._colored
        values = np.clip(1.25 * rng.random((count, 3) if colored else count) - 0.125, 0.0, 1.0)
        if name in ROUGHNESS:
            values = np.maximum(values, LEAST_SHEEN)
        return values.astype(np.float32).astype(np.float64)

    @property
    def _colored(self) -> bool:
        return self.row.name == "multiply_color3"


COMBINED_NODES = tuple(CombinedSubject(row) for row in COMBINATIONS)
