# SPDX-License-Identifier: Apache-2.0
"""Models that can be fitted: one row each, with the ranges of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mxeon.models import eon_brdf, fresnel_schlick_avg, generalized_schlick_brdf
from mxeon.models.coat import dielectric_over_eon_brdf
from mxeon.models.coat.curves import coat_of, unpack_cosine
from mxeon.models.core.arrays import Array, ArrayLike

dielectric_over_eon = dielectric_over_eon_brdf
LEAST_ALPHA = 0.02  # below, a lobe is narrower than what is measured


@dataclass(frozen=True)
class FitModel:
    """A model to fit: `value(wo, wi, rho, **scalars)`, shape (N, C).

    Attributes
    ----------
    value : callable
    bounds : dict of str to tuple
        Range of each scalar.
    starts : dict of str to tuple
        Values of each scalar from which the search starts.
    """

    value: Callable[..., Array]
    bounds: Mapping[str, tuple[float, float]]
    starts: Mapping[str, tuple[float, ...]]


def openpbr_base(
    wo: Array,
    wi: Array,
    rho: ArrayLike,
    roughness: float,
    specular_roughness: float,
    specular_ior: float,
    metalness: float,
) -> Array:
    """BRDF of OpenPBR's base: a metal and a dielectric over EON, mixed, in 1/sr.

    Parameters
    ----------
    wo, wi, rho
        As those of `dielectric_over_eon`; `rho` is `base_color`, of the metal too.
    roughness, specular_roughness, specular_ior, metalness : float
        `base_diffuse_roughness`, `specular_roughness`, `specular_ior` and `base_metalness`; the weights
        and `specular_color` are 1, and nothing is anisotropic or transmits.

    Returns
    -------
    ndarray, shape (N, C)
    """
    alpha = specular_roughness**2
    missing = coat_of(alpha, specular_ior).at(unpack_cosine(wo))[0][:, np.newaxis]
    metal = generalized_schlick_brdf(wo, wi, rho, 1.0, 1.0, alpha, 5.0, compensate=False)
    metal = metal * (1.0 + fresnel_schlick_avg(rho, 1.0, 1.0, 5.0) * missing)
    glossy = dielectric_over_eon(wo, wi, rho, roughness, alpha, specular_ior)
    return (1.0 - metalness) * glossy + metalness * metal


FIT_MODELS = {
    "eon": FitModel(eon_brdf, {"roughness": (0.0, 1.0)}, {"roughness": (0.2, 0.8)}),
    "dielectric_over_eon": FitModel(
        dielectric_over_eon,
        {"roughness": (0.0, 1.0), "alpha": (LEAST_ALPHA, 1.0), "ior": (1.0, 4.0)},
        {"roughness": (0.5,), "alpha": (0.1, 0.4), "ior": (1.5,)},
    ),
    "openpbr_base": FitModel(
        openpbr_base,
        {
            "roughness": (0.0, 1.0),
            "specular_roughness": (np.sqrt(LEAST_ALPHA), 1.0),
            "specular_ior": (1.0, 4.0),
            "metalness": (0.0, 1.0),
        },
        {
            "roughness": (0.5,),
            "specular_roughness": (0.4,),
            "specular_ior": (1.5,),
            "metalness": (0.1, 0.9),
        },
    ),
}
