# SPDX-License-Identifier: Apache-2.0
"""The row of subsurface scattering, as it is seen on a plane under a distant light.

There every point has the same light, so that the profile, whose integral is 1, changes nothing: the
node is Lambert of its color, whatever its radius and its anisotropy.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.namespaces import array_namespace
from mxeon.models.diffuse.brdf import lambert_brdf
from mxeon.models.nodes.node import PbrNode

STEPS = 32  # of the circle in MaterialX
FLATTEST = 100.0  # radius of it
LEAST_RADIUS = 0.1  # of the profile


def circle_blur(mu: Array, radius: Array, body: float = FLATTEST) -> Array:
    """Cosine of a light as MaterialX blurs it, along a circle through the light.

    `mu` (N,), `radius` (N, 3): mean free path. MaterialX takes `body`, the circle's radius, from the
    curvature, and at most 100.
    """
    theta = np.arccos(np.clip(mu, -1.0, 1.0))[:, np.newaxis]
    shape = 1.0 / np.maximum(radius, LEAST_RADIUS)
    turns = -np.pi + (np.arange(STEPS) + 0.5) * 2.0 * np.pi / STEPS
    light, total = np.zeros(radius.shape), np.zeros(radius.shape)
    for turn in turns:
        distance = body * abs(2.0 * np.sin(0.5 * turn))
        profile = (np.exp(-shape * distance) + np.exp(-shape * distance / 3.0)) / distance
        light += profile * np.maximum(np.cos(theta + turn), 0.0)
        total += profile
    return light / total


SUBSURFACE_NODE = PbrNode(
    "subsurface",
    "Subsurface scattering, which is Lambert on a plane",
    "subsurface_bsdf",
    ("color", "radius"),
    lambda wo, wi, inputs: lambert_brdf(wo, wi, inputs["color"]),
    lambda wo, inputs: array_namespace(wo).broadcast_to(inputs["color"], wo.shape),
)
