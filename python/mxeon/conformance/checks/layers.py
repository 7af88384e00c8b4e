# SPDX-License-Identifier: Apache-2.0
"""Checks of what a lobe lets through to the one below it."""

from mxeon.conformance.checks import bsdf_measures as measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import pass_all
from mxeon.conformance.diagnosis import candidates as diagnosis
from mxeon.conformance.probes.cases import layering_cases, transmission_cases
from mxeon.models.nodes import NODES

LAYERS = tuple(row.name for row in NODES if row.layerable)

CHECKS = (
    Check(
        "layering",
        "The throughput of a layer is 1 - E for light from above, for every weight.",
        LAYERS,
        layering_cases,
        "all light passes",
        pass_all,
        "throughput",
        diagnose=diagnosis.diagnose_throughput,
    ),
    Check(
        "transmission",
        "The throughput of a layer is 1 - E for light through the base as well.",
        LAYERS,
        transmission_cases,
        "all light passes",
        pass_all,
        "throughput",
        diagnose=diagnosis.diagnose_transmission,
    ),
    Check(
        "layer",
        "A layer over a white base returns all light.",
        LAYERS,
        measures.layer,
        "all light passes",
        pass_all,
        "light",
        diagnose=diagnosis.diagnose_throughput,
    ),
)
