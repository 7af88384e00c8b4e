# SPDX-License-Identifier: Apache-2.0
"""The NumPy models as a host, in float64: the reference of every other host."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance.reference.graph import Graph, Lobe
from mxeon.errors import NotRun
from mxeon.models import table
from mxeon.shaders import hosts
from mxeon.shaders.generation import Shader
from mxeon.shaders.hosts import base
from mxeon.shaders.hosts.base import Identity
from mxeon.shaders.scene import VIEW, Scene, sphere, sphere_directions

# Any target will do: the document behind the shader is what is evaluated.
ROW = hosts.Row("reference", target="glsl", module=__name__)


class Host(base.Host):
    """The models of `mxeon.models.table`."""

    name = ROW.name
    target = ROW.target

    def identity(self) -> Identity:
        """Version of NumPy."""
        return Identity(self.name, f"NumPy {np.__version__}", "CPU, float64")

    def picture(self, shader: Shader, scene: Scene) -> NDArray[np.float64]:
        """Picture of the sphere with the shader's document on it; see `mxeon.shaders.hosts.base.Host`.

        Raises
        ------
        NotRun
            If the material has lobes that the models do not cover, or the light is an image.
        """
        points = sphere(scene.size)
        normal, texcoord = points.normal[points.mask], points.texcoord[points.mask]
        if scene.light is not None:
            wo, wi = (sphere_directions(scene.size, each) for each in (VIEW, scene.light))
            lobe = _lit(wo, wi, np.pi)
        elif isinstance(scene.environment, float):
            lobe = _furnace(normal[:, 2], scene.environment)
        else:
            raise NotRun("reference: environment must be uniform; got an image")
        image = np.zeros(points.normal.shape)
        image[points.mask] = Graph(shader.document, texcoord, lobe).element(shader.element)
        return image

    def evaluate(
        self,
        shader: Shader,
        wo: NDArray[Any],
        wi: NDArray[Any],
        inputs: Mapping[str, Any],
        branch: str,
        *,
        output: str = "response",
        irradiance: NDArray[Any] | None = None,
    ) -> NDArray[np.float64]:
        """Values of the document's one lobe; see `mxeon.shaders.hosts.base.Host`.

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
        lobe = _furnace(wo[:, 2], 1.0) if branch == "environment" else _lit(wo, wi, 1.0)
        values: NDArray[np.float64] = Graph(shader.document, None, lobe, inputs).element(
            shader.element
        )
        return values


def _lit(wo: NDArray[Any], wi: NDArray[Any], irradiance: float) -> Lobe:
    """Lobe under a distant light: its irradiance times f cos(theta_i), 0 below the horizon."""
    lit = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0)

    def lobe(name: str, rho: ArrayLike, parameter: ArrayLike) -> NDArray[np.float64]:
        value = np.zeros((len(wo), 3))
        rho = np.broadcast_to(rho, value.shape)[lit]
        parameter = np.broadcast_to(parameter, len(wo))[lit]
        brdf = table.model(name).brdf(wo[lit], wi[lit], rho, parameter)
        value[lit] = irradiance * brdf * wi[lit, 2:]
        return value

    return lobe


def _furnace(mu: NDArray[Any], radiance: float) -> Lobe:
    """Lobe in a uniform environment: its directional albedo."""

    def lobe(name: str, rho: ArrayLike, parameter: ArrayLike) -> NDArray[np.float64]:
        return radiance * table.model(name).closed_albedo_dir(mu, rho, parameter)

    return lobe
