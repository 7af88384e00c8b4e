# SPDX-License-Identifier: Apache-2.0
"""Babylon.js: its PBRMaterial with each diffuse model, and its OpenPBRMaterial, on two engines."""

from __future__ import annotations

import base64
from collections.abc import Sequence

from mxeon.hosts import browser
from mxeon.hosts.base import Array
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


class Host(browser.PackageHost):
    name, title, package = "babylon", "Babylon.js", PACKAGE
    imports, assets = IMPORTS, ASSETS

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        backend, model = NODES[title]
        return self._draw(color, roughness, scene, backend=backend, model=model)
