# SPDX-License-Identifier: Apache-2.0
"""Babylon.js: its PBRMaterial with each diffuse model, and its OpenPBRMaterial, on two engines."""

from __future__ import annotations

import base64

from mxeon.survey import browser
from mxeon.survey.specs import BOTH, COLOR, PUBLISHED, node

PACKAGE = "@babylonjs/core"
IMPORTS = {"@babylonjs/core/": "@babylonjs/core/"}
BACKENDS = {"WebGL2": "webgl", "WebGPU": "webgpu"}

# OpenPBRMaterial loads blue noise for effects that are off here; one gray texel replaces it.
ASSETS = {
    "https://assets.babylonjs.com/core/blue_noise/blue_noise_rgb.png": base64.b64decode(
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNoaGgAAAMEAYF1LgG8AAAAAElFTkSuQmCC"
    )
}

# Title, Babylon.js's diffuse model (OpenPBRMaterial has only one), our model, inputs and forms.
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


class BabylonHost(browser.PackageHost):
    name, title, package = "babylon", "Babylon.js", PACKAGE
    imports, assets = IMPORTS, ASSETS
