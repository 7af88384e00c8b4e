# SPDX-License-Identifier: Apache-2.0
"""Albedos of microfacet BRDFs: limits, invariants, and agreement of independent quadratures."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from mxeon.models import (
    conductor_albedo_dir,
    conductor_brdf,
    dielectric_albedo_dir,
    dielectric_brdf,
    fresnel_dielectric,
    generalized_schlick_albedo_dir,
    generalized_schlick_brdf,
    ggx_albedo_dir,
    ggx_albedo_dir_anisotropic,
)
from mxeon.models.microfacet import ggx, slopes
from mxeon.models.microfacet.ggx import missing_light
from mxeon.models.sampling import ggx_sample
from tests.support import tolerances
from tests.support.cases import direction
from tests.support.hemispheres import hemisphere

ALPHA = np.geomspace(1e-4, 1.0, 9)
MU = np.unique(np.concatenate([np.geomspace(1e-4, 1.0, 13), 1.0 - np.geomspace(1e-12, 0.1, 4)]))
GOLD = [0.183, 1.373], [3.424, 1.77]
CUBICS = 5e-13  # twice the rounding error of (1 - E_ss) / E_ss
COLORS = [0.9, 0.2], 0.5, 1.0
EXACT = {"epsabs": 1e-13, "epsrel": 1e-12, "limit": 200}
NODES = {
    "dielectric_bsdf": (
        lambda wo, wi, alpha, *a: dielectric_brdf(wo, wi, [0.2, 1.0], alpha, 1.5, *a),
        lambda wo, alpha: dielectric_albedo_dir(wo, [0.2, 1.0], alpha, 1.5),
    ),
    "conductor_bsdf": (
        lambda wo, wi, alpha, *a: conductor_brdf(wo, wi, alpha, *GOLD, *a),
        lambda wo, alpha: conductor_albedo_dir(wo, alpha, *GOLD),
    ),
    "generalized_schlick_bsdf": (
        lambda wo, wi, alpha, *a: generalized_schlick_brdf(wo, wi, *COLORS, alpha, 5.0, *a),
        lambda wo, alpha: generalized_schlick_albedo_dir(wo, *COLORS, alpha, 5.0),
    ),
}
every_node = pytest.mark.parametrize("name", NODES)


# --- E_ss --------------------------------------------------------------------------------------


def test_the_albedo_is_converged(monkeypatch):
    mu = np.append(MU, [0.0, 1e-14, 1e-10, 1e-8, 1e-6])[:, None]
    small = np.geomspace(1e-9, 1e-5, 5)
    values, small_values = ggx_albedo_dir(mu, ALPHA), ggx_albedo_dir(mu, small)
    monkeypatch.setattr(ggx, "RULE", np.polynomial.legendre.leggauss(96))
    assert np.abs(values - ggx_albedo_dir(mu, ALPHA)).max() < tolerances.E_SS
    assert np.abs(small_values - ggx_albedo_dir(mu, small)).max() < tolerances.E_SS_SMALL


def test_the_albedo_agrees_with_a_quadrature_over_slopes(monkeypatch):
    monkeypatch.setattr(slopes, "SLOPE_NODES", 32)
    monkeypatch.setattr(slopes, "QUADRANT", 48)
    alpha, mu = np.array([0.03, 0.1, 0.3, 1.0]), np.array([1e-3, 0.1, 0.7])[:, None]
    E = ggx_albedo_dir_anisotropic(direction(mu), np.stack([alpha, alpha], axis=-1))
    assert np.abs(E - ggx_albedo_dir(mu, alpha)).max() < tolerances.E_SS


def test_the_albedo_agrees_with_adaptive_quadrature_of_the_printed_integral():
    mu, alpha = 0.3, 0.5

    def integrand(phi, mu_i):
        s = np.sqrt((1.0 - mu**2) * (1.0 - mu_i**2)) * np.cos(phi)
        hz2 = (mu + mu_i) ** 2 / (2.0 + 2.0 * (s + mu * mu_i))
        D = 1.0 / (np.pi * alpha**2 * ((1.0 - hz2) / alpha**2 + hz2) ** 2)
        smith = [np.sqrt(alpha**2 + (1.0 - alpha**2) * m**2) for m in (mu, mu_i)]
        return D * mu_i / (2.0 * (smith[0] * mu_i + smith[1] * mu))

    half, _ = dblquad(integrand, 0.0, 1.0, 0.0, np.pi, epsabs=1e-12, epsrel=1e-12)
    assert abs(ggx_albedo_dir(mu, alpha) - 2.0 * half) < tolerances.E_SS


def test_the_albedo_lies_between_its_limits_on_the_closed_domain():
    mu = np.array([0.0, 5e-324, 1e-160, 1e-8, 1e-3, 0.5, 1.0 - 1e-16, 1.0])
    alpha = np.array([0.0, 5e-324, 1e-160, 1e-9, 1e-4, 0.5, 1.0])
    E = ggx_albedo_dir(mu[:, None], alpha)
    assert (E > 0.3).all() and (E <= 1.0).all() and (E[:, 0] == 1.0).all()
    assert abs(ggx_albedo_dir(1.0, 1.0) - (1.0 - np.log(2.0))) < tolerances.E_SS


def test_the_table_of_what_facets_miss_agrees_with_the_quadrature():
    rng = np.random.default_rng(0)
    mu, alpha = rng.random((2, 3000)) ** [[6.0], [3.0]]
    # Small alphas: cosines near 0, near 1, and proportional to alpha.
    small = np.geomspace(1e-9, 1e-4, 6)[:, None]
    mu = np.concatenate([mu, (small * [0.0, 0.1, 1.0, 10.0, 1e3]).ravel(), np.ones(30)])
    alpha = np.concatenate([np.maximum(alpha, small[0]), np.repeat(small, 10)])
    E = ggx.quadrature(mu, alpha, refined=4)
    assert np.abs(missing_light(mu, alpha) - (1.0 - E) / E).max() < tolerances.E_SS


def test_a_mirror_misses_nothing_and_grazing_light_has_a_limit():
    mu = np.array([0.0, 5e-324, 1e-160, 0.5, 1.0, 1.0 + 1e-7])
    assert (missing_light(mu, np.zeros(1)) == 0.0).all()
    assert (missing_light(np.linspace(0.0, 1.0, ggx.MANY), np.zeros(1)) == 0.0).all()
    light = missing_light(mu, np.array([5e-324, 1e-160, 1.0])[:, None])
    assert (light >= 0.0).all() and np.ptp(light[:, 0]) < tolerances.E_SS


@pytest.mark.parametrize("alpha", [1e-160, 1e-4, 0.3, 1.0])
def test_many_cosines_of_one_alpha_share_cubics_that_follow_the_polynomials(alpha):
    s = np.linspace(0.0, 0.9999, ggx.MANY) ** 3
    mu = np.append(s * alpha / (1.0 + alpha - s), [0.0, 5e-324, 1.0, 1.0 + 1e-7, np.nan])
    cubics = missing_light(mu, np.array([alpha]))
    polynomials = [missing_light(part, np.array([alpha])) for part in np.array_split(mu, 2)]
    error = np.abs(cubics - np.concatenate(polynomials))
    assert np.isnan(cubics[-1]) and error[:-1].max() < CUBICS


def test_at_small_alpha_the_albedo_is_a_function_of_mu_over_alpha():
    scaled = [ggx_albedo_dir(np.array([0.3, 1.0, 4.0]) * a, a) for a in (1e-12, 1e-10, 1e-8)]
    assert np.ptp(scaled, axis=0).max() < 1e-7


# --- albedos with Fresnel ----------------------------------------------------------------------


@every_node
@pytest.mark.parametrize("alpha", [(0.5, 0.5), (0.3, 0.8)], ids=str)
def test_the_albedo_is_the_integral_of_the_value(name, alpha):
    brdf, albedo = NODES[name]
    for mu, phi in ((0.9, 0.0), (0.3, 1.0)):
        wo = direction(mu, phi)
        wi, weights = hemisphere(mu, 64)
        for retroreflective in (False, True):
            value = brdf(wo, wi, alpha, retroreflective)
            integral = np.einsum("nc,n,n->c", value, wi[:, 2], weights)
            assert np.abs(albedo(wo, alpha) - integral).max() < tolerances.SLOPES


@every_node
def test_the_albedo_is_converged_over_slopes(name, monkeypatch):
    albedo = NODES[name][1]
    wo = direction(np.array([1e-4, 1e-2, 0.5, 1.0]), 0.7)[:, None]
    alpha = np.array(
        [[1e-4, 1e-4], [1e-3, 1e-3], [0.02, 0.02], [0.3, 0.3], [1.0, 1.0], [0.05, 0.6]]
    )
    values = albedo(wo, alpha)
    monkeypatch.setattr(slopes, "SLOPE_NODES", 32)
    monkeypatch.setattr(slopes, "QUADRANT", 32)
    more = albedo(wo, alpha)
    assert (np.abs(values - more) / np.maximum(more, 1.0)).max() < tolerances.SLOPES


@pytest.mark.parametrize("ior", [0.3, 1.0 / 1.5, 0.95])
def test_the_albedo_is_converged_at_a_critical_angle(ior, monkeypatch):
    wo = direction(np.array([1e-4, 0.1, 0.5, 0.72, 0.75, 0.9, 1.0]), 0.7)[:, None]
    alpha = np.array([[1e-4, 1e-4], [0.02, 0.02], [0.3, 0.3], [1.0, 1.0], [0.05, 0.6], [1.0, 0.1]])
    values = dielectric_albedo_dir(wo, 1.0, alpha, ior)[..., 0]
    monkeypatch.setattr(slopes, "SPLIT_NODES", 64)
    monkeypatch.setattr(slopes, "SPLIT_PART", 64)
    error = np.abs(values - dielectric_albedo_dir(wo, 1.0, alpha, ior)[..., 0])
    assert error[:, :4].max() < tolerances.E_SS  # isotropic lobes
    assert error.max() < tolerances.SLOPES


@pytest.mark.parametrize(
    "mu, alpha, ior", [(0.5, 0.5, 1 / 1.5), (0.8, 0.3, 1 / 1.5), (0.3, 1.0, 0.7)]
)
def test_the_albedo_agrees_with_a_quadrature_around_the_view_at_a_critical_angle(mu, alpha, ior):
    def around(c):
        """Integrand over azimuths of half vectors around wo whose cosine with wo is c."""
        slope = np.sqrt((1.0 - c * c) * (1.0 - mu * mu))
        horizon = (mu / (2.0 * c) - c * mu) / slope
        if horizon >= 1.0:
            return 0.0
        return 2.0 * quad(value, 0.0, np.arccos(max(horizon, -1.0)), (c, slope), **EXACT)[0]

    def value(psi, c, slope):
        hz = c * mu + slope * np.cos(psi)
        mu_i = 2.0 * c * hz - mu
        D = 1.0 / (np.pi * alpha**2 * ((1.0 - hz * hz) / alpha**2 + hz * hz) ** 2)
        smith = [np.sqrt(alpha**2 + (1.0 - alpha**2) * m * m) for m in (mu, mu_i)]
        return D * c * 2.0 * mu_i / (smith[0] * mu_i + smith[1] * mu)

    def share(t, low, high):
        c = low + (high - low) * t * t * (3.0 - 2.0 * t)  # F starts like a square root
        return fresnel_dielectric(c, ior) * around(c) * 6.0 * t * (1.0 - t) * (high - low)

    theta, quarter = np.arccos(mu), 0.5 * np.pi
    bends = [np.cos(0.5 * (quarter + theta)), np.cos(0.5 * (quarter - theta))]
    parts = pairwise(sorted([1e-9, np.sqrt(1.0 - ior**2), *bends, 1.0 - 1e-15]))
    expected = sum(quad(share, 0.0, 1.0, part, **EXACT)[0] for part in parts)
    E = dielectric_albedo_dir(direction(mu), 1.0, [alpha, alpha], ior, compensate=False)[0]
    assert abs(E - expected) < tolerances.SPLIT


def test_a_critical_angle_that_is_not_split_would_be_seen():
    wo, alpha, ior = direction(0.3), np.array([1.0, 1.0]), 1.0 / 1.5
    c, weight = slopes.slope_nodes(wo, alpha)
    unsplit = np.sum(fresnel_dielectric(c, ior) * weight)
    E = dielectric_albedo_dir(wo, 1.0, alpha, ior, compensate=False)[0]
    assert abs(unsplit - E) > 1e-3


def test_a_white_surface_returns_all_light():
    mu = np.array([1e-4, 0.01, 0.3, 1.0])[:, None]
    alpha = np.array([0.0, 1e-4, 0.01, 0.3, 1.0])
    pairs = np.stack([alpha, alpha], axis=-1)
    for E in (
        generalized_schlick_albedo_dir(direction(mu), 1.0, 1.0, 1.0, pairs, 5.0),
        dielectric_albedo_dir(direction(mu), 1.0, pairs, 0.0),
        conductor_albedo_dir(direction(mu), pairs, 0.0, 3.0),
    ):
        assert np.abs(E - 1.0).max() < tolerances.SLOPES


def test_without_compensation_light_is_lost():
    E = dielectric_albedo_dir(direction(0.5), 1.0, [1.0, 1.0], 0.0, compensate=False)
    assert abs(E[0] - ggx_albedo_dir(0.5, 1.0)) < tolerances.SLOPES


def test_a_mirror_has_the_albedo_of_its_fresnel_reflectance():
    mu = np.array([0.01, 0.3, 1.0])
    E = dielectric_albedo_dir(direction(mu), 1.0, [0.0, 0.0], 1.5)[:, 0]
    assert np.abs(E - fresnel_dielectric(mu, 1.5)).max() < tolerances.SLOPES


def test_anisotropic_facets_gain_no_energy():
    mu, phi = np.meshgrid([1e-3, 0.01, 0.3, 1.0], np.linspace(0.0, 0.5 * np.pi, 7))
    for roughness in ([0.001, 1.0], [0.02, 1.0], [0.18, 0.35], [0.9, 0.1]):
        E = ggx_albedo_dir_anisotropic(direction(mu.ravel(), phi.ravel()), roughness)
        assert (E > 0.3).all() and (E < 1.0 + tolerances.SLOPES).all()


@every_node
def test_albedos_are_finite_on_the_closed_domain(name):
    mu = np.array([0.0, 5e-324, 1e-8, 1.0 - 1e-16, 1.0])
    ends = np.array([0.0, 5e-324, 1e-160, 1e-4, 1.0])
    E = NODES[name][1](direction(mu)[:, None, None], np.stack(np.meshgrid(ends, ends), axis=-1))
    assert np.isfinite(E).all() and (E >= 0.0).all()


@pytest.mark.parametrize("alpha", [(0.3, 0.12), (0.3, 0.6), (0.01, 0.004), (0.02, 1.0)])
def test_many_views_of_two_alphas_share_a_polynomial_that_follows_the_quadrature(alpha):
    mu, phi = np.random.default_rng(3).random((2, 600)) * [[1.0], [2.0 * np.pi]]
    wo = np.concatenate([direction(mu**2, phi), direction(np.array([1e-4, 1.0]), 0.0)])
    few = wo[::10]
    shared, own = (
        conductor_brdf(each, each, alpha, 0.0, 3.0)
        / conductor_brdf(each, each, alpha, 0.0, 3.0, compensate=False)
        for each in (wo, few)
    )
    np.testing.assert_allclose(shared[::10], own, rtol=tolerances.SLOPES)


def test_a_sum_over_visible_normals_is_the_albedo_but_for_its_masking():
    rng, count = np.random.default_rng(7), 1 << 18
    wo, same, other = np.array(direction(0.4, 0.7)), np.array([0.3, 0.3]), np.array([0.2, 0.6])
    for alpha in (same, other):
        wi, _ = ggx_sample(np.broadcast_to(wo, (count, 3)), rng.random((count, 2)), alpha)
        mean = np.full(2, np.sqrt(alpha.prod()))
        lit = wi[:, 2] > 0.0
        # The density is D G_1 / (4 mu_o). MaterialX's sum weights by G_2 / G_1 of the mean alpha.
        weight = np.where(lit, ggx.smith_g2(wo[2], np.abs(wi[:, 2]), mean[0]), 0.0)
        weight = weight / ggx.smith_g1(wo[np.newaxis], mean[np.newaxis])
        found = slopes.slope_nodes(wo[:, np.newaxis], alpha[:, np.newaxis], summed=True)[1].sum()
        assert abs(found - weight.mean()) < 5.0 * weight.std() / np.sqrt(count)
    exact = slopes.slope_nodes(wo[:, np.newaxis], same[:, np.newaxis])[1].sum()
    found = slopes.slope_nodes(wo[:, np.newaxis], same[:, np.newaxis], summed=True)[1].sum()
    assert abs(found - exact) < 1e-12
