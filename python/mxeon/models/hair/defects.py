# SPDX-License-Identifier: Apache-2.0
"""Forms of the hair model that shaders have instead of the text's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.hair.formulas import TEXT, HairForm

# The series of I_0 has so many terms, and above the limit a logarithm takes its place.
TERMS, LIMIT, NARROW = 10, 12.0, 0.1
LIMITS = (0.001, 1.0)  # of every roughness


def materialx_longitudinal(
    sin_i: Array, cos_i: Array, sin_o: Array, cos_o: Array, v: Array
) -> Array:
    """M_p of MaterialX's GLSL, mx_chiang_hair_bsdf.glsl, after an older implementation.

    The series of I_0 stops after ten terms. Above 12 its logarithm has half of the term 1 / (8 x).
    A tilted cosine keeps its sign, so that the series serves arguments below -12. ln 2 is 0.6931.
    """
    a, b = cos_i * cos_o / v, sin_i * sin_o / v
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        log_series = np.log(_series(np.minimum(a, LIMIT)))
        x = np.maximum(a, LIMIT)
        log_large = x + 0.5 * (1.0 / (8.0 * x) - np.log(2.0 * np.pi * x))
        logarithm = np.where(a > LIMIT, log_large, log_series)
        narrow = np.exp(logarithm - b - 1.0 / v + 0.6931 + np.log(0.5 / v))
        wide = np.exp(-b) * _series(a) / (2.0 * v * np.sinh(1.0 / np.maximum(v, NARROW)))
    return np.where(v < NARROW, narrow, wide)


def _series(x: Array) -> Array:
    """TERMS terms of the power series of I_0."""
    value = term = np.ones_like(x)
    for k in range(1, TERMS):
        term = term * np.square(0.5 * x / k)
        value = value + term
    return value


UNIFORM, BESSEL, CLAMPED, TILTED = (
    "N of TRRT+ pi/2 instead of 1/(2 pi)",
    "I_0 from ten terms, and half a term of its logarithm",
    "roughness clamped to [0.001, 1]",
    "the viewer's inclination tilted instead of the light's",
)
FORMS: dict[str, HairForm] = {
    UNIFORM: replace(TEXT, uniform=0.5 * np.pi),
    BESSEL: replace(TEXT, longitudinal=materialx_longitudinal),
    CLAMPED: replace(TEXT, limits=LIMITS),
    TILTED: replace(TEXT, tilts_light=False),
    f"MaterialX's GLSL: {UNIFORM}; {BESSEL}; {CLAMPED}": replace(
        TEXT, uniform=0.5 * np.pi, longitudinal=materialx_longitudinal, limits=LIMITS
    ),
}

# Readings that the text leaves open, or that its later versions have.
READINGS: dict[str, HairForm] = {
    "F of the effective index": replace(TEXT, effective=True),
    "no factor 1/pi, as in later versions of the text": replace(TEXT, factor=1.0),
}
