# SPDX-License-Identifier: Apache-2.0
"""Variants of nodes as implemented in OSL's library BSDL and in Blender's Cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.defects import BSDL, SINGLE, conty_kulla_albedo
from mxeon.models.microfacet.ggx import missing_light
from mxeon.models.nodes import microfacets, node
from mxeon.models.nodes.microfacets import CONDUCTOR_LOBE, DIELECTRIC_LOBE, SCHLICK_LOBE, undipped
from mxeon.models.nodes.node import Inputs, Scattering, Variant, white
from mxeon.models.transmission import index_of

INDEX = (1.001, 5.0)  # BSDL clamps indices of refraction to this range


def _indexed(inputs: Inputs) -> dict[str, Array]:
    return {**inputs, "ior": np.clip(inputs["ior"], *INDEX)}


def _dielectric_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of an untinted dielectric whose alphas are replaced by their arithmetic mean."""
    mean = inputs["roughness"].mean(axis=-1, keepdims=True)
    alphas = np.repeat(mean, 2, axis=-1)
    return DIELECTRIC_LOBE.albedo(wo, {**_indexed(inputs), "tint": np.ones(3), "roughness": alphas})


def _schlick_albedo(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a dielectric with the mean channel of `color0` as normal-incidence reflectance."""
    return _dielectric_albedo(wo, {**inputs, "ior": index_of(inputs["color0"].mean(axis=-1), 0.0)})


def gray(albedo: Callable[[Array, Inputs], Array], wo: Array, inputs: Inputs) -> Array:
    """An albedo that is multiplied by the largest channel of the color and clamped to 1."""
    largest = np.max(np.broadcast_to(inputs["color"], wo.shape), axis=-1, keepdims=True)
    return np.asarray(np.minimum(albedo(wo, inputs) * largest, 1.0))


def _white_zeltner(wo: Array, inputs: Inputs) -> Array:
    return node("zeltner").albedo(wo, white(inputs))


CONTY_KULLA = partial(gray, conty_kulla_albedo)
# Variants of each node, by the name of the node's row in the table.
BSDL_VARIANTS: Mapping[str, tuple[Variant[Scattering], ...]] = {
    "dielectric": (
        Variant(
            "BSDL's lobe, of an index from 1.001 to 5",
            lambda wo, wi, i: DIELECTRIC_LOBE.value(wo, wi, _indexed(i), BSDL.lobe),
            _dielectric_albedo,
        ),
    ),
    "conductor": (Variant(BSDL.title, partial(CONDUCTOR_LOBE.value, terms=BSDL.lobe)),),
    "schlick": (
        Variant(
            "BSDL's lobe, and color82 counts as 1",
            lambda wo, wi, i: SCHLICK_LOBE.value(wo, wi, undipped(i), BSDL.lobe),
        ),
        Variant(
            "the albedo of a dielectric of the mean F0, of an index up to 5", None, _schlick_albedo
        ),
    ),
    "conty_kulla": (
        Variant(
            "MaterialX's fit of its albedo, times the largest channel of the color",
            albedo=CONTY_KULLA,
            above=True,
        ),
    ),
    "zeltner": (
        Variant(
            "its albedo times the largest channel of the color",
            albedo=partial(gray, _white_zeltner),
            above=True,
        ),
        Variant(
            "MaterialX's fit of the Conty-Kulla albedo, times the largest channel of the color",
            albedo=CONTY_KULLA,
            above=True,
        ),
    ),
}


LOSSLESS = "the largest channel of the albedo of facets that lose no light"


def _single(lobe: microfacets.MicrofacetLobe, wo: Array, inputs: Inputs) -> Array:
    """Single-scattering albedo of a lobe whose alphas are replaced by their geometric mean."""
    return np.asarray(lobe.albedo(wo, microfacets.isotropic(inputs), compensate=False))


def _largest(albedo: Array) -> Array:
    return np.broadcast_to(albedo.max(axis=-1, keepdims=True), albedo.shape)


def _lossless(lobe: microfacets.MicrofacetLobe, wo: Array, inputs: Inputs) -> Array:
    """Largest channel of the single-scattering albedo, divided by E_ss."""
    alpha = microfacets.isotropic(inputs)["roughness"][:, 0]
    missing = missing_light(wo[:, 2], alpha)[:, np.newaxis]
    return _largest(_single(lobe, wo, inputs) * (1.0 + missing))


def _lossless_dielectric(wo: Array, inputs: Inputs) -> Array:
    """`_lossless` for an IOR above 1, otherwise the albedo of a smooth dielectric."""
    smooth = DIELECTRIC_LOBE.fresnel(np.minimum(wo[:, 2], 1.0), inputs) * inputs["tint"]
    rough = _lossless(DIELECTRIC_LOBE, wo, inputs)
    return np.where(np.reshape(inputs["ior"], (-1, 1)) > 1.0, rough, _largest(smooth))


SHEEN: Variant[Scattering] = Variant(
    "the largest channel of the Zeltner sheen's albedo, with the color squared",
    albedo=lambda wo, i: gray(_white_zeltner, wo, {**i, "color": np.square(i["color"])}),
    above=True,
)
# Variants of each node, by the name of the node's row in the table.
CYCLES_VARIANTS: Mapping[str, tuple[Variant[Scattering], ...]] = {
    "dielectric": (
        Variant(
            SINGLE.title,
            partial(DIELECTRIC_LOBE.value, terms=SINGLE.lobe),
            partial(_single, DIELECTRIC_LOBE),
        ),
        Variant(LOSSLESS, albedo=_lossless_dielectric, above=True),
    ),
    "conductor": (
        Variant(
            SINGLE.title,
            partial(CONDUCTOR_LOBE.value, terms=SINGLE.lobe),
            partial(_single, CONDUCTOR_LOBE),
        ),
    ),
    "schlick": (
        Variant(
            f"{SINGLE.title}, and color82 counts as 1",
            lambda wo, wi, i: SCHLICK_LOBE.value(wo, wi, undipped(i), SINGLE.lobe),
            lambda wo, i: _single(SCHLICK_LOBE, wo, undipped(i)),
        ),
        Variant(
            f"{LOSSLESS}, and color82 counts as 1",
            albedo=lambda wo, i: _lossless(SCHLICK_LOBE, wo, undipped(i)),
        ),
    ),
    "conty_kulla": (SHEEN,),
    "zeltner": (SHEEN,),
}
