# SPDX-License-Identifier: Apache-2.0
"""Variants that renderers' own nodes have: where they are right, and how they are wrong."""

import numpy as np
import pytest

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.diffuse import (
    burley_brdf,
    burley_cosine_brdf,
    lambert_brdf,
    qon_brdf,
    qon_degrees_albedo_dir,
    qon_degrees_brdf,
)
from mxeon.models.table import OTHERS, PARAMETRIZATIONS, diffuse_model
from tests.support import tolerances


def directions(seed):
    rng = np.random.default_rng(seed)
    mu, azimuth = 0.05 + 0.95 * rng.random(1000), 2.0 * np.pi * rng.random(1000)
    radius = np.sqrt(1.0 - mu * mu)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), mu], axis=-1)


WO, WI = directions(1), directions(2)
COATED = ("eon_coated", "eon_varnished", "openpbr_half_metal")


# By the last word of a name: the parameter of the model, from a roughness.
PARAMETERS = {"half_pi": 0.3 * np.pi, "slope": 0.6 / np.sqrt(2.0), "squared": 0.36}


@pytest.mark.parametrize("row", PARAMETRIZATIONS, ids=lambda row: row.name)
def test_a_model_of_another_roughness_is_the_model_of_its_parameter(row):
    [(word, parameter)] = [pair for pair in PARAMETERS.items() if row.name.endswith(pair[0])]
    base = diffuse_model(row.name.removesuffix(f"_{word}"))
    rho = [0.8, 0.2]
    np.testing.assert_allclose(row.brdf(WO, WI, rho, 0.6), base.brdf(WO, WI, rho, parameter))
    assert bool(row.albedo_dir) == bool(base.albedo_dir)
    if row.albedo_dir:
        albedo = row.closed_albedo_dir(WO[:, 2], rho, 0.6)
        np.testing.assert_allclose(albedo, base.closed_albedo_dir(WO[:, 2], rho, parameter))


@pytest.mark.parametrize("row", OTHERS, ids=lambda row: row.name)
def test_a_row_is_found_by_its_name_and_vanishes_on_black_unless_it_has_facets(row):
    assert diffuse_model(row.name) is row
    assert row.brdf(WO, WI, 0.0, 0.5).any() == (row.name in COATED)


def test_degrees_are_radians_at_zero_and_wrong_elsewhere():
    error = np.pi * np.abs(qon_degrees_brdf(WO, WI, 0.8, 0.0) - lambert_brdf(WO, WI, 0.8))
    assert error.max() <= tolerances.BRDF
    assert np.abs(qon_degrees_brdf(WO, WI, 0.8, 0.1) - qon_brdf(WO, WI, 0.8, 0.1)).max() > 0.1


def test_the_albedo_of_degrees_is_its_integral():
    mu = np.array([0.2, 0.6, 1.0])
    integral = albedo_dir_quadrature(qon_degrees_brdf, mu, [0.5, 1.0], 0.1)
    closed = qon_degrees_albedo_dir(mu, [0.5, 1.0], 0.1)
    assert np.abs(integral - closed).max() <= tolerances.QUADRATURE


def test_the_cosine_twice_is_burley_where_the_light_is_along_the_normal():
    up = np.array([0.0, 0.0, 1.0])
    for roughness in (0.0, 1.0):
        values = burley_cosine_brdf(WO, up, 0.5, roughness)
        assert np.abs(values - burley_brdf(WO, up, 0.5, roughness)).max() <= tolerances.BRDF
    wrong = burley_cosine_brdf(WO, WI, 0.5, 0.5) - burley_brdf(WO, WI, 0.5, 0.5)
    assert np.abs(wrong).max() > 0.1


def test_a_white_surface_of_the_cosine_twice_reflects_two_thirds():
    albedo = albedo_dir_quadrature(burley_cosine_brdf, 1.0, 1.0, 0.5)
    assert 0.6 < albedo.item() < 0.7
