# SPDX-License-Identifier: Apache-2.0
"""Renderers with a Python package, which render built-in nodes on a polyhedron.

Each renderer runs in a separate process. The samples of these renderers are spread over a pixel, so
flat facets replace the sphere.
"""

from __future__ import annotations

import json
import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import ClassVar

import numpy as np

from mxeon.errors import NotRun, install
from mxeon.hosts.base import Array, Engine, Identity
from mxeon.hosts.process import Worker
from mxeon.shaders.scene import Scene
from mxeon.survey.facets import polyhedron
from mxeon.survey.specs import Material

PICTURES = 64  # cached pictures, which the checks of a node share
MESH = "polyhedron.npz"


class PolyhedronHost(Engine):
    samples: ClassVar[int]  # samples per pixel under an environment
    script: ClassVar[Path]  # program of the worker process
    device: ClassVar[str]
    missing: ClassVar[str] = ""  # message if the renderer is not installed

    def __init__(self) -> None:
        self.worker = Worker(self.name, self._interpreter(), self.script)
        self.worker.limit = 120.0  # seconds
        self._folder = self.worker.folder
        mesh = polyhedron()
        np.savez(self._folder / MESH, vertices=mesh.vertices, triangles=mesh.triangles)
        self._picture = lru_cache(maxsize=PICTURES)(lambda job: self._ask(**json.loads(job)))

    def identity(self) -> Identity:
        try:
            self.worker.start()
        except NotRun as error:
            if "No module named" in str(error):
                raise self._not_installed() from None
            raise
        return Identity(self.name, f"{self.name} {self.worker.version}", self.device)

    def node(self, material: Material, scene: Scene) -> Array:
        self.refuse_paths(scene)
        request = {
            "material": material,
            "mesh": str(self._folder / MESH),
            "size": scene.size,
            "light": scene.light,
            "environment": scene.environment,
            "samples": 1 if scene.environment is None else self.samples,
        }
        return self._picture(json.dumps(request))

    def close(self) -> None:
        self.worker.close()

    def _ask(self, **request: object) -> Array:
        self.identity()
        output = self._folder / "output.npy"
        output.unlink(missing_ok=True)
        self.worker.ask(output=str(output), **request)
        values: Array = np.load(output, allow_pickle=False)
        values.flags.writeable = False  # all callers share the cached picture
        return values

    def _interpreter(self) -> Path:
        """Path of the Python that has the renderer, by default the Python of this process."""
        path = os.environ.get(f"MXEON_{self.name.upper()}_PYTHON")
        python = Path(path or sys.executable)
        if not (python.is_file() and os.access(python, os.X_OK)):
            raise self._not_installed(f"; no interpreter {path}")
        return python

    def _not_installed(self, reason: str = "") -> NotRun:
        remedy = self.missing or (
            f"not installed: {install(self.name)}, or name an interpreter "
            f"that has it in MXEON_{self.name.upper()}_PYTHON"
        )
        return NotRun(f"{self.name}: {remedy}{reason}")
