# SPDX-License-Identifier: Apache-2.0
"""Checks of a Python function, for renderers and libraries with bindings."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version
from typing import ClassVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

import mxeon
from mxeon.conformance.checks.application import judge_check
from mxeon.conformance.checks.controls import Altered
from mxeon.conformance.checks.table import CHECKS, Check
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.comparisons import VALUE
from mxeon.conformance.diagnosis.regions import smallest
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.diffuse import CHANGES, ModelSubject
from mxeon.conformance.probes.cases import edge_case
from mxeon.conformance.probes.memory import Evaluations
from mxeon.conformance.probes.probe import LobeProbe, Probe
from mxeon.conformance.results import PASSED, Run
from mxeon.conformance.samples.batch import (
    PAIRS,
    SEED,
    Array,
    Batch,
    Changes,
    Values,
    directions,
    random_inputs,
)
from mxeon.conformance.samples.edge_cases import diffuse_edges, special_directions, special_inputs
from mxeon.conformance.samples.measurement import Case, absolute, point_of
from mxeon.errors import InputError, assert_known
from mxeon.hosts.base import Host, Identity
from mxeon.models import table as reference

# Checks of values alone: a function has no environment branch and no flag.
KEYS = ("value", "albedo", "black", "reciprocity", "lambert", "inputs", "finite")
LIBRARY = "callable"

Brdf = Callable[[Array, Array, Array, Array], ArrayLike]  # of wo, wi, rho, roughness


class CallableHost(Host):
    """A Python function instead of an engine."""

    target = ""

    def __init__(self, name: str, brdf: Brdf) -> None:
        self.name, self.brdf = name, brdf

    def identity(self) -> Identity:
        return Identity(self.name, "version not given", "device not given")


@dataclass(frozen=True)
class ClaimedModel(ModelSubject):
    """The model that a function has to be, instead of a node."""

    title: str
    model: str

    node: ClassVar[str] = "a function"
    kind: ClassVar[str] = kinds.DIFFUSE
    inputs: ClassVar[tuple[str, ...]] = ("color", "roughness")
    libraries: ClassVar[tuple[str, ...]] = ()

    @property
    def _others(self) -> tuple[reference.Model, ...]:
        return reference.PARAMETRIZATIONS

    def document(self, inputs: Values | None = None) -> str:
        """None: a function needs no document."""
        return ""

    @property
    def changes(self) -> dict[str, Changes]:
        return {name: ({}, {name: CHANGES[name]}) for name in self.inputs}


class CallableProbe(LobeProbe):
    """A function evaluated for pairs."""

    kind = kinds.DIFFUSE

    host: CallableHost
    subject: ClaimedModel

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        rng, row = np.random.default_rng(SEED), reference.model(self.subject.model)
        wo, wi = directions(rng, PAIRS), directions(rng, PAIRS)
        exact = special_directions(rng)
        special = Batch(*exact, special_inputs(rng, len(exact[0]), row))
        return Batch(wo, wi, random_inputs(rng, PAIRS, row)), special

    @cached_property
    def edges(self) -> Batch:
        """Pairs and inputs at the edges of the domain, then all others for which a check asks."""
        asked = [diffuse_edges()]

        def note(batch: Batch) -> Batch:
            asked.append(batch)
            return batch

        for check in _checks(self.subject.model):
            if check.key != "finite":
                check.measured(Altered(self, note), absolute)
        columns = zip(*map(_arguments, asked), strict=True)
        wo, wi, rho, roughness = map(np.concatenate, columns)
        return Batch(wo, wi, {"color": rho, "roughness": roughness})

    def direct(self, batch: Batch) -> Array:
        """pi f cos(theta_i), (N, 3); NaN in every channel where one is not finite."""

        def evaluated() -> Array:
            values = np.asarray(self.host.brdf(*_arguments(batch)), np.float64)
            if values.shape != batch.wi.shape:
                raise InputError(
                    f"values of {self.host.name} must have shape {batch.wi.shape}; got {values.shape}"
                )
            finite = np.isfinite(values).all(axis=1, keepdims=True)
            return np.pi * (np.where(finite, values, np.nan) * batch.wi[:, 2:])

        return self._evaluations.values(batch, (), evaluated)

    @cached_property
    def _evaluations(self) -> Evaluations:
        return Evaluations()

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Nothing, (N, 0): a function has no environment branch."""
        return np.empty((len(batch.wi), 0))


def _arguments(batch: Batch) -> tuple[Array, Array, Array, Array]:
    """wo, wi, rho and roughness of each pair."""
    rho = np.broadcast_to(np.asarray(batch.inputs["color"], float), batch.wi.shape)
    roughness = np.broadcast_to(np.asarray(batch.inputs["roughness"], float), len(batch.wi))
    return batch.wo, batch.wi, rho, roughness


