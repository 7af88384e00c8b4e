# SPDX-License-Identifier: Apache-2.0
"""Albedos as MaterialX 1.39 fits them, in its GLSL library of pbrlib, to recognize them by."""

from collections.abc import Mapping

import numpy as np

from mxeon.models.arrays import Array, ArrayLike
from mxeon.models.microfacet_defects import fitted_albedo


def burley_albedo(wo: Array, inputs: Mapping[str, Array]) -> Array:
    """Fit of Burley's albedo, mx_burley_diffuse_dir_albedo, (N, 3)."""
    x, r = np.minimum(wo[:, 2], 1.0), inputs["roughness"]
    smooth = 0.97619 - 0.488095 * (1.0 - x) ** 5
    rough = 1.55754 + (-2.02221 + (2.56283 - 1.06244 * x) * x) * x
    return np.asarray(((1.0 - r) * smooth + r * rough)[:, np.newaxis] * inputs["color"])


def conty_kulla_albedo(wo: Array, inputs: Mapping[str, Array]) -> Array:
    """Fit of the Conty-Kulla albedo, without the color, (N, 3).

    mx_imageworks_sheen_dir_albedo_analytic.
    """
    x, y = np.minimum(wo[:, 2], 1.0), inputs["roughness"]
    above = 13.673 - 68.78018 * x + 799.08825 * y - 905.00061 * x * y
    above += 60.28956 * x * x + 1086.96473 * y * y
    below = 1.0 + 61.57746 * x + 442.78211 * y + 2597.49308 * x * y
    below += 121.81241 * x * x + 3045.55075 * y * y
    return np.repeat(np.clip(above / below, 0.0, 1.0)[:, np.newaxis], 3, axis=-1)


def layer_albedo(
    wo: Array, inputs: Mapping[str, Array], F0: ArrayLike, F90: ArrayLike, F: ArrayLike
) -> Array:
    """Albedo of a microfacet lobe as its throughput takes it, with F in the compensation."""
    alpha = np.sqrt(inputs["roughness"].prod(axis=-1))
    mu = np.minimum(wo[:, 2], 1.0)
    A, B = (fitted_albedo(mu, alpha, *ends)[:, np.newaxis] for ends in ((1.0, 0.0), (0.0, 1.0)))
    albedo = np.asarray(F0) * A + np.asarray(F90) * B
    return np.broadcast_to(albedo * (1.0 + np.asarray(F) * (1.0 / (A + B) - 1.0)), wo.shape)
