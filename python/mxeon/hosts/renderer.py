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
        """Picture of the unit sphere, or of the polyhedron, with a node of the renderer's own on it.

        Parameters
        ----------
        title : str
            Of the node.
        color : sequence of float
            Linear, per channel.
        roughness : float
        scene : Scene

        Returns
        -------
        ndarray, shape (size, size, 3)
            Linear radiance, row 0 at the top, 0 off the object.

        Raises
        ------
        Unsupported
            If the renderer has no such verb.
        NotRun
            If it cannot show the scene, or fails.
        ValueError
            If the scene asks for paths and their number is fixed.
        """
        raise self._unsupported("nodes of its own", "cycles-native")

    def pairs(
        self,
        title: str,
        wo: Array,
        wi: Array,
        color: Array,
        roughness: Array,
    ) -> Array:
        """Values of a node of the renderer's own for pairs of directions.

        Parameters
        ----------
        title : str
        wo, wi, color : ndarray, shape (N, 3)
            The directions are unit vectors, normal +z.
        roughness : ndarray, shape (N,)

        Returns
        -------
        ndarray, shape (N, 3)
            f cos(theta_i), in 1/sr.

        Raises
        ------
        Unsupported
            If the host has no such verb.
        """
        raise self._unsupported("values of its own nodes", "mitsuba")

    def sample(self, wo: Array, u: Array, roughness: Array) -> Array:
        """Directions to the light that the renderer draws for EON.

        Parameters
        ----------
        wo : ndarray, shape (N, 3)
            Unit vectors, normal +z.
        u : ndarray, shape (N, 2)
            Random numbers in [0, 1).
        roughness : ndarray, shape (N,)

        Returns
        -------
        ndarray, shape (N, 3)

        Raises
        ------
        Unsupported
            If the host has no such verb.
        """
        raise self._unsupported("sampling of its own", "three-gpu-pathtracer")

    def density(self, wo: Array, wi: Array, roughness: Array) -> Array:
        """Density in solid angle of the directions that `sample` draws, (N,); see there."""
        raise self._unsupported("density of its own", "three-gpu-pathtracer")
