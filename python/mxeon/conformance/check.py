# SPDX-License-Identifier: Apache-2.0
"""A check: a claim, what is measured of a case, how wrong it may be, and the control that it must catch.

A check passes at error <= tolerance. Its control is the same case with other inputs or outputs, on the same
engine; the check has to fail on it.
"""

import math
import warnings
from collections.abc import Callable, Iterable
from copy import copy
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

import numpy as np

from mxeon.conformance import results
from mxeon.conformance.backends import Backend
from mxeon.conformance.case import Case
from mxeon.conformance.controls import Control
from mxeon.conformance.diagnosis import UNTOLD, Comparison, searched
from mxeon.conformance.diagnosis.regions import errors
from mxeon.conformance.results import Cause, Diagnosis, Kind, Result
from mxeon.conformance.spec import NO_ABILITY, Ability, LobeSpec, Spec, ValueSpec
from mxeon.conformance.tolerance import Compared, Measurement, Tolerance, worst_of
from mxeon.errors import Implied, NotRun, OutsideModel, ShaderError
from mxeon.hosts.base import RendererWarning
from mxeon.shaders.methods import GENERATED, Methods

Measure: TypeAlias = Callable[[Case], Compared | Iterable[Compared] | Measurement]
Explain: TypeAlias = Callable[[Case], Diagnosis]
S = TypeVar("S", bound=Spec)


@dataclass(frozen=True)
class Specs:
    """A set of specs; `|`, `&` and `-` combine them."""

    holds: Callable[[Spec], bool]

    def __call__(self, spec: Spec) -> bool:
        return self.holds(spec)

    def __or__(self, other: "Specs") -> "Specs":
        return Specs(lambda spec: self(spec) or other(spec))

    def __and__(self, other: "Specs") -> "Specs":
        return Specs(lambda spec: self(spec) and other(spec))

    def __sub__(self, other: "Specs") -> "Specs":
        return Specs(lambda spec: self(spec) and not other(spec))


def family(kind: type[S], holds: Callable[[S], bool] = lambda spec: True) -> Specs:
    """The specs of a family, or some of them."""
    return Specs(lambda spec: isinstance(spec, kind) and holds(spec))


def compared_of(found: Compared | Iterable[Compared] | Measurement) -> list[Compared]:
    """What was compared; none for a number of its own."""
    if isinstance(found, Measurement):
        return []
    return [found] if isinstance(found, Compared) else list(found)


def always(diagnosis: Diagnosis) -> Explain:
    """The same explanation of every failure."""
    return lambda case: diagnosis


