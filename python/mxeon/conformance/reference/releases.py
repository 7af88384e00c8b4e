# SPDX-License-Identifier: Apache-2.0
"""Graphs of surface shaders beside those that MaterialX released: their values, and how they differ.

A document has the surface shader as its node SHADER.
"""

from functools import cached_property

import MaterialX as mx
import numpy as np

from mxeon.conformance.reference.graph import Graph
from mxeon.conformance.reference.nodes import OPERATIONS, ShadingPoints, plain
from mxeon.conformance.samples import Array, Batch
from mxeon.hosts.calls import NORMAL, TANGENT
from mxeon.shaders.released_graphs import RELEASES, differences, digest, installed, said

SHADER = "shading"


class Graphs:
    """The surface shader of a document, and that of the installed release or of its own."""

    def __init__(self, own: mx.Document, text: str) -> None:
        self.own, self._said = own, self._says(own)
        self._known = RELEASES.get(digest(self._said), ())
        self.right = own
        if mx.getVersionString() not in self._known:
            self.right = mx.createDocument()
            mx.readFromXmlString(self.right, text)
            self.right.setDataLibrary(installed())

    @staticmethod
    def _says(document: mx.Document) -> dict[str, str]:
        return said(document.getNode(SHADER), OPERATIONS)

    @cached_property
    def same(self) -> bool:
        """Whether both say the same, so that their values are equal."""
        return self._said == self._says(self.right)

    def values(self, batch: Batch, right: bool = False) -> Array:
        """What a surface shader makes of marks that stand for the inputs of its lobes, and emits, (N, 3).

        An input that is NaN has the default of the definition.
        """
        document = self.right if right else self.own
        definition, inputs = document.getNode(SHADER).getNodeDef(), {}
        for name, given in batch.inputs.items():
            if port := definition.getActiveInput(name):
                frame = TANGENT if "tangent" in name else NORMAL
                default = frame if port.hasDefaultGeomPropString() else plain(port.getValue())
                if default is not None:
                    rows = np.reshape(given, (len(batch.wo), -1))
                    inputs[name] = np.where(np.isnan(rows), default, rows)
        normal, tangent = (np.broadcast_to(axis, batch.wo.shape) for axis in (NORMAL, TANGENT))
        points = ShadingPoints(batch.wo, batch.wi, 1.0, normal, tangent)
        found = Graph(document, points, inputs, marked=True).element(SHADER)
        return np.array(np.broadcast_to(found, batch.wo.shape))

    @property
    def difference(self) -> tuple[str, bool]:
        """Where the graph differs, and whether it is that of another release, or of another version of the node."""
        version, other = (
            each.getNode(SHADER).getNodeDef().getVersionString() for each in (self.own, self.right)
        )
        parts = differences(self._said, self._says(self.right))
        text = f"differs from the graph that is installed: {parts}"
        if self._known:
            text = f"the graph of MaterialX {' and '.join(self._known)}; it {text}"
        elif version != other:
            text = f"the graph of version {version} of the node; it {text}, of version {other}"
        return text, bool(self._known) or version != other
