# SPDX-License-Identifier: Apache-2.0
"""Host for three.js, with MeshPhysicalMaterial in two renderers and with MaterialXLoader."""

from __future__ import annotations

from collections.abc import Sequence

import MaterialX as mx

from mxeon.hosts.base import Array
from mxeon.shaders.generation import Shader
from mxeon.shaders.nodes import document_text, input_text, node_text
from mxeon.shaders.scene import Scene
from mxeon.survey import browser
from mxeon.survey.specs import PUBLISHED, Material, node

PACKAGE = "three"
IMPORTS = {
    "three": "three/build/three.module.js",
    "three/webgpu": "three/build/three.webgpu.js",
    "three/tsl": "three/build/three.tsl.js",
    "three/addons/": "three/examples/jsm/",
}

# Names of three inputs by category: color, roughness, and weight of lobes above the diffuse lobe.
INPUTS = {
    "open_pbr_surface": ("base_color", "base_diffuse_roughness", "specular_weight"),
    "standard_surface": ("base_color", "diffuse_roughness", "specular"),
}
# OpenPBR specifies the model EON, and Standard Surface specifies the Oren-Nayar model.
NODES = (
    node("MeshPhysicalMaterial, WebGLRenderer", "eon", browser.material("webgl"), forms=PUBLISHED),
    node(
        "MeshPhysicalMaterial, WebGPURenderer", "eon", browser.material("webgpu"), forms=PUBLISHED
    ),
    node(
        "open_pbr_surface, MaterialXLoader",
        "eon",
        browser.material("webgpu", category="open_pbr_surface"),
        forms=PUBLISHED,
    ),
    node(
        "standard_surface, MaterialXLoader",
        "qon",
        browser.material("webgpu", category="standard_surface"),
    ),
)


class ThreeHost(browser.ReadingHost):
    name = title = package = PACKAGE
    imports = IMPORTS

    def read(self, shader: Shader) -> Material:
        text = mx.writeToXmlString(shader.document)
        return {"backend": "webgpu", "document": text, "element": shader.element}

    def node(self, material: Material, scene: Scene) -> Array:
        if "category" not in material:
            return super().node(material, scene)
        return super().node({**material, "document": document(**material)}, scene)


def document(category: str, color: Sequence[float], roughness: float, backend: str) -> str:
    """MaterialX text of a material that has only a diffuse lobe."""
    color_input, roughness_input, weight_input = INPUTS[category]
    text = input_text(color_input, "color3", color)
    text += input_text(roughness_input, "float", roughness)
    text += input_text(weight_input, "float", 0.0)
    return document_text(node_text(category, "surfaceshader", "shading", text))
