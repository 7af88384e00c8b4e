# SPDX-License-Identifier: Apache-2.0
"""Blender's own nodes as a renderer to judge: Cycles without OSL, and without MaterialX."""

from mxeon.errors import NotRun
from mxeon.shaders.hosts import cycles
from mxeon.shaders.hosts.base import Identity

# Title of a node -> Blender's type, its sockets for color and roughness, and what switches all
# but its diffuse lobe off.
NODES = {
    "Diffuse BSDF": ("ShaderNodeBsdfDiffuse", "Color", "Roughness", {}),
    "Principled BSDF": (
        "ShaderNodeBsdfPrincipled",
        "Base Color",
        "Diffuse Roughness",
        {"Specular IOR Level": 0.0},
    ),
}


class Host:
    """Blender's Cycles with its own shading nodes.

    Raises
    ------
    NotRun
        If no interpreter with Blender is found.
    """

    name = "cycles-native"
    target = "osl"  # of its sibling: nothing is generated for this host
    profile = None

    def __init__(self):
        self._cycles = cycles.Host()

    def identity(self):
        """Name and version; the device is always the CPU."""
        return Identity(self.name, self._cycles.identity().version, "CPU, SVM")

    def node(self, title, color, roughness, scene):
        """The unit sphere wearing one of NODES; see `mxeon.shaders.hosts.cycles.Host.node`."""
        kind, color_socket, roughness_socket, fixed = NODES[title]
        inputs = {color_socket: (*color, 1.0), roughness_socket: roughness, **fixed}
        return self._cycles.node(kind, inputs, scene)

    def picture(self, shader, scene):
        """Nothing: this host knows no generated shader.

        Raises
        ------
        NotRun
            Always.
        """
        raise NotRun("cycles-native: Blender's own nodes run no generated shader")

    def close(self):
        """End the process."""
        self._cycles.close()
