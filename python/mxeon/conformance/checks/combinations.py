# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that combine two lobes."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from mxeon.conformance.case import LIGHT, Case, throughputs
from mxeon.conformance.check import add_check, check, of_family, pass_all, shifted, with_values
from mxeon.conformance.diagnosis import ALBEDO, THROUGHPUT, VALUE, Diagnosis
from mxeon.conformance.specs.combinations import SINGLE, CombinedSpec
from mxeon.conformance.tolerance import Compared
from mxeon.models.nodes.combinations import FACTOR

is_combined = of_family(CombinedSpec)


add_check(
    VALUE,
    "combination",
    "Two combined lobes have the value that the node's equation gives.",
    is_combined,
    shifted,
    pairs=True,
)

add_check(
    ALBEDO,
    "combined_albedo",
    "The environment branch of two combined lobes returns their albedo.",
    is_combined,
    shifted,
    pairs=True,
)


@check(is_combined, pass_all, "throughput", open=True, diagnose=THROUGHPUT.diagnose)
def combined_throughput(case: Case) -> Iterator[Compared]:
    """Two combined lobes pass on what they do not scatter, as the layer equation requires.

    A negative throughput counts as 0, as `layer` takes it.
    """
    for compared in throughputs(case, *LIGHT):
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
