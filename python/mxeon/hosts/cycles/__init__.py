# SPDX-License-Identifier: Apache-2.0
"""Blender's renderer Cycles, which runs OSL on the CPU in a separate process.

Cycles is part of the Python module `bpy`, which needs a separate environment. This half of the host
writes OSL files and reads float32 pictures, which `worker.py` renders.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
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
from mxeon.hosts.osl.points import side, with_header
from mxeon.hosts.pairs import DISTANCE, HEIGHT, LAMP, SKY, PairHost, tilted_triangles
from mxeon.io.images import read_image
from mxeon.shaders import functions, generation, library
from mxeon.shaders.inner_lobes import inner_lobes
from mxeon.shaders.scene import Scene, sphere

Socket: TypeAlias = float | Sequence[float]  # value of a Blender node's input

PICTURES = 64  # cached pictures, which the checks of a node share

# Start of a block in which local variables hide the globals `u`, `v` and `dPdu`, because Cycles has
# no surface coordinates on a point cloud. The values are as in `mxeon.shaders.scene`.
TEXCOORD = """{
    float u = 0.5 + atan2(N[0], N[2]) / M_2PI;
    float v = 0.5 + atan2(N[1], hypot(N[0], N[2])) / M_PI;
    vector dPdu = vector(N[2], 0.0, -N[0]);
"""

SKY_SAMPLES = 64  # paths per pixel under a sky


class CyclesHost(PairHost):
    """Blender's Cycles in a separate process, with a temporary folder.

    `call` executes functions of OSL files in the folder `sources`, which is eonlib's by default.
    """

    name = "cycles"
    profile = "cycles"

    def __init__(self, sources: Path | None = None) -> None:
        self._sources = Path(sources or library.source_folder("eonlib") / "genosl").resolve()
        self.worker = process.Blender(self.name)
        self._picture = lru_cache(maxsize=PICTURES)(self._rendered)

    def close(self) -> None:
        self.worker.close()

    def identity(self) -> Identity:
        self.worker.start()
        return Identity(self.name, f"Blender {self.worker.version}", "CPU, OSL")

    def picture(self, shader: generation.Shader, scene: Scene) -> Array:
        """Float32 picture of the sphere with an OSL shader. An environment must be uniform.

        Under a distant light, pixels are exact up to float32. Under an environment, a pixel is a
        mean of `process.ENVIRONMENT_SAMPLES` samples with a fixed seed. At roughness 1, the error
        is then 2e-3 rms, 0.1 at the rim, and 2e-5 in the mean over the sphere. Raises NotRun if
        Cycles lacks a closure.
        """
        self.refuse_shape(scene)
        if isinstance(scene.environment, (str, Path)):
            raise NotRun("cycles: environment must be uniform; got an image")
        text = with_header(shader.stages["pixel"], shader)
        head, brace, body = text.rpartition("\n)\n{\n")
        text = f"{head}{brace}{TEXCOORD}{body}}}"
        return self._picture(text, json.dumps(process.request(scene, inner_lobes(shader))))

    def approximations(self, shader: generation.Shader, scene: Scene) -> tuple[str, ...]:
        return process.approximations(scene, inner_lobes(shader))

    def _values(self, query: Query) -> Array:
        if query.branch != GRAPH:
            return super()._values(query)
        # The shader emits the color of the uniform EDF. Statements that follow the EDF are dropped.
        shader = query.shader
        call = re.search(r"\n *EDF \w+ = uniform_edf\((\w+)\);", shader.stages["pixel"])
        if not call:
            raise InputError(
                f"element {shader.element!r} must call a uniform EDF; its shader calls none"
            )
        pixel = shader.stages["pixel"][: call.start()] + "\n}\n"
        graph = replace(shader, stages={"pixel": pixel})
        last = f"    {{output}} = {call[1]} * emission();\n"
        columns = points.columns_of(shader, query.inputs)
        count = max(len(each.rows) for each in columns.values())
        with self.worker.temporary() as name:
            variables = columns, Path(name, points.IMAGE), count, process.PLACE
            text = points.with_variables(graph, *variables, last)
            return self._plane(Path(name), text, count)

    def _pixels(
        self, shader: generation.Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
    ) -> NDArray[np.float64]:
        scene = tilted_triangles(wo, wi, side(len(wo)))
        columns = points.columns_of(shader, inputs, scene.turned)
        with self.worker.temporary() as name:
            folder = Path(name)
            variables = columns, folder / points.IMAGE, len(wo), scene.place
            text = points.with_variables(shader, *variables, last)
            corners = folder / "triangles.npy"
            np.save(corners, scene.corners.astype(np.float32))
            frame: dict[str, object] = {**process.request(process.DARK, ()), "size": side(len(wo))}
            frame |= {"radius": 0.5 * HEIGHT, "width": scene.width, "triangles": str(corners)}
            if light == LAMP:
                frame["lamp"] = DISTANCE
            if light == SKY:
                frame |= {"samples": SKY_SAMPLES, "environment": 1.0}
            pixels = self._render(folder, text, **frame)
        values = np.asarray(pixels.reshape(-1, 3)[: len(wo)].astype(np.float64))
        return values / (DISTANCE**2 * scene.irradiance) if light == LAMP else values

    def blender_node(self, kind: str, inputs: Mapping[str, Socket], scene: Scene) -> Array:
        """Picture of the sphere with a Blender node. The keys of `inputs` are names of sockets."""
        native = {"native": {"kind": kind, "inputs": dict(inputs)}}
        return self._picture("", json.dumps(process.request(scene, ()) | native))

    def call(self, function: str, *arguments: ArrayLike) -> Array:
        for path in sorted(self._sources.rglob("*.osl")):
            if function in functions.signatures(path.read_text(encoding="utf-8")):
                return self.execute(functions.expanded(path), function, *arguments)
        raise InputError(f"function must be defined in {self._sources}; got {function!r}")

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a function, emitted by a plane that reads the arguments from an image."""
        with self.worker.temporary() as name:
            place, output = (Path(name, points.IMAGE), process.PLACE), "output closure color out"
            last = "out = {} * emission();"
            text, count = points.call_text(source, function, arguments, *place, output, last)
            return self._plane(Path(name), text, count)

    def _plane(self, folder: Path, text: str, count: int) -> Array:
        """Radiance of a plane that shows a point per pixel, (count, 3)."""
        frame = {**process.request(process.DARK, ()), "body": "plane", "size": side(count)}
        return self._render(folder, text, **frame).reshape(-1, 3)[:count]

    def _rendered(self, text: str, request: str) -> Array:
        frame = json.loads(request)
        with self.worker.temporary() as name:
            pixels = self._render(Path(name), text, **frame)
        image = np.where(sphere(frame["size"]).mask[..., None], pixels, np.float32(0.0))
        image.flags.writeable = False  # all callers share the cached image
        return image

    def _render(self, folder: Path, text: str, **frame: object) -> Array:
        # If a closure is unsupported, the whole shader is black and Cycles prints an error.
        for line in self.worker.render(folder, text, **frame):
            if line.startswith("ERROR"):
                raise NotRun(f"cycles: {line.partition(', called from')[0]}")
        try:
            return read_image(folder / process.PICTURE)
        except ImageError as error:
            raise NotRun(f"cycles: Blender wrote no readable picture; {error}") from None
