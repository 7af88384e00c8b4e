# SPDX-License-Identifier: Apache-2.0
"""Blender's own nodes: Cycles without OSL, and without MaterialX."""

from __future__ import annotations

from collections.abc import Sequence

from mxeon.hosts import cycles
from mxeon.hosts.base import Array, Identity, RendererHost
from mxeon.shaders.scene import Scene

# Title of a node -> Blender's type, its sockets for color and roughness, and what switches all
# but its diffuse lobe off.
NODES: dict[str, tuple[str, str, str, dict[str, float]]] = {
    "Diffuse BSDF": ("ShaderNodeBsdfDiffuse", "Color", "Roughness", {}),
    "Principled BSDF": (
        "ShaderNodeBsdfPrincipled",
        "Base Color",
        "Diffuse Roughness",
        {"Specular IOR Level": 0.0},
    ),
}


class Host(RendererHost):
    name = "cycles-native"

    def __init__(self) -> None:
        self._cycles = cycles.Host()

    def identity(self) -> Identity:
        return Identity(self.name, self._cycles.identity().version, "CPU, SVM")

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        kind, color_socket, roughness_socket, fixed = NODES[title]
        inputs: dict[str, cycles.Socket] = {
            color_socket: (*color, 1.0),
            roughness_socket: roughness,
            **fixed,
        }
        return self._cycles.blender_node(kind, inputs, scene)

    def close(self) -> None:
        self._cycles.close()
