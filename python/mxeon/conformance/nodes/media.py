# SPDX-License-Identifier: Apache-2.0
"""Subjects and probes of the VDF nodes: a medium below a surface that lets light through."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from mxeon.conformance.nodes.emission import MEDIUM, view_rows
from mxeon.conformance.nodes.subject import Changes
from mxeon.conformance.samples.batch import Array, Batch, Candidate
from mxeon.models.pbrlib.media import AMOUNT, COMBINED_MEDIA, FACTOR, MEDIA, Medium
from mxeon.shaders.nodes import SURFACE, document_text, input_text, node_text

LARGEST = 4.0  # coefficient, 1/m
INTERFACE = """  <dielectric_bsdf name="top" type="BSDF">
    <input name="weight" type="float" value="1.0" />
    <input name="scatter_mode" type="string" value="T" />
  </dielectric_bsdf>
"""
PORT = '    <input name="{}" type="VDF" nodename="{}" />\n'
SOURCES = {  # names of the media that a node takes, by its port
    "mix": {"fg": "first", "bg": "second"},
    "add": {"in1": "first", "in2": "second"},
    "multiply": {"in1": "first"},
}
PORTS = """    <input name="top" type="BSDF" nodename="top" />
    <input name="base" type="VDF" nodename="medium" />
"""


@dataclass(frozen=True)
class MediumSubject:
    """A row of `mxeon.models.pbrlib.media`.

    Attributes
    ----------
    row : Medium
    """

    row: Medium

    kind: ClassVar[str] = MEDIUM
    libraries: ClassVar[tuple[str, ...]] = ()
    closure: ClassVar[bool] = True

    @property
    def title(self) -> str:
        """Name in reports."""
        if not self.combined:
            return self.node
        scaled = f", in2 {self._kind(FACTOR)}" if FACTOR in self.inputs else ""
        return f"{self.node}, VDF{scaled}"

    @property
    def combined(self) -> bool:
        """Whether it combines media."""
        return self.row in COMBINED_MEDIA

    @property
    def node(self) -> str:
        """Category of the node."""
        return self.row.category

    @property
    def model(self) -> str:
        """Name of its row."""
        return self.row.name

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs that its transmittance depends on."""
        return self.row.inputs

    @property
    def changes(self) -> dict[str, Changes]:
        """For each input: inputs without and with a change of it alone."""
        return {
            name: ({}, {name: 0.3 if self._kind(name) == "float" else (0.9, 0.1, 0.6)})
            for name in self.inputs
        }

    def document(self, inputs: Mapping[str, Any] | None = None) -> str:
        """MaterialX text of a surface that lets light into the medium."""
        sources = SOURCES.get(self.node, {})
        ports = {name: "" for name in ("medium", *sources.values())}
        for path in self.inputs:
            node, _, name = path.rpartition("/")
            kind = self._kind(path)
            value = 0.5 if kind == "float" else (0.5, 0.5, 0.5)
            ports[node or "medium"] += input_text(name, kind, value)
        ports["medium"] += "".join(PORT.format(*each) for each in sources.items())
        media = [
            node_text("anisotropic_vdf", "VDF", name, ports[name]) for name in sources.values()
        ]
        media.append(node_text(self.node, "VDF", "medium", ports["medium"]))
        layer = node_text("layer", "BSDF", "lobe", PORTS)
        return document_text(INTERFACE + "".join(media) + layer + SURFACE)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random coefficients, of which an eighth is 0, shares and factors; float32 numbers."""
        inputs = {}
        for name in self.inputs:
            shape = (count,) if self._kind(name) == "float" else (count, 3)
            values = np.maximum(1.125 * rng.random(shape) - 0.125, 0.0)
            largest = LARGEST if self._kind(name) == "vector3" else 1.0
            inputs[name] = (largest * values).astype(np.float32).astype(np.float64)
        return inputs

    def _kind(self, path: str) -> str:
        if path == AMOUNT:
            return "float"
        if path == FACTOR:
            return "float" if self.row.name.endswith("_float") else "color3"
        return "vector3"

    def expected(self, batch: Batch) -> Array:
        """Transmittance, (N, 3)."""
        return _transmittance(self.row.value, batch)

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """The row's own transmittance, and its variants."""
        rows = ((self.row.title, self.row.value), *self.row.variants)
        return tuple(Candidate(title, partial(_transmittance, value)) for title, value in rows)


def _transmittance(value: Any, batch: Batch) -> Array:
    """Transmittance of a function of coefficients, (N, 3)."""
    return np.asarray(value(view_rows(batch)))


MEDIUM_NODES = tuple(MediumSubject(row) for row in (*MEDIA, *COMBINED_MEDIA))
