# SPDX-License-Identifier: Apache-2.0
"""Checks of the utility nodes, which compute numbers and colors that feed the lobes."""

from mxeon.conformance.accuracy import utilities as tolerances
from mxeon.conformance.accuracy.diffuse import count_of
from mxeon.conformance.checks import measures
from mxeon.conformance.checks import utility_measures as value_measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import drop_changes, no_number, shifted
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.models.nodes.utilities import UTILITIES

NAMES = tuple(row.category for row in UTILITIES)

CHECKS = (
    Check(
        "output",
        "The output of the utility node is that of its equations.",
        NAMES,
        value_measures.value,
        "each row has the inputs of another",
        shifted,
        "value",
        diagnose=value_measures.explained,
        open=True,
        adapt=tolerances.utility_tolerance,
    ),
    Check(
        "round_trip",
        "The artistic index has the reflectivity that was asked for.",
        ("artistic_ior",),
        value_measures.round_trip,
        "each row has the inputs of another",
        shifted,
        tolerances.ROUND_TRIP,
        applies=lambda subject, host: subject.title == "artistic_ior, ior",
        diagnose=value_measures.explained,
    ),
    Check(
        "output_inputs",
        "Every input of the utility node changes the output that depends on it.",
        NAMES,
        measures.inputs,
        "every change is dropped",
        drop_changes,
        count_of("inputs"),
        diagnose=input_diagnosis.diagnose_inputs,
    ),
    Check(
        "output_finite",
        "No output is infinite or not a number, at the ends of the ranges and beyond.",
        NAMES,
        value_measures.finite,
        "one output is not a number",
        no_number,
        count_of("values"),
        pairs=True,
        diagnose=value_measures.explained_finite,
    ),
)
