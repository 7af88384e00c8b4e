# SPDX-License-Identifier: Apache-2.0
"""Functions of OSL's library BSDL and of Blender's Cycles, as variants of the nodes that they implement."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.defects import BSDL, SINGLE, conty_kulla_albedo
from mxeon.models.microfacet.ggx import missing_light
from mxeon.models.nodes.lobes import untinted
from mxeon.models.nodes.microfacets import (
    CONDUCTOR,
    DIELECTRIC,
    SCHLICK,
    BareLobe,
    isotropic,
    undipped,
    white,
)
from mxeon.models.nodes.node import Inputs, Scattering, Variant
from mxeon.models.sheen import zeltner_albedo_dir

INDEX = (1.001, 5.0)  # of a dielectric


def _bsdl_lobe(category: str, wo: Array, wi: Array, inputs: Inputs) -> Array:
    """Values of a microfacet node."""
    return BSDL.value(category, wo, wi, inputs)


def _indexed(inputs: Inputs) -> dict[str, Array]:
    """Inputs with the index that BSDL takes for it."""
    return {**inputs, "ior": np.clip(inputs["ior"], *INDEX)}


def _dielectric(wo: Array, wi: Array, inputs: Inputs) -> Array:
    return _bsdl_lobe("dielectric_bsdf", wo, wi, _indexed(inputs))


def _bsdl_schlick(wo: Array, wi: Array, inputs: Inputs) -> Array:
    return _bsdl_lobe("generalized_schlick_bsdf", wo, wi, undipped(inputs))


def _bsdl_dielectric_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a dielectric without its tint, at the arithmetic mean of both alphas."""
    mean = inputs["roughness"].mean(axis=-1, keepdims=True)
    alphas = np.repeat(mean, 2, axis=-1)
    return DIELECTRIC.albedo(wo, {**white(_indexed(inputs)), "roughness": alphas})


def _bsdl_schlick_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a dielectric whose index has the mean of `color0`, in every channel."""
    root = np.sqrt(np.clip(np.mean(inputs["color0"], axis=-1), 0.0, 0.99))
    return _bsdl_dielectric_albedo(wo, {**inputs, "ior": (1.0 + root) / (1.0 - root)})


def gray(albedo: Callable[[Array, Inputs], Array], wo: Array, inputs: Inputs) -> Array:
    """An albedo times the largest channel of the color, in every channel."""
    largest = np.max(np.broadcast_to(inputs["color"], wo.shape), axis=-1, keepdims=True)
    return np.asarray(np.minimum(albedo(wo, inputs) * largest, 1.0))


CONTY_KULLA = partial(gray, conty_kulla_albedo)
# By the name of the node's row.
BSDL_VARIANTS: Mapping[str, tuple[Variant[Scattering], ...]] = {
    "dielectric": (
        Variant("BSDL's lobe, of an index from 1.001 to 5", _dielectric, _bsdl_dielectric_albedo),
    ),
    "conductor": (Variant(BSDL.title, partial(_bsdl_lobe, "conductor_bsdf")),),
    "schlick": (
        Variant("BSDL's lobe, and color82 counts as 1", _bsdl_schlick),
        Variant(
            "the albedo of a dielectric of the mean F0, of an index up to 5",
            albedo=_bsdl_schlick_albedo,
        ),
    ),
    "conty_kulla": (
        Variant(
            "MaterialX's fit of its albedo, times the largest channel of the color",
            albedo=CONTY_KULLA,
        ),
    ),
    "zeltner": (
        Variant(
            "its albedo times the largest channel of the color",
            albedo=partial(gray, untinted(zeltner_albedo_dir)),
        ),
        Variant(
            "MaterialX's fit of the Conty-Kulla albedo, times the largest channel of the color",
            albedo=CONTY_KULLA,
        ),
    ),
}


LOSSLESS = "the largest channel of the albedo of facets that lose no light"


def _cycles_lobe(category: str, wo: Array, wi: Array, inputs: Inputs) -> Array:
    """Values of a microfacet node."""
    return SINGLE.value(category, wo, wi, inputs)


def _cycles_schlick(wo: Array, wi: Array, inputs: Inputs) -> Array:
    return _cycles_lobe("generalized_schlick_bsdf", wo, wi, undipped(inputs))


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


def _cycles_dielectric_albedo(wo: Array, inputs: Inputs) -> Array:
    """Such an albedo; of an index below 1 that of a smooth surface."""
    smooth = DIELECTRIC.fresnel(np.minimum(wo[:, 2], 1.0), inputs) * inputs["tint"]
    rough = _lossless(DIELECTRIC, wo, inputs)
    return np.where(np.reshape(inputs["ior"], (-1, 1)) > 1.0, rough, _largest(smooth))


def _cycles_schlick_albedo(wo: Array, inputs: Inputs) -> Array:
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
        Variant(
            SINGLE.title, partial(_cycles_lobe, "dielectric_bsdf"), partial(_single, DIELECTRIC)
        ),
        Variant(LOSSLESS, albedo=_cycles_dielectric_albedo),
    ),
    "conductor": (
        Variant(SINGLE.title, partial(_cycles_lobe, "conductor_bsdf"), partial(_single, CONDUCTOR)),
    ),
    "schlick": (
        Variant(f"{SINGLE.title}, and color82 counts as 1", _cycles_schlick, _single_schlick),
        Variant(f"{LOSSLESS}, and color82 counts as 1", albedo=_cycles_schlick_albedo),
    ),
    "conty_kulla": (SHEEN,),
    "zeltner": (SHEEN,),
}
