# SPDX-License-Identifier: Apache-2.0
"""Functions of Blender's Cycles, as variants of the nodes whose closures it makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.defects import SINGLE
from mxeon.models.microfacet.missing import missing_light
from mxeon.models.nodes.bsdl import gray
from mxeon.models.nodes.lobes import untinted
from mxeon.models.nodes.microfacets import (
    CONDUCTOR,
    DIELECTRIC,
    SCHLICK,
    BareLobe,
    isotropic,
    undipped,
)
from mxeon.models.nodes.node import Inputs, Scattering, Variant
from mxeon.models.sheen import zeltner_albedo_dir

LOSSLESS = "the largest channel of the albedo of facets that lose no light"


def _lobe(category: str, wo: Array, wi: Array, inputs: Inputs) -> Array:
    """Values of a microfacet node."""
    return SINGLE.value(category, wo, wi, inputs)


def _schlick(wo: Array, wi: Array, inputs: Inputs) -> Array:
    return _lobe("generalized_schlick_bsdf", wo, wi, undipped(inputs))


def _single(lobe: BareLobe, wo: Array, inputs: Inputs) -> Array:
    """Albedo of single scattering, at the geometric mean of both alphas."""
    return np.asarray(lobe.albedo(wo, isotropic(inputs), compensate=False))


def _single_schlick(wo: Array, inputs: Inputs) -> Array:
    return _single(SCHLICK, wo, undipped(inputs))


def _largest(albedo: Array) -> Array:
    """The largest channel of an albedo, in every channel."""
    return np.broadcast_to(albedo.max(axis=-1, keepdims=True), albedo.shape)


def _lossless(lobe: BareLobe, wo: Array, inputs: Inputs) -> Array:
    """Albedo of single scattering over that of facets that reflect everything."""
    alpha = isotropic(inputs)["roughness"][:, 0]
    missing = missing_light(wo[:, 2], alpha)[:, np.newaxis]
    return _largest(_single(lobe, wo, inputs) * (1.0 + missing))


def _dielectric_albedo(wo: Array, inputs: Inputs) -> Array:
    """Such an albedo; of an index below 1 that of a smooth surface."""
    smooth = DIELECTRIC.fresnel(np.minimum(wo[:, 2], 1.0), inputs) * inputs["tint"]
    rough = _lossless(DIELECTRIC, wo, inputs)
    return np.where(np.reshape(inputs["ior"], (-1, 1)) > 1.0, rough, _largest(smooth))


def _schlick_albedo(wo: Array, inputs: Inputs) -> Array:
    return _lossless(SCHLICK, wo, undipped(inputs))


def _sheen_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of the Zeltner sheen, whose color counts twice; its largest channel."""
    squared = {**inputs, "color": np.square(inputs["color"])}
    return gray(untinted(zeltner_albedo_dir), wo, squared)


SHEEN: Variant[Scattering] = Variant(
    "the largest channel of the Zeltner sheen's albedo, with the color squared",
    albedo=_sheen_albedo,
)
# By the name of the node's row.
CYCLES_VARIANTS: Mapping[str, tuple[Variant[Scattering], ...]] = {
    "dielectric": (
        Variant(SINGLE.title, partial(_lobe, "dielectric_bsdf"), partial(_single, DIELECTRIC)),
        Variant(LOSSLESS, albedo=_dielectric_albedo),
    ),
    "conductor": (
        Variant(SINGLE.title, partial(_lobe, "conductor_bsdf"), partial(_single, CONDUCTOR)),
    ),
    "schlick": (
        Variant(f"{SINGLE.title}, and color82 counts as 1", _schlick, _single_schlick),
        Variant(f"{LOSSLESS}, and color82 counts as 1", albedo=_schlick_albedo),
    ),
    "conty_kulla": (SHEEN,),
    "zeltner": (SHEEN,),
}
