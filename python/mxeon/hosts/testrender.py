# SPDX-License-Identifier: Apache-2.0
"""Programs of Open Shading Language: oslc compiles generated OSL, and testrender renders a scene.

Each pixel of a picture shows a different pair of directions; see `testrender_scene`. The program
testshade evaluates functions.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import LAST_OUTPUT, MxeonError, NotRun, ShaderError
from mxeon.hosts import testrender_scene as scenes
from mxeon.hosts.base import Array, Identity, Inputs, RendererWarning
from mxeon.hosts.osl import points
from mxeon.hosts.pairs import LAMP, SKY, PairHost
from mxeon.io.images import read_image
from mxeon.jobs.signals import Temporary
from mxeon.shaders.generation import Shader

VARIABLES = {"oslc": "MXEON_OSLC", "testrender": "MXEON_TESTRENDER", "testshade": "MXEON_TESTSHADE"}
TIMEOUT = 300.0  # maximum seconds for one run of a program
LINES = 4  # number of lines that a message quotes from the end of a program's output
# Matches the first line of the help, because oslc has no option that prints the version.
TITLE = re.compile(r"^oslc -- (Open Shading Language) compiler (\S+)", re.MULTILINE)
HELPERS = {
    "mxeon_root": "shader mxeon_root(closure color material = 0) { Ci = material; }",
    "mxeon_light": "shader mxeon_light() { Ci = emission(); }",
    "mxeon_sky": "shader mxeon_sky() { Ci = background(); }",
}
OPTIONS = ("--center", "-d", "float", points.CALL, "-o", "result")


class TestrenderHost(PairHost):
    """The programs oslc, testrender and testshade, on PATH or named by environment VARIABLES."""

    name = "testrender"

    def __init__(self) -> None:
        self._oslc, self._testrender = map(find_program, ("oslc", "testrender"))
        self._version = version(self._oslc)
        self._temporary = Temporary("mxeon-testrender-")
        self._folder = Path(self._temporary.name)
        self._compiled: dict[str, str] = {}

    def identity(self) -> Identity:
        return Identity(self.name, self._version, "CPU")

    def _pixels(
        self, shader: Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
    ) -> NDArray[np.float64]:
        """Radiance towards wo. With DARK, the lamp stays on, because its light is negligible."""
        lit = light != SKY
        wo, wi = (np.asarray(each, np.float64) for each in (wo, wi))
        scene = scenes.pair_scene(wo, wi, points.side(len(wo)))
        columns = points.columns_of(shader, inputs, scene.turned)
        variables = columns, self._folder / points.IMAGE, len(wo), scenes.PLACE
        text = points.with_variables(shader, *variables, last)
        for name, each in {shader.name: text, **HELPERS}.items():
            self._compile(name, each)
        for name, each in scene.files(shader.name, lit).items():
            (self._folder / name).write_text(each, encoding="utf-8")
        samples = scenes.LIGHT_SAMPLES if lit else scenes.SKY_SAMPLES
        options = ["-t", "1", "-aa", str(samples), "--res", str(scene.size), str(scene.size)]
        pixels = self._image([self._testrender, *options, scenes.SCENE])
        values = pixels[..., :3].reshape(-1, 3)[: len(wo)]
        return values / scene.irradiance[:, np.newaxis] if light == LAMP else values

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        place, last = (self._folder / points.IMAGE, scenes.PLACE), "result = {};"
        text, count = points.call_text(
            source, function, arguments, *place, "output color result", last
        )
        self._compile(points.CALL, text)
        size = ["-t", "1", "--res", *[str(points.side(count))] * 2]
        pixels = self._image([find_program("testshade"), *size, *OPTIONS])
        return pixels.reshape(-1, 3)[:count]

    def close(self) -> None:
        self._temporary.cleanup()

    def _compile(self, name: str, text: str) -> None:
        """Compile a shader, unless the shader was compiled before with the same text."""
        if self._compiled.get(name) == text:
            return
        (self._folder / f"{name}.osl").write_text(text, encoding="utf-8")
        output([self._oslc, "-q", f"{name}.osl"], self._folder, ShaderError)
        self._compiled[name] = text

    def _image(self, command: list[str]) -> NDArray[np.float64]:
        """Pixels of a picture that a program writes, in TIFF because EXR would have half floats."""
        picture = self._folder / "picture.tif"
        picture.unlink(missing_ok=True)
        output([*command, picture.name], self._folder)
        try:
            return read_image(picture).astype(np.float64)
        except ValueError as error:
            raise NotRun(f"testrender: {error}") from None


def find_program(name: str) -> str:
    """Path of a program, from an environment variable or on PATH."""
    variable = VARIABLES[name]
    program = os.environ.get(variable) or name
    path = shutil.which(program)
    if path is None:
        raise NotRun(
            f"testrender: no program {program!r}; build Open Shading Language, as tools/build_testrender.sh "
            f"does on Debian 12, and name it in {variable}"
        )
    return os.path.abspath(path)


def version(oslc: str) -> str:
    """Name and version of the language, from the help of oslc."""
    title = TITLE.search(output([oslc, "--help"]))
    if title is None:
        raise NotRun(f"testrender: {oslc} must be OSL's compiler; its help names no version")
    return f"{title[1]} {title[2]}"


def output(
    command: Sequence[str],
    folder: Path | None = None,
    failure: type[MxeonError] = NotRun,
) -> str:
    """Standard output of a program, whose warnings become `RendererWarning`.

    Raises `failure` with the last lines of output if the program fails. Raises ShaderError if a
    program reports an error but succeeds, as testrender does after dropping lobes that exceed a
    memory limit.
    """
    try:
        process = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotRun(f"testrender: {error}") from None
    lines = (process.stdout + process.stderr).strip().splitlines()
    program = Path(command[0]).name
    if process.returncode:
        last = " | ".join(lines[-LINES:])
        raise failure(f"testrender: {program}: exit status {process.returncode}{LAST_OUTPUT}{last}")
    for line in lines:
        if line.startswith("ERROR") or "Assertion" in line:
            raise ShaderError(f"testrender: {program}: {line}")
    for line in dict.fromkeys(lines):
        if line.startswith("WARNING"):
            warnings.warn(f"{program}: {line}", RendererWarning, stacklevel=2)
    return process.stdout
