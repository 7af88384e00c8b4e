# SPDX-License-Identifier: Apache-2.0
"""Diagnoses of what surrounds a model: the throughput, the frame and the environment."""

from collections.abc import Callable

import numpy as np

from mxeon.conformance.accuracy import diffuse as tolerances
from mxeon.conformance.accuracy.accuracy import ACCURACY
from mxeon.conformance.diagnosis.candidates import (
    NEAR,
    Diagnosis,
    not_finite,
    region,
)
from mxeon.conformance.diagnosis.comparisons import VALUE
from mxeon.conformance.diagnosis.faults import normal_ignored
from mxeon.conformance.diagnosis.regions import smallest
from mxeon.conformance.probes.cases import (
    BRANCHES,
    dead_inputs,
    edge_case,
    frame_cases,
    stretched_case,
    surroundings_case,
    throughput_cases,
)
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import absolute
from mxeon.conformance.samples.uneven_environment import sky, sky_behind
from mxeon.models.nodes.frames import UP

UNKNOWN = "the cause is unknown"

# The irradiance that a wrong look-up finds, by what it does.
LOOKUPS: dict[str, Callable[[Batch], Array]] = {
    "opposite to the normal": lambda batch: sky(-batch.normal),
    "toward the viewer": lambda batch: sky(batch.world(batch.wo)),
    "away from the viewer": lambda batch: sky(-batch.world(batch.wo)),
    "toward the light": lambda batch: sky(batch.world(batch.wi)),
    "along the mirror direction": lambda batch: sky(batch.world(batch.wo * [-1.0, -1.0, 1.0])),
    "along the surface's normal instead of the node's": lambda batch: sky(_constant(batch, UP)),
    "along the surface's normal turned toward the viewer, instead of the node's": lambda batch: sky(
        np.where(batch.world(batch.wo)[:, 2:] < 0.0, -1.0, 1.0) * _constant(batch, UP)
    ),
    "along a normal that is not turned toward the viewer": lambda batch: sky(
        batch.inputs["normal"]
    ),
    "in the map of radiances": lambda batch: np.ones_like(batch.wo),
    "nowhere: it is black": lambda batch: np.zeros_like(batch.wo),
}


def diagnose_inputs(probe: Probe) -> Diagnosis:
    """The inputs that change nothing."""
    return Diagnosis(f"inputs without effect: {', '.join(dead_inputs(probe))}")


def diagnose_finite(probe: Probe) -> Diagnosis:
    """Where values at the edges are not finite."""
    return Diagnosis(not_finite([edge_case(probe)]))


def diagnose_throughput(probe: Probe) -> Diagnosis:
    """The branches whose throughput is not 0, with its value."""
    branches: dict[str, list[str]] = {}
    for branch in BRANCHES:
        cases = list(throughput_cases(probe, branch))
        wrong = [absolute(case.measured, case.expected) > tolerances.OPAQUE.value for case in cases]
        values = np.concatenate(
            [case.measured[bad] for case, bad in zip(cases, wrong, strict=True)]
        )
        if len(values):
            number = f"{values.flat[0]:.3g}" if np.ptp(values) == 0.0 else "not 0"
            place = smallest([case.batch for case in cases], wrong)
            branches.setdefault(f"{number} {place}".rstrip(), []).append(branch)
    return Diagnosis(
        "; ".join(
            f"throughput {text} (branches: {', '.join(names)})" for text, names in branches.items()
        )
    )


def diagnose_frame(probe: Probe) -> Diagnosis:
    """Whether the normal is dropped or not turned, in the first branch that is wrong."""
    tolerance = ACCURACY[probe.kind].frame
    assert tolerance is not None, f"no frame is asked of {probe.kind}"
    for case, branch in zip(frame_cases(probe), ("direct", "environment"), strict=True):
        wrong = tolerance.metric(case.measured, case.expected) > tolerance.value
        if not wrong.any():
            continue
        # Whether the surface's normal takes the place of the node's.
        expected = probe.expected if branch == "direct" else probe.expected_albedo
        dropped = expected(normal_ignored(case.batch))
        if tolerance.metric(case.measured, dropped).max() <= tolerance.value:
            text = "the node's normal is ignored; the surface's is used instead"
        else:
            # Or else where it is wrong, and which axis has no effect.
            text = not_finite([case]) or region([case.batch], [wrong])
            text = text or without_effect(probe, "tangent")
            text = text or without_effect(probe, "curve_direction") or UNKNOWN
        return Diagnosis(f"branch {branch}: {text}")
    return Diagnosis(UNKNOWN)


def ignored(name: str) -> Callable[[Probe], Diagnosis]:
    """Whether an input is dropped, or else the explanation of the values."""
    return lambda probe: Diagnosis(without_effect(probe, name) or VALUE.diagnose(probe).text)


def without_effect(probe: Probe, name: str) -> str:
    """Words on an input that changes nothing; "" if it does, or there is none."""
    dead = name in probe.changes and name in dead_inputs(probe)
    return f"{name} is ignored" if dead else ""


def diagnose_stretched(probe: Probe) -> Diagnosis:
    """Whether directions of visible normals are weighted by G_1 at the mean alpha."""
    case = stretched_case(probe)
    view, alpha = case.batch.wo, case.batch.inputs["roughness"]
    mu2, mean2 = view[:, 2] ** 2, alpha.prod(axis=1)
    drawn = np.sqrt((alpha**2 * view[:, :2] ** 2).sum(axis=1) + mu2)
    factor = (view[:, 2] + np.sqrt(mean2 + (1.0 - mean2) * mu2)) / (view[:, 2] + drawn)
    errors = (
        np.sqrt(np.mean((case.measured - scale * case.expected) ** 2))
        for scale in (factor[:, np.newaxis], 1.0)
    )
    if next(errors) < NEAR * next(errors):
        return Diagnosis("anisotropic visible normals are weighted by G_1 at the mean alpha")
    return Diagnosis(UNKNOWN)


def diagnose_surroundings(probe: Probe) -> Diagnosis:
    """The direction at which the environment is looked up."""
    case, limit = surroundings_case(probe), tolerances.SURROUNDINGS.value
    for words, found in LOOKUPS.items():
        if np.sqrt(np.mean((case.measured - found(case.batch)) ** 2)) <= limit:
            return Diagnosis(f"the environment is looked up {words}")
    if np.sqrt(np.mean((case.measured - sky_behind(case.expected)) ** 2)) <= limit:
        return Diagnosis("the environment is looked up on the other side of the surface")
    wrong = absolute(case.measured, case.expected) > limit
    return Diagnosis(not_finite([case]) or region([case.batch], [wrong]) or UNKNOWN)


def _constant(batch: Batch, vector: tuple[float, float, float]) -> Array:
    return np.broadcast_to(vector, batch.wo.shape)
