# SPDX-License-Identifier: Apache-2.0
"""Conversion between linear values and sRGB code values."""

from __future__ import annotations

from functools import cache, reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Codes = NDArray[np.uint8]

SLOPE = 2.4 / 1.055  # largest slope of the decoding curve, which is at 1
STEPS = 2**13  # steps of the lookup table in [0, 1]; each has at most two codes
NOT_FINITE = (255, 0, 255)  # magenta, the code values of non-finite pixels


def srgb_decoded(image: ArrayLike) -> Floats:
    """Linear values of sRGB values in [0, 1].

    IEC 61966-2-1, the encoding of sRGB.

        >>> srgb_decoded([0.0, 0.5, 1.0]).round(3).tolist()
        [0.0, 0.214, 1.0]
    """
    image = np.asarray(image, np.float64)
    return np.where(image <= 0.04045, image / 12.92, ((image + 0.055) / 1.055) ** 2.4)


def srgb_encoded(image: ArrayLike) -> Codes:
    """Eight-bit sRGB code values of a linear image (..., 3), clipped; magenta if not finite.

    IEC 61966-2-1, the encoding of sRGB.

        >>> srgb_encoded([0.0, 0.18, 1.0]).tolist()
        [0, 118, 255]
    """
    image = np.asarray(image, dtype=np.float32)
    finite = reduce(np.logical_and, np.moveaxis(np.isfinite(image), -1, 0))
    linear = np.clip(image, np.float32(0.0), np.float32(1.0))
    linear[~finite] = 0.0
    # Take the least code of the step, plus 1 above its threshold; mode "clip" skips bounds checks.
    thresholds, least = _codes()
    codes: Codes = least.take((linear * np.float32(STEPS)).astype(np.intp), mode="clip")
    codes += linear >= thresholds.take(codes, mode="clip")
    codes[~finite] = NOT_FINITE
    return codes


@cache
def _codes() -> tuple[NDArray[np.float32], Codes]:
    """The linear value at which each sRGB code ends, and the least code of each of STEPS steps.

    No step contains two ends: even at 0, where ends are closest, the curve's slope is only 12.92.
    """
    ends = srgb_decoded((np.arange(255) + 0.5) / 255.0).astype(np.float32)
    least = np.searchsorted(
        ends, np.arange(STEPS + 1, dtype=np.float32) / np.float32(STEPS), "right"
    )
    return np.append(ends, np.float32(np.inf)), least.astype(np.uint8)
