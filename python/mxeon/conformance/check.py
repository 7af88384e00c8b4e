# SPDX-License-Identifier: Apache-2.0
"""A check has a claim, a measurement of a case, a tolerance, and a negative control.

A check passes if the error is at most the tolerance, and if the check fails on the negative
control, which is the same case with wrong inputs or outputs.
"""

import math
import warnings
from collections.abc import Callable, Iterable
from copy import copy
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

import numpy as np

from mxeon.conformance import backends, controls, results
from mxeon.conformance.case import Case
from mxeon.conformance.diagnosis import UNEXPLAINED, UNTOLD, Comparison, regions, searched
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
    """A set of specs, defined by a condition. The operators `|`, `&` and `-` combine sets."""

    contains: Callable[[Spec], bool]

    def __call__(self, spec: Spec) -> bool:
        return self.contains(spec)

    def __or__(self, other: "Specs") -> "Specs":
        return Specs(lambda spec: self(spec) or other(spec))

    def __and__(self, other: "Specs") -> "Specs":
        return Specs(lambda spec: self(spec) and other(spec))

    def __sub__(self, other: "Specs") -> "Specs":
        return Specs(lambda spec: self(spec) and not other(spec))


def family(kind: type[S], condition: Callable[[S], bool] = lambda spec: True) -> Specs:
    return Specs(lambda spec: isinstance(spec, kind) and condition(spec))


def compared_of(measured: Compared | Iterable[Compared] | Measurement) -> list[Compared]:
    """The comparisons that a check's function returns, or none if the function returns a number."""
    if isinstance(measured, Measurement):
        return []
    return [measured] if isinstance(measured, Compared) else list(measured)


@dataclass(frozen=True, kw_only=True)
class Check:
    """A claim about nodes, with a measurement, a tolerance and a negative control."""

    key: str  # a single word
    claim: str  # a full sentence
    applies: Specs
    measure: Measure  # returns a single number, or comparisons whose worst row is judged
    # A tolerance for all specs, or a key of `Spec.errors`. The default is the key of the compared
    # quantity or, without a comparison, the check's key.
    tolerance: str | Tolerance = ""
    control: controls.Control
    explain: Explain | Diagnosis | None = None  # comparisons have a default explanation
    requires: Ability = NO_ABILITY  # abilities that the check requires of a backend
    # Profile of generated shaders, such as "path" for path tracers, or "" for rasterizers. Checks
    # with a profile other than "" only run for nodes that the user names.
    profile: str = ""
    # Whether the verdict is "differs" instead of "failed" if a permitted function explains the
    # values.
    open: bool = False
    # Whether a spec can be measured on the named host, and with a client's lighting methods.
    hosts: Callable[[Spec, str], bool] = lambda spec, host: True
    methods: Callable[[Spec, Methods], bool] = lambda spec, methods: True

    def measured(self, case: Case, tolerance: Tolerance) -> Measurement:
        """The worst error of a case, and the errors of all samples if the check fails."""
        measured = self.measure(case)
        if isinstance(measured, Measurement):
            return measured
        compared = compared_of(measured)
        worst = worst_of(tolerance.metric, compared)
        if case.control or worst.error <= tolerance.value:
            return worst
        return Measurement(worst.error, worst.worst, *regions.errors(compared, tolerance))

    def is_reproduced(self, case: Case, title: str, tolerance: Tolerance) -> bool:
        """Whether the function `title` reproduces the engine's values on the check's samples.

        Negative values count as 0, because the check `dark` judges negative values.
        """
        model = copy(case.backend)  # a backend that returns the values of the function `title`
        for name, candidates in (
            ("direct", case.spec.all_candidates if isinstance(case.spec, ValueSpec) else ()),
            ("albedo", case.candidates("albedo") if isinstance(case.spec, LobeSpec) else ()),
        ):
            for each in candidates:
                if each.title == title:
                    vars(model)[name] = lambda batch, *_, values=each.values: values(batch)
        engine = replace(case, outputs=lambda batch, values: np.maximum(values, 0.0))
        measured = [self.measure(each) for each in (engine, replace(engine, backend=model))]
        return all(
            not tolerance.wrong(Compared(one.batch, *columns)).any()
            for one, other in zip(*map(compared_of, measured), strict=True)
            for columns in zip(one[1:], other[1:], strict=True)
        )

    @property
    def judged(self) -> str | Tolerance:
        compared = self.measure.quantity if isinstance(self.measure, Comparison) else self.key
        return self.tolerance or compared

    def applies_to(
        self, spec: Spec, backend: type[backends.Backend], host: str, methods: Methods = GENERATED
    ) -> bool:
        """Whether the check applies to a node on a host, with a client's lighting methods."""
        methods = backend.methods.over(methods)
        key = self.judged
        return (
            self.applies(spec)
            and self.hosts(spec, host)
            and self.methods(spec, methods)
            and self.requires in backend.abilities
            and (isinstance(key, Tolerance) or backend.errors(spec).get(key) is not None)
        )

    def allowed(self, case: Case) -> Tolerance:
        """The tolerance for a case, including errors of the engine's functions."""
        key = self.judged
        return key if isinstance(key, Tolerance) else case.tolerance(key)

    def judge(self, case: Case) -> Result:
        spec, claim = case.spec, case.spec.claim or self.claim
        names = self.key, claim, spec.title, case.host.name, case.library
        claimed, model = case.backend.claims
        place = Result(*names, results.NOT_RUN, claimed=claimed, model=model)
        tolerance = self.allowed(case)

        def explain() -> Diagnosis:
            own = self.measure.diagnose if isinstance(self.measure, Comparison) else UNEXPLAINED
            explained = own if self.explain is None else self.explain
            diagnosis = explained if isinstance(explained, Diagnosis) else explained(case)
            causes = diagnosis.causes
            if diagnosis.first in UNTOLD and (compared := compared_of(self.measure(case))):
                causes = (searched(diagnosis.first, compared, tolerance),)
            # Errors that a permitted function explains are failures unless `open` is set.
            permitted = self.open and diagnosis.permitted
            if permitted and not isinstance(self.measure, Comparison) and diagnosis.distances:
                permitted = self.is_reproduced(case, diagnosis.first.key, tolerance)
            return replace(diagnosis, causes=causes, permitted=permitted)

        def measure(wrong: bool) -> Measurement:
            return self.measured(self.control.of(case) if wrong else case, tolerance)

        return judge(place, tolerance, measure, self.control.words, explain)


