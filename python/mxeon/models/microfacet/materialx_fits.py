# SPDX-License-Identifier: Apache-2.0
"""Albedos as MaterialX 1.39 fits them, in its GLSL library of pbrlib, to recognize them by."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.defects import fitted_albedo


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
    wo: Array, inputs: Mapping[str, Array], F0: Array, F90: Array | float, F: Array
) -> Array:
    """Albedo of a microfacet lobe as its throughput takes it, with F in the compensation, (N, 3)."""
    mu, alpha = _arguments(wo, inputs)
    A, B = (fitted_albedo(mu, alpha, *ends)[:, np.newaxis] for ends in ((1.0, 0.0), (0.0, 1.0)))
    return np.broadcast_to((F0 * A + F90 * B) * compensation(wo, inputs, F), wo.shape)


def compensation(wo: Array, inputs: Mapping[str, Array], F: Array) -> Array:
    """Energy compensation with F, by the fit of E_ss, (N, 1 or 3)."""
    E_ss = fitted_albedo(*_arguments(wo, inputs), 1.0, 1.0)[:, np.newaxis]
    return 1.0 + F * (1.0 - E_ss) / E_ss


def _arguments(wo: Array, inputs: Mapping[str, Array]) -> tuple[Array, Array]:
    """Cosine and alpha, at least 1e-6 as in the shaders."""
    alpha = np.sqrt(np.maximum(inputs["roughness"], 1e-6).prod(axis=-1))
    return np.clip(wo[:, 2], 1e-6, 1.0), alpha
