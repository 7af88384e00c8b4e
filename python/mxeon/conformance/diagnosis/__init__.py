# SPDX-License-Identifier: Apache-2.0
"""Explains failures by a model, defect or fault that gives the values, or by the wrong region."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter, methodcaller
from typing import TypeAlias

import numpy as np

from mxeon.conformance.cache import remembered
from mxeon.conformance.case import LIGHT, Case, albedos, dead_inputs, frames, throughputs, values
from mxeon.conformance.diagnosis import faults, regions
from mxeon.conformance.diagnosis.faults import NO_FAULT, Fault, exchanges, scaled_by
from mxeon.conformance.diagnosis.regions import EXACT, correct_except, place_of, smallest, span
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

EXCHANGES = (NO_FAULT,)  # tries no faults except exchanged inputs and a scale factor
PLACELESS = Ability.MEDIUM | Ability.OUTPUT  # nodes that depend on neither view nor light
# If one of these causes is found, the check's own values are searched for a wrong input range.
SINGLY_RIGHT, UNKNOWN, OTHER_AVERAGE, UNMASKED = UNTOLD = tuple(
    Cause(Kind.UNKNOWN, key) for key in ("singly_right", "unknown", "other_average", "unmasked")
)
WORST = 32  # number of the worst pairs that a cure is tried on, all of which must be wrong
CURES = 2  # maximum number of reported inputs
DIMMING = ("weight", "occlusion")  # inputs that can reduce any error
SHOWN = 0.1  # smallest fraction of light that must remain after a cure
# An explanation is complete if its distance is below SAME times that of any other explanation,
# and it is reported as the nearest below NEAR times.
SAME, NEAR = 0.03, 0.3
FAR = 0.2  # another model's distance must be below this share of the claimed model's distance
NAMED = 0.5  # the closest model is named if its distance is below this share of the values
INEXACT = 30.0  # up to this many tolerances, the expected model counts as inexact
LEAST_LIGHT = 1e-3  # faults of the light's cosine are indistinguishable up to this cosine


def defect(key: str, *names: str) -> Diagnosis:
    """The diagnosis for a row of `mxeon.conformance.words.DEFECTS`."""
    return Diagnosis((Cause(Kind.DEFECT, key, names),))


def causes_of(parts: Iterable[tuple[Cause, Compared]], tolerance: Tolerance) -> Diagnosis:
    """A diagnosis with the cause of each part that is wrong."""
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
    """Explain values by candidates, or by faults of the first candidate, the node's own model.

    `candidates` are functions that may give the values, starting with the node's own model. A value
    is correct if it is within the tolerance. `measure` compares the values of a case.
    """
    if infinite := not_finite(cases):  # NaN has no distance; explain only finite values
        finite = [each.where(np.isfinite(each.measured.sum(axis=1))) for each in cases]
        rest = NO_DIAGNOSIS
        if any(tolerance.wrong(each).any() for each in finite):
            rest = explain(case, finite, candidates, faults, tolerance)
        return Diagnosis((*infinite, *rest.causes), rest.distances)
    few = case.backend.counts.diagnosed
    short = [Compared(batch.first(few), *(each[:few] for each in rest)) for batch, *rest in cases]
    # Many faults leave the inputs of the node's own model unchanged, so its values are cached.
    own = replace(candidates[0], values=remembered(candidates[0].values))
    candidates = [own, *candidates[1:]]
    models = {each.title: _distance(short, each, NO_FAULT, tolerance) for each in candidates}
    ranking = sorted(models.items(), key=lambda item: item[1])
    # Search for a fault of the node's own model if no other candidate explains the values.
    if ranking[0][0] == own.title or ranking[0][1] > tolerance.value:
        names = [each.name for each in case.spec.inputs if each.name not in DIMMING]
        exchanged = exchanges(names) if faults else ()
        # The factor that brings the expected values closest to the measured values.
        weighed = [(each, np.maximum(1.0, np.abs(each.expected)) ** 2) for each in short]
        squares = sum(np.sum(each.expected**2 / scale) for each, scale in weighed)
        products = sum(np.sum(each.expected * each.measured / scale) for each, scale in weighed)
        factor = float(products / squares) if squares else 1.0
        faults = (*faults, *exchanged, scaled_by(factor))
        distances = [_distance(short, own, fault, tolerance) for fault in faults]
        order = np.argsort(distances, kind="stable")
        least, others = distances[order[0]], [distances[each] for each in order[1:]]
        rival = min([*models.values(), *others])
        enough = max(SAME * rival, tolerance.value)
        if least <= SAME * models[own.title] and least <= enough:
            return Diagnosis((faults[order[0]].cause(least),), models)
    nearest = next(each for each in candidates if each.title == ranking[0][0])
    # The model that is nearest on average may still be far from the wrong values.
    near, far = (
        max(tolerance.metric(each.measured, model.values(each.batch)).max() for each in short)
        for model in (nearest, own)
    )
    explains = nearest is not own and near <= max(tolerance.value, SAME * far)
    causes = _model(case, cases, ranking, own.title, tolerance, measure, explains)
    permitted = nearest.permitted and not any(
        tolerance.wrong(each._replace(expected=nearest.values(each.batch))).any() for each in cases
    )
    return Diagnosis(causes, models, permitted)


def _distance(
    cases: Sequence[Compared], candidate: Candidate, fault: Fault, tolerance: Tolerance
) -> float:
    """Root-mean-square distance between the measured values and a candidate with a fault.

    Pairs with roughness above 1, which not every model supports, and with light up to LEAST_LIGHT
    are excluded. If the tolerance is for a mean, values are noisy and their means are compared.
    """
    errors = []
    for case in cases:
        try:
            values = fault.values(case.batch, candidate.values(fault.batch(case.batch)))
        except ValueError:  # exchanged inputs may lie outside each other's domain
            return float("inf")
        kept = case.batch.rough <= 1.0
        if not tolerance.quantity.of_views:
            kept &= np.abs(case.batch.wi[:, 2]) > LEAST_LIGHT
        error = ((case.measured - values) / tolerance.scale(case.expected))[kept]
        mean = tolerance.metric is mean_error
        errors.append(error.mean(axis=0, keepdims=True) if mean else error)
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _model(
    case: Case,
    cases: Sequence[Compared],
    ranking: Sequence[tuple[str, float]],
    own: str,
    tolerance: Tolerance,
    measure: Measure | None,
    explains: bool,
) -> tuple[Cause, ...]:
    """Causes: the closest model if it explains the values, the wrong region, or no close model."""
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    (first, least), (_, rival) = ranking[:2]
    # Report another model if it explains all values.
    if explains and least <= max(tolerance.value, SAME * rival):
        flags = (
            (float(spec.flag),)
            for spec in diffuse.DIFFUSE
            if spec.node == case.spec.node and spec.title != case.spec.title
            if spec.flag is not None and reference.diffuse_model(spec.model).title == first
        )
        return (Cause(Kind.MODEL, first, values=next(flags, ()), rms=least),)
    # The values match the own model except in a region or range, or are not accurate enough.
    if not wrong.any():
        return (SINGLY_RIGHT,)
    if place := smallest(cases, tolerance):
        return (correct_except(cases, tolerance, place),)
    place, mostly = span(cases, tolerance), wrong.mean() < 0.5
    if first != own and least <= min(NEAR * rival, FAR * dict(ranking)[own]):
        part = (correct_except(cases, tolerance, place),) if place and mostly else ()
        return *part, Cause(Kind.MODEL, first, rms=least)
    cures: dict[str, float] = {}
    if not place and measure and np.count_nonzero(wrong) >= WORST and mostly:
        cures = _cures(case, cases, tolerance, measure)
        weak = span(cases, tolerance, regions.WEAK) if len(cures) == 1 else None
        place = weak if weak and weak.name in cures else None
    few = dict(list(cures.items())[:CURES])
    right = (Cause(Kind.CURE, "inputs", tuple(few), tuple(few.values())),) if cures else ()
    if place:
        return (correct_except(cases, tolerance, place),)
    errors = [tolerance.metric(each.measured, each.expected) for each in cases]
    if first == own and max(map(np.max, errors)) <= INEXACT * tolerance.value:
        return Cause(Kind.ACCURACY, own, rms=least), *right
    share = correct_except(cases, tolerance)
    if right:
        return share, *right
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
    if first == own and mostly:
        return (replace(share, point=point),)
    # Values that are as far from every model as from black resemble no model.
    black = Candidate("", lambda batch: np.zeros((len(batch.wo), 1)))
    far = _distance(cases, black, NO_FAULT, tolerance)
    near = least < NAMED * (far if first == own else min(far, dict(ranking)[own]))
    unlike = Cause(Kind.UNKNOWN, "no_model")
    if near:
        unlike = replace(unlike, names=(first,), rms=least)
    return unlike, replace(share, key="wrong", point=point)


def searched(cause: Cause, cases: Sequence[Compared], tolerance: Tolerance) -> Cause:
    """The region or input range that contains all wrong values; without one, the given cause."""
    if place := place_of(cases, tolerance):
        return correct_except(cases, tolerance, place)
    if cause == SINGLY_RIGHT and tolerance.metric in (absolute, relative, scaled):
        return replace(correct_except(cases, tolerance), key="wrong")
    return cause


def _cures(
    case: Case, cases: Sequence[Compared], tolerance: Tolerance, measure: Measure
) -> dict[str, float]:
    """Inputs that make the worst pairs correct if changed alone, each with its new value."""
    most = max(cases, key=lambda each: np.count_nonzero(tolerance.wrong(each)))
    worst = np.argsort(tolerance.metric(most.measured, most.expected))[-WORST:]
    pairs = Ability.PAIRS in case.backend.abilities  # a picture cannot be restricted to some points
    batch, found = most.batch.where(worst) if pairs else most.batch, {}
    # Making all values dark is not a cure.
    light = np.maximum(np.abs(most.expected), np.abs(most.measured))[worst]
    least = SHOWN * min(float(light.mean()), 1.0)
    for port in case.spec.inputs:
        if port.name not in batch.inputs or port.type not in COMPONENTS or port.name in DIMMING:
            continue
        ends = (port.high, *port.edges, port.low) if np.ndim(port.high) == 0 else ()
        for value in dict.fromkeys(float(np.ravel(end)[0]) for end in ends):
            changed = batch.altered(**{port.name: np.full_like(batch.inputs[port.name], value)})
            compared = list(measure(replace(case, chosen=(changed,))))
            wrong = any(tolerance.wrong(each).any() for each in compared)
            if not wrong and min(float(np.abs(each.expected).mean()) for each in compared) >= least:
                found[port.name] = value
                break
    return found


def not_finite(cases: Sequence[Compared]) -> tuple[Cause, ...]:
    """The cause for non-finite values, with their region; empty if all are finite."""
    zeros = list(map(regions.unbounded, cases))
    if not any(EXACT.wrong(each).any() for each in zeros):
        return ()
    return (Cause(Kind.NOT_FINITE, region=place_of(zeros, EXACT)),)


# Comparisons, one per quantity.


@dataclass(frozen=True, eq=False)
class Comparison:
    """Measured and expected values of a quantity, with candidates for their explanation."""

    quantity: str  # quantity whose tolerance applies
    compared: Callable[[Case], Iterable[Compared]]
    candidates: Callable[[Case], Sequence[Candidate]]  # candidates, starting with the own model
    faults: Sequence[Fault] = ()  # faults to try between inputs and own model

    def __call__(self, case: Case) -> Iterable[Compared]:
        return self.compared(case)

    def diagnose(self, case: Case) -> Diagnosis:
        """The explanation of a case, cached because several checks of a node fail alike."""
        known = case.explained
        if self not in known:
            tolerance = case.tolerance(self.quantity, "value")
            compared = list(self.compared(case))
            candidates = self.candidates(case)
            known[self] = explain(case, compared, candidates, self.faults, tolerance, self.compared)
        found: Diagnosis = known[self]
        return found


def _backs(case: Case) -> Iterator[Compared]:
    batch = case.backend.take(case.of(emission.EmissionSpec).backs)
    yield case.valued.rescaled(case.compared(batch))


def _alike(case: Case) -> Sequence[Candidate]:
    """Candidates for values, rescaled to the unit in which errors are uniform."""

    def alike(candidate: Candidate, batch: Batch) -> Array:
        values = candidate.values(batch)
        return case.valued.rescaled(Compared(batch, values, values)).expected

    return [replace(each, values=partial(alike, each)) for each in case.valued.value_candidates]


def _transmittances(case: Case) -> Iterator[Compared]:
    """Light through a medium, and through a surface above it, against its transmittance."""
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
ALBEDOS, RESTS = (methodcaller("candidates", each) for each in ("albedo", "throughput"))
VALUE = Comparison("value", values, VALUES, faults.DIRECT_FAULTS)
ALBEDO = Comparison("albedo", albedos, ALBEDOS, faults.ENVIRONMENT_FAULTS)
# Comparisons of a layer's throughput, for light from above and for light through the base.
THROUGHPUT = Comparison("throughput", lambda case: throughputs(case, *LIGHT), RESTS, EXCHANGES)
TRANSMISSION = Comparison(
    "throughput", lambda case: throughputs(case, "transmission"), RESTS, EXCHANGES
)
# Comparison of a utility node's output, or of emission from the front.
OUTPUT = Comparison(
    "value", lambda case: map(case.valued.rescaled, values(case)), _alike, faults.COLOR_FAULTS
)
BACK = Comparison("value", _backs, _alike)
TRANSMITTANCE = Comparison("value", _transmittances, VALUES)


# Diagnoses of what surrounds a model: throughput, frame and environment.

# Irradiance that each kind of wrong lookup returns.
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
    """The diagnosis of throughputs that must be 0: each nonzero output, its region and branches."""
    found: dict[Cause, list[str]] = {}
    for (output, branch), compared in passed.items():
        values = np.concatenate([each.measured[EXACT.wrong(each)] for each in compared])
        if len(values):
            number = (float(values.flat[0]),) if np.ptp(values) == 0.0 else ()
            place = smallest(compared, EXACT)
            cause = Cause(Kind.DEFECT, "not_zero", (output,), number, region=place)
            found.setdefault(cause, []).append(branch)
    return Diagnosis(tuple(replace(each, names=(*each.names, *found[each])) for each in found))


def diagnose_frame(case: Case) -> Diagnosis:
    """The diagnosis of the first wrong branch: an ignored normal or axis, or a wrong region."""
    tolerance = case.tolerance("frame")
    for compared, branch in zip(frames(case), ("direct", "environment", ""), strict=False):
        if not tolerance.wrong(compared).any():
            continue
        if not branch:
            return defect("retroreflective_normal")
        expected = case.expected if branch == "direct" else case.expected_albedo
        dropped = compared._replace(expected=expected(faults.normal_ignored(compared.batch)))
        if not tolerance.wrong(dropped).any():
            causes = defect("normal_of_surface").causes
        else:
            # Report the wrong region, or an axis without effect.
            causes = not_finite([compared]) or _region([compared], tolerance)
            axes = ("normal", "tangent", "curve_direction")
            dead = (found for name in axes for found in without_effect(case, name))
            causes = causes or tuple(dead)[:1] or _beside_equal(case, compared, branch)
            causes = causes or (UNKNOWN,)
        return Diagnosis((replace(causes[0], branch=branch),))
    return Diagnosis((UNKNOWN,))


def _beside_equal(case: Case, compared: Compared, branch: str) -> tuple[Cause, ...]:
    """A cause if the worst rotated pair becomes correct when all pixels share its inputs."""
    tolerance, output = case.tolerance("frame"), case.direct if branch == "direct" else case.albedo
    worst = np.full(4, tolerance.metric(compared.measured, compared.expected).argmax())
    same = compared.where(worst)
    same = same._replace(measured=output(same.batch))
    return () if tolerance.wrong(same).any() else (Cause(Kind.CURE, "beside_equal_pixels"),)


def _region(cases: Sequence[Compared], tolerance: Tolerance) -> tuple[Cause, ...]:
    place = smallest(cases, tolerance)
    return (correct_except(cases, tolerance, place),) if place else ()


def ignored(name: str) -> Callable[[Case], Diagnosis]:
    """A diagnosis that the input has no effect; otherwise the explanation of the values."""
    return lambda case: Diagnosis(without_effect(case, name) or VALUE.diagnose(case).causes)


def without_effect(case: Case, name: str) -> tuple[Cause, ...]:
    """A cause if the case has this input and it has no effect; otherwise empty."""
    dead = name in case.changes and name in dead_inputs(case)
    return defect("input_ignored", name).causes if dead else ()


def diagnose_surroundings(compared: Compared, tolerance: Tolerance) -> Diagnosis:
    batch, measured, expected = compared
    irradiances = {
        **{key: found(batch) for key, found in LOOKUPS.items()},
        # Reversing a normal replaces the sky by 1 minus the sky.
        "other_side": 1.0 - expected,
        "viewer_side": sky(batch.normal),
    }
    for key, irradiance in irradiances.items():
        if np.sqrt(np.mean((measured - irradiance) ** 2)) <= tolerance.value:
            return defect(f"lookup_{key}")
    return Diagnosis(not_finite([compared]) or _region([compared], tolerance) or (UNKNOWN,))
