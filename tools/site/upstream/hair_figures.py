# SPDX-License-Identifier: Apache-2.0
"""Figures in the sentences of the pages on hair."""

import numpy as np
from scipy.optimize import brentq

from mxeon.models.hair.defects import LIMITS
from mxeon.models.hair.parameters import chiang_hair_roughness
from mxeon.models.microfacet.fresnel import fresnel_dielectric
from tools.site.upstream.shader_figures import azimuth_errors

SWITCH = 12.0  # argument at which a logarithm takes the place of the series of I_0
TERMS = 10
FIBER = 1.55  # index of hair


def longitudinal_figures():
    """Shares of M_p that GLSL's series, logarithm and difference miss."""
    x = SWITCH
    steps = np.arange(1.0, TERMS)
    series = 1.0 + np.cumprod((x / (2.0 * steps)) ** 2).sum()
    second = np.log1p(1.0 / (8.0 * x)) - 1.0 / (16.0 * x)
    return {
        "series": 1.0 - series / np.i0(x),
        "logarithm": -np.expm1(-second),
        "ln2": np.log(2.0) - 0.6931,
        "difference": 1000.0 * 2.0**-24,
    }


def roughness_figures():
    """Ranges of the node of the roughness, and where they meet the limits of GLSL."""
    longest = chiang_hair_roughness(1.0, 1.0)
    R, TT, TRT = (lambda x, lobe=lobe: chiang_hair_roughness(x, 0.5)[lobe][0] for lobe in range(3))
    low, high = LIMITS
    return {
        "variance_r": longest[0][0],
        "variance_trt": longest[2][0],
        "scale": longest[0][1],
        "highest_r": brentq(lambda x: R(x) - high, 0.0, 1.0),
        "highest_trt": brentq(lambda x: TRT(x) - high, 0.0, 1.0),
        "lowest_r": brentq(lambda x: R(x) - low, 0.0, 1.0),
        "lowest_tt": brentq(lambda x: TT(x) - low, 0.0, 1.0),
    }


def uniform_figures():
    """Light of white hair with a last lobe pi^2 too bright, and that lobe's share seen straight."""
    F = fresnel_dielectric(1.0, FIBER)
    return {"bright": 1.0 + 4.0 / 27.0 * (np.pi**2 - 1.0), "straight": (1.0 - F) * F * F}


def azimuth_figures():
    """Rounding of sqrt(1 - cos^2) beside a cosine of 1 in float32, and of the driver's arc sine."""
    near = float(np.nextafter(np.float32(1.0), np.float32(0.0)))
    return {"sine": np.sqrt(1.0 - near * near), **azimuth_errors()}


OF_HAIR = {
    "genglsl_hair_azimuth": azimuth_figures,
    "genglsl_hair_longitudinal": longitudinal_figures,
    "genglsl_hair_roughness": roughness_figures,
    "genglsl_hair_uniform_lobe": uniform_figures,
}
