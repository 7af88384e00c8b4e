# SPDX-License-Identifier: Apache-2.0
"""Checks of surface shaders as a whole."""

import numpy as np

from mxeon.conformance.accuracy.diffuse import count_of
from mxeon.conformance.checks import surface_diagnosis as diagnosis
from mxeon.conformance.checks import surface_measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import Altered, scale, shifted
from mxeon.conformance.nodes.surface_shaders import SHADERS
from mxeon.conformance.probes.cases import albedo_cases, value_cases
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch

MODELS = tuple(shader.model for shader in SHADERS)


class IgnoreChanges(Altered):
    """A probe whose host sees the first pair only."""

    def response(self, batch: Batch, branch: str) -> Array:
        return np.repeat(self.probe.response(batch.first(1), branch), len(batch.wo), axis=0)


def ignore_changes(probe: Probe) -> Altered:
    return IgnoreChanges(probe)


CHECKS = (
    Check(
        "lobes",
        "Direct light is that of all lobes by the layer equation.",
        MODELS,
        value_cases,
        "each pair has the inputs of another",
        shifted,
        "value",
        diagnose=diagnosis.diagnose_lobes,
    ),
    Check(
        "lobes_albedo",
        "The environment branch gives the albedo of all lobes by the layer equation.",
        MODELS,
        albedo_cases,
        "each view has the inputs of another",
        shifted,
        "albedo",
        diagnose=diagnosis.diagnose_sum,
    ),
    Check(
        "lobes_furnace",
        "A white material of many lobes in a white environment cannot be seen.",
        MODELS,
        surface_measures.furnace,
        "every value is a tenth lower",
        scale(0.9),
        "albedo",
        diagnose=diagnosis.diagnose_sum,
    ),
    Check(
        "lobes_energy",
        "No material of these lobes reflects and transmits more light than it gets.",
        MODELS,
        surface_measures.energy,
        "every value is half as high again",
        scale(1.5),
        "albedo",
        diagnose=diagnosis.diagnose_sum,
    ),
    Check(
        "reach",
        "An input changes a value, unless its page says that it does not.",
        MODELS,
        surface_measures.reach,
        "every change is dropped",
        ignore_changes,
        count_of("inputs"),
        diagnose=diagnosis.diagnose_reach,
    ),
)
