# SPDX-License-Identifier: Apache-2.0
"""Subjects and probes of the node `surface` with an emission, and nodes that no target has."""

from dataclasses import dataclass
from typing import ClassVar

from mxeon.conformance.nodes.emission import EMITTER, SURFACES, AbsentSubject
from mxeon.conformance.samples.batch import Values
from mxeon.shaders.nodes import document_text, input_text, node_text

COLOR = (0.2, 0.5, 2.0)  # radiance
BLACK = '  <oren_nayar_diffuse_bsdf name="lobe" type="BSDF" />\n'
EMISSION = '    <input name="edf" type="EDF" nodename="emission" />\n'


@dataclass(frozen=True)
class SurfaceSubject:
    """The node `surface` with an emission, in the dark.

    Attributes
    ----------
    title : str
        Name in reports.
    lit : bool
        Whether it has a BSDF beside.
    """

    title: str
    lit: bool

    node: ClassVar[str] = "surface"
    kind: ClassVar[str] = SURFACES
    model: ClassVar[str] = SURFACES
    closure: ClassVar[bool] = True
    libraries: ClassVar[tuple[str, ...]] = ("stock",)  # no library of ours has one

    def document(self, inputs: Values | None = None) -> str:
        """MaterialX text of the surface, with this opacity."""
        emission = node_text("uniform_edf", "EDF", "emission", input_text("color", "color3", COLOR))
        lobe = '    <input name="bsdf" type="BSDF" nodename="lobe" />\n' if self.lit else ""
        opacity = input_text("opacity", "float", (inputs or {}).get("opacity", 1.0))
        surface = node_text("surface", "surfaceshader", "shading", lobe + EMISSION + opacity)
        return document_text((BLACK if self.lit else "") + emission + surface)


ABSENT_NODES = (
    AbsentSubject(
        "measured_edf", "measured_edf", node_text("measured_edf", "EDF", "emission") + EMITTER
    ),
)
SURFACE_NODES = (
    SurfaceSubject("surface, an EDF alone", lit=False),
    SurfaceSubject("surface, a BSDF and an EDF", lit=True),
)
