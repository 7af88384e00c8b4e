# SPDX-License-Identifier: Apache-2.0
"""Variants that renderers use in their own nodes: where they are correct, and how they fail."""

import numpy as np
import pytest

from mxeon.models.table import OTHERS, PARAMETRIZATIONS, diffuse_model
from tests.support.cases import directions

WO, WI = directions((2, 1000), seed=1, least=0.05)
# Parameters that correspond to a roughness of 0.6, by the last word of the model's name.
PARAMETERS = {"half_pi": 0.3 * np.pi, "slope": 0.6 / np.sqrt(2.0), "squared": 0.36}


@pytest.mark.parametrize("row", PARAMETRIZATIONS, ids=lambda row: row.name)
def test_a_model_of_another_roughness_is_the_model_of_its_parameter(row):
    [(word, parameter)] = [pair for pair in PARAMETERS.items() if row.name.endswith(pair[0])]
    base = diffuse_model(row.name.removesuffix(f"_{word}"))
    rho = [0.8, 0.2]
    np.testing.assert_allclose(row.brdf(WO, WI, rho, 0.6), base.brdf(WO, WI, rho, parameter))
    assert bool(row.albedo_dir) == bool(base.albedo_dir)
    if row.albedo_dir:
        albedo = row.albedo_dir(WO[:, 2], rho, 0.6)
        np.testing.assert_allclose(albedo, base.albedo_dir(WO[:, 2], rho, parameter))


@pytest.mark.parametrize("row", OTHERS, ids=lambda row: row.name)
def test_a_row_is_found_by_its_name_and_vanishes_on_black(row):
    assert diffuse_model(row.name) is row
    assert not row.brdf(WO, WI, 0.0, 0.5).any()
