# SPDX-License-Identifier: Apache-2.0
"""Row of pbrlib's hair node. Its inputs have the names of `mxeon.models.hair.chiang_hair_bcsdf`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.namespaces import array_namespace
from mxeon.models.hair import (
    DEFAULTS,
    ROUGHNESSES,
    TINTS,
    chiang_hair_attenuation,
    chiang_hair_bcsdf,
)
from mxeon.models.hair.defects import FORMS, READINGS
from mxeon.models.hair.formulas import TEXT, HairForm
from mxeon.models.microfacet.albedo import dielectric_albedo_dir
from mxeon.models.nodes.node import Inputs, PbrNode, Variant


def _value(form: HairForm = TEXT) -> Callable[[Array, Array, Inputs], Array]:
    """Values in a form of the model."""

    def value(wo: Array, wi: Array, inputs: Inputs) -> Array:
        named = {name: inputs[name] for name in DEFAULTS if name in inputs}
        return chiang_hair_bcsdf(wo, wi, **named, form=form)

    return value


def _albedo(wo: Array, inputs: Inputs) -> Array:
    """Integral of the values over all lights, for a cuticle without tilt: sum of t_p A_p, over pi."""
    factors = chiang_hair_attenuation(wo, inputs["ior"], inputs["absorption_coefficient"])
    tints = array_namespace(factors).stack([inputs[n] for n in (*TINTS, TINTS[-1])], axis=-1)
    return array_namespace(factors).sum(factors * tints, axis=-1) / np.pi


def _whole(wo: Array, inputs: Inputs) -> Array:
    """The albedo without the factor 1/pi."""
    return np.pi * _albedo(wo, inputs)


def _ggx(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a GGX lobe of the mean roughness and tint: the environment of MaterialX's GLSL."""
    alpha = np.mean([inputs[name] for name in ROUGHNESSES], axis=0)
    alpha = np.sqrt(np.clip(alpha, 1e-6, 1.0).prod(axis=-1, keepdims=True))
    tint = np.mean([inputs[name] for name in TINTS], axis=0)
    albedo = dielectric_albedo_dir(wo, 1.0, np.repeat(alpha, 2, axis=-1), inputs["ior"])
    return np.asarray(tint * albedo)


HAIR_NODE = PbrNode(
    "hair",
    "Chiang hair",
    "chiang_hair_bsdf",
    tuple(DEFAULTS),
    _value(),
    _albedo,
    reciprocal=False,
    variants=(
        *(Variant(title, _value(form)) for title, form in FORMS.items()),
        *(Variant(title, _value(form), permitted=True) for title, form in READINGS.items()),
        Variant("a GGX lobe of the mean roughness and tint, without absorption", albedo=_ggx),
        Variant("no factor 1/pi, as in later versions of the text", albedo=_whole, permitted=True),
    ),
)
