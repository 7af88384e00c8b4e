# SPDX-License-Identifier: Apache-2.0
"""Checks of light that microfacets transmit, in the branch that looks up an environment."""

from collections.abc import Callable

import numpy as np

from mxeon.conformance.accuracy import bsdf as tolerances
from mxeon.conformance.accuracy.diffuse import SURROUNDINGS, count_of
from mxeon.conformance.checks import transmission_measures as measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import (
    Altered,
    drop_changes,
    mistake,
    offset,
    scale,
    with_inputs,
)
from mxeon.conformance.checks.measures import counted, finite
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import NEAR, Diagnosis, not_finite
from mxeon.conformance.nodes.transmission import (
    TRANSMITTING,
    TransmissionSubject,
)
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import Case

MODELS = tuple(subject.model for subject in TRANSMITTING)
BOTH = tuple(subject.model for subject in TRANSMITTING if subject.reflects)
SEEN = "the mean of 1 - F over the visible normals"
SUMMED = 1e-3  # rms by which a sum over the normals of an engine differs from it


@mistake("every value is infinite")
def infinite(probe: Probe) -> Altered:
    def divided(batch: Batch, values: Array) -> Array:
        return np.full_like(values, np.inf)

    return Altered(probe, values=divided)


def diagnose_transmitted(probe: Probe) -> Diagnosis:
    """Whether the light is what facets pass, or that over G_1, as MaterialX has it; and where it is NaN."""
    cases = measures.transmitted(probe)
    subject = subject_of(probe, TransmissionSubject)

    def distance(found: Callable[[Case], Array]) -> float:
        return float(np.sqrt(np.mean(np.concatenate([_squares(c, found(c)) for c in cases]))))

    distances = {
        f"{SEEN}, divided by G_1 of the view": distance(
            lambda case: measures.seen(subject, case.batch, masked=True)
        ),
        SEEN: distance(lambda case: measures.seen(subject, case.batch)),
    }
    words = min(distances, key=lambda name: distances[name])
    known = distances[words] < max(NEAR * distance(lambda case: case.expected), SUMMED)
    return Diagnosis("; ".join(filter(None, (words if known else "", not_finite(cases)))))


def _squares(case: Case, expected: Array) -> Array:
    """Squared errors of the values that are finite."""
    known = np.isfinite(case.measured)
    squares: Array = (case.measured - expected)[known] ** 2
    return squares


def diagnose_inputs(probe: Probe) -> Diagnosis:
    """The inputs that change nothing, or that change what they must not."""
    return Diagnosis(f"no effect, or a wrong one: {', '.join(measures.wrong_inputs(probe))}")


def diagnose_finite(probe: Probe) -> Diagnosis:
    """Where values at the edges are not finite."""
    return Diagnosis(not_finite([measures.finite_case(probe)]))


def unknown(probe: Probe) -> Diagnosis:
    """No explanation."""
    return Diagnosis(input_diagnosis.UNKNOWN)


CHECKS = (
    Check(
        "transmitted",
        "In a uniform environment, the light that passes lies between the BTDF's share and all that is not reflected.",
        MODELS,
        measures.transmitted,
        scale("values are twice as large", 2.0),
        "value",
        diagnose=diagnose_transmitted,
    ),
    Check(
        "clear",
        "A white lobe that reflects and transmits returns all light of a uniform environment.",
        BOTH,
        measures.clear,
        scale("values are 5 % too large", 1.05),
        "light",
        diagnose=diagnose_transmitted,
    ),
    Check(
        "kept",
        "Modes R and RT reflect, and pass to their base, the same light; mode T reflects nothing; mode R transmits nothing.",
        MODELS,
        measures.kept,
        offset,
        tolerances.RETROREFLECTION,
        diagnose=unknown,
    ),
    Check(
        "critical",
        "A smooth surface transmits 1 - F, and nothing beyond the critical angle.",
        MODELS,
        measures.critical,
        with_inputs("the index is different", ior=2.5, color0=(0.5, 0.5, 0.5)),
        tolerances.SMOOTH_PASSED,
        diagnose=diagnose_transmitted,
    ),
    Check(
        "refraction",
        "An uneven environment is looked up along the ray that a solid sphere refracts.",
        MODELS,
        measures.refraction_case,
        with_inputs("the index is different", ior=2.5, color0=(0.5, 0.5, 0.5)),
        SURROUNDINGS,
        lit=True,
        diagnose=unknown,
    ),
    Check(
        "transmitted_finite",
        "All light through the surface is finite at the edges of the domain.",
        MODELS,
        finite(measures.finite_case),
        infinite,
        count_of("values"),
        diagnose=diagnose_finite,
    ),
    Check(
        "transmitted_inputs",
        "Every input except retroreflective changes the light through the surface.",
        MODELS,
        counted(measures.wrong_inputs),
        drop_changes,
        count_of("inputs"),
        lit=True,
        diagnose=diagnose_inputs,
    ),
)
