# SPDX-License-Identifier: Apache-2.0
"""A check: a claim, what is measured of a case, how wrong it may be, and the control that it must catch.

A check passes at error <= tolerance. Its control is the same case with other inputs or outputs, on the same
engine; the check has to fail on it.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.backends import Backend
from mxeon.conformance.case import Case
from mxeon.conformance.diagnosis import UNTOLD, VALUE, Comparison, searched
from mxeon.conformance.results import (
    DIFFERS,
    FAILED,
    NOT_RUN,
    PASSED,
    Cause,
    Diagnosis,
    Kind,
    Result,
    quoted,
)
from mxeon.conformance.results import Control as Caught
from mxeon.conformance.samples import Array, Batch
from mxeon.conformance.spec import Spec
from mxeon.conformance.tolerance import Compared, Measurement, Metric, Tolerance, worst_of
from mxeon.errors import Implied, NotRun, OutsideModel, ShaderError
from mxeon.hosts.base import RendererWarning
from mxeon.shaders.methods import GENERATED, Methods

Measure: TypeAlias = Callable[[Case], Compared | Iterable[Compared] | Measurement]

M = TypeVar("M", bound=Callable[..., Any])


@dataclass(frozen=True)
class Control:
    """A mistake that a check must catch: in words, and the case that makes it."""

    words: str
    make: Callable[[Case], Case]

    def of(self, case: Case) -> Case:
        return replace(self.make(case), control=True)


@dataclass(frozen=True)
class Check:
    """A claim about nodes."""

    key: str  # one word
    claim: str  # a sentence
    applies: Callable[[Spec], bool]
    measure: Measure  # the worst row counts, or a number of its own
    control: Control
    quantity: str  # by whose error it is judged
    diagnose: Callable[[Case], Diagnosis]
    tolerance: Tolerance | None = None  # where it is the same for all
    pairs: bool = False  # whether it needs pairs of directions that not every host has
    # Whether it is about how light is found, summed or let through, unlike closures.
    lit: bool = False
    # Of the text that it asks, not the rasterizer's; it is made where a node is asked for by name.
    profile: str = ""
    # Whether an error differs, and does not fail, where a permitted function explains it.
    open: bool = False
    # Whether it can be asked on the host of a name.
    hosts: Callable[[Spec, str], bool] = lambda spec, host: True
    # Whether it can be asked with a client's methods.
    methods: Callable[[Spec, Methods], bool] = lambda spec, methods: True

    def measured(self, case: Case, metric: Metric) -> Measurement:
        """The worst error of a case."""
        found = self.measure(case)
        if isinstance(found, Measurement):
            return found
        return worst_of(metric, [found] if isinstance(found, Compared) else found)

    def applies_to(
        self, spec: Spec, backend: type[Backend], host: str, methods: Methods = GENERATED
    ) -> bool:
        """Whether it is asked about a node on a host, by one of its backends, with a client's methods."""
        if not (self.applies(spec) and self.hosts(spec, host) and self.methods(spec, methods)):
            return False
        if (self.pairs and not backend.any_pairs) or (self.lit and isinstance(spec, backend.unlit)):
            return False
        return (self.tolerance or backend.error(spec, self.quantity)) is not None

    def judge(self, case: Case) -> Result:
        """The result for a case, with its control and, on failure, a diagnosis."""
        names = self.key, self.claim, case.spec.title, case.host.name, case.library
        place = Result(*names, NOT_RUN, **case.backend.claims)
        tolerance = self.tolerance or case.tolerance(self.quantity)

        def diagnose() -> Diagnosis:
            diagnosis = self.diagnose(case)  # a permitted function excuses an open check alone
            causes = diagnosis.causes
            if diagnosis.first in UNTOLD and not isinstance(
                found := self.measure(case), Measurement
            ):
                compared = [found] if isinstance(found, Compared) else list(found)
                causes = (searched(diagnosis.first, compared, tolerance),)
            return replace(diagnosis, causes=causes, permitted=self.open and diagnosis.permitted)

        return judge(
            place,
            tolerance,
            lambda wrong: self.measured(self.control.of(case) if wrong else case, tolerance.metric),
            self.control.words,
            diagnose,
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
        verdict=PASSED if passed and caught else DIFFERS if diagnosis.permitted else FAILED,
        error=right.error,
        quantity=tolerance.quantity,
        tolerance=tolerance.value,
        derivation=tolerance.derivation,
        worst=right.worst,
        diagnosis=diagnosis,
        control=Caught(variant, wrong.error, caught),
    )


