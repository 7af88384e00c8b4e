# SPDX-License-Identifier: Apache-2.0
"""Models that can be fitted: one row each, with the ranges of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mxeon.models import eon_brdf
from mxeon.models.coat import dielectric_over_eon_brdf
from mxeon.models.coat.openpbr import openpbr_base_brdf
from mxeon.models.core.arrays import Array

# Other spellings of both functions of `mxeon.models`.
dielectric_over_eon, openpbr_base = dielectric_over_eon_brdf, openpbr_base_brdf
LEAST_ALPHA = 0.02  # below, a lobe is narrower than what is measured


@dataclass(frozen=True)
class FitModel:
    """A model to fit: `value(wo, wi, rho, **scalars)`, shape (N, C)."""

    value: Callable[..., Array]
    bounds: Mapping[str, tuple[float, float]]  # of each scalar
    starts: Mapping[str, tuple[float, ...]]  # values of each scalar from which the search starts


FIT_MODELS = {
    "eon": FitModel(eon_brdf, {"roughness": (0.0, 1.0)}, {"roughness": (0.2, 0.8)}),
    "dielectric_over_eon": FitModel(
        dielectric_over_eon_brdf,
        {"roughness": (0.0, 1.0), "alpha": (LEAST_ALPHA, 1.0), "ior": (1.0, 4.0)},
        {"roughness": (0.5,), "alpha": (0.1, 0.4), "ior": (1.5,)},
    ),
    "openpbr_base": FitModel(
        openpbr_base_brdf,
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
