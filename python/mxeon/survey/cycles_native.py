# SPDX-License-Identifier: Apache-2.0
"""Blender's own nodes in Cycles, without OSL and MaterialX."""

from __future__ import annotations

from mxeon.hosts import cycles
from mxeon.hosts.base import Array, Engine, Identity
from mxeon.shaders.scene import Scene
from mxeon.survey.specs import Material, node

# Type and sockets of each node in Blender, with values for which only the diffuse lobe remains.
MATERIALS: dict[str, Material] = {
    "Diffuse BSDF": {
        "kind": "ShaderNodeBsdfDiffuse",
        "Color": "{color}",
        "Roughness": "{roughness}",
    },
    "Principled BSDF": {
        "kind": "ShaderNodeBsdfPrincipled",
        "Base Color": "{color}",
        "Diffuse Roughness": "{roughness}",
        "Specular IOR Level": 0.0,
    },
}
NODES = tuple(node(title, "eon", material) for title, material in MATERIALS.items())


class CyclesNativeHost(Engine):
    name = "cycles-native"

    def __init__(self) -> None:
        self._cycles = cycles.CyclesHost()

    def identity(self) -> Identity:
        return Identity(self.name, self._cycles.identity().version, "CPU, SVM")

    def node(self, material: Material, scene: Scene) -> Array:
        sockets = {
            name: (*value, 1.0) if isinstance(value, tuple) else value
            for name, value in material.items()
            if name != "kind"
        }
        return self._cycles.blender_node(material["kind"], sockets, scene)

    def close(self) -> None:
        self._cycles.close()
