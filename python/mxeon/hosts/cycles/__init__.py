# SPDX-License-Identifier: Apache-2.0
"""Blender's Cycles: OSL on the CPU, in a process of its own.

Cycles is part of the Python module `bpy`, which needs an environment of its own. This half writes
OSL files, `worker.py` renders them there, and this half reads the float32 pictures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import ImageError, InputError, NotRun, ShaderError
from mxeon.hosts.base import Array, Identity, Inputs
from mxeon.hosts.cycles import calls, closures, graphs, pairs, tracing
from mxeon.hosts.cycles.process import interpreter
from mxeon.hosts.osl.points import with_header
from mxeon.hosts.pairs import PairHost
from mxeon.hosts.process import Worker
from mxeon.io.images import read_image
from mxeon.shaders import functions
from mxeon.shaders.generation import Shader
from mxeon.shaders.inner_lobes import inner_lobes
from mxeon.shaders.library import source_folder
from mxeon.shaders.scene import FRONT, Scene, sphere

Socket: TypeAlias = float | Sequence[float]  # value of a Blender node's input

# Pictures that are kept: the checks of a node ask for some of them again.
PICTURES = 64

# Cycles has no surface coordinates on a point cloud: a block that opens like this gives the globals
# `u` and `v`, which a generated shader reads, the values of `mxeon.shaders.scene.sphere`.
TEXCOORD = """{
    float u = 0.5 + atan2(N[0], N[2]) / M_2PI;
    float v = 0.5 + atan2(N[1], hypot(N[0], N[2])) / M_PI;
"""


class Host(PairHost):
    """Blender's Cycles, with a process and a temporary folder.

    `sources` is the folder of the OSL files whose functions `call` executes, eonlib's unless given;
    `limit` the seconds that one picture may take.
    """

    name = "cycles"
    profile = "cycles"

    def __init__(self, sources: Path | None = None, limit: float = 300.0) -> None:
        python = interpreter()
        self._sources = Path(sources or source_folder("eonlib") / "genosl").resolve()
        self._temporary = TemporaryDirectory(prefix="mxeon-cycles-")
        log = Path(self._temporary.name, "log.txt")
        script = Path(__file__).with_name("worker.py")
        self.worker = Worker(self.name, python, script, log, limit)
        self._picture = lru_cache(maxsize=PICTURES)(self._rendered)

    def close(self) -> None:
        self.worker.close()
        self._temporary.cleanup()

    def identity(self) -> Identity:
        self.worker.start()
        return Identity(self.name, f"Blender {self.worker.version}", "CPU, OSL")

    def picture(self, shader: Shader, scene: Scene) -> Array:
        """Picture of the sphere with an OSL shader on it, float32, under a uniform environment at most.

        Exact but for float32 under a distant light. Under an environment a pixel is a mean of
        `tracing.ENVIRONMENT_SAMPLES` samples, always the same; at roughness 1 its error is 2e-3 rms, 0.1 at
        the rim, and 2e-5 in the mean over the sphere. NotRun where Cycles lacks a closure.
        """
        self.refuse_shape(scene)
        if isinstance(scene.environment, (str, Path)):
            raise NotRun("cycles: environment must be uniform; got an image")
        text = _on_sphere(with_header(shader.stages["pixel"], shader))
        return self._picture(scene, inner_lobes(shader), text=text)

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        return tracing.approximations(scene, inner_lobes(shader))

    def evaluate(
        self,
        shader: Shader,
        wo: Array,
        wi: Array,
        inputs: Inputs,
        branch: str,
        *,
        output: str = "response",
        irradiance: Array | None = None,
    ) -> Array:
        if branch != graphs.BRANCH:
            return super().evaluate(
                shader, wo, wi, inputs, branch, output=output, irradiance=irradiance
            )
        source, arguments = graphs.graph_function(shader, inputs)
        return self.execute(with_header(source, shader), graphs.FUNCTION, *arguments)

    def _pixels(
        self, shader: Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
    ) -> NDArray[np.float64]:
        with self._folder() as name:
            folder = Path(name)
            text, frame, scale = pairs.request(folder, shader, wo, wi, inputs, last, light)
            pixels = self._render(folder, with_header(text, shader), **frame)
        return np.asarray(pixels.reshape(-1, 3)[: len(wo)].astype(np.float64) / scale)

    def blender_node(self, kind: str, inputs: Mapping[str, Socket], scene: Scene) -> Array:
        """Picture of the sphere with a Blender node, of a type, with inputs by the names of its sockets."""
        return self._picture(scene, (), kind=kind, inputs=tuple(inputs.items()))

    def call(self, function: str, *arguments: ArrayLike) -> Array:
        return self.execute(functions.expanded(self._file(function)), function, *arguments)

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        with self._folder() as name:
            folder = Path(name)
            text, frame, count = calls.request(folder, source, function, *arguments)
            pixels = self._render(folder, text, **frame)
        return pixels.reshape(-1, 3)[:count]

    def closures(self) -> dict[str, str]:
        """For each of MaterialX's closures, "" if Cycles renders it, else its reason not to."""
        return {name: self._reason(name) for name in closures.CALLS}

    def _reason(self, closure: str) -> str:
        frame = tracing.request(replace(FRONT, size=4), ())
        try:
            with self._folder() as folder:
                self._render(Path(folder), closures.text(closure), **frame)
        except (NotRun, ShaderError) as error:
            return str(error)
        return ""

    def forget(self) -> None:
        self._picture.cache_clear()

    def _rendered(
        self,
        scene: Scene,
        lobes: tuple[str, ...],
        text: str = "",
        kind: str = "",
        inputs: tuple[tuple[str, Socket], ...] = (),
    ) -> Array:
        """Picture of the sphere with an OSL shader or a node of Blender's on it; read-only."""
        frame = tracing.request(scene, lobes)
        with self._folder() as folder:
            if text:
                pixels = self._render(Path(folder), text, **frame)
            else:
                native = {"kind": kind, "inputs": dict(inputs)}
                pixels = self._request(Path(folder), native=native, **frame)
        image = np.where(sphere(scene.size).mask[..., None], pixels, np.float32(0.0))
        image.flags.writeable = False  # shared by all callers
        return image

    def _folder(self) -> TemporaryDirectory[str]:
        return TemporaryDirectory(dir=self._temporary.name)

    def _file(self, function: str) -> Path:
        for path in sorted(self._sources.glob("*.osl")):
            if function in functions.signatures(path.read_text(encoding="utf-8")):
                return path
        raise InputError(f"function must be defined in {self._sources}; got {function!r}")

    def _render(self, folder: Path, text: str, **frame: object) -> Array:
        """Picture that the worker renders of the OSL shader `text`."""
        shader = folder / "shader.osl"
        shader.write_text(text)
        return self._request(folder, shader=str(shader), **frame)

    def _request(self, folder: Path, **request: object) -> Array:
        output = folder / "output.exr"
        reply = self.worker.ask(output=str(output), **request)
        if "error" in reply:
            errors = " | ".join(self.worker.printed()[:4])
            raise ShaderError(f"cycles: the shader does not compile: {errors}")
        # A closure that Cycles lacks makes the whole shader black, with no other sign than this.
        for line in self.worker.printed():
            if line.startswith("ERROR"):
                raise NotRun(f"cycles: {line.partition(', called from')[0]}")
        try:
            return read_image(output)
        except ImageError as error:
            raise NotRun(f"cycles: Blender wrote no picture that can be read; {error}") from None


def _on_sphere(text: str) -> str:
    """A generated shader with the sphere's texture coordinates."""
    head, brace, body = text.rpartition("\n)\n{\n")
    return head + brace + TEXCOORD + body + "}"
