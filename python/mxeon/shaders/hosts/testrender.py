# SPDX-License-Identifier: Apache-2.0
"""OSL's own renderer: generated OSL compiled by oslc and rendered by testrender.

Its sphere is a mesh and its camera a perspective one, so the picture is of a plane, on which every
pixel is a pair of directions that is known exactly.

Not verified against a real build of OSL: only programs that imitate oslc and testrender were run.
Options and scene format are those of OSL 1.14's sources.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.errors import MxeonError, NotRun, ShaderError
from mxeon.io.images import read_image
from mxeon.shaders.generation import Shader
from mxeon.shaders.hosts import base
from mxeon.shaders.hosts.base import Identity
from mxeon.shaders.plane import DISTANCE, FOV, TILT, falloff
from mxeon.shaders.scene import Scene

PROGRAMS = {"oslc": "MXEON_OSLC", "testrender": "MXEON_TESTRENDER"}  # program -> variable
UNVERIFIED = "not verified against a real build"
TIMEOUT = 300.0  # seconds for one of them
LINES = 4  # last ones of a program's output in a message

PLANE = 100.0  # half the plane's side
SAMPLES = {"light": 8, "environment": 16}  # squared: rays of a pixel

HELPERS = {
    "mxeon_root": "shader mxeon_root(closure color material = 0) { Ci = material; }",
    "mxeon_light": "shader mxeon_light(float radiance = 1.0) { Ci = radiance * emission(); }",
    "mxeon_sky": "shader mxeon_sky(float radiance = 1.0) { Ci = radiance * background(); }",
}
SCENE = """<World>
  <Option no_jitter="int 1" />
  <Camera eye="0,0,1" dir="0,{sine:.9g},{cosine:.9g}" up="0,0,1" fov="{fov:.9g}" />
  <ShaderGroup name="plane">
    shader {shader} material ;
    shader mxeon_root root ;
    connect material.out root.material ;
  </ShaderGroup>
  <Quad corner="-{half},-{half},0" edge_x="{side},0,0" edge_y="0,{side},0" />
{light}
</World>
"""
LIGHT = """  <ShaderGroup name="light" is_light="yes">
    param float radiance {radiance:.9g} ;
    shader mxeon_light light ;
  </ShaderGroup>
  <Quad corner="{corner}" edge_x="{x}" edge_y="{y}" is_light="yes" />"""
SKY = """  <ShaderGroup name="sky">
    param float radiance {radiance:.9g} ;
    shader mxeon_sky sky ;
  </ShaderGroup>
  <Background />"""


class Host(base.Host):
    """oslc and testrender, on PATH or named by MXEON_OSLC and MXEON_TESTRENDER.

    Raises
    ------
    NotRun
        If one of them is missing, or oslc does not start.
    """

    name = "testrender"
    target = "osl"

    def __init__(self) -> None:
        self._oslc, self._testrender = map(_program, PROGRAMS)
        self._version = _run([self._oslc, "--version"]).strip() or "unknown version"
        self._temporary = TemporaryDirectory(prefix="mxeon-testrender-")
        self._folder = Path(self._temporary.name)
        self._compiled: dict[str, str] = {}

    def identity(self) -> Identity:
        """Version of oslc; the device is the CPU."""
        return Identity(self.name, f"OSL {self._version}, {UNVERIFIED}", "CPU")

    def plane(self, shader: Shader, scene: Scene) -> NDArray[Any]:
        """Radiance of a plane with the shader on it, at `mxeon.shaders.plane.plane_pairs`.

        Parameters
        ----------
        shader : Shader
        scene : Scene
            A distant light, in the plane's frame, or a uniform environment.

        Returns
        -------
        ndarray, shape (size * size, 3), float64
            pi f cos(theta_i), or radiance. testrender writes half floats.
        """
        for name, text in {shader.name: shader.stages["pixel"], **HELPERS}.items():
            self._compile(name, text)
        pixels = self._render(_scene(shader, scene), scene)
        return (
            pixels
            if scene.light is None
            else pixels / falloff(scene.light, scene.size)[:, np.newaxis]
        )

    def close(self) -> None:
        """Remove the host's files."""
        self._temporary.cleanup()

    def _compile(self, name: str, text: str) -> None:
        """Compile a shader, unless its text is that of the last one of its name."""
        if self._compiled.get(name) == text:
            return
        (self._folder / f"{name}.osl").write_text(text, encoding="utf-8")
        header = mx.getDefaultDataSearchPath().find("libraries/stdlib/genosl/include/mx_funcs.h")
        include = f"-I{header.getParentPath().asString()}"
        _run([self._oslc, "-q", include, f"{name}.osl"], self._folder, ShaderError)
        self._compiled[name] = text

    def _render(self, text: str, scene: Scene) -> NDArray[np.float64]:
        """Pixels of a scene, (size * size, 3)."""
        size, aa = str(scene.size), SAMPLES["environment" if scene.light is None else "light"]
        picture = self._folder / "plane.exr"
        picture.unlink(missing_ok=True)
        (self._folder / "scene.xml").write_text(text, encoding="utf-8")
        command = [self._testrender, "-r", size, size, "-aa", str(aa), "scene.xml", picture.name]
        _run(command, self._folder)
        try:
            pixels = read_image(picture)
        except ValueError as error:
            raise NotRun(f"testrender: {error}") from None
        return pixels[..., :3].reshape(-1, 3).astype(np.float64)


def _scene(shader: Shader, scene: Scene) -> str:
    """Scene in testrender's XML."""
    if scene.light is None:
        lit = SKY.format(radiance=scene.environment)
    else:
        toward = np.array(scene.light)
        x = np.cross([0.0, 1.0, 0.0] if abs(toward[1]) < 0.9 else [1.0, 0.0, 0.0], toward)
        x = x / np.linalg.norm(x)
        y = np.cross(toward, x)
        lit = LIGHT.format(
            radiance=np.pi * DISTANCE**2,
            corner=_triple(DISTANCE * toward - 0.5 * (x + y)),
            x=_triple(x),
            y=_triple(y),
        )
    return SCENE.format(
        sine=np.sin(TILT), cosine=-np.cos(TILT), fov=FOV, half=PLANE, side=2.0 * PLANE,
        shader=shader.name, light=lit,
    )  # fmt: skip


def _triple(vector: NDArray[Any]) -> str:
    return ",".join(f"{component:.9g}" for component in vector)


def _program(name: str) -> str:
    """Path of a program, named by its variable or on PATH."""
    variable = PROGRAMS[name]
    program = os.environ.get(variable) or name
    path = shutil.which(program)
    if path is None:
        raise NotRun(
            f"testrender: no program {program!r}; build Open Shading Language and name it in {variable}"
        )
    return os.path.abspath(path)


def _run(
    command: Sequence[str], folder: Path | None = None, failure: type[MxeonError] = NotRun
) -> str:
    """Output of a program; `failure` is raised with its last lines if it fails."""
    try:
        process = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotRun(f"testrender: {error}") from None
    if process.returncode:
        lines = (process.stdout + process.stderr).strip().splitlines()[-LINES:]
        raise failure(
            f"testrender: {Path(command[0]).name}: exit status {process.returncode}, "
            f"{UNVERIFIED}; last output: {' | '.join(lines)}"
        )
    return process.stdout
