# SPDX-License-Identifier: Apache-2.0
"""Functions of OSL's library BSDL, as variants of the nodes whose closures OSL's renderer makes of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.defects import BSDL
from mxeon.models.microfacet.materialx_fits import conty_kulla_albedo
from mxeon.models.nodes.lobes import untinted
from mxeon.models.nodes.microfacets import DIELECTRIC, undipped, white
from mxeon.models.nodes.node import Inputs, Scattering, Variant
from mxeon.models.sheen import zeltner_albedo_dir

INDEX = (1.001, 5.0)  # of a dielectric


def _lobe(category: str, wo: Array, wi: Array, inputs: Inputs) -> Array:
    """Values of a microfacet node."""
    return BSDL.value(category, wo, wi, inputs)


def _indexed(inputs: Inputs) -> dict[str, Array]:
    """Inputs with the index that BSDL takes for it."""
    return {**inputs, "ior": np.clip(inputs["ior"], *INDEX)}


def _dielectric(wo: Array, wi: Array, inputs: Inputs) -> Array:
    return _lobe("dielectric_bsdf", wo, wi, _indexed(inputs))


def _schlick(wo: Array, wi: Array, inputs: Inputs) -> Array:
    return _lobe("generalized_schlick_bsdf", wo, wi, undipped(inputs))


def _dielectric_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a dielectric without its tint, at the arithmetic mean of both alphas."""
    mean = inputs["roughness"].mean(axis=-1, keepdims=True)
    alphas = np.repeat(mean, 2, axis=-1)
    return DIELECTRIC.albedo(wo, {**white(_indexed(inputs)), "roughness": alphas})


def _schlick_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a dielectric whose index has the mean of `color0`, in every channel."""
    root = np.sqrt(np.clip(np.mean(inputs["color0"], axis=-1), 0.0, 0.99))
    return _dielectric_albedo(wo, {**inputs, "ior": (1.0 + root) / (1.0 - root)})


def gray(albedo: Callable[[Array, Inputs], Array], wo: Array, inputs: Inputs) -> Array:
    """An albedo times the largest channel of the color, in every channel."""
    largest = np.max(np.broadcast_to(inputs["color"], wo.shape), axis=-1, keepdims=True)
    return np.asarray(np.minimum(albedo(wo, inputs) * largest, 1.0))


CONTY_KULLA = partial(gray, conty_kulla_albedo)
# By the name of the node's row.
BSDL_VARIANTS: Mapping[str, tuple[Variant[Scattering], ...]] = {
    "dielectric": (
        Variant("BSDL's lobe, of an index from 1.001 to 5", _dielectric, _dielectric_albedo),
    ),
    "conductor": (Variant(BSDL.title, partial(_lobe, "conductor_bsdf")),),
    "schlick": (
        Variant("BSDL's lobe, and color82 counts as 1", _schlick),
        Variant(
            "the albedo of a dielectric of the mean F0, of an index up to 5",
            albedo=_schlick_albedo,
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