@dataclass(frozen=True, kw_only=True)
class Check:
    """A claim about nodes."""

    key: str  # one word
    claim: str  # a sentence
    applies: Specs
    measure: Measure  # the worst row counts, or a number of its own
    tolerance: str | Tolerance  # an error of the spec, by its name, or the same for all
    control: Control
    explain: Explain
    requires: Ability = NO_ABILITY  # what a backend must support to be judged
    # Profile of the generated text, if not the rasterizer's; only for nodes that the user names.
    profile: str = ""
    # Whether an error differs, and does not fail, where a permitted function explains it.
    open: bool = False
    # Whether it can be measured on the host of a name, and with a client's methods.
    hosts: Callable[[Spec, str], bool] = lambda spec, host: True
    methods: Callable[[Spec, Methods], bool] = lambda spec, methods: True

    def measured(self, case: Case, tolerance: Tolerance) -> Measurement:
        """The worst error of a case; all of its errors if that is too large."""
        found = self.measure(case)
        if isinstance(found, Measurement):
            return found
        compared = compared_of(found)
        worst = worst_of(tolerance.metric, compared)
        if case.control or worst.error <= tolerance.value:
            return worst
        return Measurement(worst.error, worst.worst, *errors(compared, tolerance))

    def gives(self, case: Case, title: str, tolerance: Tolerance) -> bool:
        """Whether a permitted function gives the engine's values for the check's own samples.

        Negative values, which the check `dark` judges, count as 0.
        """
        model = copy(case.backend)  # with values of that function
        for name, candidates in (
            ("direct", case.spec.all_candidates if isinstance(case.spec, ValueSpec) else ()),
            ("albedo", case.albedo_candidates if isinstance(case.spec, LobeSpec) else ()),
        ):
            for each in candidates:
                if each.title == title:
                    vars(model)[name] = lambda batch, *_, values=each.values: values(batch)
        lit = replace(case, outputs=lambda batch, values: np.maximum(values, 0.0))
        found = [self.measure(each) for each in (lit, replace(lit, backend=model))]
        return all(
            not tolerance.wrong(Compared(own.batch, *columns)).any()
            for own, other in zip(*map(compared_of, found), strict=True)
            for columns in zip(own[1:], other[1:], strict=True)
        )

    def applies_to(
        self, spec: Spec, backend: type[Backend], host: str, methods: Methods = GENERATED
    ) -> bool:
        """Whether a node is judged by it on a host, by one of its backends, with a client's methods."""
        if not (self.applies(spec) and self.hosts(spec, host) and self.methods(spec, methods)):
            return False
        own = self.tolerance
        judged = isinstance(own, Tolerance) or backend.errors(spec).get(own) is not None
        return judged and self.requires in backend.abilities

    def allowed(self, case: Case) -> Tolerance:
        """The largest error of a case that passes."""
        own = self.tolerance
        return own if isinstance(own, Tolerance) else case.tolerance(own)

    def judge(self, case: Case) -> Result:
        """The result for a case, with its control and, on failure, a diagnosis."""
        names = self.key, self.claim, case.spec.title, case.host.name, case.library
        place = Result(*names, results.NOT_RUN, **case.backend.claims)
        tolerance = self.allowed(case)

        def explain() -> Diagnosis:
            diagnosis = self.explain(case)  # a permitted function excuses an open check alone
            causes = diagnosis.causes
            if diagnosis.first in UNTOLD and (compared := compared_of(self.measure(case))):
                causes = (searched(diagnosis.first, compared, tolerance),)
            permitted = self.open and diagnosis.permitted
            if permitted and not isinstance(self.measure, Comparison) and diagnosis.distances:
                permitted = self.gives(case, diagnosis.first.key, tolerance)
            return replace(diagnosis, causes=causes, permitted=permitted)

        return judge(
            place,
            tolerance,
            lambda wrong: self.measured(self.control.of(case) if wrong else case, tolerance),
            self.control.words,
            explain,
        )


def judge(
    place: Result,
    tolerance: Tolerance,
    measure: Callable[[bool], Measurement],
    variant: str,
    diagnose: Callable[[], Diagnosis],
) -> Result:
    """The result of a check that measures a subject, and its control if True, whose mistake is `variant`.

    `place` is the result of a check that is not run: it stays so without an engine; a shader error fails it.
    The renderer's own warnings are part of a diagnosis, others are shown with their own lines.
    """
    try:
        with warnings.catch_warnings(record=True) as records:
            warnings.simplefilter("always", RendererWarning)
            right, wrong = measure(False), measure(True)
            diagnosis = diagnose() if right.error > tolerance.value else Diagnosis()
    except (NotRun, ShaderError) as error:
        return not_measured(place, error)
    notes: dict[str, None] = {}  # each once
    for record in records:
        if isinstance(record.message, RendererWarning):
            notes[str(record.message)] = None
        else:
            warnings.showwarning(record.message, record.category, record.filename, record.lineno)
    caught, passed = wrong.error > tolerance.value, right.error <= tolerance.value
    if passed and not caught:
        diagnosis = Diagnosis((Cause(Kind.CONTROL),), diagnosis.distances)
    elif diagnosis.causes:
        own = tuple(Cause(Kind.TEXT, text=each) for each in notes)
        diagnosis = replace(diagnosis, causes=diagnosis.causes + own)
    return replace(
        place,
        verdict=results.PASSED
        if passed and caught
        else results.DIFFERS
        if diagnosis.permitted and math.isfinite(right.error)
        else results.FAILED,
        error=right.error,
        quantity=tolerance.quantity,
        tolerance=tolerance.value,
        derivation=tolerance.derivation,
        worst=right.worst,
        errors=right.errors,
        samples=right.samples,
        diagnosis=diagnosis,
        control=results.Control(variant, wrong.error, caught),
    )


def not_measured(place: Result, error: NotRun | ShaderError) -> Result:
    """The result of a check without a measurement: not run, or failed by a shader error."""
    if isinstance(error, ShaderError):
        return replace(place, verdict=results.FAILED, diagnosis=results.quoted(str(error)))
    causes: tuple[Cause, ...] = ()
    if isinstance(error, Implied):
        causes = (Cause(Kind.FOLLOWS),)
    if isinstance(error, OutsideModel) and error.input:
        causes = (Cause(Kind.INPUT, names=(error.input,)),)
    return replace(place, reason=str(error), diagnosis=Diagnosis(causes))
