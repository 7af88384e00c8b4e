# SPDX-License-Identifier: Apache-2.0
"""Renderers with a Python package, which render their own nodes on the polyhedron.

Each runs in a process of its own: a worker renders, `<name>.py` asks it. The samples of
these renderers spread over a pixel, so they show `mxeon.shaders.facets` instead of a sphere.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import ClassVar, TypeAlias

import numpy as np

from mxeon.errors import NotRun, install
from mxeon.hosts.base import Array, Identity, RendererHost
from mxeon.hosts.process import Worker
from mxeon.shaders.facets import polyhedron
from mxeon.shaders.scene import Scene

Material: TypeAlias = Mapping[str, str | float]  # properties of a renderer's material

PICTURES = 64  # that are kept: the checks of a node ask for some of them again
MESH = "polyhedron.npz"


class PolyhedronHost(RendererHost):
    """A renderer that shows its own nodes on the polyhedron, with a process and a folder.

    `nodes` has the properties of the renderer's material by the title of a node: "{color}" and
    "{roughness}" stand for the inputs. `samples` are those per pixel under an environment; one is
    enough under a distant light. A request may take `limit` seconds.
    """

    nodes: ClassVar[Mapping[str, Material]]
    samples: ClassVar[int]
    script: ClassVar[str]  # of the worker
    device: ClassVar[str]

    def __init__(self, limit: float = 120.0) -> None:
        python = self._interpreter()
        self._temporary = TemporaryDirectory(prefix=f"mxeon-{self.name}-")
        self._folder = Path(self._temporary.name)
        mesh = polyhedron()
        np.savez(self._folder / MESH, vertices=mesh.vertices, triangles=mesh.triangles)
        script = Path(__file__).parent / self.script
        self.worker = Worker(self.name, python, script, self._folder / "log.txt", limit)
        self._picture = lru_cache(maxsize=PICTURES)(self._rendered)

    def identity(self) -> Identity:
        try:
            self.worker.start()
        except NotRun as error:
            if "No module named" in str(error):
                raise NotRun(self._missing()) from None
            raise
        return Identity(self.name, f"{self.name} {self.worker.version}", self.device)

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        self.refuse_paths(scene)
        return self._picture(title, tuple(map(float, color)), float(roughness), scene)

    def close(self) -> None:
        self.worker.close()
        self._temporary.cleanup()

    def _material(
        self, title: str, color: Sequence[float] | str, roughness: float | str
    ) -> dict[str, object]:
        inputs = {"{color}": color, "{roughness}": roughness}
        return {
            name: inputs.get(value, value) if isinstance(value, str) else value
            for name, value in self.nodes[title].items()
        }

    def _rendered(
        self, title: str, color: tuple[float, ...], roughness: float, scene: Scene
    ) -> Array:
        """Picture of a node; read-only."""
        picture = self._ask(
            material=self._material(title, color, roughness),
            mesh=str(self._folder / MESH),
            size=scene.size,
            light=scene.light,
            environment=scene.environment,
            samples=1 if scene.environment is None else self.samples,
        )
        picture.flags.writeable = False  # shared by all callers
        return picture

    def _ask(self, **request: object) -> Array:
        self.identity()
        output = self._folder / "output.npy"
        output.unlink(missing_ok=True)
        self.worker.ask(output=str(output), **request)
        values: Array = np.load(output, allow_pickle=False)
        return values

    def _interpreter(self) -> Path:
        """Path of the Python that has the renderer: a variable names it, or this one."""
        path = os.environ.get(self._variable())
        python = Path(path or sys.executable)
        if not (python.is_file() and os.access(python, os.X_OK)):
            raise NotRun(f"{self._missing()}; no interpreter {path}")
        return python

    def _variable(self) -> str:
        return f"MXEON_{self.name.upper()}_PYTHON"

    def _missing(self) -> str:
        return (
            f"{self.name}: not installed: {install(self.name)}, or name an interpreter "
            f"that has it in {self._variable()}"
        )
