# SPDX-License-Identifier: Apache-2.0
"""Samplers: limits, invariants, and agreement of samples with densities and models."""

import numpy as np
import pytest

from mxeon.models import sampling
from mxeon.models.diffuse import C1, eon_albedo_dir, eon_brdf, fon_brdf
from mxeon.models.sampling import cosine_pdf, eon_cltc_sample, eon_pdf, eon_sample
from tests.support import tolerances
from tests.support.cases import direction
from tests.support.hemispheres import COSINES, every_sampler, every_scene, hemisphere, uniforms
from tools.paper.samplers import BY_NAME, SAMPLERS


@pytest.mark.parametrize(
    "sampler", [row for row in SAMPLERS if row.name != "uniform"], ids=lambda sampler: sampler.name
)
@pytest.mark.parametrize("mu", COSINES)
def test_without_roughness_every_sampler_but_uniform_is_cosine(sampler, mu):
    wi, _ = hemisphere(mu, 8)
    pdf = sampler.pdf(direction(mu), wi, 0.0)
    np.testing.assert_allclose(pdf, cosine_pdf(wi), rtol=tolerances.SAMPLE_PDF, atol=0.0)


@pytest.mark.parametrize("rho", [1e-9, 0.18, 0.8, 1.0])
@every_scene
def test_gray_eon_pdf_is_the_brdf_times_the_cosine_over_the_albedo(mu, roughness, rho):
    wi, _ = hemisphere(mu, 8)
    value = eon_brdf(direction(mu), wi, rho, roughness)[..., 0] * wi[..., 2]
    value = value / eon_albedo_dir(mu, rho, roughness)
    pdf = eon_pdf(direction(mu), wi, roughness, rho=rho)
    np.testing.assert_allclose(pdf, value, rtol=tolerances.PDF, atol=0.0)


def test_eon_pdf_of_a_black_surface_is_that_of_fon():
    wi, weights = hemisphere(0.3)
    value = fon_brdf(direction(0.3), wi, 1.0, 1.0)[..., 0] * wi[..., 2]
    pdf = eon_pdf(direction(0.3), wi, 1.0, rho=0.0)
    np.testing.assert_allclose(pdf, value / (value @ weights), rtol=tolerances.QUADRATURE)


@every_sampler
@every_scene
def test_pdf_integrates_to_what_is_not_wasted(sampler, mu, roughness):
    wi, weights = hemisphere(mu)
    kept = 1.0
    if sampler.name == "ltc":
        kept = sampling.cltc_kept_fraction(sampling.ltc_md(mu, roughness))
    clipped = sampler.name in ("ltc", "cltc", "eon_cltc")
    bound = tolerances.KINK_QUADRATURE if clipped else tolerances.QUADRATURE
    assert abs(sampler.pdf(direction(mu), wi, roughness) @ weights - kept) < bound


@pytest.mark.parametrize("mu", [0.0, 1e-9, 0.3, 1.0 - 1e-9, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 1e-9, 0.3, 1.0])
def test_the_four_parts_of_eon_sum_to_one(mu, roughness):
    S = np.sqrt((1.0 - mu) * (1.0 + mu))
    total = sum(sampling.eon_integrals(np.float64(mu), S, 1.0, roughness))
    assert abs(total / (1.0 + C1 * roughness) - 1.0) < tolerances.PDF


def assert_same_density(pdf, again):
    """Assert that two densities are equal up to rounding."""
    np.testing.assert_allclose(pdf, again, rtol=tolerances.SAMPLE_PDF, atol=tolerances.DIRECTION)


def turned(w, angle):
    """The direction `w` rotated about the normal."""
    x, y, z = np.moveaxis(w, -1, 0)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


@every_sampler
def test_turning_both_directions_leaves_the_pdf(sampler):
    wi, _ = hemisphere(0.3, 8)
    pdf = sampler.pdf(direction(0.3, 2.0), turned(wi, 2.0), 1.0)
    assert_same_density(pdf, sampler.pdf(direction(0.3), wi, 1.0))


@pytest.mark.parametrize("name", ["ltc", "cltc", "eon"])
def test_turning_the_view_turns_the_samples(name):
    wi, pdf = BY_NAME[name].sample(direction(0.3), uniforms(1000, 1), 1.0)
    again, again_pdf = BY_NAME[name].sample(direction(0.3, 2.0), uniforms(1000, 1), 1.0)
    same = np.abs(again - turned(wi, 2.0)).max(axis=-1) <= tolerances.TURNED_DIRECTION
    assert np.mean(~same) <= tolerances.TURNED_SHARE
    moved = again_pdf[same] - pdf[same]
    assert (np.abs(moved) <= tolerances.SAMPLE_PDF * pdf[same] + tolerances.TURNED_PDF).all()


