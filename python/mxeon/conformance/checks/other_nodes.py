# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that scatter nothing: those that emit light, media, and utility nodes."""

from dataclasses import replace

import numpy as np

from mxeon.conformance.backends import implementation
from mxeon.conformance.case import Case
from mxeon.conformance.check import (
    Control,
    check,
    gray,
    no_number,
    of_family,
    offset,
    shifted,
    with_inputs,
)
from mxeon.conformance.diagnosis import BACK, OUTPUT, TRANSMITTANCE, VALUE, defect
from mxeon.conformance.diagnosis.regions import EXACT, correct_except, span, unbounded
from mxeon.conformance.results import Diagnosis, Kind
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.specs.emission import (
    OPACITY,
    UNIMPLEMENTED,
    AbsentSpec,
    EmissionSpec,
    EmittingSurface,
    MediumSpec,
)
from mxeon.conformance.specs.utilities import UtilitySpec
from mxeon.conformance.tolerance import Compared, Measurement, count_not_finite, count_of

is_emission = of_family(EmissionSpec)


unimplemented = Control(
    "the node is one that nothing implements", lambda case: case.another(UNIMPLEMENTED)
)


@check(
    of_family(EmissionSpec, MediumSpec, AbsentSpec),
    unimplemented,
    tolerance=count_of(Quantity.NODES),
    diagnose=lambda case: defect("not_implemented", case.host.target, case.spec.title),
)
def implemented(case: Case) -> Measurement:
    """The target implements the node."""
    shader = implementation(case.host, case.spec.document(), case.library)
    return Measurement(float(shader is None), {})


@check(is_emission, gray, OUTPUT)
def radiance() -> None:
    """The radiance matches the node's equation for every view from the front."""


@check(is_emission, offset, BACK, pairs=True, open=True)
def back() -> None:
    """The back of the surface emits what the equation gives."""


@check(of_family(MediumSpec), shifted, TRANSMITTANCE)
def transmittance() -> None:
    """Over one meter, a medium transmits what its coefficients give."""


def diagnose_opacity(case: Case) -> Diagnosis:
    """Whether the opacity is dropped."""
    full = max(
        OPACITY.metric(each.measured, case.expected(each.batch.altered(opacity=1.0))).max()
        for each in VALUE(case)
    )
    return defect("input_ignored", "opacity") if full <= OPACITY.value else Diagnosis()


@check(
    of_family(EmittingSurface),
    with_inputs("the opacity is 1", opacity=1.0),
    VALUE,
    diagnose=diagnose_opacity,
)
def opacity() -> None:
    """The light that a surface emits is scaled by its opacity."""


# --- utility nodes, in units in which the roundings of their values are alike ---------------------

is_utility = of_family(UtilitySpec)


@check(is_utility, shifted, OUTPUT, open=True)
def output() -> None:
    """The output of the utility node matches its equations."""


def outside(case: Case) -> Compared:
    """Outputs at the ends of the ranges and beyond, beside 0."""
    batch = case.samples.take(case.of(UtilitySpec).outside)
    return Compared(batch, case.direct(batch), np.zeros((1, 3)))


def explained_finite(case: Case) -> Diagnosis:
    """How many outputs are not finite, and the range of an input that has all of them."""
    compared = unbounded(outside(case))
    share = correct_except([compared], EXACT, span([compared], EXACT))
    return Diagnosis((replace(share, kind=Kind.NOT_FINITE),))


@check(
    lambda spec: is_utility(spec) and not spec.libraries,
    no_number,
    tolerance=count_of(Quantity.VALUES),
    pairs=True,
    diagnose=explained_finite,
)
def output_finite(case: Case) -> Measurement:
    """Every output is finite, at the ends of the ranges and beyond."""
    return count_not_finite(outside(case))
