# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that combine two lobes."""

from mxeon.conformance.checks import bsdf_measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import pass_all, shifted
from mxeon.conformance.checks.names import COMBINATION
from mxeon.conformance.diagnosis import candidates as diagnosis
from mxeon.conformance.probes.cases import albedo_cases, value_cases

CHECKS = (
    Check(
        "combination",
        "The value of two lobes together is that of the node's equation.",
        COMBINATION,
        value_cases,
        "each pair has the inputs of another",
        shifted,
        "value",
        pairs=True,
    ),
    Check(
        "combined_albedo",
        "The environment branch of two lobes together gives their albedo.",
        COMBINATION,
        albedo_cases,
        "each pair has the inputs of another",
        shifted,
        "albedo",
        pairs=True,
        diagnose=diagnosis.diagnose_albedo,
    ),
    Check(
        "combined_throughput",
        "Two lobes together pass what they do not scatter, as the layer equation asks.",
        COMBINATION,
        bsdf_measures.passing,
        "all light passes",
        pass_all,
        "throughput",
        diagnose=diagnosis.diagnose_throughput,
        open=True,
    ),
)
