# SPDX-License-Identifier: Apache-2.0
"""Conversion between linear values and sRGB code values, and a tone curve for display.

The tone curve is Khronos PBR Neutral [Khronos2024]. The curve preserves colors under moderate
studio lighting, and compresses highlights while keeping hue.
"""

from __future__ import annotations

from functools import cache, reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Codes = NDArray[np.uint8]

SLOPE = 2.4 / 1.055  # largest slope of the decoding curve, at the value 1
STEPS = 2**13  # steps of the lookup table in [0, 1], each with at most two codes
NOT_FINITE = (255, 0, 255)  # magenta, for pixels that are not finite
FRESNEL = 0.04  # reflectance at normal incidence, which is subtracted to reproduce base colors
START = 0.8 - FRESNEL  # value of the largest channel above which compression starts
DESATURATION = 0.15


def srgb_decoded(image: ArrayLike) -> Floats:
    """Linear values of sRGB values in [0, 1], by the sRGB encoding of IEC 61966-2-1.

    >>> srgb_decoded([0.0, 0.5, 1.0]).round(3).tolist()
    [0.0, 0.214, 1.0]
    """
    image = np.asarray(image, np.float64)
    return np.where(image <= 0.04045, image / 12.92, ((image + 0.055) / 1.055) ** 2.4)


def srgb_encoded(image: ArrayLike) -> Codes:
    """Eight-bit sRGB code values, by IEC 61966-2-1, of a linear image (..., 3), clipped to [0, 1].
    Pixels that are not finite are magenta.

        >>> srgb_encoded([0.0, 0.18, 1.0]).tolist()
        [0, 118, 255]
    """
    image = np.asarray(image, dtype=np.float32)
    finite = reduce(np.logical_and, np.moveaxis(np.isfinite(image), -1, 0))
    linear = np.clip(image, np.float32(0.0), np.float32(1.0))
    linear[~finite] = 0.0
    # A step of the table contains values of one or two codes, which the threshold separates. The
    # mode "clip" avoids checks of bounds.
    thresholds, least = _codes()
    codes: Codes = least.take((linear * np.float32(STEPS)).astype(np.intp), mode="clip")
    codes += linear >= thresholds.take(codes, mode="clip")
    codes[~finite] = NOT_FINITE
    return codes


@cache
def _codes() -> tuple[NDArray[np.float32], Codes]:
    """The linear value at which each sRGB code ends, and the least code in each of STEPS steps.

    No step contains two ends, because ends are at least 1 / (255 * 12.92) = 2.5 / STEPS apart.
    """
    ends = srgb_decoded((np.arange(255) + 0.5) / 255.0).astype(np.float32)
    least = np.searchsorted(
        ends, np.arange(STEPS + 1, dtype=np.float32) / np.float32(STEPS), "right"
    )
    return np.append(ends, np.float32(np.inf)), least.astype(np.uint8)


def pbr_neutral(image: ArrayLike) -> Floats:
    """Display values in [0, 1] of a linear image (..., 3).

    >>> pbr_neutral([0.5, 0.5, 0.5]).round(2).tolist(), pbr_neutral([9.0, 0.0, 0.0]).round(2).tolist()
    ([0.46, 0.46, 0.46], [0.99, 0.54, 0.54])
    """
    color = np.maximum(np.asarray(image, np.float64), 0.0)
    least = color.min(axis=-1, keepdims=True)
    color = color - np.where(least < 2.0 * FRESNEL, least - least**2 / (4.0 * FRESNEL), FRESNEL)
    peak = color.max(axis=-1, keepdims=True)
    rest = 1.0 - START
    top = 1.0 - rest**2 / (np.maximum(peak, START) + rest - START)
    gray = 1.0 - 1.0 / (DESATURATION * (peak - top) + 1.0)
    compressed = (color * top / np.maximum(peak, START)) * (1.0 - gray) + top * gray
    toned: Floats = np.where(peak < START, color, compressed)
    return toned
