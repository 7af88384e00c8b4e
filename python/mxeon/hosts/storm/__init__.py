# SPDX-License-Identifier: Apache-2.0
"""Hydra Storm, the rasterizer of OpenUSD.

Storm is part of Blender's Python package, which also contains OpenUSD and MaterialX. This half of
the host writes a document, and `worker.py` draws a picture of the material.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import MaterialX as mx
import numpy as np

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.base import Array
from mxeon.hosts.cycles.process import interpreter
from mxeon.hosts.documents import DocumentHost
from mxeon.shaders.generation import Shader
from mxeon.shaders.library import environment_folders
from mxeon.shaders.methods import STORM
from mxeon.shaders.scene import Scene

REPORT = re.compile(r"^(?:Warning|Error)\b.*? in file .* : (.*)|^(?:Warning|Error)\b.*? -- (.*)")
COMPILE = "Failed to compile shader"  # first words of Storm's error message
CLOSURES = ("BSDF", "EDF", "VDF")


class StormHost(DocumentHost):
    """Storm on OpenGL without a window, with pictures of half floats; see `DocumentHost`."""

    name = "storm"
    default, fixed = STORM, True

    def transmitted(self, shader: Shader, size: int) -> Array:
        """Fraction of a white card's light that the sphere transmits. Row 0 is at the top."""
        dark = Scene("dark", size=size)
        return np.asarray(self._shown(shader, dark, card=True) - self._shown(shader, dark))

    def _shown(self, shader: Shader, scene: Scene, card: bool = False) -> Array:
        more = (str(folder) for each in shader.folders for folder in environment_folders(each))
        folders = (*shader.folders, *more)
        return super()._shown(replace(shader, folders=folders), scene, card)

    def unread(self, shader: Shader) -> str:
        """Report subsurface lobes, or enumerated inputs whose values Storm replaces by defaults."""
        if reason := super().unread(shader):
            return reason
        names = []
        for each in shader.document.traverseTree():
            node = each.getParent()
            if not each.isA(mx.Input) or not node.isA(mx.Node) or node.getType() not in CLOSURES:
                continue
            definition = node.getNodeDef()
            default = definition and definition.getActiveInput(each.getName())
            enumerated = default and default.hasAttribute(mx.ValueElement.ENUM_ATTRIBUTE)
            if enumerated and each.getValueString() != default.getValueString():
                names.append(f"{node.getName()}/{each.getName()}")
        if not names:
            return ""
        return f"Storm uses the default of enumerated inputs, here of {', '.join(names)}"

    def _interpreter(self) -> Path:
        return interpreter(self.name)

    def _needs_blocks(self, shader: Shader) -> bool:
        """Whether a shader reads textures. Triangles must then cover blocks of 2 x 2 pixels.

        For pixels of a block outside a triangle, llvmpipe reads Storm's buffers as 0. Derivatives
        of texture coordinates are then wrong, so textures are read at the wrong size.
        """
        return any(each.type == "filename" and each.value for each in shader.inputs)

    def _document(self, shader: Shader) -> tuple[str, str]:
        element = shader.document.getDescendant(shader.element)
        if element.getCategory() != mx.SURFACE_MATERIAL_NODE_STRING:
            raise NotRun(f"storm: element {shader.element!r} must be a material for USD to bind")
        return super()._document(shader)

    def _check(self, error: str, printed: Sequence[str]) -> None:
        reports = [each[1] or each[2] for line in printed if (each := REPORT.match(line))]
        reason = next(iter(reports), " ".join(error.split()))
        if reason.startswith(COMPILE):
            raise ShaderError(f"storm: {reason}")
        if reason:
            what = "use other libraries than its own" if self._folders[0] else "show the document"
            raise NotRun(f"storm: {self.worker.version} cannot {what}: {reason}")
