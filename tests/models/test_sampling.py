# SPDX-License-Identifier: Apache-2.0
"""Samplers have the right limits, and samples match the densities, the models and the weights.

Seeds are fixed. With random seeds, some chi-square test of this file would fail by chance with the
probability FALSE_ALARM, which is divided equally among the comparisons.
"""

from functools import partial

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from mxeon.models import diffuse, sampling
from mxeon.models.sampling import cosine_pdf, eon_cltc_sample, eon_pdf, eon_sample
from tests.support import tolerances
from tests.support.cases import direction
from tests.support.hemispheres import (
    COSINES,
    SCENES,
    every_sampler,
    every_scene,
    hemisphere,
    probability,
    uniforms,
)
from tools.paper.samplers import BY_NAME, SAMPLERS, Sampler


@pytest.mark.parametrize("sampler", [row for row in SAMPLERS if row.name != "uniform"])
@pytest.mark.parametrize("mu", COSINES)
def test_without_roughness_every_sampler_but_uniform_is_cosine(sampler, mu):
    wi, _ = hemisphere(mu, 8)
    pdf = sampler.pdf(direction(mu), wi, 0.0)
    np.testing.assert_allclose(pdf, cosine_pdf(wi), rtol=tolerances.SAMPLE_PDF, atol=0.0)


@pytest.mark.parametrize("rho", [1e-9, 0.18, 0.8, 1.0])
@every_scene
def test_gray_eon_pdf_is_the_brdf_times_the_cosine_over_the_albedo(mu, roughness, rho):
    wi, _ = hemisphere(mu, 8)
    value = diffuse.eon_brdf(direction(mu), wi, rho, roughness)[..., 0] * wi[..., 2]
    value = value / diffuse.eon_albedo_dir(mu, rho, roughness)
    pdf = eon_pdf(direction(mu), wi, roughness, rho=rho)
    np.testing.assert_allclose(pdf, value, rtol=tolerances.PDF, atol=0.0)


def test_eon_pdf_of_a_black_surface_is_that_of_fon():
    wi, weights = hemisphere(0.3)
    value = diffuse.fon_brdf(direction(0.3), wi, 1.0, 1.0)[..., 0] * wi[..., 2]
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
    assert abs(total / (1.0 + diffuse.C1 * roughness) - 1.0) < tolerances.PDF


def assert_same_density(pdf, again):
    np.testing.assert_allclose(pdf, again, rtol=tolerances.SAMPLE_PDF, atol=tolerances.DIRECTION)


def turned(w, angle):
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
    # Random numbers next to 0 and 1, and random numbers whose squares underflow.
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
            weight = diffuse.eon_brdf(direction(mu), wi, 1.0, roughness)[..., 0] * wi[..., 2] / pdf
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
    # The third argument, 0, means that nothing is clipped.
    z = sampling.cltc_clipped(1.0 - rest, u2, np.float64(0.0), rest)[..., 2]
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


# --- distributions of samples ----------------------------------------------------------------

FALSE_ALARM = 1e-4
GRAY = [  # exact samplers of EON for gray surfaces
    Sampler(f"eon_{rho}", partial(eon_sample, rho=rho), partial(eon_pdf, rho=rho), f"rho = {rho}")
    for rho in (0.0, 0.5)
]
ALL = [*SAMPLERS, *GRAY]
LEVEL = FALSE_ALARM / (len(ALL) * len(SCENES))


def chi_square(sampler, density, mu, roughness):
    """p-value of a chi-square test of samples against a density. Each test has its own seed."""
    u = uniforms(100_000, [ALL.index(sampler), SCENES.index((mu, roughness))])
    sample, pdf = (partial(each, roughness=roughness) for each in (sampler.sample, density.pdf))
    return probability(sample, pdf, direction(mu), u)


@pytest.mark.parametrize("sampler", ALL)
@every_scene
def test_samples_pass_the_chi_square_test_against_their_pdf(sampler, mu, roughness):
    assert chi_square(sampler, sampler, mu, roughness) > LEVEL


@pytest.mark.parametrize("mu", COSINES)
def test_chi_square_tells_the_samplers_apart(mu):
    for name in ("uniform", "cosine", "ltc"):
        assert chi_square(BY_NAME[name], BY_NAME["eon"], mu, 1.0) < LEVEL


# --- throughput weights ----------------------------------------------------------------------

# The weight of a sample at unit reflectance is f cos(theta_i) / p and has the mean 1. With the
# density p that the exact sampler returns, every weight is 1. The tests below replace p by the true
# density of the samples, which differs slightly because the sampler uses two fits, MULTIPLE and
# UPPER. The variable of each fit is a root of a random number. ROOTS holds values of the variable,
# which are dense at both ends of [0, 1].
ROOTS = np.sin(0.5 * np.pi * (np.arange(4001) + 0.5) / 4001) ** 2


