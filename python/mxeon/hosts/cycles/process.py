# SPDX-License-Identifier: Apache-2.0
"""The process in which Blender runs, and the numbers of samples and bounces in Cycles.

A point of a point cloud is an exact sphere. Paths that enter the point find no exit in Cycles,
however, so materials with lobes below the surface are rendered on a mesh.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.process import Worker
from mxeon.shaders.inner_lobes import SUBSURFACE
from mxeon.shaders.library import data_folder
from mxeon.shaders.scene import Scene

CHECKOUT = data_folder()  # contains .venv-cycles, unless the package is installed


def interpreter(name: str = "cycles") -> Path:
    """Path of a Python with `bpy`, from MXEON_CYCLES_PYTHON or the checkout's `.venv-cycles`.

    For security, a `.venv-cycles` in the working folder is ignored.
    """
    path = os.environ.get("MXEON_CYCLES_PYTHON")
    python = Path(path or Path(CHECKOUT, ".venv-cycles", "bin", "python"))
    if python.is_file() and os.access(python, os.X_OK):
        return python
    missing = f"no interpreter {path}" if path else "needs Blender's Python package (1 GB)"
    raise NotRun(
        f"{name}: {missing}; in a checkout: ./run demo --host cycles; else pip install bpy==5.0.1 with "
        "Python 3.11 and name that Python in MXEON_CYCLES_PYTHON"
    )


class Blender(Worker):
    """A process of Blender that renders OSL shaders or Blender's own nodes."""

    def __init__(self, name: str) -> None:
        super().__init__(name, interpreter(name), Path(__file__).with_name("worker.py"))

    def render(self, folder: Path, text: str = "", **frame: object) -> list[str]:
        """Render a shader's text or a node to PICTURE in a folder, and return the printed lines."""
        if text:
            (folder / "shader.osl").write_text(text, encoding="utf-8")
            frame["shader"] = str(folder / "shader.osl")
        reply = self.ask(output=str(folder / PICTURE), **frame)
        lines = self.printed()
        if "error" in reply:
            errors = " | ".join(lines[:4])
            raise ShaderError(f"{self.name}: the shader does not compile: {errors}")
        return lines


PICTURE = "output.exr"
# Numbers of samples per pixel. One sample is enough under a distant light.
ENVIRONMENT_SAMPLES = 256
INNER_SAMPLES = 64
# A random walk below the surface counts as one bounce, and on a convex body no second bounce
# follows. Refracted light is reflected several times inside a body. Under a uniform sky, a sphere
# of dielectric_bsdf is equally bright with 6 and 16 bounces in float32, and darker by 1e-3 with 2
# bounces.
SURFACE_BOUNCES, REFRACTED_BOUNCES = 1, 8

DARK = Scene("dark")  # a scene without light, to which a request may add a light
# OSL expressions of a point's image coordinates on the body "plane".
PLACE = "0.5 + 0.5 * P[0], 0.5 - 0.5 * P[1]"
FEWEST_SAMPLES = 16  # minimum samples per pixel for lobes below the surface, which are noisy


def request(scene: Scene, lobes: Sequence[str]) -> dict[str, Any]:
    """Parameters of the worker for a scene and a material with `lobes` below the surface."""
    samples = ENVIRONMENT_SAMPLES if scene.environment is not None else 1
    return {
        "size": scene.size,
        "samples": scene.paths.samples or (max(samples, INNER_SAMPLES) if lobes else samples),
        "bounces": scene.paths.bounces or _bounces(lobes),
        "radius": 1.0,
        "light": scene.light,
        "environment": scene.environment,
        "body": "mesh" if lobes else "points",
    }


def approximations(scene: Scene, lobes: Sequence[str]) -> tuple[str, ...]:
    """Reasons why a picture with `lobes` below the surface needs more or longer paths."""
    if not lobes:
        return ()
    paths, reasons = request(scene, lobes), []
    if paths["samples"] < FEWEST_SAMPLES:
        reasons.append(
            f"{' and '.join(lobes)}: needs at least {FEWEST_SAMPLES} samples per pixel; with "
            f"{paths['samples']}, the picture is noise"
        )
    if paths["bounces"] < _bounces(lobes):
        reasons.append(
            f"{' and '.join(lobes)}: needs {_bounces(lobes)} bounces; with {paths['bounces']} the "
            "light on longer paths is missing"
        )
    return tuple(reasons)


def _bounces(lobes: Sequence[str]) -> int:
    return SURFACE_BOUNCES if set(lobes) <= {SUBSURFACE} else REFRACTED_BOUNCES