def _finite_rows(cases: Iterable[Case]) -> Iterator[Case]:
    """Cases without the rows that are not finite, which are for one check; as they are if all are so."""
    for case in cases:
        expected = np.broadcast_to(case.expected, case.measured.shape)
        rows = np.asarray(np.isfinite(case.measured + expected).all(axis=1))
        kept = Case(case.batch.where(rows), case.measured[rows], expected[rows])
        yield kept if rows.any() else case


VALUE_OF_REST = replace(VALUE, cases=lambda probe: _finite_rows(VALUE.cases(probe)))


def _explain_not_finite(probe: Probe) -> Diagnosis:
    """How many values are not finite, where, and the arguments of the first."""
    case = edge_case(probe)
    wrong = np.asarray(~np.isfinite(case.measured).all(axis=1))
    place = smallest([case.batch], [wrong])
    point = point_of(case.batch, int(wrong.argmax()))
    wo, wi, rho, roughness = (", ".join(f"{x:.6g}" for x in each) for each in point.values())
    return Diagnosis(
        f"{wrong.sum()} of {len(wrong)} values are not finite{place and f', all {place}'}; the "
        f"first for wo = ({wo}), wi = ({wi}), rho = ({rho}), roughness = {roughness}"
    )


def _of_rest(check: Check) -> Check:
    """A row of the table that judges the finite values; "finite" says of the others where they are."""
    if check.key == "finite":
        return replace(check, diagnose=_explain_not_finite)
    if check.key == "inputs":
        return check
    if check.measure is VALUE:
        return replace(check, measure=VALUE_OF_REST)
    measure = cast(Callable[[Probe], Iterable[Case]], check.measure)
    return replace(
        check, measure=lambda probe: _finite_rows(measure(probe)), diagnose=VALUE_OF_REST.diagnose
    )


def check_brdf(brdf: Brdf, model: str = "eon", name: str | None = None) -> Run:
    """Run every check that applies to a function of directions and inputs.

    Parameters
    ----------
    brdf : callable
        `brdf(wo, wi, rho, roughness) -> values`, with wo, wi and rho (N, 3), roughness (N,) and
        values (N, 3) in 1/sr, without the cosine. The directions leave the surface, in the local
        frame with the normal +z; roughness lies in [0, 1], or is sigma, in radian, in [0, pi/2] for
        models that have one: `mxeon.models.table`.
    model : str
        The model that it has to be: a row of `mxeon.models.table.MODELS` with a parameter.
    name : str or None
        Its name in the report; None for the function's own name.

    Returns
    -------
    Run
        See `mxeon.report.write`.

        Values that are not finite fail one check, which says how many, where and the first; the others
        judge the rest.

    Raises
    ------
    ValueError
        If there is no such model, or the values have another shape.

    Examples
    --------
    >>> from mxeon.models import eon_brdf
    >>> {result.verdict for result in check_brdf(eon_brdf).results}
    {'passed'}
    """
    probe = _probe(brdf, model, name)
    results = tuple(judge_check(check, probe) for check in _checks(model))
    return Run(
        version=mxeon.__version__,
        software={"Python": platform.python_version(), "numpy": version("numpy")},
        hosts=(probe.host.identity(),),
        results=results,
    )


def brdf_test(brdf: Brdf, model: str = "eon", name: str | None = None) -> Callable[..., None]:
    """Test function for pytest, with one case per check of `check_brdf`.

    Assign it to a name that begins with `test_`:

        from mxeon import brdf_test
        from my_renderer import my_brdf

        test_my_brdf_is_eon = brdf_test(my_brdf, "eon")

    On failure it shows the error, the tolerance and the best-matching model.
    """
    import pytest

    probe = _probe(brdf, model, name)

    @pytest.mark.parametrize("check", _checks(model), ids=lambda check: check.key)
    def test_brdf(check: Check) -> None:
        result = judge_check(check, probe)
        assert result.verdict == PASSED, f"{check.claim} {result.explanation}"

    return cast(Callable[..., None], test_brdf)


def _probe(brdf: Brdf, model: str, name: str | None) -> CallableProbe:
    title = name or str(getattr(brdf, "__name__", type(brdf).__name__))
    return CallableProbe(
        CallableHost(title, brdf), ClaimedModel(reference.model(model).title, model), LIBRARY
    )


def _checks(model: str) -> tuple[Check, ...]:
    """Rows of the table for values of a model, whichever models they are made for."""
    row = reference.model(model)
    if not row.parameter:
        assert_known("model", model, (row.name for row in reference.MODELS if row.parameter))
    return tuple(
        _of_rest(check)
        for check in CHECKS
        if check.key in KEYS and (check.key != "albedo" or row.albedo_dir)
    )
