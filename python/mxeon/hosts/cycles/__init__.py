# SPDX-License-Identifier: Apache-2.0
"""Blender's Cycles: OSL on the CPU, in its own process.

Cycles is part of the Python module `bpy`, which needs its own environment. This half writes OSL files, `worker.py`
renders them, and this half reads the float32 pictures.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import ImageError, InputError, NotRun
from mxeon.hosts.base import Array, Identity, Inputs, Query
from mxeon.hosts.calls import GRAPH
from mxeon.hosts.cycles import process
from mxeon.hosts.osl import points
from mxeon.hosts.osl.points import side, statements, with_header
from mxeon.hosts.pairs import DISTANCE, HEIGHT, LAMP, SKY, PairHost, tilted_triangles
from mxeon.io.images import read_image
from mxeon.shaders import functions, generation, library
from mxeon.shaders.inner_lobes import inner_lobes
from mxeon.shaders.scene import Scene, sphere

Socket: TypeAlias = float | Sequence[float]  # value of a Blender node's input

PICTURES = 64  # cached pictures; the checks of a node request some again

# Cycles has no surface coordinates on a point cloud: this block sets the globals `u`, `v` and `dPdu` as in
# `mxeon.shaders.scene`.
TEXCOORD = """{
    float u = 0.5 + atan2(N[0], N[2]) / M_2PI;
    float v = 0.5 + atan2(N[1], hypot(N[0], N[2])) / M_PI;
    vector dPdu = vector(N[2], 0.0, -N[0]);
"""


SKY_SAMPLES = 64  # paths per pixel under a sky
# Name of a function that repeats a shader's statements before its uniform EDF, and returns the EDF's color.
GRAPH_FUNCTION = "mxeon_graph"


class CyclesHost(PairHost):
    """Blender's Cycles, with its process and a temporary folder.

    `sources` is the folder of the OSL files whose functions `call` executes, by default eonlib's; `limit` is in seconds
    per picture.
    """

    name = "cycles"
    profile = "cycles"

    def __init__(self, sources: Path | None = None, limit: float = 300.0) -> None:
        self._sources = Path(sources or library.source_folder("eonlib") / "genosl").resolve()
        self.worker = process.Blender(self.name, limit)
        self._picture = lru_cache(maxsize=PICTURES)(self._rendered)

    def close(self) -> None:
        self.worker.close()

    def identity(self) -> Identity:
        self.worker.start()
        return Identity(self.name, f"Blender {self.worker.version}", "CPU, OSL")

    def picture(self, shader: generation.Shader, scene: Scene) -> Array:
        """Picture of the sphere with an OSL shader, float32; the only environment is a uniform one.

        Under a distant light it is exact up to float32. Under an environment a pixel is a mean of
        `process.ENVIRONMENT_SAMPLES` samples with a fixed seed; at roughness 1 its error is 2e-3 rms, 0.1 at the rim,
        and 2e-5 in the mean over the sphere. NotRun if Cycles lacks a closure.
        """
        self.refuse_shape(scene)
        if isinstance(scene.environment, (str, Path)):
            raise NotRun("cycles: environment must be uniform; got an image")
        text = with_header(shader.stages["pixel"], shader)
        head, brace, body = text.rpartition("\n)\n{\n")
        text = f"{head}{brace}{TEXCOORD}{body}}}"
        return self._picture(scene, inner_lobes(shader), text=text)

    def approximations(self, shader: generation.Shader, scene: Scene) -> tuple[str, ...]:
        return process.approximations(scene, inner_lobes(shader))

    def _values(self, query: Query) -> Array:
        if query.branch != GRAPH:
            return super()._values(query)
        source, arguments = _graph_function(query.shader, query.inputs)
        return self.execute(with_header(source, query.shader), GRAPH_FUNCTION, *arguments)

    def _pixels(
        self, shader: generation.Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
    ) -> NDArray[np.float64]:
        scene = tilted_triangles(wo, wi, side(len(wo)))
        columns = points.columns_of(shader, inputs, scene.turned)
        with self.worker.temporary() as name:
            folder = Path(name)
            block = statements(columns, folder / points.IMAGE, len(wo), scene.place)
            text = points.with_variables(shader, block, lambda output: last.format(output=output))
            corners = folder / "triangles.npy"
            np.save(corners, scene.corners.astype(np.float32))
            frame: dict[str, object] = {**process.request(process.DARK, ()), "size": side(len(wo))}
            frame |= {"radius": 0.5 * HEIGHT, "width": scene.width, "triangles": str(corners)}
            if light == LAMP:
                frame["lamp"] = DISTANCE
            if light == SKY:
                frame |= {"samples": SKY_SAMPLES, "environment": 1.0}
            pixels = self._render(folder, with_header(text, shader), **frame)
        values = np.asarray(pixels.reshape(-1, 3)[: len(wo)].astype(np.float64))
        return values / (DISTANCE**2 * scene.irradiance) if light == LAMP else values

    def blender_node(self, kind: str, inputs: Mapping[str, Socket], scene: Scene) -> Array:
        """Picture of the sphere with a Blender node and `inputs` by socket."""
        return self._picture(scene, (), kind=kind, inputs=tuple(inputs.items()))

    def call(self, function: str, *arguments: ArrayLike) -> Array:
        for path in sorted(self._sources.rglob("*.osl")):
            if function in functions.signatures(path.read_text(encoding="utf-8")):
                return self.execute(functions.expanded(path), function, *arguments)
        raise InputError(f"function must be defined in {self._sources}; got {function!r}")

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a function: a plane emits them, and its shader reads the arguments from unfiltered pixels."""
        with self.worker.temporary() as name:
            place, output = (Path(name, points.IMAGE), process.PLACE), "output closure color out"
            last = "out = {} * emission();"
            text, count = points.call_text(source, function, arguments, *place, output, last)
            frame = {**process.request(process.DARK, ()), "body": "plane", "size": side(count)}
            return self._render(Path(name), text, **frame).reshape(-1, 3)[:count]

    def _rendered(
        self,
        scene: Scene,
        lobes: tuple[str, ...],
        text: str = "",
        kind: str = "",
        inputs: tuple[tuple[str, Socket], ...] = (),
    ) -> Array:
        native = {"native": {"kind": kind, "inputs": dict(inputs)}} if kind else {}
        with self.worker.temporary() as name:
            pixels = self._render(Path(name), text, **process.request(scene, lobes), **native)
        image = np.where(sphere(scene.size).mask[..., None], pixels, np.float32(0.0))
        image.flags.writeable = False  # shared by all callers
        return image

    def _render(self, folder: Path, text: str, **frame: object) -> Array:
        # An unsupported closure makes the whole shader black, and prints an error.
        for line in self.worker.render(folder, text, **frame):
            if line.startswith("ERROR"):
                raise NotRun(f"cycles: {line.partition(', called from')[0]}")
        try:
            return read_image(folder / process.PICTURE)
        except ImageError as error:
            raise NotRun(f"cycles: Blender wrote no picture that can be read; {error}") from None


def _graph_function(shader: generation.Shader, inputs: Inputs) -> tuple[str, list[ArrayLike]]:
    """Text that defines GRAPH_FUNCTION, and the values of its arguments.

    `inputs` override the document's values by path or name. InputError without a uniform EDF.
    """
    text = shader.stages["pixel"]
    head, _, body = text.rpartition("\n)\n{\n")
    call = re.search(r"\n *EDF \w+ = uniform_edf\((\w+)\);", "\n" + body)
    if not call:
        raise InputError(
            f"element {shader.element!r} must call a uniform EDF; its shader calls none"
        )
    statements = ("\n" + body)[: call.start()]
    before = head[: head.rindex("\nshader ")]
    words = set(re.findall(r"\w+", statements + call[1]))
    count = max([np.shape(value)[0] for value in inputs.values() if np.ndim(value)], default=1)
    parameters, locals_ = ["float mxeon_row"], []  # one parameter even if the graph reads no inputs
    arguments: list[ArrayLike] = [np.zeros(count)]
    for port in shader.inputs:
        if port.name not in words:
            continue
        key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
        value = np.asarray(inputs.get(key, port.value), np.float32)
        if port.type == "vector2":  # not supported by OSL's textures
            parts = [f"{port.name}_{axis}" for axis in "xy"]
            parameters += [f"float {part}" for part in parts]
            locals_.append(f"    vector2 {port.name} = vector2({', '.join(parts)});")
            arguments += [value[..., 0], value[..., 1]]
        else:
            kind = {"color3": "color", "vector3": "vector"}.get(port.type, port.type)
            parameters.append(f"{kind} {port.name}")
            arguments.append(value)
    head = f"color {GRAPH_FUNCTION}({', '.join(parameters)})"
    lines = [before, head, "{", *locals_, statements, f"    return {call[1]};", "}", ""]
    return "\n".join(lines), arguments