def weights_of(sampler, mu, roughness):
    """Weights at quadrature nodes with a positive density, and probabilities of these nodes."""
    wi, solid_angle = hemisphere(mu, 32)
    pdf = sampler.pdf(direction(mu), wi, roughness)
    wi, pdf, solid_angle = wi[pdf > 0.0], pdf[pdf > 0.0], solid_angle[pdf > 0.0]
    value = diffuse.eon_brdf(direction(mu), wi, 1.0, roughness)[..., 0] * wi[..., 2]
    return value / pdf, pdf * solid_angle


@pytest.mark.parametrize("name", ("uniform", "cosine", "eon_cltc", "eon"))
@every_scene
def test_mean_weight_is_one(name, mu, roughness):
    weight, probability = weights_of(BY_NAME[name], mu, roughness)
    assert abs(weight @ probability - 1.0) < tolerances.QUADRATURE


def multiple_error():
    """Cosines sampled by the fit MULTIPLE, and the relative error of the density."""
    w = Polynomial([0.0, 1.0])
    a, b, c, d, e, f = sampling.MULTIPLE
    t = 1.0 - w**2
    mu = t * (1.0 + w**2 * (a + w**2 * (b + w * (c + w * (d + w * (e + w**4 * f))))))
    cosines = sampling.eon_multiple_cosine(t(ROOTS))
    np.testing.assert_allclose(cosines, mu(ROOTS), atol=tolerances.DIRECTION)
    # The random number is t^3 = (1 - w^2)^3, with the derivative -6 w t^2.
    slope = mu.deriv()(ROOTS) / (-6.0 * ROOTS * t(ROOTS) ** 2)
    density = 2.0 * diffuse.fon_loss_mu(mu(ROOTS)) * mu(ROOTS) / (diffuse.C1 - diffuse.C2)
    return mu(ROOTS), 1.0 / (slope * density) - 1.0


def upper_error(mu_o):
    """Cosines sampled by the fit UPPER, and the relative error of the density."""
    y = Polynomial([0.0, 1.0])
    fit = y * (1.0 + (1.0 - y) * Polynomial(sampling.UPPER))
    S_o = np.sqrt((1.0 - mu_o) * (1.0 + mu_o))
    K_o = sampling.eon_segment(mu_o, S_o)
    y_o = sampling.eon_upper_limit(mu_o, S_o)
    scale = (1.0 - mu_o) / fit(y_o)
    mu = sampling.eon_upper_cosine(ROOTS, mu_o, y_o)
    S = np.sqrt((1.0 - mu) * (1.0 + mu))
    np.testing.assert_allclose(mu, 1.0 - scale * fit(y_o * ROOTS), atol=tolerances.DIRECTION)
    # The random number is y^2.5. ROOTS holds the values of y.
    slope = scale * y_o * fit.deriv()(y_o * ROOTS) / (2.5 * ROOTS**1.5)
    return mu, K_o / (slope * S * (1.0 - mu)) - 1.0


def excess(mu, roughness):
    """Relative excess of the samples' true density over `eon_pdf`, and probability of each node."""
    wi, solid_angle = hemisphere(mu, 32)
    mu_i, s = wi[:, 2], direction(mu)[0] * wi[:, 0]
    losses = diffuse.fon_loss_mu(mu_i) * diffuse.fon_loss_mu(mu)
    multiple = roughness * losses / (diffuse.C1 - diffuse.C2)
    upper = np.where(mu_i >= mu, roughness * np.maximum(s, 0.0) * (1.0 / mu_i - 1.0), 0.0)
    total = 1.0 + roughness * diffuse.fon_quotient(mu, mu_i, s) + multiple
    extra = multiple * np.interp(mu_i, *(row[::-1] for row in multiple_error()))
    if mu < 1.0:
        extra += upper * np.interp(mu_i, *(row[::-1] for row in upper_error(mu)))
    return extra / total, eon_pdf(direction(mu), wi, roughness) * solid_angle


def test_what_the_fits_leave_is_what_the_documentation_states():
    errors = [multiple_error()[1]] + [upper_error(mu)[1] for mu in np.linspace(0.0, 0.99, 100)]
    assert max(np.abs(error).max() for error in errors) < tolerances.EON_DENSITY


@pytest.mark.parametrize("mu", (0.0, 1e-3, 0.03, 0.1, 0.3, 0.6, 0.9, 1.0))
@pytest.mark.parametrize("roughness", (1e-9, 1e-6, 1e-3, 0.05, 0.25, 0.5, 0.75, 1.0))
def test_exact_sampling_has_no_variance_and_is_never_worse_than_cosine(mu, roughness):
    relative, probability = excess(mu, roughness)
    weight = 1.0 / (1.0 + relative)
    variance = (weight - 1.0) ** 2 @ probability
    assert weight.max() <= 1.0 + tolerances.EON_WEIGHT
    assert variance < tolerances.EON_VARIANCE
    # At the smallest roughness, cosine sampling is almost exact.
    cosine, probability = weights_of(BY_NAME["cosine"], mu, roughness)
    assert variance <= (cosine - 1.0) ** 2 @ probability
