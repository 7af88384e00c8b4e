# SPDX-License-Identifier: Apache-2.0
"""The half of the `luxcore` host that runs in the process of LuxCoreRender; see `mxeon.hosts.process`."""

from __future__ import annotations

import json
import math
import os
import sys
import time
from typing import Any, TypeAlias

REPLIES = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)

import numpy as np  # noqa: E402
import pyluxcore  # noqa: E402

LuxCore: TypeAlias = Any  # an object of pyluxcore, which has no types
JsonObject: TypeAlias = dict[str, Any]  # of a request

# One thread and a fixed seed make pictures repeatable.
RENDERER = {
    "renderengine.type": "PATHCPU",
    "renderengine.seed": 1,
    "native.threads.count": 1,
    "sampler.type": "SOBOL",
    "path.pathdepth.total": 1,
    "path.pathdepth.diffuse": 1,
    "path.pathdepth.glossy": 1,
    "path.pathdepth.specular": 1,
    "path.clamping.variance.maxvalue": 0.0,
    "film.filter.type": "NONE",
    "film.imagepipelines.0.0.type": "NOP",
    "film.outputs.0.type": "RGB",
    "film.outputs.0.filename": "none.exr",
}


def properties(values: JsonObject) -> LuxCore:
    result = pyluxcore.Properties()
    for name, value in values.items():
        result.Set(pyluxcore.Property(name, value))
    return result


def camera(size: int) -> JsonObject:
    """The square [-1, 1]^2 seen orthographically along -z.

    LuxCore counts rows from below and begins one row too high: its window is a pixel lower.
    """
    row = 2.0 / size
    return {
        "type": "orthographic",
        "lookat.orig": [0.0, 0.0, 2.0],
        "lookat.target": [0.0, 0.0, 0.0],
        "up": [0.0, 1.0, 0.0],
        "screenwindow": [-1.0, 1.0, -1.0 - row, 1.0 - row],
        "autovolume.enable": 0,
    }


def define(kind: str, values: JsonObject) -> LuxCore:
    return properties({f"scene.{kind}.{name}": value for name, value in values.items()})


def build(
    material: JsonObject, mesh: str, size: int, light: list[float] | None, environment: float | None
) -> LuxCore:
    data, scene = np.load(mesh), pyluxcore.Scene()
    vertices = [tuple(each) for each in data["vertices"].tolist()]
    triangles = [tuple(each) for each in data["triangles"].tolist()]
    scene.DefineMesh("polyhedron", vertices, triangles, None, None, None, None)
    scene.Parse(define("camera", camera(size)))
    scene.Parse(define("materials.material", material))
    scene.Parse(define("objects.object", {"shape": "polyhedron", "material": "material"}))
    if light is not None:
        sun = {"type": "sharpdistant", "direction": [-each for each in light]}
        scene.Parse(define("lights.light", {**sun, "gain": [math.pi] * 3, "color": [1.0] * 3}))
    if environment is not None:
        sky = {"type": "constantinfinite", "gain": [environment] * 3, "color": [1.0] * 3}
        scene.Parse(define("lights.environment", sky))
    return scene


def render(samples: int, size: int, **parts: Any) -> LuxCore:
    film = {"film.width": size, "film.height": size, "batch.haltspp": samples}
    session = pyluxcore.RenderSession(
        pyluxcore.RenderConfig(properties(RENDERER | film), build(size=size, **parts))
    )
    session.Start()
    while not session.HasDone():
        time.sleep(0.002)
        session.UpdateStats()
    session.Stop()
    pixels = np.zeros(size * size * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
    return pixels.reshape(size, size, 3)[::-1]


def main() -> None:
    pyluxcore.Init(lambda message: None)
    print(json.dumps({"version": pyluxcore.Version()}), file=REPLIES)
    for line in sys.stdin:
        request = json.loads(line)
        np.save(request.pop("output"), render(**request))
        print("{}", file=REPLIES)
    os._exit(0)  # its threads do not survive the end of Python


if __name__ == "__main__":
    main()
