# SPDX-License-Identifier: Apache-2.0
"""Babylon.js on two engines, with OpenPBRMaterial and with each diffuse model of PBRMaterial."""

from __future__ import annotations

import base64

from mxeon.errors import NotRun
from mxeon.shaders.document.graphs import surface_shader
from mxeon.shaders.generation import Shader
from mxeon.survey import browser
from mxeon.survey.specs import BOTH, COLOR, PUBLISHED, Material, node

PACKAGE, OPEN_PBR = "@babylonjs/core", "open_pbr_surface"
IMPORTS = {"@babylonjs/core/": "@babylonjs/core/"}
BACKENDS = {"WebGL2": "webgl", "WebGPU": "webgpu"}

# OpenPBRMaterial loads an image of blue noise for effects that are off here. This image of one gray
# texel replaces the blue noise.
ASSETS = {
    "https://assets.babylonjs.com/core/blue_noise/blue_noise_rgb.png": base64.b64decode(
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNoaGgAAAMEAYF1LgG8AAAAAElFTkSuQmCC"
    )
}

# Title, diffuse model in Babylon.js ("" for OpenPBRMaterial), expected model, inputs, forms.
MATERIALS = (
    ("PBRMaterial E_OREN_NAYAR", "E_OREN_NAYAR", "eon", BOTH, PUBLISHED),
    ("OpenPBRMaterial", "", "eon", BOTH, PUBLISHED),
    ("PBRMaterial BURLEY", "BURLEY", "burley", BOTH, ()),
    ("PBRMaterial LEGACY", "LEGACY", "burley_lambert", BOTH, ()),
    ("PBRMaterial LAMBERT", "LAMBERT", "lambert", COLOR, ()),
)
NODES = tuple(
    node(f"{title}, {name}", ours, browser.material(backend, model=model), ports, forms=forms)
    for title, model, ours, ports, forms in MATERIALS
    for name, backend in BACKENDS.items()
)


class BabylonHost(browser.ReadingHost):
    name, title, package = "babylon", "Babylon.js", PACKAGE
    imports, assets = IMPORTS, ASSETS

    def read(self, shader: Shader) -> Material:
        """The inputs of `open_pbr_surface`, with the camel-case names that OpenPBRMaterial has."""
        surface = surface_shader(shader.document, shader.element)
        if surface.getCategory() != OPEN_PBR:
            raise NotRun(f"babylon: it has no {surface.getCategory()}, only {OPEN_PBR}")
        values: dict[str, object] = {}
        for port in surface.getNodeDef().getActiveInputs():
            name, given = port.getName(), surface.getInput(port.getName())
            if given and given.getValue() is None:
                raise NotRun(f"babylon: {name} must be a value; it is connected")
            if (value := (given or port).getValue()) is not None:
                parts = name.split("_")
                key = parts[0] + "".join(map(str.title, parts[1:]))
                values[key] = tuple(value) if port.getType() in ("color3", "vector3") else value
        return {"backend": "webgl", "inputs": values}
