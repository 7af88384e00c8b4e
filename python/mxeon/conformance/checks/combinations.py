# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that combine two lobes."""

from collections.abc import Iterable, Iterator
from itertools import product

import numpy as np

from mxeon.conformance.case import Case
from mxeon.conformance.check import check, of_family, pass_all, shifted, with_values
from mxeon.conformance.diagnosis import ALBEDO, THROUGHPUT, VALUE, Diagnosis
from mxeon.conformance.specs.combinations import SINGLE, CombinedSpec
from mxeon.conformance.tolerance import Compared
from mxeon.models.nodes.combinations import FACTOR

is_combined = of_family(CombinedSpec)


@check(is_combined, shifted, VALUE, pairs=True)
def combination(case: Case) -> Iterable[Compared]:
    """Two combined lobes have the value that the node's equation gives."""
    return VALUE(case)


@check(is_combined, shifted, ALBEDO, pairs=True)
def combined_albedo(case: Case) -> Iterable[Compared]:
    """The environment branch of two combined lobes returns their albedo."""
    return ALBEDO(case)


@check(is_combined, pass_all, THROUGHPUT, open=True)
def combined_throughput(case: Case) -> Iterator[Compared]:
    """Two combined lobes pass on what they do not scatter, as the layer equation requires.

    A negative throughput counts as 0, as `layer` takes it.
    """
    for compared in THROUGHPUT(case):
        yield compared._replace(measured=np.maximum(compared.measured, 0.0))


@check(
    lambda spec: spec.model in SINGLE,
    with_values(
        "values are multiplied twice",
        lambda batch, values: values * np.reshape(batch.inputs[FACTOR], (len(values), -1)),
    ),
    pairs=True,
    open=True,
    diagnose=lambda case: Diagnosis("the factor is not clamped", permitted=True),
)
def factor(case: Case) -> Iterator[Compared]:
    """Factors are clamped to [0, 1]."""
    for batch, (factor, end) in product(case.few, ((2.0, 1.0), (-1.0, 0.0))):
        beyond, nearest = (
            batch.altered(**{FACTOR: np.full_like(batch.inputs[FACTOR], number)})
            for number in (factor, end)
        )
        yield Compared(beyond, case.direct(beyond), case.direct(nearest))
        passed = (case.throughput(each, "direct") for each in (beyond, nearest))
        yield Compared(beyond, *passed)
