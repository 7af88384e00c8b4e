# SPDX-License-Identifier: Apache-2.0
"""Diagnoses of what surrounds a model: the throughput, the frame and the environment."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mxeon.conformance.case import Case, dead_inputs, edge_values, frames
from mxeon.conformance.diagnosis.candidates import NEAR, UNKNOWN, Diagnosis, not_finite, region
from mxeon.conformance.diagnosis.comparisons import VALUE
from mxeon.conformance.diagnosis.faults import normal_ignored
from mxeon.conformance.diagnosis.regions import smallest
from mxeon.conformance.samples import Array, Batch, sky, sky_behind
from mxeon.conformance.tolerance import Compared, absolute
from mxeon.models.shading_model import UP

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


def diagnose_inputs(case: Case) -> Diagnosis:
    return Diagnosis(f"inputs without effect: {', '.join(dead_inputs(case))}")


def diagnose_finite(case: Case) -> Diagnosis:
    return Diagnosis(not_finite([edge_values(case)]))


def diagnose_throughput(passed: Mapping[str, Sequence[Compared]]) -> Diagnosis:
    """The branches whose throughput is not 0, with its value."""
    branches: dict[str, list[str]] = {}
    for branch, compared in passed.items():
        wrong = [absolute(each.measured, each.expected) > 0.0 for each in compared]
        values = np.concatenate(
            [each.measured[bad] for each, bad in zip(compared, wrong, strict=True)]
        )
        if len(values):
            number = f"{values.flat[0]:.3g}" if np.ptp(values) == 0.0 else "not 0"
            place = smallest([each.batch for each in compared], wrong)
            branches.setdefault(f"{number} {place}".rstrip(), []).append(branch)
    texts = (f"throughput {text} (branches: {', '.join(branches[text])})" for text in branches)
    return Diagnosis("; ".join(texts))


def diagnose_frame(case: Case) -> Diagnosis:
    """Whether the normal is dropped or not turned, in the first branch that is wrong."""
    tolerance = case.tolerance("frame")
    for compared, branch in zip(frames(case), ("direct", "environment"), strict=True):
        wrong = tolerance.metric(compared.measured, compared.expected) > tolerance.value
        if not wrong.any():
            continue
        expected = case.expected if branch == "direct" else case.expected_albedo
        dropped = expected(normal_ignored(compared.batch))
        if tolerance.metric(compared.measured, dropped).max() <= tolerance.value:
            text = "the node's normal is ignored; the surface's is used instead"
        else:
            # Where it is wrong, or which axis has no effect.
            text = not_finite([compared]) or region([compared.batch], [wrong])
            text = text or without_effect(case, "tangent")
            text = text or without_effect(case, "curve_direction") or UNKNOWN
        return Diagnosis(f"branch {branch}: {text}")
    return Diagnosis(UNKNOWN)


def ignored(name: str) -> Callable[[Case], Diagnosis]:
    """Whether an input is dropped, or else the explanation of the values."""
    return lambda case: Diagnosis(without_effect(case, name) or VALUE.diagnose(case).text)


def without_effect(case: Case, name: str) -> str:
    """Words on an input that changes nothing; "" if it does, or there is none."""
    dead = name in case.changes and name in dead_inputs(case)
    return f"{name} is ignored" if dead else ""


def diagnose_stretched(compared: Compared) -> Diagnosis:
    """Whether directions of visible normals are weighted by G_1 at the mean alpha."""
    view, alpha = compared.batch.wo, compared.batch.inputs["roughness"]
    mu2, mean2 = view[:, 2] ** 2, alpha.prod(axis=1)
    drawn = np.sqrt((alpha**2 * view[:, :2] ** 2).sum(axis=1) + mu2)
    factor = (view[:, 2] + np.sqrt(mean2 + (1.0 - mean2) * mu2)) / (view[:, 2] + drawn)
    errors = (
        np.sqrt(np.mean((compared.measured - scale * compared.expected) ** 2))
        for scale in (factor[:, np.newaxis], 1.0)
    )
    if next(errors) < NEAR * next(errors):
        return Diagnosis("anisotropic visible normals are weighted by G_1 at the mean alpha")
    return Diagnosis(UNKNOWN)


def diagnose_surroundings(compared: Compared, limit: float) -> Diagnosis:
    """The direction at which the environment is looked up."""
    for words, found in LOOKUPS.items():
        if np.sqrt(np.mean((compared.measured - found(compared.batch)) ** 2)) <= limit:
            return Diagnosis(f"the environment is looked up {words}")
    if np.sqrt(np.mean((compared.measured - sky_behind(compared.expected)) ** 2)) <= limit:
        return Diagnosis("the environment is looked up on the other side of the surface")
    wrong = absolute(compared.measured, compared.expected) > limit
    return Diagnosis(not_finite([compared]) or region([compared.batch], [wrong]) or UNKNOWN)


def _constant(batch: Batch, vector: tuple[float, float, float]) -> Array:
    return np.broadcast_to(vector, batch.wo.shape)
