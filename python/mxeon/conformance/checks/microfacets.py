# SPDX-License-Identifier: Apache-2.0
"""Checks of lobes of microfacets alone."""

from mxeon.conformance.accuracy import bsdf as tolerances
from mxeon.conformance.accuracy.rendered import widen_for_place
from mxeon.conformance.checks import bsdf_measures as measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import isotropic, rougher, scale, with_inputs
from mxeon.conformance.checks.names import shows_exactly
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.probes.cases import stretched_case
from mxeon.models.nodes.microfacets import MICROFACET_NODES

MICROFACETS = tuple(row.name for row in MICROFACET_NODES)
CHECKS = (
    Check(
        "lossless",
        "A lossless lobe returns all light at every roughness.",
        MICROFACETS,
        measures.lossless,
        scale("values are 2 % too large", 1.02),
        "integral",
    ),
    Check(
        "shape",
        "For one view, the values for two lights have the ratio of D F G2.",
        MICROFACETS,
        measures.shape,
        rougher,
        tolerances.SHAPE,
        pairs=True,
        applies=shows_exactly,
        open=True,
    ),
    Check(
        "retroreflection",
        "The retroreflective lobe equals the mirror lobe for the mirrored view.",
        MICROFACETS,
        measures.retroreflection,
        with_inputs("the flag is dropped", retroreflective=False),
        tolerances.RETROREFLECTION,
        pairs=True,
        adapt=widen_for_place,
        diagnose=input_diagnosis.ignored("retroreflective"),
    ),
    Check(
        "anisotropy",
        "The lobe turns with the tangent.",
        MICROFACETS,
        measures.anisotropy,
        with_inputs("the tangent is dropped", tangent=(1.0, 0.0, 0.0)),
        tolerances.ANISOTROPY,
        pairs=True,
        adapt=widen_for_place,
        diagnose=input_diagnosis.ignored("tangent"),
    ),
    Check(
        "anisotropic_albedo",
        "The environment branch of an anisotropic lobe returns the integral of its values.",
        MICROFACETS,
        stretched_case,
        isotropic,
        tolerances.ANISOTROPIC_ALBEDO,
        pairs=True,
        lit=True,
        diagnose=input_diagnosis.diagnose_stretched,
    ),
)
