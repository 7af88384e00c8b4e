# SPDX-License-Identifier: Apache-2.0
"""Blender's renderer EEVEE with Blender's nodes, on OpenGL without a screen."""

from __future__ import annotations

from pathlib import Path

from mxeon.hosts.cycles import process
from mxeon.survey.cycles_native import MATERIALS
from mxeon.survey.polyhedron import PolyhedronHost
from mxeon.survey.specs import COLOR, node

# Both nodes are Lambertian. According to Blender's manual, only Cycles supports the roughness.
NODES = tuple(node(title, "lambert", material, COLOR) for title, material in MATERIALS.items())


class EeveeHost(PolyhedronHost):
    name = "eevee"
    script = Path(process.__file__).with_name("worker.py")
    samples = 1  # pictures of EEVEE have no noise
    device = "OpenGL"
    missing = (
        "no Blender: pip install bpy==5.0.1 in an environment of Python 3.11 and name "
        "its interpreter in MXEON_CYCLES_PYTHON"
    )

    def _interpreter(self) -> Path:
        return process.interpreter(self.name)
