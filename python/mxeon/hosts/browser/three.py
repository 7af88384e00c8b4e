# SPDX-License-Identifier: Apache-2.0
"""three.js: its MeshPhysicalMaterial in two renderers, and the materials that it loads."""

from __future__ import annotations

from collections.abc import Sequence

from mxeon.hosts import browser
from mxeon.hosts.base import Array
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


class Host(browser.PackageHost):
    name = title = package = PACKAGE
    imports = IMPORTS

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        backend, category = NODES[title]
        text = document(category, color, roughness) if category else None
        return self._draw(color, roughness, scene, backend=backend, document=text)


def document(category: str, color: Sequence[float], roughness: float) -> str:
    """MaterialX text of a material of a category with its diffuse lobe alone."""
    color_input, roughness_input, others = INPUTS[category]
    text = input_text(color_input, "color3", [float(channel) for channel in color])
    text += input_text(roughness_input, "float", float(roughness))
    text += input_text(others, "float", 0.0)
    return document_text(node_text(category, "surfaceshader", "shading", text))
