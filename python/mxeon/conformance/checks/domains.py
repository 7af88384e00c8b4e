# SPDX-License-Identifier: Apache-2.0
"""Inputs outside the ranges that other checks draw from, as far as hosts pass them."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from mxeon.conformance.case import Case
from mxeon.conformance.check import check, scale
from mxeon.conformance.checks.lobes import is_layer
from mxeon.conformance.diagnosis import Diagnosis
from mxeon.conformance.results import WRONG_INSIDE
from mxeon.conformance.samples import Batch
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.microfacets import TransmissionSpec
from mxeon.conformance.tolerance import Compared, absolute, given, scaled
from mxeon.errors import NotRun
from mxeon.hosts.calls import NORMAL

PAIRS = 16  # of each value
LEAST = 0.3  # of weights and occlusions, so that each pair shows it
TOLERANCES = given(1.0, "tolerances", "the tolerance of each quantity")


def quantities(case: Case, batch: Batch, right: Batch) -> Iterator[tuple[str, Compared]]:
    """Values, albedos and throughputs, each by its name, against those that are expected of other inputs."""
    albedo = case.expected_albedo(right)
    yield "value", Compared(batch, case.direct(batch), case.expected(right))
    yield "albedo", Compared(batch, case.albedo(batch), albedo)
    if is_layer(case.spec):
        passed = case.throughput(batch, "direct")
        yield "throughput", Compared(batch, passed, np.maximum(1.0 - albedo, 0.0))


def outside(case: Case) -> Iterator[tuple[str, str, float, Compared]]:
    """Each quantity of a few pairs for each input and value, but for what is wrong inside the ranges already.

    Values are divided by the largest error that passes.
    """
    spec, views = case.of(PbrSpec), case.samples.views[0]
    row, names = np.arange(len(views.wo))[:, np.newaxis], {"weight", "occlusion"}
    wo = np.where(row == 1, NORMAL, views.wo)
    wi = np.where(row % 2 == 1, wo * [-1.0, -1.0, spec.side], views.wi)  # microfacets reflect most
    seen = {name: np.maximum(views.inputs[name], LEAST) for name in names & views.inputs.keys()}
    views = replace(views, wo=wo, wi=wi).altered(**seen)
    plain = replace(case, outputs=lambda batch, values: values)
    wrong = {
        name
        for name, (_, measured, expected) in quantities(plain, views, views)
        if scaled(measured, expected).max() > case.tolerance(name).value
    }
    if len(wrong) == 2 + is_layer(spec):
        raise NotRun(f"{case.host.name}: not measured, since {spec.title} {WRONG_INSIDE}")
    batch = views.first(PAIRS)
    for each in spec.bounded:
        for value in each.beyond:
            lit, right = (
                batch.altered(**{each.name: np.full_like(batch.inputs[each.name], number)})
                for number in (value, float(np.clip(value, *each.ends)))
            )
            for name, (_, measured, expected) in quantities(case, lit, right):
                if name not in wrong:
                    tolerance = case.tolerance(f"{name} with {each.name} {value:g}", name)
                    scale = tolerance.value * tolerance.scale(expected)
                    yield name, each.name, value, Compared(lit, measured / scale, expected / scale)


def diagnose(case: Case) -> Diagnosis:
    """The inputs, and the values of each, with which a quantity is wrong."""
    wrong: dict[tuple[str, str], list[float]] = {}
    for quantity, name, value, compared in outside(case):
        if absolute(*compared[1:]).max() > TOLERANCES.value:
            wrong.setdefault((name, quantity), []).append(value)
    texts = (
        f"the {quantity} is wrong with {name} {', '.join(f'{value:g}' for value in values)}"
        for (name, quantity), values in wrong.items()
    )
    return Diagnosis("; ".join(texts))


@check(
    lambda spec: (
        isinstance(spec, PbrSpec) and not isinstance(spec, TransmissionSpec) and bool(spec.bounded)
    ),
    scale("values are 30 % too large", 1.3),
    tolerance=TOLERANCES,
    pairs=True,
    lit=True,
    diagnose=diagnose,
)
def domain(case: Case) -> Iterator[Compared]:
    """Inputs outside their usual range have the value, the albedo and the throughput of the model, too."""
    return (compared for *_, compared in outside(case))
