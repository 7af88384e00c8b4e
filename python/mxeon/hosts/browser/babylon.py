# SPDX-License-Identifier: Apache-2.0
"""Babylon.js: its PBRMaterial with each diffuse model, and its OpenPBRMaterial, on two engines."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from pathlib import Path

from mxeon.hosts import browser
from mxeon.hosts.base import Array, Identity, RendererHost
from mxeon.shaders.scene import Scene

PACKAGE = "@babylonjs/core"
IMPORTS = {"@babylonjs/core/": "@babylonjs/core/"}
BACKENDS = {"WebGL2": "webgl", "WebGPU": "webgpu"}

# OpenPBRMaterial loads blue noise for effects that are off here; one gray texel takes its place.
ASSETS = {
    "https://assets.babylonjs.com/core/blue_noise/blue_noise_rgb.png": base64.b64decode(
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNoaGgAAAMEAYF1LgG8AAAAAElFTkSuQmCC"
    )
}

# Materials -> the name of the diffuse model in Babylon.js; OpenPBRMaterial has no choice.
MODELS = {
    "PBRMaterial E_OREN_NAYAR": "E_OREN_NAYAR",
    "PBRMaterial BURLEY": "BURLEY",
    "PBRMaterial LAMBERT": "LAMBERT",
    "PBRMaterial LEGACY": "LEGACY",
    "OpenPBRMaterial": "",
}
# Title of a node -> backend and diffuse model.
NODES = {
    f"{material}, {name}": (backend, model)
    for material, model in MODELS.items()
    for name, backend in BACKENDS.items()
}


class Host(RendererHost):
    """Babylon.js in a headless Chromium."""

    name = "babylon"

    def __init__(self, limit: float = browser.LIMIT) -> None:
        modules = browser.modules_folder(PACKAGE, self.name)
        self._version = browser.package_version(modules, PACKAGE)
        page = Path(__file__).with_suffix(".js")
        self._browser = browser.Browser(
            self.name, page, IMPORTS, modules, assets=ASSETS, limit=limit
        )

    def identity(self) -> Identity:
        answers = [self._browser.ask({"backend": backend}) for backend in BACKENDS.values()]
        version = f"Babylon.js {self._version}, Chromium {answers[0]['browser']}"
        return Identity(self.name, version, "; ".join(answer["device"] for answer in answers))

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        self.refuse_paths(scene)
        backend, model = NODES[title]
        job = {
            "backend": backend,
            "model": model,
            "color": [float(channel) for channel in color],
            "roughness": float(roughness),
            "size": scene.size,
            "light": scene.light,
            "irradiance": math.pi,
            "environment": scene.environment,
        }
        return self._browser.picture(job, scene.size)

    def close(self) -> None:
        self._browser.close()
