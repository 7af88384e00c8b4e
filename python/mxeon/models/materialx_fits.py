# SPDX-License-Identifier: Apache-2.0
"""Albedos as MaterialX 1.39 fits them, in its GLSL library of pbrlib, to recognize them by."""

from collections.abc import Mapping

import numpy as np

from mxeon.models.arrays import Array, ArrayLike


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


def ggx_albedo(mu: Array, alpha: Array) -> tuple[Array, Array]:
    """Factors of F0 and of F90 in the albedo of GGX, mx_ggx_dir_albedo_analytic."""
    x, y = mu, alpha
    terms = (1.0, x, y, x * y, x * x, y * y, x * x * y, x * y * y, x * x * y * y)
    sums = [
        sum(number * term for number, term in zip(row, terms, strict=True)) for row in GGX_TERMS
    ]
    return np.clip(sums[0] / sums[2], 0.0, 1.0), np.clip(sums[1] / sums[3], 0.0, 1.0)


def layer_albedo(
    wo: Array, inputs: Mapping[str, Array], F0: ArrayLike, F90: ArrayLike, F: ArrayLike
) -> Array:
    """Albedo of a microfacet lobe as its throughput takes it, with F in the compensation."""
    alpha = np.sqrt(inputs["roughness"].prod(axis=-1))
    A, B = ggx_albedo(np.minimum(wo[:, 2], 1.0), alpha)
    missing = (1.0 / np.minimum(A + B, 2.0) - 1.0)[:, np.newaxis]
    albedo = np.asarray(F0) * A[:, np.newaxis] + np.asarray(F90) * B[:, np.newaxis]
    return np.broadcast_to(albedo * (1.0 + np.asarray(F) * missing), wo.shape)


# Rows: numerators and denominators of the factors of F0 and F90, in the order of the terms.
GGX_TERMS = (
    (0.1003, -0.6303, 9.748, -2.038, 29.34, -8.245, -26.44, 19.99, -5.448),
    (0.9345, -2.323, 2.229, -3.748, 1.424, -0.7684, 1.436, 0.2913, 0.6286),
    (1.0, -1.765, 8.263, 11.53, 28.96, -7.507, -36.11, 15.86, 33.37),
    (1.0, 0.2281, 15.94, -55.83, 13.08, 41.26, 54.9, 300.2, -285.1),
)
