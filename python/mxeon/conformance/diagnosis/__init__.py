# SPDX-License-Identifier: Apache-2.0
"""The explanation of a failure: the known model, defect or fault that gives the values, or their place."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from operator import attrgetter
from typing import TypeAlias

import numpy as np

from mxeon.conformance.cache import Remembered
from mxeon.conformance.case import (
    LIGHT,
    Case,
    albedos,
    dead_inputs,
    edge_values,
    frames,
    throughputs,
    values,
)
from mxeon.conformance.diagnosis.faults import (
    COLOR_FAULTS,
    DIRECT_FAULTS,
    ENVIRONMENT_FAULTS,
    Fault,
    exchanges,
    normal_ignored,
    scaled_by,
)
from mxeon.conformance.diagnosis.regions import (
    EXACT,
    WEAK,
    correct_except,
    place_of,
    region,
    share,
    smallest,
    span,
    unbounded,
)
from mxeon.conformance.samples import Array, Batch, Candidate, sky
from mxeon.conformance.spec import COMPONENTS
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.conformance.specs.emission import EmissionSpec, MediumSpec
from mxeon.conformance.specs.utilities import UtilitySpec
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
from mxeon.shaders.nodes import FLAG

Measure: TypeAlias = Callable[[Case], Iterable[Compared]]

PLACELESS = (MediumSpec, UtilitySpec)  # nodes without a view and a light
SINGLY_RIGHT = "each value on its own is within tolerance"
UNKNOWN = "the cause is unknown"
OTHER_AVERAGE = "the compensation uses a different average of the film's reflectance"
UNMASKED = "the visible facets are not weighted by masking and shadowing"
# Diagnoses after which the values of the check itself are searched for a range of an input.
UNTOLD = (SINGLY_RIGHT, UNKNOWN, OTHER_AVERAGE, UNMASKED)
WORST = 32  # pairs of which one input is changed, and the fewest that have to be wrong
CURES = 2  # inputs that are named
DIMMING = ("weight", "occlusion")  # inputs that make any error small
SHOWN = 0.1  # share of the light that has to be left where another input is changed
# Share of the distance to any other explanation up to which one explains all, and up to which it is
# called the nearest.
SAME, NEAR = 0.03, 0.3
NAMED = 0.5  # share of the values' own size up to which the closest model is named
INEXACT = 30.0  # tolerances up to which the right model is called inexact, and not another one
LEAST_LIGHT = 1e-3  # cosine of the light up to which factors of it cannot be told apart


@dataclass(frozen=True)
class Diagnosis:
    """The explanation of some values."""

    text: str = ""  # the model, defect or fault that explains them; or where they are wrong
    # Root-mean-square distance to every model and defect, by title, in units of pi f cos.
    distances: dict[str, float] = field(default_factory=dict)
    permitted: bool = (
        False  # whether a function that the specification leaves open gives all values
    )


def sentence(distances: Sequence[tuple[str, float]]) -> str:
    """The nearest models in words, of titles and root-mean-square distances, nearest first.

    >>> sentence([("Lambert", 0.001), ("EON", 0.25)])
    'best match: Lambert (rms 0.001), then EON (0.25)'
    """
    (first, least), *others = distances[:2]
    then = "".join(f", then {second} ({next_least:.2g})" for second, next_least in others)
    return f"best match: {first} (rms {least:.2g}){then}"


def explain(
    case: Case,
    cases: Sequence[Compared],
    candidates: Sequence[Candidate],
    faults: Sequence[Fault],
    tolerance: Tolerance,
    measure: Measure | None = None,
) -> Diagnosis:
    """The explanation of values, by candidates and by faults on the way to the first, the own one.

    `candidates` are functions that may give the values, its own model first; a value is right up to the
    tolerance. `measure` compares the values of a case.
    """
    if text := not_finite(cases):  # it has no distance to anything
        return Diagnosis(text)
    few = case.samples.counts.diagnosed
    short = [Compared(batch.first(few), *(each[:few] for each in rest)) for batch, *rest in cases]
    # Many a fault leaves the inputs of the own model alone.
    own = replace(candidates[0], values=Remembered(candidates[0].values))
    candidates = [own, *candidates[1:]]
    models = {each.title: _distance(short, each, Fault(""), tolerance) for each in candidates}
    ranking = sorted(models.items(), key=lambda item: item[1])
    # Look for a fault of the first where no other explains the values.
    if ranking[0][0] == own.title or ranking[0][1] > tolerance.value:
        names = [each.name for each in case.spec.inputs if each.name not in DIMMING]
        exchanged = exchanges(names) if faults else ()
        # The factor by which the expected values come nearest to the measured ones.
        weighed = [(each, np.maximum(1.0, np.abs(each.expected)) ** 2) for each in short]
        squares = sum(np.sum(each.expected**2 / scale) for each, scale in weighed)
        products = sum(np.sum(each.expected * each.measured / scale) for each, scale in weighed)
        factor = float(products / squares) if squares else 1.0
        faults = (*faults, *exchanged, scaled_by(factor))
        distances = {fault.text: _distance(short, own, fault, tolerance) for fault in faults}
        (text, least), *others = sorted(distances.items(), key=lambda item: item[1])
        rival = min([*models.values(), *(distance for _, distance in others)])
        enough = max(SAME * rival, tolerance.value)
        if least <= SAME * models[own.title] and least <= enough:
            return Diagnosis(f"fault: {text} (rms {least:.2g})", models)
    nearest = next(each for each in candidates if each.title == ranking[0][0])
    # What is near on average may be far off where values are wrong.
    near, far = (
        max(tolerance.metric(each.measured, model.values(each.batch)).max() for each in short)
        for model in (nearest, own)
    )
    explains = nearest is not own and near <= max(tolerance.value, SAME * far)
    text = _model(case, cases, ranking, own.title, tolerance, measure, explains)
    permitted = nearest.permitted and not any(
        tolerance.wrong(each._replace(expected=nearest.values(each.batch))).any() for each in cases
    )
    return Diagnosis(text, models, permitted)


def _distance(
    cases: Sequence[Compared], candidate: Candidate, fault: Fault, tolerance: Tolerance
) -> float:
    """Root-mean-square distance of the measured values from those of a candidate with a fault.

    A roughness above 1 is left out, which not every model takes; and light up to LEAST_LIGHT. Where the
    tolerance is that of a mean, values have noise and means are compared.
    """
    errors = []
    for case in cases:
        try:
            values = fault.values(case.batch, candidate.values(fault.batch(case.batch)))
        except ValueError:  # inputs that are exchanged may lie outside each other's domain
            return float("inf")
        kept = case.batch.rough <= 1.0
        if "albedo" not in tolerance.unit:
            kept &= np.abs(case.batch.wi[:, 2]) > LEAST_LIGHT
        error = ((case.measured - values) / tolerance.scale(case.expected))[kept]
        errors.append(
            error.mean(axis=0, keepdims=True) if tolerance.metric is mean_error else error
        )
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _model(
    case: Case,
    cases: Sequence[Compared],
    ranking: Sequence[tuple[str, float]],
    own: str,
    tolerance: Tolerance,
    measure: Measure | None,
    explains: bool,
) -> str:
    """The closest model, which may explain every wrong value, the region that is wrong, or that no model is close."""
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    (first, least), (_, rival) = ranking[:2]
    # Another model explains all.
    if explains and least <= max(tolerance.value, SAME * rival):
        flags = (
            f", as with {FLAG} {str(spec.flag).lower()}"
            for spec in DIFFUSE
            if spec.node == case.spec.node and spec.title != case.spec.title
            if reference.diffuse_model(spec.model).title == first
        )
        return sentence(ranking) + next(flags, "")
    # Its own model is correct except in a region or for a range of an input, or not accurate enough.
    if (place := region(cases, tolerance)) or not wrong.any():
        return place or SINGLY_RIGHT
    place, values, mostly = span(cases, tolerance), "", wrong.mean() < 0.5
    if first != own and least <= NEAR * rival:
        few = f"{correct_except(cases, tolerance, place)}; " if place and mostly else ""
        return few + sentence(ranking)
    if not place and measure and np.count_nonzero(wrong) >= WORST and mostly:
        cures = _cures(case, cases, tolerance, measure)
        weak = span(cases, tolerance, WEAK) if len(cures) == 1 else ""
        place = weak if weak and cures[0].split()[0] in weak.split() else ""
        values = " or ".join(cures[:CURES])
    if place:
        return correct_except(cases, tolerance, place)
    errors = [tolerance.metric(each.measured, each.expected) for each in cases]
    if first == own and max(map(np.max, errors)) <= INEXACT * tolerance.value:
        right = f"; the worst are right with {values}" if values else ""
        return f"right model, {own} (rms {least:.2g}), but not accurate enough{right}"
    if values:
        return f"{correct_except(cases, tolerance)}; the worst are right with {values}"
    part = f"{100.0 * wrong.mean():.3g} % of the pairs"
    index = int(np.argmax(list(map(np.max, errors))))
    row, batch = int(errors[index].argmax()), cases[index].batch
    lit = "albedo" not in tolerance.unit and not isinstance(case.spec, EmissionSpec)
    light = f" and a light cosine of {batch.wi[row, 2]:.2g}" * lit
    place = f"at a view cosine of {batch.wo[row, 2]:.2g}{light}"
    if measure and case.backend.any_pairs:
        same = measure(replace(case, asked=(batch.where(np.full(4, row)),)))
        if not any(tolerance.wrong(each).any() for each in same):
            return f"wrong for {part}; the worst are right beside pixels with the same inputs"
    if isinstance(case.spec, PLACELESS):
        point = point_of(batch, row)
        numbers = (
            f"{port.name} {' '.join(f'{each:.3g}' for each in point[port.name])}"
            for port in case.spec.inputs
            if port.name in point
        )
        place = f"with {', '.join(numbers)}"
    if first == own and mostly:
        return f"correct except for {part}; worst {place}"
    # What is off by as much as black would be resembles nothing.
    black = Candidate("", lambda batch: np.zeros((len(batch.wo), 1)))
    near = least < NAMED * _distance(cases, black, Fault(""), tolerance)
    closest = f", the closest is {first} (rms {least:.2g})" if near else ""
    return f"no known model matches{closest}; wrong for {part}, worst {place}"


def searched(text: str, cases: Sequence[Compared], tolerance: Tolerance) -> str:
    """A diagnosis that names no cause, or the region or the range of an input that holds all wrong values."""
    if place := place_of(cases, tolerance):
        return correct_except(cases, tolerance, place)
    if text == SINGLY_RIGHT and tolerance.metric in (absolute, relative, scaled):
        return f"wrong for {share(cases, tolerance)}"
    return text


def _cures(
    case: Case,
    cases: Sequence[Compared],
    tolerance: Tolerance,
    measure: Measure,
) -> list[str]:
    """Values of single inputs with which the worst values are right."""
    most = max(cases, key=lambda each: np.count_nonzero(tolerance.wrong(each)))
    worst = np.argsort(tolerance.metric(most.measured, most.expected))[-WORST:]
    batch, found = most.batch.where(worst), []
    # An input that only darkens what should be dark cures nothing.
    light = np.maximum(np.abs(most.expected), np.abs(most.measured))[worst]
    least = SHOWN * min(float(light.mean()), 1.0)
    for port in case.spec.inputs:
        if port.name not in batch.inputs or port.type not in COMPONENTS or port.name in DIMMING:
            continue
        ends = (port.high, *port.edges, port.low) if np.ndim(port.high) == 0 else ()
        for value in dict.fromkeys(float(np.ravel(end)[0]) for end in ends):
            changed = batch.altered(**{port.name: np.full_like(batch.inputs[port.name], value)})
            compared = list(measure(replace(case, asked=(changed,))))
            wrong = any(tolerance.wrong(each).any() for each in compared)
            if not wrong and min(float(np.abs(each.expected).mean()) for each in compared) >= least:
                found.append(f"{port.name} {value:g}")
                break
    return found


def not_finite(cases: Sequence[Compared]) -> str:
    """Where values are not finite; "" if all are."""
    zeros = list(map(unbounded, cases))
    if not any(EXACT.wrong(each).any() for each in zeros):
        return ""
    return f"NaN or infinity {place_of(zeros, EXACT)}".rstrip()


# What is compared with what, by quantity.


@dataclass(frozen=True, eq=False)
class Comparison:
    """Values of a quantity against the ones expected."""

    quantity: str  # by whose error they are judged
    compared: Callable[[Case], Iterable[Compared]]
    candidates: Callable[[Case], Sequence[Candidate]]  # that may explain them, its own model first
    faults: Sequence[Fault] = ()  # of the way from the inputs to that model

    def __call__(self, case: Case) -> Iterable[Compared]:
        return self.compared(case)

    def diagnose(self, case: Case) -> Diagnosis:
        """The explanation of a case, made once: several checks of a node fail for one reason."""
        known = case.explained
        if self not in known:
            tolerance = case.tolerance(self.quantity, "value")
            compared = list(self.compared(case))
            candidates = self.candidates(case)
            known[self] = explain(case, compared, candidates, self.faults, tolerance, self.compared)
        found: Diagnosis = known[self]
        return found


def _rests(case: Case) -> Sequence[Candidate]:
    """Functions that may explain throughputs: what each albedo leaves, or all light."""
    *own, nothing = case.albedo_candidates
    named = [*own, replace(nothing, title="all light passes", permitted=False)]

    def rest(candidate: Candidate) -> Callable[[Batch], Array]:
        return lambda batch: np.maximum(1.0 - candidate.values(batch), 0.0)

    return [replace(each, values=rest(each)) for each in named]


def _backs(case: Case) -> Iterator[Compared]:
    """Radiance towards views from the back."""
    batch = case.samples.take(case.of(EmissionSpec).backs)
    yield case.valued.alike(Compared(batch, case.direct(batch), case.expected(batch)))


def _alike(case: Case) -> Sequence[Candidate]:
    """Functions that may explain values, in the unit in which their errors are alike."""

    def alike(candidate: Candidate, batch: Batch) -> Array:
        values = candidate.values(batch)
        return case.valued.alike(Compared(batch, values, values)).expected

    return [replace(each, values=partial(alike, each)) for each in case.valued.value_candidates]


def _transmittances(case: Case) -> Iterator[Compared]:
    """Light through a medium and the throughput of a surface over it, against its transmittance."""
    spec, evaluate = case.of(MediumSpec), case.evaluating.evaluate
    [batch] = case.batches
    expected = case.expected(batch)
    yield Compared(batch, case.direct(batch), expected)
    lit = batch.altered(**{"top/weight": 1.0})
    coefficients = (each for each in spec.names if np.shape(batch.inputs[each])[1:])
    clear = lit.altered(**dict.fromkeys(coefficients, (0.0, 0.0, 0.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        through = evaluate(lit, "transmission") / evaluate(clear, "transmission")
    yield Compared(batch, through, expected)


VALUES, ALBEDOS = attrgetter("valued.value_candidates"), attrgetter("albedo_candidates")
VALUE = Comparison("value", values, VALUES, DIRECT_FAULTS)
ALBEDO = Comparison("albedo", albedos, ALBEDOS, ENVIRONMENT_FAULTS)
# Of a layer, for light from above, and for light through the base.
THROUGHPUT = Comparison("throughput", lambda case: throughputs(case, *LIGHT), _rests)
TRANSMISSION = Comparison("throughput", lambda case: throughputs(case, "transmission"), _rests)
# Of a utility node, or of an emission from the front.
OUTPUT = Comparison(
    "value", lambda case: map(case.valued.alike, values(case)), _alike, COLOR_FAULTS
)
BACK = Comparison("value", _backs, _alike)
TRANSMITTANCE = Comparison("value", _transmittances, VALUES)


# What surrounds a model: the throughput, the frame and the environment.

# The irradiance that a wrong look-up finds, by what it does.
LOOKUPS: dict[str, Callable[[Batch], Array]] = {
    "opposite to the normal": lambda batch: sky(-batch.normal),
    "toward the viewer": lambda batch: sky(batch.world(batch.wo)),
    "away from the viewer": lambda batch: sky(-batch.world(batch.wo)),
    "toward the light": lambda batch: sky(batch.world(batch.wi)),
    "along the mirror direction": lambda batch: sky(batch.world(batch.wo * [-1.0, -1.0, 1.0])),
    "along the surface's normal instead of the node's": lambda batch: sky(
        np.broadcast_to(UP, batch.wo.shape)
    ),
    "along the surface's normal turned toward the viewer, instead of the node's": lambda batch: sky(
        np.where(batch.world(batch.wo)[:, 2:] < 0.0, -1.0, 1.0) * UP
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


def diagnose_throughput(passed: Mapping[tuple[str, str], Sequence[Compared]]) -> Diagnosis:
    """The outputs that are not 0, with their values and branches."""
    branches: dict[str, list[str]] = {}
    for (output, branch), compared in passed.items():
        values = np.concatenate([each.measured[EXACT.wrong(each)] for each in compared])
        if len(values):
            number = f"{values.flat[0]:.3g}" if np.ptp(values) == 0.0 else "not 0"
            place = smallest(compared, EXACT)
            branches.setdefault(f"{output} {number} {place}".rstrip(), []).append(branch)
    texts = (f"{text} (branches: {', '.join(each)})" for text, each in branches.items())
    return Diagnosis("; ".join(texts))


def diagnose_frame(case: Case) -> Diagnosis:
    """Whether the normal is dropped or not turned, in the first branch that is wrong."""
    tolerance = case.tolerance("frame")
    for compared, branch in zip(frames(case), ("direct", "environment"), strict=True):
        if not tolerance.wrong(compared).any():
            continue
        expected = case.expected if branch == "direct" else case.expected_albedo
        dropped = compared._replace(expected=expected(normal_ignored(compared.batch)))
        if not tolerance.wrong(dropped).any():
            text = "the node's normal is ignored; the surface's is used instead"
        else:
            # Where it is wrong, or which axis has no effect.
            text = not_finite([compared]) or region([compared], tolerance)
            text = text or without_effect(case, "normal") or without_effect(case, "tangent")
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


def diagnose_surroundings(compared: Compared, tolerance: Tolerance) -> Diagnosis:
    """The direction at which the environment is looked up."""
    batch, measured, expected = compared
    irradiances = {
        **{words: found(batch) for words, found in LOOKUPS.items()},
        # With every normal turned around the sky is 1 minus itself.
        "on the other side of the surface": 1.0 - expected,
        "on the viewer's side alone": sky(batch.normal),
    }
    for words, irradiance in irradiances.items():
        if np.sqrt(np.mean((measured - irradiance) ** 2)) <= tolerance.value:
            return Diagnosis(f"the environment is looked up {words}")
    return Diagnosis(not_finite([compared]) or region([compared], tolerance) or UNKNOWN)
