# SPDX-License-Identifier: Apache-2.0
"""Burley's diffuse node, and the translucent one."""

from mxeon.conformance.specs.lobes import (
    CLOSED_ALBEDO,
    COLOR,
    FLAT_FRAME,
    NORMAL,
    WEIGHT,
    PbrSpec,
    lobe_errors,
)
from mxeon.conformance.specs.sheen import ROUGHNESS
from mxeon.conformance.tolerance import roundings, sum_of
from mxeon.models.nodes import node

# 17 in each factor of Burley's, ten of them in the cosine of the half vector, and seven in the products.
VALUE = sum_of(roundings(2 * 17 + 7, "of the value or 1: 17 in each factor, 7 in the products"))
ERRORS = lobe_errors(VALUE, CLOSED_ALBEDO, FLAT_FRAME, quadrature=1e-8)


class FlatSpec(PbrSpec):
    """A lobe without a peak."""

    flat = True


BURLEY = FlatSpec.of(node("burley"), (WEIGHT, COLOR, ROUGHNESS, NORMAL), ERRORS)
TRANSLUCENT = FlatSpec.of(node("translucent"), (WEIGHT, COLOR, NORMAL), ERRORS)
