# SPDX-License-Identifier: Apache-2.0
"""Specs of both modes of the sheen node: Zeltner's sheen, and Conty and Kulla's."""

from dataclasses import replace

import numpy as np

from mxeon.conformance import samples, spec
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.specs import lobes
from mxeon.conformance.specs.lobes import FLAT_FRAME
from mxeon.conformance.tolerance import ROUNDING, Term, Tolerance, roundings, sum_in, sum_of
from mxeon.hosts.base import Host
from mxeon.models.nodes import node

BOUNDED = (
    replace(lobes.ROUGHNESS, beyond=(1e-3, 1e-4, 2.0), ends=(1e-4, 1.0)),
    replace(lobes.ROUGHNESS, beyond=(0.0, 1e-3, 2.0), ends=(0.01, 1.0)),
)
INPUTS, ZELTNER_INPUTS = ((lobes.WEIGHT, lobes.COLOR, each, lobes.NORMAL) for each in BOUNDED)
FIT_COSINE = 1e-4  # smallest cosine in the domains of the albedo fits
EXPONENT = 1.0 / samples.LEAST_SHEEN  # largest exponent of the sine in Conty and Kulla's sheen

ZELTNER_VALUE = sum_of(
    roundings(48, "of max(value, 1): 4 x 8 in the inverse fourth power of a length, and 16"),
    roundings(10 * 11.6, "(10 in the albedo's exponent, 11.6 where values are about 1)"),
)
CLOSED = roundings(32, "of max(albedo, 1): 20 in an exponent, times 0.6, and 20 outside")
ZELTNER_ALBEDO = ZELTNER_THROUGHPUT = sum_of(CLOSED, quantity=Quantity.ALBEDO)
LOGARITHM = 4 * 0.5 / samples.LEAST_SHEEN  # four roundings divided by twice the smallest roughness


def conty_kulla_value(logarithm: float) -> Tolerance:
    words = "in the logarithm of a sine, divided by twice the roughness"
    return sum_of(roundings(32), roundings(logarithm, words))


CONTY_KULLA_VALUE = conty_kulla_value(LOGARITHM)
FIT = (
    Term(1.53e-3, "the fit of the albedo"),  # tools/fits/conty_kulla_albedo.py
    ZELTNER_ALBEDO.term("roundings of an albedo in closed form"),
)
CONTY_KULLA_ALBEDO = sum_in(Quantity.ALBEDO, *FIT, exact=True)


def power_error(host: Host) -> float:
    """Error of Conty and Kulla's sheen due to the engine's pow(), beyond LOGARITHM roundings.

    With n = 1 / roughness, pi f cos is at most (2 + n) sin^n / 8. The error is relative for values
    above 1.
    """
    rng = samples.generator()
    exponent = samples.LEAST_SHEEN ** -rng.random(spec.ARGUMENTS)
    # The power sine^exponent is uniformly distributed.
    sine = samples.float32(rng.random(spec.ARGUMENTS) ** (1.0 / exponent))
    exponent = samples.float32(exponent)
    factor = (2.0 + exponent) / 8.0
    scale = np.maximum(1.0, factor * sine**exponent)
    error = (factor * spec.POWER.errors(host, sine, exponent) / scale).max()
    return max(float(error) + (EXPONENT - LOGARITHM) * ROUNDING, 0.0)


ZELTNER = lobes.PbrSpec(
    **lobes.mode_of(node("zeltner")),
    inputs=ZELTNER_INPUTS,
    errors=lobes.lobe_errors(
        ZELTNER_VALUE, ZELTNER_ALBEDO, ZELTNER_THROUGHPUT, FLAT_FRAME, quadrature=1e-8
    ),
    along=0.03,
)
CONTY_KULLA = lobes.PbrSpec(
    **lobes.mode_of(node("conty_kulla")),
    inputs=INPUTS,
    errors={
        **lobes.lobe_errors(
            CONTY_KULLA_VALUE, CONTY_KULLA_ALBEDO, CONTY_KULLA_ALBEDO, FLAT_FRAME, quadrature=2e-4
        ),
        # If wo and wi are swapped, the half vector and the power of the sine stay the same.
        "reciprocity": sum_of(roundings(32)),
    },
    outside_errors={("value", "roughness", x): conty_kulla_value(2.0 / x) for x in (1e-3, 1e-4)},
    engines={"value": (spec.EngineError("the engine's pow()", power_error),)},
    least_cosine=FIT_COSINE,
)
