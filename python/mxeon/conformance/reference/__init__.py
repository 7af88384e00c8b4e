# SPDX-License-Identifier: Apache-2.0
"""The NumPy models as a host like the others, in float64: what every other host is compared with."""

import numpy as np

from mxeon.conformance.reference.graph import Graph
from mxeon.errors import NotRun
from mxeon.models import table as reference
from mxeon.shaders import hosts
from mxeon.shaders.hosts import base
from mxeon.shaders.hosts.base import Identity
from mxeon.shaders.scene import VIEW, local_directions, sphere

# Any target will do: the document behind the shader is what is evaluated.
ROW = hosts.Row("reference", target="glsl", module=__name__)


class Host(base.Host):
    """The models of `mxeon.models.table`."""

    name = ROW.name
    target = ROW.target

    def identity(self):
        """NumPy's version."""
        return Identity(self.name, f"NumPy {np.__version__}", "CPU, float64")

    def picture(self, shader, scene):
        """The document behind the shader, on the sphere; see `mxeon.shaders.hosts`.

        Raises
        ------
        NotRun
            If the material has lobes that the models do not cover, or the light is an image.
        """
        points = sphere(scene.size)
        normal, texcoord = points.normal[points.mask], points.texcoord[points.mask]
        if scene.light is not None:
            wi = local_directions(normal, scene.light)
            lobe = _lit(local_directions(normal, VIEW), wi, np.pi)
        elif isinstance(scene.environment, float):
            lobe = _furnace(normal[:, 2], scene.environment)
        else:
            raise NotRun("reference: the surrounding must be uniform, or the light distant")
        image = np.zeros(points.normal.shape)
        image[points.mask] = Graph(shader.document, texcoord, lobe).element(shader.element)
        return image

    def evaluate(self, shader, wo, wi, inputs, branch):
        """The one lobe of the document for pairs of directions; see `mxeon.shaders.hosts`."""
        lobe = _furnace(wo[:, 2], 1.0) if branch == "environment" else _lit(wo, wi, 1.0)
        return Graph(shader.document, None, lobe, inputs).element(shader.element)


def _lit(wo, wi, irradiance):
    """Lobe under a distant light: its irradiance times f cos(theta_i), 0 below the horizon."""
    lit = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0)

    def lobe(name, rho, parameter):
        value = np.zeros((len(wo), 3))
        rho = np.broadcast_to(rho, value.shape)[lit]
        parameter = np.broadcast_to(parameter, len(wo))[lit]
        brdf = reference.model(name).brdf(wo[lit], wi[lit], rho, parameter)
        value[lit] = irradiance * brdf * wi[lit, 2:]
        return value

    return lobe


def _furnace(mu, radiance):
    """Lobe in a uniform surrounding: its directional albedo."""

    def lobe(name, rho, parameter):
        return radiance * reference.model(name).albedo_dir(mu, rho, parameter)

    return lobe
