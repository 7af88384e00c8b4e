# SPDX-License-Identifier: Apache-2.0
"""three.js: its MeshPhysicalMaterial in two renderers, and the materials that it loads."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from mxeon.hosts import browser
from mxeon.hosts.base import Array, Identity, RendererHost
from mxeon.shaders.nodes import document_text, input_text, node_text
from mxeon.shaders.scene import Scene

PACKAGE = "three"
IMPORTS = {
    "three": "three/build/three.module.js",
    "three/webgpu": "three/build/three.webgpu.js",
    "three/tsl": "three/build/three.tsl.js",
    "three/addons/": "three/examples/jsm/",
}

# Title of a node -> backend, and the category of the node of a document, or "" for no document.
NODES = {
    "MeshPhysicalMaterial, WebGLRenderer": ("webgl", ""),
    "MeshPhysicalMaterial, WebGPURenderer": ("webgpu", ""),
    "open_pbr_surface, MaterialXLoader": ("webgpu", "open_pbr_surface"),
    "standard_surface, MaterialXLoader": ("webgpu", "standard_surface"),
}
# Category -> its inputs for color and roughness, and what switches all but its diffuse lobe off.
INPUTS = {
    "open_pbr_surface": ("base_color", "base_diffuse_roughness", "specular_weight"),
    "standard_surface": ("base_color", "diffuse_roughness", "specular"),
}


class Host(RendererHost):
    """three.js in a headless Chromium."""

    name = "three"

    def __init__(self, limit: float = browser.LIMIT) -> None:
        modules = browser.modules_folder(PACKAGE, self.name)
        self._version = browser.package_version(modules, PACKAGE)
        page = Path(__file__).with_suffix(".js")
        self._browser = browser.Browser(self.name, page, IMPORTS, modules, limit=limit)

    def identity(self) -> Identity:
        answers = [self._browser.ask({"backend": backend}) for backend in ("webgl", "webgpu")]
        version = f"three {self._version}, Chromium {answers[0]['browser']}"
        return Identity(self.name, version, "; ".join(answer["device"] for answer in answers))

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        self.refuse_paths(scene)
        backend, category = NODES[title]
        job = {
            "backend": backend,
            "color": [float(channel) for channel in color],
            "roughness": float(roughness),
            "size": scene.size,
            "light": scene.light,
            "irradiance": math.pi,
            "environment": scene.environment,
            "document": document(category, color, roughness) if category else None,
        }
        return self._browser.picture(job, scene.size)

    def close(self) -> None:
        self._browser.close()


def document(category: str, color: Sequence[float], roughness: float) -> str:
    """MaterialX text of a material of a category with its diffuse lobe alone."""
    color_input, roughness_input, others = INPUTS[category]
    text = input_text(color_input, "color3", [float(channel) for channel in color])
    text += input_text(roughness_input, "float", float(roughness))
    text += input_text(others, "float", 0.0)
    return document_text(node_text(category, "surfaceshader", "shading", text))
