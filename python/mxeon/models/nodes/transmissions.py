# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's nodes that transmit through microfacets: scatter modes T and RT.

A rasterizer has no light behind the surface. It looks up an environment instead, so that what can be
promised of it is the share of the light that passes, and where from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.nodes.microfacets import DIELECTRIC, MICROFACET_NODES, SCHLICK
from mxeon.models.nodes.node import Inputs, PbrNode
from mxeon.models.transmission.btdf import dielectric_btdf
from mxeon.models.transmission.schlick import (
    generalized_schlick_btdf,
    generalized_schlick_transmittance_dir,
    schlick_ior,
)
from mxeon.models.transmission.transmittance import dielectric_transmittance_dir

MODES = ("T", "RT")


@dataclass(frozen=True)
class Transmission:
    """Functions of a node that transmits, by its inputs.

    - `passed`: Share of the light from wo that the BTDF transmits, with its tint; without `shadow`,
      the mean of 1 - F over the facets that wo sees.
    - `reflected`: Directional albedo of the reflection with its energy compensation, without a
      tint.
    """

    value: Callable[[Array, Array, Inputs], Array]  # BTDF of radiance, with its tint
    passed: Callable[[Array, Inputs, bool], Array]
    reflected: Callable[[Array, Inputs], Array]
    tint: Callable[[Inputs], Array]
    fresnel: Callable[[Array, Inputs], Array]
    ior: Callable[[Inputs], Array]  # index of refraction that refracts the view


def _white(inputs: Inputs) -> dict[str, Array]:
    return {**inputs, "tint": np.ones(3)}


TRANSMISSIONS = {
    DIELECTRIC.category: Transmission(
        lambda wo, wi, i: dielectric_btdf(wo, wi, i["tint"], i["roughness"], i["ior"]),
        lambda wo, i, shadow: dielectric_transmittance_dir(
            wo, i["tint"], i["roughness"], i["ior"], shadow
        ),
        lambda wo, i: DIELECTRIC.albedo(wo, _white(i)),
        lambda i: i["tint"],
        DIELECTRIC.fresnel,
        lambda i: i["ior"],
    ),
    SCHLICK.category: Transmission(
        lambda wo, wi, i: generalized_schlick_btdf(
            wo, wi, i["color0"], i["color82"], i["color90"], i["roughness"], i["exponent"]
        ),
        lambda wo, i, shadow: generalized_schlick_transmittance_dir(
            wo,
            i["color0"],
            i["color82"],
            i["color90"],
            i["roughness"],
            i["exponent"],
            shadow=shadow,
        ),
        SCHLICK.albedo,
        lambda i: 0.0 * i["color0"] + 1.0,
        SCHLICK.fresnel,
        lambda i: schlick_ior(i["color0"])[..., 0],
    ),
}


def _transmitting(row: PbrNode, mode: str) -> PbrNode:
    """A row of a node in another scatter mode."""
    return replace(row, name=f"{row.name}_{mode.lower()}", fixed={"scatter_mode": mode})


TRANSMISSION_NODES = tuple(
    _transmitting(row, mode)
    for row in MICROFACET_NODES
    if row.category in TRANSMISSIONS
    for mode in MODES
)
