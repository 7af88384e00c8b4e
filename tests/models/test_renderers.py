# SPDX-License-Identifier: Apache-2.0
"""Variants of the nodes in OSL's library BSDL and in Cycles, which diagnoses on testrender or
Cycles name.

The tests of both hosts compare them with the renderers themselves.
"""

import numpy as np
import pytest

from mxeon.models.nodes import node
from mxeon.models.nodes.renderers import BSDL_VARIANTS, CYCLES_VARIANTS

WO, WI = np.array([[0.6, 0.0, 0.8]] * 3), np.array([[-0.6, 0.0, 0.8]] * 3)
COLOR = np.array([[0.2, 0.5, 0.8]] * 3)
FACETS = {"roughness": np.array([[0.8, 0.8], [0.5, 0.9], [0.8, 0.8]])}
INPUTS = {
    "dielectric": FACETS | {"tint": COLOR, "ior": np.array([1.5, 0.9, 7.0])},
    "conductor": FACETS | {"ior": COLOR, "extinction": np.full((3, 3), 2.0)},
    "schlick": FACETS
    | {
        "color0": 0.1 * COLOR,
        "color82": 0.5 * COLOR,
        "color90": np.ones((3, 3)),
        "exponent": np.full(3, 5.0),
    },
    "conty_kulla": {"color": COLOR, "roughness": np.array([0.3, 0.5, 1.0])},
    "zeltner": {"color": COLOR, "roughness": np.array([0.3, 0.5, 1.0])},
}
VARIANTS = [
    (name, each)
    for renderer in (BSDL_VARIANTS, CYCLES_VARIANTS)
    for name, variants in renderer.items()
    for each in variants
]


@pytest.mark.parametrize("name, variant", VARIANTS, ids=[each.title for _, each in VARIANTS])
def test_a_variant_is_another_function_and_finite(name, variant):
    row, inputs = node(name), INPUTS[name]
    for found, right in (
        (variant.value and variant.value(WO, WI, inputs), row.value(WO, WI, inputs)),
        (variant.albedo and variant.albedo(WO, inputs), row.albedo(WO, inputs)),
    ):
        if found is not None:
            assert found.shape == (3, 3) and np.isfinite(found).all() and (found >= 0.0).all()
            assert np.abs(found - right).max() > 1e-3 * right.max()


@pytest.mark.parametrize("variants", [BSDL_VARIANTS, CYCLES_VARIANTS], ids=["BSDL", "Cycles"])
def test_color82_counts_as_1(variants):
    both = INPUTS["schlick"], INPUTS["schlick"] | {"color82": np.full((3, 3), 0.9)}
    for each in variants["schlick"]:
        assert not each.value or np.array_equal(*(each.value(WO, WI, given) for given in both))
        assert not each.albedo or np.array_equal(*(each.albedo(WO, given) for given in both))
