# SPDX-License-Identifier: Apache-2.0
"""Explains a failed check by another model, by a mistake in the inputs, or by a region of errors.

A candidate is a function that may have computed a node's values, such as another model. A fault is
a mistake of a shader that uses a correct model, such as an ignored weight. A region is a set of
direction pairs, or a range of an input, that contains all wrong values.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from operator import attrgetter, methodcaller
from typing import TypeAlias

import numpy as np

from mxeon.conformance.cache import remembered
from mxeon.conformance.case import LIGHT, Case, albedos, dead_inputs, frames, throughputs, values
from mxeon.conformance.diagnosis import faults, regions
from mxeon.conformance.diagnosis.faults import NO_FAULT, Fault, exchanges, scaled_by
from mxeon.conformance.diagnosis.regions import EXACT, correct_except, region_of, smallest, span
from mxeon.conformance.results import NO_DIAGNOSIS, Cause, Diagnosis, Kind
from mxeon.conformance.samples import Array, Batch, Candidate, sky
from mxeon.conformance.spec import COMPONENTS, Ability
from mxeon.conformance.specs import diffuse, emission
from mxeon.conformance.tolerance import (
    Compared,
    Tolerance,
    absolute,
    mean_error,
    point_of,
    relative,
    scaled,
)
from mxeon.models import table as reference
from mxeon.models.shading_model import UP

Measure: TypeAlias = Callable[[Case], Iterable[Compared]]

EXCHANGES = (NO_FAULT,)  # try no faults except exchanged inputs and a wrong factor
PLACELESS = Ability.MEDIUM | Ability.OUTPUT  # nodes that depend on neither view nor light
# Causes that are reported only if no region contains all wrong values of the check.
SINGLY_RIGHT, UNKNOWN, OTHER_AVERAGE, UNMASKED = UNTOLD = tuple(
    Cause(Kind.UNKNOWN, key) for key in ("singly_right", "unknown", "other_average", "unmasked")
)
UNEXPLAINED = Diagnosis((UNKNOWN,))
# A cure is a change of an input to a value that makes the worst pairs of a check correct.
WORST = 32  # number of the worst pairs for which cures are tried
CURES = 2  # maximum number of reported cures
DIMMING = ("weight", "occlusion")  # inputs that can hide any error
REMAINING = 0.1  # smallest share of the light that must remain after a cure
# An explanation is complete if the distance between explained and measured values is below SAME
# times the distance of every other explanation. For a near explanation, the factor is NEAR.
SAME, NEAR = 0.03, 0.3
FAR = 0.2  # a near model is at most this fraction of the expected model's distance from the values
NAMED = 0.5  # largest distance of a reported model from the values; black values have distance 1
INEXACT = 30.0  # errors up to 30 times the tolerance count as inaccuracy of the expected model
LEAST_LIGHT = 1e-3  # smallest cosine of the light that shows which fault changes the cosine


def defect(key: str, *names: str) -> Diagnosis:
    """A diagnosis of the defect with a key of `mxeon.conformance.words.DEFECTS`."""
    return Diagnosis((Cause(Kind.DEFECT, key, names),))


def causes_of(parts: Iterable[tuple[Cause, Compared]], tolerance: Tolerance) -> Diagnosis:
    """A diagnosis with the causes of all parts whose comparison fails."""
    wrong = (cause for cause, each in parts if tolerance.wrong(each).any())
    return Diagnosis(tuple(dict.fromkeys(wrong)))


def explain(
    case: Case,
    cases: Sequence[Compared],
    candidates: Sequence[Candidate],
    faults: Sequence[Fault],
    tolerance: Tolerance,
    measure: Measure | None = None,
) -> Diagnosis:
    """Explain values by candidates, or by faults of the node's own model.

    - `candidates`: Functions that may have computed the values. The first is the node's own model.
    - `measure`: The check's measurement, to be repeated for changed inputs, or None to change no
      inputs.
    """
    if infinite := not_finite(cases):  # explain only finite values
        finite = [each.where(np.isfinite(each.measured.sum(axis=1))) for each in cases]
        others = NO_DIAGNOSIS
        if any(tolerance.wrong(each).any() for each in finite):
            others = explain(case, finite, candidates, faults, tolerance)
        return Diagnosis((*infinite, *others.causes), others.distances)
    few = slice(case.backend.counts.diagnosed)
    short = [Compared(batch.where(few), *(each[few] for each in rest)) for batch, *rest in cases]
    # Many faults leave the inputs of the node's own model unchanged, so values are cached.
    own = replace(candidates[0], values=remembered(candidates[0].values))
    candidates = [own, *candidates[1:]]
    models = {each.title: _distance(short, each, NO_FAULT, tolerance) for each in candidates}
    ranking = sorted(models.items(), key=lambda item: item[1])
    # Search for a fault of the node's own model unless another candidate explains the values.
    if ranking[0][0] == own.title or ranking[0][1] > tolerance.value:
        names = [each.name for each in case.spec.inputs if each.name not in DIMMING]
        exchanged = exchanges(names) if faults else ()
        # The factor that brings the expected values closest to the measured values.
        scales = [each.over(np.maximum(1.0, np.abs(each.expected))) for each in short]
        squares = sum(np.sum(each.expected**2) for each in scales)
        products = sum(np.sum(each.expected * each.measured) for each in scales)
        factor = float(products / squares) if squares else 1.0
        faults = (*faults, *exchanged, scaled_by(factor))
        distances = [_distance(short, own, fault, tolerance) for fault in faults]
        best = int(np.argsort(distances, kind="stable")[0])  # argmin would choose a NaN
        least = distances.pop(best)
        rival = min([*models.values(), *distances])
        if least <= min(SAME * models[own.title], max(SAME * rival, tolerance.value)):
            return Diagnosis((faults[best].cause(least),), models)
    nearest = next(each for each in candidates if each.title == ranking[0][0])
    # The model that is nearest on average may still be far from single values.
    near, far = (
        max(tolerance.metric(each.measured, model.values(each.batch)).max() for each in short)
        for model in (nearest, own)
    )
    explains = nearest is not own and near <= max(tolerance.value, SAME * far)
    causes = _without_fault(case, cases, ranking, own.title, tolerance, measure, explains)
    permitted = nearest.permitted and not any(
        tolerance.wrong(each._replace(expected=nearest.values(each.batch))).any() for each in cases
    )
    return Diagnosis(causes, models, permitted)


def _distance(
    cases: Sequence[Compared], candidate: Candidate, fault: Fault, tolerance: Tolerance
) -> float:
    """Root-mean-square distance between the measured values and a candidate with a fault.

    Pairs with a roughness above 1, which not every model supports, or with a light's cosine of at
    most LEAST_LIGHT are excluded. If the tolerance limits a mean, means are compared.
    """
    errors = []
    for case in cases:
        try:
            values = fault.values(case.batch, candidate.values(fault.batch(case.batch)))
        except ValueError:  # an exchanged input may be outside the model's domain
            return float("inf")
        judged = case.batch.rough <= 1.0
        if not tolerance.quantity.of_views:
            judged &= np.abs(case.batch.wi[:, 2]) > LEAST_LIGHT
        error = ((case.measured - values) / tolerance.scale(case.expected))[judged]
        if tolerance.metric is mean_error:
            error = error.mean(axis=0, keepdims=True)
        errors.append(error)
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _without_fault(
    case: Case,
    cases: Sequence[Compared],
    ranking: Sequence[tuple[str, float]],
    own: str,
    tolerance: Tolerance,
    measure: Measure | None,
    explains: bool,
) -> tuple[Cause, ...]:
    """Causes if no fault explains the values: another model, a region, cures, or an unknown cause.

    - `ranking`: Titles and distances of candidates, closest first.
    - `own`: Title of the node's own model.
    - `explains`: Whether the closest candidate is another model that matches every value.
    """
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    (first, least), (_, rival) = ranking[:2]
    if explains and least <= max(tolerance.value, SAME * rival):
        flags = (
            (float(spec.flag),)
            for spec in diffuse.DIFFUSE
            if spec.node == case.spec.node and spec.title != case.spec.title
            if spec.flag is not None and reference.diffuse_model(spec.model).title == first
        )
        return (Cause(Kind.MODEL, first, values=next(flags, ()), rms=least),)
    # Find a region in which values differ from the node's own model, or report a lack of accuracy.
    if not wrong.any():
        return (SINGLY_RIGHT,)
    if region := smallest(cases, tolerance):
        return (correct_except(cases, tolerance, region),)
    region, mostly_right = span(cases, tolerance), wrong.mean() < 0.5
    if first != own and least <= min(NEAR * rival, FAR * dict(ranking)[own]):
        part = (correct_except(cases, tolerance, region),) if region and mostly_right else ()
        return *part, Cause(Kind.MODEL, first, rms=least)
    cures: dict[str, float] = {}
    if not region and measure and np.count_nonzero(wrong) >= WORST and mostly_right:
        cures = _cures(case, cases, tolerance, measure)
        weak = span(cases, tolerance, regions.WEAK) if len(cures) == 1 else None
        region = weak if weak and weak.name in cures else None
    if region:
        return (correct_except(cases, tolerance, region),)
    few = dict(list(cures.items())[:CURES])
    cured = (Cause(Kind.CURE, "inputs", tuple(few), tuple(few.values())),) if cures else ()
    errors = [tolerance.metric(each.measured, each.expected) for each in cases]
    if first == own and max(map(np.max, errors)) <= INEXACT * tolerance.value:
        return Cause(Kind.ACCURACY, own, rms=least), *cured
    share = correct_except(cases, tolerance)
    if cured:
        return share, *cured
    index = int(np.argmax(list(map(np.max, errors))))
    row, batch = int(errors[index].argmax()), cases[index].batch
    if measure and Ability.PAIRS in case.backend.abilities:
        same = measure(replace(case, chosen=(batch.where(np.full(4, row)),)))
        if not any(tolerance.wrong(each).any() for each in same):
            return replace(share, key="wrong"), Cause(Kind.CURE, "beside_equal_pixels")
    point = point_of(batch, row)
    if case.spec.requires & PLACELESS:
        point = {port.name: point[port.name] for port in case.spec.inputs if port.name in point}
    elif tolerance.quantity.of_views or Ability.EMISSION in case.spec.requires:
        point = {"wo": point["wo"]}
    else:
        point = {name: point[name] for name in ("wo", "wi")}
    if first == own and mostly_right:
        return (replace(share, point=point),)
    # Values that are as far from every model as from black resemble no model.
    black = Candidate("", lambda batch: np.zeros((len(batch.wo), 1)))
    far = _distance(cases, black, NO_FAULT, tolerance)
    unlike = Cause(Kind.UNKNOWN, "no_model")
    if least < NAMED * (far if first == own else min(far, dict(ranking)[own])):
        unlike = replace(unlike, names=(first,), rms=least)
    return unlike, replace(share, key="wrong", point=point)


def searched(cause: Cause, cases: Sequence[Compared], tolerance: Tolerance) -> Cause:
    """A cause with the region of all wrong values, or `cause` if there is no such region."""
    if region := region_of(cases, tolerance):
        return correct_except(cases, tolerance, region)
    if cause == SINGLY_RIGHT and tolerance.metric in (absolute, relative, scaled):
        return replace(correct_except(cases, tolerance), key="wrong")
    return cause


def _cures(
    case: Case, cases: Sequence[Compared], tolerance: Tolerance, measure: Measure
) -> dict[str, float]:
    """Inputs whose change alone corrects the worst pairs, and the new value of each input."""
    most = max(cases, key=lambda each: np.count_nonzero(tolerance.wrong(each)))
    worst = np.argsort(tolerance.metric(most.measured, most.expected))[-WORST:]
    batch, cures = most.batch, {}
    if Ability.PAIRS in case.backend.abilities:  # a picture cannot be restricted to some points
        batch = batch.where(worst)
    # Making all values dark is not a cure.
    light = np.maximum(np.abs(most.expected), np.abs(most.measured))[worst]
    least = REMAINING * min(float(light.mean()), 1.0)
    for port in case.spec.inputs:
        if port.name not in batch.inputs or port.type not in COMPONENTS or port.name in DIMMING:
            continue
        ends = (port.high, *port.edges, port.low) if np.ndim(port.high) == 0 else ()
        for value in dict.fromkeys(float(np.ravel(end)[0]) for end in ends):
            changed = batch.altered(**{port.name: np.full_like(batch.inputs[port.name], value)})
            compared = list(measure(replace(case, chosen=(changed,))))
            wrong = any(tolerance.wrong(each).any() for each in compared)
            if not wrong and min(float(np.abs(each.expected).mean()) for each in compared) >= least:
                cures[port.name] = value
                break
    return cures


def not_finite(cases: Sequence[Compared]) -> tuple[Cause, ...]:
    """A cause with the region of non-finite values, or () if all values are finite."""
    zeros = list(map(regions.unbounded, cases))
    if not any(EXACT.wrong(each).any() for each in zeros):
        return ()
    return (Cause(Kind.NOT_FINITE, region=region_of(zeros, EXACT)),)


@dataclass(frozen=True, eq=False)
class Comparison:
    """A comparison of measured with expected values, with functions that explain differences."""

    quantity: str  # name of the quantity in a spec's tolerances
    compared: Measure
    candidates: Callable[[Case], Sequence[Candidate]]  # the first candidate is the node's model
    faults: Sequence[Fault] = ()  # faults to combine with the node's own model

    def __call__(self, case: Case) -> Iterable[Compared]:
        return self.compared(case)

    def diagnose(self, case: Case) -> Diagnosis:
        """The explanation of a case, cached because several checks may fail for the same reason."""
        if self not in case.explained:
            tolerance, compared = case.tolerance(self.quantity, "value"), list(self(case))
            candidates, faults = self.candidates(case), self.faults
            explained = explain(case, compared, candidates, faults, tolerance, self.compared)
            case.explained[self] = explained
        return case.explained[self]


def _backs(case: Case) -> Iterator[Compared]:
    batch = case.backend.take(case.of(emission.EmissionSpec).backs)
    yield case.valued.rescaled(case.compared(batch))


def _rescaled_candidates(case: Case) -> Sequence[Candidate]:

    def rescaled(candidate: Candidate, batch: Batch) -> Array:
        values = candidate.values(batch)
        return case.valued.rescaled(Compared(batch, values, values)).expected

    return [replace(each, values=partial(rescaled, each)) for each in case.valued.value_candidates]


def _transmittances(case: Case) -> Iterator[Compared]:
    """Compare the light through a medium, alone and under a surface, with the transmittance.

    The light through a medium under a surface is divided by the light without the medium.
    """
    spec, evaluate = case.of(emission.MediumSpec), case.evaluating.evaluate
    [batch] = case.batches
    yield case.compared(batch)
    lit = batch.altered(**{"top/weight": 1.0})
    coefficients = (each for each in spec.names if np.shape(batch.inputs[each])[1:])
    clear = lit.altered(**dict.fromkeys(coefficients, (0.0, 0.0, 0.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        through = evaluate(lit, "transmission") / evaluate(clear, "transmission")
    yield Compared(batch, through, case.expected(batch))


VALUES = attrgetter("valued.value_candidates")
ALBEDOS, PASSED = (methodcaller("candidates", each) for each in ("albedo", "throughput"))
VALUE = Comparison("value", values, VALUES, faults.DIRECT_FAULTS)
ALBEDO = Comparison("albedo", albedos, ALBEDOS, faults.ENVIRONMENT_FAULTS)
# Comparisons of a layer's throughput, for light from above and for light through the base.
THROUGHPUT = Comparison("throughput", lambda case: throughputs(case, *LIGHT), PASSED, EXCHANGES)
TRANSMISSION = Comparison(
    "throughput", lambda case: throughputs(case, "transmission"), PASSED, EXCHANGES
)
# OUTPUT compares the output of a utility node, or emission toward the front of a surface. BACK
# compares emission toward the back of the surface.
OUTPUT = Comparison(
    "value",
    lambda case: map(case.valued.rescaled, values(case)),
    _rescaled_candidates,
    faults.COLOR_FAULTS,
)
BACK = Comparison("value", _backs, _rescaled_candidates)
TRANSMITTANCE = Comparison("value", _transmittances, VALUES)


# Diagnoses of throughput, frame and environment lookup, which do not depend on the model.

# Irradiance that results from each kind of wrong environment lookup.
LOOKUPS: dict[str, Callable[[Batch], Array]] = {
    "opposite": lambda batch: sky(-batch.normal),
    "viewer": lambda batch: sky(batch.world(batch.wo)),
    "from_viewer": lambda batch: sky(-batch.world(batch.wo)),
    "light": lambda batch: sky(batch.world(batch.wi)),
    "mirror": lambda batch: sky(batch.world(batch.wo * [-1.0, -1.0, 1.0])),
    "surface_normal": lambda batch: sky(np.broadcast_to(UP, batch.wo.shape)),
    "facing_surface_normal": lambda batch: sky(
        np.where(batch.world(batch.wo)[:, 2:] < 0.0, -1.0, 1.0) * UP
    ),
    "not_facing": lambda batch: sky(batch.inputs["normal"]),
    "radiances": lambda batch: np.ones_like(batch.wo),
    "black": lambda batch: np.zeros_like(batch.wo),
}


def diagnose_throughput(passed: Mapping[tuple[str, str], Sequence[Compared]]) -> Diagnosis:
    """Explain nonzero outputs by a constant value, by a region, and by the kinds of light."""
    branches: dict[Cause, list[str]] = {}
    for (output, branch), compared in passed.items():
        values = np.concatenate([each.measured[EXACT.wrong(each)] for each in compared])
        if len(values):
            constant = (float(values.flat[0]),) if np.ptp(values) == 0.0 else ()
            region = smallest(compared, EXACT)
            cause = Cause(Kind.DEFECT, "not_zero", (output,), constant, region=region)
            branches.setdefault(cause, []).append(branch)
    return Diagnosis(
        tuple(replace(cause, names=(*cause.names, *names)) for cause, names in branches.items())
    )


def diagnose_frame(case: Case) -> Diagnosis:
    """Diagnose the first wrong kind of light: an ignored normal or axis, or a region."""
    tolerance = case.tolerance("frame")
    rows = (
        ("direct", case.direct, case.expected),
        ("environment", case.albedo, case.expected_albedo),
    )
    for compared, row in zip_longest(frames(case), rows):
        if not compared or not tolerance.wrong(compared).any():
            continue
        if not row:
            return defect("retroreflective_normal")
        branch, measure, expected = row
        without_normal = expected(faults.normal_ignored(compared.batch))
        if not tolerance.wrong(compared._replace(expected=without_normal)).any():
            return Diagnosis((Cause(Kind.DEFECT, "normal_of_surface", branch=branch),))
        causes = not_finite([compared]) or _region([compared], tolerance)
        for name in ("normal", "tangent", "curve_direction"):
            causes = causes or without_effect(case, name)
        if not causes:  # evaluate the worst pair again, with the same inputs in all pixels
            errors = tolerance.metric(compared.measured, compared.expected)
            same = compared.where(np.full(4, errors.argmax()))
            same = same._replace(measured=measure(same.batch))
            wrong = tolerance.wrong(same).any()
            causes = (UNKNOWN if wrong else Cause(Kind.CURE, "beside_equal_pixels"),)
        return Diagnosis((replace(causes[0], branch=branch),))
    return UNEXPLAINED


def _region(cases: Sequence[Compared], tolerance: Tolerance) -> tuple[Cause, ...]:
    region = smallest(cases, tolerance)
    return (correct_except(cases, tolerance, region),) if region else ()


def ignored(name: str) -> Callable[[Case], Diagnosis]:
    """A function that reports that an input is ignored or, if not, explains the values."""
    return lambda case: Diagnosis(without_effect(case, name) or VALUE.diagnose(case).causes)


def without_effect(case: Case, name: str) -> tuple[Cause, ...]:
    """A cause if the case has an input called `name` without effect, otherwise ()."""
    dead = name in case.changes and name in dead_inputs(case)
    return defect("input_ignored", name).causes if dead else ()


def diagnose_surroundings(compared: Compared, tolerance: Tolerance) -> Diagnosis:
    batch, measured, expected = compared
    irradiances = {
        **{key: irradiance(batch) for key, irradiance in LOOKUPS.items()},
        "other_side": 1.0 - expected,  # the sky in the opposite direction
        "viewer_side": sky(batch.normal),
    }
    for key, irradiance in irradiances.items():
        if np.sqrt(np.mean((measured - irradiance) ** 2)) <= tolerance.value:
            return defect(f"lookup_{key}")
    return Diagnosis(not_finite([compared]) or _region([compared], tolerance) or (UNKNOWN,))
