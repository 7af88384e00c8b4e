# SPDX-License-Identifier: Apache-2.0
"""The NumPy models as a host, in float64: the reference of every other host."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon import hosts
from mxeon.conformance.reference.graph import Graph
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.errors import NotRun
from mxeon.hosts import base
from mxeon.hosts.base import Identity
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import VIEW, Scene, sphere, tangents

SCENES = 4  # whose points are kept: the pictures of a run have as many

# Any target will do: the document behind the shader is what is evaluated.
ROW = hosts.Row("reference", target="glsl", module=__name__)


class Host(base.Host):
    """The models of `mxeon.models.table` and the nodes of `mxeon.models.nodes`."""

    name = ROW.name
    target = ROW.target

    def identity(self) -> Identity:
        """Version of NumPy."""
        return Identity(self.name, f"NumPy {np.__version__}", "CPU, float64")

    def picture(self, shader: Shader, scene: Scene) -> NDArray[np.float64]:
        """Picture of the sphere with the shader's document on it; see `mxeon.hosts.base.Host`.

        Raises
        ------
        NotRun
            If the material has lobes that the models do not cover, or the light is an image.
        ValueError
            If the scene asks for paths.
        """
        self.refuse_paths(scene)
        self.refuse_shape(scene)
        points = sphere(scene.size)
        image = np.zeros(points.normal.shape)
        image[points.mask] = Graph(shader.document, _shown(scene)).element(shader.element)
        return image

    def evaluate(
        self,
        shader: Shader,
        wo: NDArray[np.float64],
        wi: NDArray[np.float64],
        inputs: Mapping[str, ArrayLike],
        branch: str,
        *,
        output: str = "response",
        irradiance: NDArray[np.floating] | None = None,
    ) -> NDArray[np.float64]:
        """Values of the document's lobes; see `mxeon.hosts.base.Host`.

        Raises
        ------
        NotRun
            Unless the response to a light or to a uniform environment is asked for.
        """
        if (
            output != "response"
            or irradiance is not None
            or branch not in ("direct", "environment")
        ):
            raise NotRun(
                "reference: only the response to a light or a uniform environment is known"
            )
        normal, tangent = (np.broadcast_to(axis, wo.shape) for axis in ((0, 0, 1.0), (1.0, 0, 0)))
        points = ShadingPoints(wo, wi if branch == "direct" else None, 1.0, normal, tangent)
        values = Graph(shader.document, points, inputs, emits=False).element(shader.element)
        return np.array(np.broadcast_to(values, wo.shape), np.float64)


@lru_cache(maxsize=SCENES)
def _shown(scene: Scene) -> ShadingPoints:
    """The points that a picture shows, and the light at them.

    Raises
    ------
    NotRun
        If the light is an image.
    """
    points = sphere(scene.size)
    normal, texcoord = points.normal[points.mask], points.texcoord[points.mask]
    if scene.light is not None:
        wi, strength = np.broadcast_to(scene.light, normal.shape), np.pi
    elif isinstance(scene.environment, float):
        wi, strength = None, scene.environment
    else:
        raise NotRun("reference: environment must be uniform; got an image")
    wo = np.broadcast_to(VIEW, normal.shape)
    return ShadingPoints(wo, wi, strength, normal, tangents(normal), texcoord)
