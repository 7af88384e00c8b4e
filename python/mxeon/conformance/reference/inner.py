# SPDX-License-Identifier: Apache-2.0
"""Lobes that send light below the surface, and hair, as a picture of the unit sphere has them.

A rasterizer has no light behind a surface: what is transmitted of a uniform environment is all that is not
reflected, and of a distant light nothing. Subsurface scattering spreads light over the sphere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from mxeon.conformance.reference.operations import Operation, Values
from mxeon.models.core.layering import Bsdf
from mxeon.models.media.subsurface import diffusion_blur
from mxeon.models.media.volume import transmittance
from mxeon.models.nodes.hair import HAIR_NODE
from mxeon.models.nodes.media import METER
from mxeon.models.nodes.microfacets import isotropic
from mxeon.models.nodes.node import Inputs, PbrNode
from mxeon.models.nodes.subsurface import SUBSURFACE_NODE
from mxeon.models.nodes.transmissions import TRANSMISSION_NODES, TRANSMISSIONS

COSINES = np.linspace(-1.0, 1.0, 1025)  # of the light, between which its blur is straight
REACHES = (1e-6, 1e3)  # of mean free paths, over the radius of the sphere


def _dark(wo: Values, *_: object) -> Values:
    return np.zeros(wo.shape)


def _not_reflected(category: str, wo: Values, inputs: Inputs) -> Values:
    """Share of a uniform environment that passes microfacets."""
    functions = TRANSMISSIONS[category]
    rest = 1.0 - functions.reflected(wo, isotropic(inputs))
    return np.asarray(functions.tint(inputs) * np.maximum(rest, 0.0))


def _transmitting(row: PbrNode) -> PbrNode:
    """Row of a node in a scatter mode, of which T reflects nothing."""
    if row.fixed["scatter_mode"] == "RT":
        return row
    return replace(row, value=_dark, albedo=_dark, integral=_dark)


def _spread(wo: Values, wi: Values, inputs: Inputs) -> Values:
    """Radiance of subsurface scattering over the irradiance of a distant light."""
    # The mean free path of isotropic scattering.
    count = len(wi)
    forward = np.broadcast_to(inputs["anisotropy"], (count,))[:, np.newaxis]
    radius = np.broadcast_to(inputs["radius"], (count, 3))
    reach = np.clip(radius / np.maximum(1.0 - forward, 1e-3), *REACHES)
    mu = np.clip(wi[:, 2], -1.0, 1.0)
    if np.ptp(reach, axis=0).any():
        light = np.stack([diffusion_blur(mu, each) for each in reach.T], axis=-1)
    else:
        light = np.stack([np.interp(mu, COSINES, _blur(each)) for each in reach[0]], axis=-1)
    return np.asarray(inputs["color"] / np.pi * light)


@lru_cache(maxsize=64)
def _blur(reach: float) -> Values:
    """The blurred cosine at COSINES."""
    return diffusion_blur(COSINES, reach)


# Share of a uniform environment that is transmitted, by the name of a row.
LET_THROUGH: dict[str, Callable[[Values, Inputs], Values]] = {
    row.name: partial(_not_reflected, row.category) for row in TRANSMISSION_NODES
}
# Radiance over irradiance of what takes light from all sides, without a cosine.
AROUND: dict[str, Callable[[Values, Values, Inputs], Values]] = {
    SUBSURFACE_NODE.category: _spread,
    HAIR_NODE.category: HAIR_NODE.value,
}
INNER_NODES = (
    *map(_transmitting, TRANSMISSION_NODES),
    replace(SUBSURFACE_NODE, inputs=("color", "radius", "anisotropy")),
    HAIR_NODE,
)
# Nodes of a volume below a layer, by the light that passes them.
VOLUMES: dict[str, Operation] = {
    "absorption_vdf": (("absorption",), lambda a: transmittance(a, 0.0, METER)),
    "anisotropic_vdf": (("absorption", "scattering"), lambda a, s: transmittance(a, s, METER)),
}


def over_volume(top: Bsdf, medium: Values | None) -> Bsdf:
    """A layer over a volume, for light that is transmitted."""
    passed = 1.0 if medium is None else medium
    return Bsdf(top.value * passed, top.throughput * passed)