def judge(
    place: Result,
    tolerance: Tolerance,
    measure: Callable[[bool], Measurement],
    variant: str,
    diagnose: Callable[[], Diagnosis],
) -> Result:
    """The result of a check.

    `measure(False)` measures the subject, and `measure(True)` measures the negative control, which
    `variant` describes. If a measurement raises an error, the result is `place` with the error. The
    diagnosis quotes the renderer's warnings.
    """
    try:
        with warnings.catch_warnings(record=True) as records:
            warnings.simplefilter("always", RendererWarning)
            measured, control = measure(False), measure(True)
            diagnosis = diagnose() if measured.error > tolerance.value else Diagnosis()
    except (NotRun, ShaderError) as error:
        return not_measured(place, error)
    notes: dict[str, None] = {}  # a dictionary as an ordered set
    for record in records:
        if isinstance(record.message, RendererWarning):
            notes[str(record.message)] = None
        else:
            warnings.showwarning(record.message, record.category, record.filename, record.lineno)
    caught, passed = control.error > tolerance.value, measured.error <= tolerance.value
    verdict: results.Verdict = results.PASSED if passed and caught else results.FAILED
    if passed and not caught:
        diagnosis = Diagnosis((Cause(Kind.CONTROL),), diagnosis.distances)
    elif diagnosis.causes:
        warned = tuple(Cause(Kind.TEXT, text=each) for each in notes)
        diagnosis = replace(diagnosis, causes=diagnosis.causes + warned)
    if diagnosis.permitted and math.isfinite(measured.error):
        verdict = results.DIFFERS
    return replace(
        place,
        verdict=verdict,
        quantity=tolerance.quantity,
        tolerance=tolerance.value,
        derivation=tolerance.derivation,
        diagnosis=diagnosis,
        control=results.Control(variant, control.error, caught),
        **vars(measured),
    )


def not_measured(place: Result, error: NotRun | ShaderError) -> Result:
    """The result of a check without a measurement: "not run", or "failed" for a shader error."""
    if isinstance(error, ShaderError):
        return replace(place, verdict=results.FAILED, diagnosis=results.quoted(str(error)))
    causes: tuple[Cause, ...] = ()
    if isinstance(error, Implied):
        causes = (Cause(Kind.FOLLOWS),)
    if isinstance(error, OutsideModel) and error.input:
        causes = (Cause(Kind.INPUT, names=(error.input,)),)
    return replace(place, reason=str(error), diagnosis=Diagnosis(causes))
