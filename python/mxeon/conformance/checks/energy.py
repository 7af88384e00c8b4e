# SPDX-License-Identifier: Apache-2.0
"""Checks of energy: what a lobe scatters in all, what it lets through, and both of two lobes together."""

import numpy as np

from mxeon.conformance.accuracy import bsdf as tolerances
from mxeon.conformance.checks import bsdf_measures as measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import Altered, mistake, pass_all, scale, shifted
from mxeon.conformance.checks.names import COMBINATION, OTHERS
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.comparisons import ALBEDO, THROUGHPUT, TRANSMISSION, VALUE
from mxeon.conformance.nodes.combinations import SINGLE
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.models.nodes import NODES
from mxeon.models.nodes.combinations import FACTOR

LAYERS = tuple(row.name for row in NODES if row.layerable)


@mistake("values are multiplied twice")
def again(probe: Probe) -> Altered:
    def scaled(batch: Batch, values: Array) -> Array:
        return values * np.reshape(batch.inputs[FACTOR], (len(values), -1))

    return Altered(probe, values=scaled)


CHECKS = (
    Check(
        "layering",
        "The throughput of a layer is 1 - E for light from above, for every weight.",
        LAYERS,
        THROUGHPUT,
        pass_all,
    ),
    Check(
        "transmission",
        "The throughput of a layer is 1 - E for light through the base, too.",
        LAYERS,
        TRANSMISSION,
        pass_all,
    ),
    Check(
        "dip",
        "Where color82 lowers the reflectance, the layer passes on what it does not reflect.",
        tuple(row.name for row in NODES if row.layerable and "color82" in row.inputs),
        measures.dip,
        pass_all,
        tolerances.DIP,
        pairs=True,
        lit=True,
        diagnose=THROUGHPUT.diagnose,
    ),
    Check(
        "denser",
        "For indices below 1, which the fit does not cover, the throughput is within its stated error.",
        tuple(row.name for row in NODES if row.layerable and "tint" in row.inputs),
        measures.denser,
        pass_all,
        tolerances.UNFITTED,
        pairs=True,
        lit=True,
        diagnose=THROUGHPUT.diagnose,
    ),
    Check(
        "layer",
        "A layer over a white base returns all light.",
        LAYERS,
        measures.layer,
        pass_all,
        "light",
        diagnose=THROUGHPUT.diagnose,
    ),
    Check(
        "integral",
        "Values integrate to the directional albedo that the equations give.",
        OTHERS,
        measures.integral,
        scale("values are 2 % too large", 1.02),
        "integral",
        open=True,
    ),
    Check(
        "energy",
        "No albedo exceeds 1 or what the equations give.",
        OTHERS,
        measures.energy,
        scale("values are 100 times as large", 100.0),
        "integral",
    ),
)
# Of the nodes that combine two lobes.
COMBINED_CHECKS = (
    Check(
        "combination",
        "Two combined lobes have the value that the node's equation gives.",
        COMBINATION,
        VALUE,
        shifted,
        pairs=True,
    ),
    Check(
        "combined_albedo",
        "The environment branch of two combined lobes returns their albedo.",
        COMBINATION,
        ALBEDO,
        shifted,
        pairs=True,
    ),
    Check(
        "combined_throughput",
        "Two combined lobes pass on what they do not scatter, as the layer equation requires.",
        COMBINATION,
        measures.passing,
        pass_all,
        "throughput",
        diagnose=THROUGHPUT.diagnose,
        open=True,
    ),
    Check(
        "factor",
        "Factors are clamped to [0, 1].",
        SINGLE,
        measures.factors,
        again,
        tolerances.FACTOR,
        pairs=True,
        diagnose=lambda probe: Diagnosis("the factor is not clamped", permitted=True),
        open=True,
    ),
)