@pytest.mark.parametrize("name", ["ltc", "cltc", "eon_cltc", "eon"])
def test_arguments_broadcast(name):
    wo = direction(COSINES)[:, np.newaxis]
    u, roughness = uniforms(7, 4), np.linspace(0.0, 1.0, 7)
    wi, pdf = BY_NAME[name].sample(wo, u, roughness)
    assert wi.shape == (len(COSINES), 7, 3) and pdf.shape == (len(COSINES), 7)
    one, one_pdf = BY_NAME[name].sample(wo[2, 0], u[3], roughness[3])
    np.testing.assert_allclose(wi[2, 3], one, rtol=0.0, atol=tolerances.DIRECTION)
    assert_same_density(pdf[2, 3], one_pdf)


@every_sampler
def test_edges_give_unit_directions_above_the_horizon_and_finite_pdf(sampler):
    # Random numbers one ulp from 0 and 1, and numbers whose squares underflow.
    edges = np.array([0.0, 5e-324, 1e-200, 2.0**-53, 1e-9, 0.25, 0.5, 0.75, 1.0 - 2.0**-53])
    u = np.stack(np.meshgrid(edges, edges), axis=-1)
    for mu in (*edges, 1.0):
        for roughness in (*edges, 1e-308, 1e-307, 1e-306, 1e-300, 1.0):
            wi, pdf = sampler.sample(direction(mu, 1.0), u, roughness)
            assert np.isfinite(wi).all() and np.isfinite(pdf).all() and (pdf >= 0.0).all()
            assert (np.abs(np.sum(wi * wi, axis=-1) - 1.0) < tolerances.DIRECTION).all()
            assert sampler.name == "ltc" or (wi[..., 2] >= 0.0).all()


def test_eon_samples_always_have_a_weight():
    edges = np.array([0.0, 5e-324, 2.0**-53, 0.5, 1.0 - 2.0**-53])
    u = np.stack(np.meshgrid(edges, edges), axis=-1)
    for mu in (*edges, 1.0):
        for roughness in (*edges, 1.0):
            wi, pdf = eon_sample(direction(mu), u, roughness)
            weight = eon_brdf(direction(mu), wi, 1.0, roughness)[..., 0] * wi[..., 2] / pdf
            np.testing.assert_allclose(weight, 1.0, rtol=tolerances.PDF)


def test_the_mixture_has_a_density_where_listing_4_has_none():
    wi, pdf = eon_cltc_sample(direction(0.5), [0.0, 0.5], 0.0)
    assert wi.tolist() == [0.0, 0.0, 1.0] and pdf == 1.0 / np.pi


@pytest.mark.parametrize("d", [-0.5, -1e-3, 0.0, 1e-3, 0.5])
def test_clipped_cosine_keeps_the_side_of_the_lune_that_lands_above_the_horizon(d):
    u1, u2 = np.moveaxis(uniforms(10000, 2), -1, 0)
    wh = sampling.cltc_clipped(u1, u2, np.float64(d))
    assert (d * wh[..., 0] + wh[..., 2] >= -tolerances.LUNE).all()


def test_clipped_cosine_keeps_its_digits_on_the_rim():
    rest, u2 = 2.0 ** -np.arange(1.0, 54.0)[:, np.newaxis], np.linspace(0.0, 1.0, 64, False)
    z = sampling.cltc_clipped(1.0 - rest, u2, np.float64(0.0), rest)[..., 2]  # d = 0 clips nothing
    np.testing.assert_allclose(z, np.sqrt(rest + 0.0 * u2), rtol=tolerances.RIM)


@every_sampler
def test_a_density_of_one_direction_is_a_number(sampler):
    wi, pdf = sampler.sample(direction(0.5), [0.25, 0.5], 0.5)
    assert type(pdf) is np.float64 and type(sampler.pdf(direction(0.5), wi, 0.5)) is np.float64


@every_sampler
@every_scene
def test_the_density_of_a_sample_is_the_pdf(sampler, mu, roughness):
    wi, pdf = sampler.sample(direction(mu), uniforms(1000, 3), roughness)
    above = wi[..., 2] >= 0.0
    again = sampler.pdf(direction(mu), wi[above], roughness)
    assert_same_density(pdf[above], again)
