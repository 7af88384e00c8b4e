# SPDX-License-Identifier: Apache-2.0
"""The tone curve for display: Khronos PBR Neutral [Khronos2024].

The curve preserves colors under moderate studio lighting, and compresses highlights while keeping
hue.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from mxeon.io.images import Floats

FRESNEL = 0.04  # reflectance at normal incidence; subtracted, to reproduce base colors
START = 0.8 - FRESNEL  # peak value above which compression starts
DESATURATION = 0.15


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
