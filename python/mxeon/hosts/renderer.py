# SPDX-License-Identifier: Apache-2.0
"""The base class of renderers whose own materials are judged: fewer verbs than those of a host."""

from __future__ import annotations

from collections.abc import Sequence

from mxeon.hosts.base import Array, Engine
from mxeon.shaders.scene import Scene


class RendererHost(Engine):
    """A renderer with materials of its own, for which nothing is generated.

    A caller may rely on this: `node` shows one of these materials by its title, with the color and
    the roughness of the call and nothing else above its diffuse lobe; a verb that a renderer lacks
    raises `Unsupported`. It reads no document.
    """

    def node(self, title: str, color: Sequence[float], roughness: float, scene: Scene) -> Array:
        """Picture of the sphere or the polyhedron with one of `mxeon.hosts.Row.nodes` on it; see `Host.picture`."""
        raise self._unsupported("nodes of its own", "cycles-native")

    def pairs(
        self,
        title: str,
        wo: Array,
        wi: Array,
        color: Array,
        roughness: Array,
    ) -> Array:
        """f cos(theta_i) of a node of the renderer's own, (N, 3) in 1/sr, for unit vectors with normal +z."""
        raise self._unsupported("values of its own nodes", "mitsuba")

    def sample(self, wo: Array, u: Array, roughness: Array) -> Array:
        """Directions to the light (N, 3) that the renderer draws for EON from u (N, 2) in [0, 1)."""
        raise self._unsupported("sampling of its own", "three-gpu-pathtracer")

    def density(self, wo: Array, wi: Array, roughness: Array) -> Array:
        """Density in solid angle of the directions that `sample` draws, (N,); see there."""
        raise self._unsupported("density of its own", "three-gpu-pathtracer")