def not_measured(place: Result, error: NotRun | ShaderError) -> Result:
    """The result of a check without a measurement: not run, or failed by a shader error."""
    if isinstance(error, ShaderError):
        return replace(place, verdict=FAILED, diagnosis=quoted(str(error)))
    causes: tuple[Cause, ...] = ()
    if isinstance(error, Implied):
        causes = (Cause(Kind.FOLLOWS),)
    if isinstance(error, OutsideModel) and error.input:
        causes = (Cause(Kind.INPUT, names=(error.input,)),)
    return replace(place, reason=str(error), diagnosis=Diagnosis(causes))


def of_family(*kinds: type[Spec]) -> Callable[[Spec], bool]:
    """Whether a spec is one of these families."""
    return lambda spec: isinstance(spec, kinds)


CHECKS: list[Check] = []  # in the order in which they are defined


def check(
    applies: Callable[[Spec], bool],
    control: Control,
    judged: str | Comparison = "",
    key: str = "",
    claim: str = "",
    diagnose: Callable[[Case], Diagnosis] | Diagnosis | None = None,
    **rest: Any,
) -> Callable[[M], M]:
    """Make a function that measures a case a check: its name is the key, its first line the claim.

    It is judged by the error of a quantity, which has its key's name unless given; or judged and explained as a
    comparison is, which also measures if the function takes no case. A diagnosis may be the same for all failures.
    """

    def add(measure: M) -> M:
        name = key or getattr(measure, "__name__", "")
        words = claim or (measure.__doc__ or "").split("\n")[0]
        own = judged if isinstance(judged, Comparison) else None
        asks = own if own and not signature(measure).parameters else measure
        quantity = own.quantity if own else str(judged or name)
        explain = diagnose or (own or VALUE).diagnose
        if isinstance(explain, Diagnosis):
            always = explain
            explain = lambda case: always  # noqa: E731
        CHECKS.append(Check(name, words, applies, asks, control, quantity, explain, **rest))
        return measure

    return add


# Controls.


def control(words: str) -> Callable[[Callable[[Case], Case]], Control]:
    return lambda make: Control(words, make)


def with_batch(words: str, change: Callable[[Batch], Batch]) -> Control:
    """The engine gets another batch than the one that is asked."""
    return Control(words, lambda case: replace(case, inputs=change))


def with_inputs(words: str, **inputs: ArrayLike) -> Control:
    return with_batch(words, lambda batch: batch.altered(**inputs))


def with_values(words: str, change: Callable[[Batch, Array], Array]) -> Control:
    return Control(words, lambda case: replace(case, outputs=change))


def scale(words: str, factor: float) -> Control:
    return with_values(words, lambda batch, values: factor * values)


def scale_cosine(words: str, power: int) -> Control:
    """Values carry a power of cos(theta_o) too many."""

    def change(batch: Batch, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(values * batch.wo[:, 2:] ** power)

    return with_values(words, change)


offset = with_values("0.001 is added to every value", lambda batch, values: values + 1e-3)
no_number = with_values(
    "one output is not a number",
    lambda batch, values: np.where(np.arange(len(values))[:, None], values, np.nan),
)
pass_all = Control(
    "all light passes",
    lambda case: replace(case, throughputs=lambda batch, values: np.ones_like(values)),
)
take_response = Control(
    "the response is returned as the throughput",
    lambda case: replace(case, throughputs=lambda batch, values: case.direct(batch)),
)
drop_changes = Control(
    "every change is dropped", lambda case: replace(case, inputs=lambda batch: case.few[0])
)


def _mean_colors(batch: Batch) -> Batch:
    colors = {
        name: np.repeat(np.mean(values, axis=-1, keepdims=True), 3, axis=-1)
        for name, values in batch.inputs.items()
        if name != "normal" and np.shape(values)[-1:] == (3,)
    }
    return batch.altered(**colors)


gray = with_batch("every channel gets the mean color", _mean_colors)
shifted = with_batch(
    "each row uses the inputs of another row",
    lambda batch: batch.altered(**{k: np.roll(v, 1, axis=0) for k, v in batch.inputs.items()}),
)
