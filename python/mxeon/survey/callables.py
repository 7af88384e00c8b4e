# SPDX-License-Identifier: Apache-2.0
"""Checks of a BRDF that is a Python function, such as a binding of a renderer or a library."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

import mxeon
from mxeon.conformance import backends, cache, checks, diagnosis, samples
from mxeon.conformance.case import Case, edge_values
from mxeon.conformance.check import Check, compared_of
from mxeon.conformance.diagnosis.regions import EXACT, correct_except, smallest, unbounded
from mxeon.conformance.results import Diagnosis, Kind, Run
from mxeon.conformance.samples import PAIRS, Array, Batch
from mxeon.conformance.spec import Ability
from mxeon.conformance.specs.diffuse import ERRORS, DiffuseModelSpec, inputs_of, model_row
from mxeon.conformance.tolerance import Compared, point_of
from mxeon.errors import InputError, assert_known
from mxeon.hosts.base import Host, Identity
from mxeon.models import table as reference

# Checks that apply to a function, which has no environment branch and no boolean input.
KEYS = ("value", "integral", "black", "reciprocity", "lambert", "inputs", "finite")
LIBRARY = "callable"

Brdf = Callable[[Array, Array, Array, Array], ArrayLike]  # arguments: wo, wi, rho, roughness


class CallableHost(Host):
    """A host that calls a Python function instead of an engine."""

    target = ""

    def __init__(self, name: str, brdf: Brdf) -> None:
        self.name, self.brdf = name, brdf

    def identity(self) -> Identity:
        return Identity(self.name, "version not given", "device not given")


@dataclass(frozen=True, eq=False, kw_only=True)
class ClaimedModel(DiffuseModelSpec):
    """The spec of a function, in which a claimed model takes the place of a node."""

    def document(self, inputs: samples.Values | None = None) -> str:
        return ""  # a function has no document

    def batches(self, counts: samples.Counts) -> tuple[Batch, ...]:
        rng = samples.generator()
        wo, wi = samples.directions(rng, PAIRS), samples.directions(rng, PAIRS)
        exact = samples.special_directions(rng)
        special = Batch(*exact, self.random_inputs(rng, len(exact[0]), edged=True))
        return Batch(wo, wi, self.random_inputs(rng, PAIRS)), special


class Function(backends.Backend):
    """A backend that evaluates a function for pairs of directions."""

    host: CallableHost

    abilities = Ability.OWN | Ability.PAIRS | Ability.LIGHT

    @cached_property
    def edges(self) -> Batch:
        """Pairs for the check `finite`: edges of the domain, and the pairs of all other checks."""
        batches = [super().edges]

        def record(batch: Batch) -> Batch:
            batches.append(batch)
            return batch

        recorded = Case(self.spec, self, inputs=record, control=True)
        for check in _checks(self.spec.model):
            if check.key != "finite":
                compared_of(check.measure(recorded))
        columns = zip(*map(_arguments, batches), strict=True)
        wo, wi, rho, roughness = map(np.concatenate, columns)
        return Batch(wo, wi, {"color": rho, "roughness": roughness})

    def direct(self, batch: Batch) -> Array:
        """Values of pi f cos(theta_i), (N, 3). If a channel is not finite, all channels are NaN."""

        def evaluated() -> Array:
            values = np.asarray(self.host.brdf(*_arguments(batch)))
            if np.iscomplexobj(values):
                raise InputError(f"values of {self.host.name} must be real; got {values.dtype}")
            values = values.astype(np.float64)
            if values.shape != batch.wi.shape:
                raise InputError(
                    f"values of {self.host.name} must have shape {batch.wi.shape}; got {values.shape}"
                )
            finite = np.isfinite(values).all(axis=1, keepdims=True)
            return np.pi * (np.where(finite, values, np.nan) * batch.wi[:, 2:])

        return self._evaluations.value(cache.parts(batch), evaluated)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """An empty array (N, 0), because a function has no environment branch."""
        return np.empty((len(batch.wi), 0))


def _arguments(batch: Batch) -> tuple[Array, Array, Array, Array]:
    rho = np.broadcast_to(np.asarray(batch.inputs["color"], float), batch.wi.shape)
    roughness = np.broadcast_to(np.asarray(batch.inputs["roughness"], float), len(batch.wi))
    return batch.wo, batch.wi, rho, roughness


def _finite_rows(compared: Compared | Iterable[Compared]) -> Iterator[Compared]:
    """Drop non-finite rows, which the check `finite` reports. Keep all rows if no row is finite."""
    for each in [compared] if isinstance(compared, Compared) else compared:
        expected = np.broadcast_to(each.expected, each.measured.shape)
        rows = np.asarray(np.isfinite(each.measured + expected).all(axis=1))
        finite = Compared(each.batch.where(rows), each.measured[rows], expected[rows])
        yield finite if rows.any() else each


FINITE_VALUE = replace(diagnosis.VALUE, compared=lambda case: _finite_rows(diagnosis.VALUE(case)))


def _explain_not_finite(case: Case) -> Diagnosis:
    """Report the number and region of non-finite values, and arguments of the first such value."""
    values = unbounded(edge_values(case))
    wrong = correct_except([values], EXACT, smallest([values], EXACT))
    point = point_of(values.batch, int(EXACT.wrong(values).argmax()))
    return Diagnosis((replace(wrong, kind=Kind.NOT_FINITE, point=point),))


def _finite_only(check: Check) -> Check:
    """Restrict a check to finite values. The check `finite` reports non-finite values."""
    if check.key == "finite":
        return replace(check, explain=_explain_not_finite)
    if check.key == "inputs":
        return check
    measure = cast(Callable[[Case], Iterable[Compared]], check.measure)
    return replace(
        check, measure=lambda case: _finite_rows(measure(case)), explain=FINITE_VALUE.diagnose
    )


def check_brdf(brdf: Brdf, model: str = "eon", name: str | None = None) -> Run:
    """Run every check that applies to a function of directions and inputs.

    - `brdf`: A function `brdf(wo, wi, rho, roughness) -> values`. The shape of wo, wi and rho is
      (N, 3), and the shape of roughness is (N,). The values, (N, 3) in 1/sr, do not include the
      cosine. The directions leave the surface, in the local frame with the normal +z. Roughness is
      in [0, 1]. If the model has the parameter sigma according to `mxeon.models.table`, roughness
      is sigma in radians, in [0, pi/2].
    - `model`: The required model, which is a row of `mxeon.models.table.DIFFUSE_MODELS` that has a
      parameter.
    - `name`: The function's name in the report. The default is `__name__`.

    Non-finite values fail one check, and the other checks judge the finite values.
    `mxeon.report.write` writes a report, and tests can call `raise_for_failure`. Raises ValueError
    for an unknown model or a wrong shape.

        >>> from mxeon.models import eon_brdf
        >>> {result.verdict for result in check_brdf(eon_brdf).results}
        {'passed'}
    """
    title = name or str(getattr(brdf, "__name__", type(brdf).__name__))
    node = "a function"
    spec = ClaimedModel(
        title=reference.diffuse_model(model).title,
        node=node,
        model=model,
        row=model_row(model, node, reference.PARAMETRIZATIONS),
        inputs=inputs_of("color", "roughness"),
        errors=ERRORS,
    )
    case = Case(spec, Function(CallableHost(title, brdf), spec, LIBRARY))
    results = tuple(check.judge(case) for check in _checks(model))
    return Run(
        version=mxeon.__version__,
        software={"Python": platform.python_version(), "numpy": version("numpy")},
        hosts=(case.host.identity(),),
        results=results,
    )


def _checks(model: str) -> tuple[Check, ...]:
    """The checks that apply to a function with this model."""
    row = reference.diffuse_model(model)
    if not row.parameter:
        assert_known(
            "model", model, (row.name for row in reference.DIFFUSE_MODELS if row.parameter)
        )
    return tuple(
        _finite_only(check)
        for check in checks.CHECKS
        if check.key in KEYS and (check.key != "integral" or row.albedo_dir)
    )
