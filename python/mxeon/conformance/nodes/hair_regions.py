# SPDX-License-Identifier: Apache-2.0
"""Views and roughnesses of hair of which a check asks apart, where shaders differ from the model."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.samples.batch import Values
from mxeon.models.hair import TINTS
from mxeon.models.hair.defects import BESSEL, CLAMPED, UNIFORM

LOBE_TINTS = {name: tuple(map(float, row)) for name, row in zip(TINTS, np.eye(3), strict=True)}
APART: Values = {**LOBE_TINTS, "tint_TRT": (0.0, 0.0, 0.0)}  # R and TT in two channels
STRAIGHT = 0.05  # azimuth, in radian, up to which a view counts as along the normal
SLANTED = (0.3, 1.2)  # azimuths of other views


@dataclass(frozen=True)
class Region:
    """Views and roughnesses of which a check asks."""

    azimuths: tuple[float, float]  # of the views from the normal, in radian
    variances: tuple[float, float]
    scales: tuple[float, float]
    tints: Values  # which lobe is in which channel
    tilt: float = 0.05  # largest distance of `cuticle_angle` from 1/2
    ior: tuple[float, float] | None = None  # ends of the index; None for those of any pair
    # Title of the form of the model that shaders have in its place there; "" if there is none.
    form: str = ""


# By the key of the check.
REGIONS = {
    "each_lobe": Region(SLANTED, (0.2, 1.0), (0.2, 1.0), LOBE_TINTS, form=UNIFORM),
    "narrow_lobes": Region(SLANTED, (1e-3, 0.1), (0.9, 1.0), APART, tilt=0.0, form=BESSEL),
    "tilted_lobes": Region(SLANTED, (1e-3, 0.1), (0.9, 1.0), APART, tilt=0.5, form=BESSEL),
    "wide_lobes": Region(SLANTED, (1.0, 100.0), (1.0, 10.0), APART, form=CLAMPED),
    "straight_views": Region((0.0, STRAIGHT), (0.2, 1.0), (0.05, 0.2), APART),
    "low_index": Region(SLANTED, (0.2, 1.0), (0.2, 1.0), APART, ior=(0.6, 0.95)),
}
