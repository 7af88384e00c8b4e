# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that emit light, and of media."""

from collections.abc import Iterable, Iterator

import numpy as np

from mxeon.conformance.backends import implementation
from mxeon.conformance.case import Case, over_condition
from mxeon.conformance.check import (
    Control,
    check,
    gray,
    of_family,
    offset,
    scale,
    shifted,
    with_inputs,
)
from mxeon.conformance.checks.lobes import summed
from mxeon.conformance.diagnosis import BACK, RADIANCE, TRANSMITTANCE, VALUE, Diagnosis
from mxeon.conformance.specs.emission import (
    OPACITY,
    UNIMPLEMENTED,
    AbsentSpec,
    EmissionSpec,
    EmittingSurface,
    MediumSpec,
)
from mxeon.conformance.tolerance import Compared, Measurement, count_of

is_emission = of_family(EmissionSpec)


unimplemented = Control(
    "the node is one that nothing implements", lambda case: case.another(UNIMPLEMENTED)
)


@check(
    of_family(EmissionSpec, MediumSpec, AbsentSpec),
    unimplemented,
    tolerance=count_of("nodes"),
    diagnose=lambda case: Diagnosis(
        f"{case.host.target} has no implementation of {case.spec.title}"
    ),
)
def implemented(case: Case) -> Measurement:
    """The target implements the node."""
    shader = implementation(case.host, case.spec.document(), case.library)
    return Measurement(float(shader is None), {})


@check(is_emission, gray, RADIANCE)
def radiance(case: Case) -> Iterator[Compared]:
    """The radiance matches the node's equation for every view from the front."""
    return (over_condition(case, each) for each in RADIANCE(case))


@check(is_emission, offset, BACK, pairs=True, open=True)
def back(case: Case) -> Iterator[Compared]:
    """The back of the surface emits what the equation gives."""
    return (over_condition(case, each) for each in BACK(case))


@check(
    is_emission, scale("the radiance is 1 % too low", 0.99), "integral", diagnose=RADIANCE.diagnose
)
def exitance(case: Case) -> Compared:
    """The radiance integrates to the power that the equation gives."""
    spec = case.of(EmissionSpec)
    views, measured = summed(case, *case.samples.take(spec.integrated))
    return Compared(views, measured, spec.exitance(views) / np.pi)


@check(of_family(MediumSpec), shifted, TRANSMITTANCE)
def transmittance(case: Case) -> Iterable[Compared]:
    """Over one meter, a medium transmits what its coefficients give."""
    return TRANSMITTANCE(case)


def diagnose_opacity(case: Case) -> Diagnosis:
    """Whether the opacity is dropped."""
    full = max(
        OPACITY.metric(each.measured, case.expected(each.batch.altered(opacity=1.0))).max()
        for each in VALUE(case)
    )
    return Diagnosis("the opacity is ignored" if full <= OPACITY.value else "")


@check(
    of_family(EmittingSurface),
    with_inputs("the opacity is 1", opacity=1.0),
    VALUE,
    diagnose=diagnose_opacity,
)
def opacity(case: Case) -> Iterable[Compared]:
    """The light that a surface emits is scaled by its opacity."""
    return VALUE(case)
