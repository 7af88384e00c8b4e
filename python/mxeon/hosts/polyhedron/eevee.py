# SPDX-License-Identifier: Apache-2.0
"""Blender's EEVEE with its own nodes, drawn by OpenGL without a screen."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from mxeon.hosts.cycles.process import interpreter
from mxeon.hosts.polyhedron import Material, PolyhedronHost


class Host(PolyhedronHost):
    name = "eevee"
    script = "../cycles/worker.py"
    samples = 1  # it has no noise
    device = "OpenGL"
    nodes: ClassVar[Mapping[str, Material]] = {
        "Diffuse BSDF": {
            "kind": "ShaderNodeBsdfDiffuse",
            "Color": "{color}",
            "Roughness": "{roughness}",
        },
        "Principled BSDF": {
            "kind": "ShaderNodeBsdfPrincipled",
            "Base Color": "{color}",
            "Diffuse Roughness": "{roughness}",
            "Specular IOR Level": 0.0,
        },
    }

    def _interpreter(self) -> Path:
        return interpreter()

    def _missing(self) -> str:
        return (
            "eevee: no Blender: pip install bpy==5.0.1 in an environment of Python 3.11 and name "
            "its interpreter in MXEON_CYCLES_PYTHON"
        )
