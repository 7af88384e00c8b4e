# SPDX-License-Identifier: Apache-2.0
"""Checks of the light that a lobe scatters in all."""

from mxeon.conformance.checks import bsdf_measures as measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import scale
from mxeon.conformance.checks.names import OTHERS

CHECKS = (
    Check(
        "integral",
        "Values integrate to the directional albedo of the equations.",
        OTHERS,
        measures.integral,
        "values are 2 % too large",
        scale(1.02),
        "integral",
        open=True,
    ),
    Check(
        "energy",
        "No albedo exceeds 1, nor what the equations have.",
        OTHERS,
        measures.energy,
        "values are 100 times as large",
        scale(100.0),
        "integral",
    ),
)
