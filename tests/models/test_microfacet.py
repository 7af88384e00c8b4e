# SPDX-License-Identifier: Apache-2.0
"""Microfacet BRDFs have the right limits, and match the published equations in 50 digits."""

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from mxeon import models
from mxeon.models.microfacet import ggx, node_brdf, slopes
from mxeon.models.microfacet.defects import MICROFACET_DEFECTS
from mxeon.models.microfacet.ggx import missing_light, ndf
from mxeon.models.nodes.microfacets import MICROFACET_NODES
from mxeon.models.sampling import ggx_sample
from tests.support import tolerances
from tests.support.cases import direction, directions
from tests.support.hemispheres import hemisphere

GOLD = [0.183, 0.421, 1.373], [3.424, 2.346, 1.77]
COLORS = [0.9, 0.2, 0.0], [0.5, 1.0, 0.1], [1.0, 0.8, 1.0]
INPUTS = {
    "dielectric_bsdf": {"tint": [0.2, 1.0, 0.5], "ior": 1.5},
    "conductor_bsdf": {"ior": GOLD[0], "extinction": GOLD[1]},
    "generalized_schlick_bsdf": dict(zip(("color0", "color82", "color90"), COLORS, strict=True))
    | {"exponent": 5.0},
}
FEWER = {  # inputs with two color channels, for the tests of albedos
    "dielectric_bsdf": {"tint": [0.2, 1.0], "ior": 1.5},
    "conductor_bsdf": {"ior": [0.183, 1.373], "extinction": [3.424, 1.77]},
    "generalized_schlick_bsdf": {
        **{"color0": [0.9, 0.2], "color82": 0.5, "color90": 1.0, "exponent": 5.0},
    },
}
every_node = pytest.mark.parametrize("name", INPUTS)


def brdf(name, wo, wi, roughness, inputs=INPUTS, **options):
    function = getattr(models, name.replace("_bsdf", "_brdf"))
    return function(wo, wi, roughness=roughness, **inputs[name], **options)


def albedo_dir(name, wo, roughness):
    function = getattr(models, name.replace("_bsdf", "_albedo_dir"))
    return function(wo, roughness=roughness, **FEWER[name])


def pairs(count, seed=1):
    """Random pairs of directions, and roughness with alpha >= 0.05."""
    rng = np.random.default_rng(seed)
    return *directions((2, count), rng), 0.05 + 0.95 * rng.random((count, 2))


def fresnel_exact(name, c, channel):
    """Fresnel reflectance, computed by the equations in the specification in 50 digits."""
    if name == "generalized_schlick_bsdf":
        r0, t, r90 = (mp.mpf(color[channel]) for color in COLORS)
        m = mp.mpf(1) / 7
        a = (r0 + (r90 - r0) * (1 - m) ** 5) * (1 - t) / (m * (1 - m) ** 6)
        # The Fresnel curve that OpenPBR specifies for metals.
        return max(r0 + (r90 - r0) * (1 - c) ** 5 - a * c * (1 - c) ** 6, 0)
    if name == "dielectric_bsdf":
        g = mp.sqrt(mp.mpf(1.5) ** 2 + c * c - 1)
        ratio = (c * (g + c) - 1) / (c * (g - c) + 1)
        return (g - c) ** 2 / (g + c) ** 2 * (1 + ratio**2) / 2
    n, k = (mp.mpf(part[channel]) for part in GOLD)
    s = 1 - c * c
    ab = mp.sqrt((n * n - k * k - s) ** 2 + 4 * n * n * k * k)
    a = mp.sqrt((ab + n * n - k * k - s) / 2)
    rs = (ab - 2 * a * c + c * c) / (ab + 2 * a * c + c * c)
    rp = rs * (c * c * ab - 2 * a * c * s + s * s) / (c * c * ab + 2 * a * c * s + s * s)
    return (rs + rp) / 2


def exact(name, wo, wi, roughness, channel):
    """BRDF without compensation and tint, computed by the published equations in 50 digits."""
    wo, wi = ([mp.mpf(float(x)) for x in w] for w in (wo, wi))
    ax, ay = (mp.mpf(float(alpha)) for alpha in roughness)
    h = [a + b for a, b in zip(wo, wi, strict=True)]
    length = mp.sqrt(sum(x * x for x in h))
    h = [x / length for x in h]
    D = 1 / (mp.pi * ax * ay * ((h[0] / ax) ** 2 + (h[1] / ay) ** 2 + h[2] ** 2) ** 2)
    lo, li = (mp.sqrt((ax * w[0]) ** 2 + (ay * w[1]) ** 2 + w[2] ** 2) for w in (wo, wi))
    G2 = 2 * wo[2] * wi[2] / (lo * wi[2] + li * wo[2])
    return D * fresnel_exact(name, length / 2, channel) * G2 / (4 * wo[2] * wi[2])


@every_node
def test_values_agree_with_the_printed_equations_in_50_digits(name):
    wo, wi, alpha = pairs(12)
    values = brdf(name, wo, wi, alpha, compensate=False)
    tint = [0.2, 1.0, 0.5] if name == "dielectric_bsdf" else [1.0, 1.0, 1.0]
    with mp.workdps(50):
        for n, channel in np.ndindex(values.shape):
            expected = tint[channel] * exact(name, wo[n], wi[n], alpha[n], channel)
            error = abs(values[n, channel] - expected)
            assert error <= tolerances.MICROFACET * max(abs(expected), 1e-3)


@every_node
def test_without_compensation_the_value_is_reciprocal(name):
    wo, wi, alpha = pairs(200)
    forth, back = (brdf(name, *w, alpha, compensate=False) for w in ((wo, wi), (wi, wo)))
    assert np.allclose(forth, back, rtol=tolerances.MICROFACET, atol=0.0)


@every_node
@pytest.mark.parametrize("equal", [True, False])
def test_compensation_is_that_of_the_albedo(name, equal):
    wo, wi, alpha = pairs(50)
    alpha = alpha[:, [0, 0]] if equal else alpha
    F_ss = {
        "dielectric_bsdf": models.fresnel_dielectric_avg(1.5),
        "conductor_bsdf": models.fresnel_conductor_avg(*GOLD),
        "generalized_schlick_bsdf": np.maximum(models.fresnel_schlick_avg(*COLORS, 5.0), 0.0),
    }[name]
    E = models.ggx_albedo_dir_anisotropic(wo, alpha)[:, None]
    if equal:
        E = models.ggx_albedo_dir(wo[:, 2], alpha[:, 0])[:, None]
    expected = brdf(name, wo, wi, alpha, compensate=False) * (1.0 + F_ss * (1.0 - E) / E)
    value = brdf(name, wo, wi, alpha)
    assert np.allclose(value, expected, rtol=tolerances.E_SS, atol=0.0)


@every_node
def test_retroreflection_mirrors_the_view_about_the_normal(name):
    wo, wi, alpha = pairs(50)
    mirrored = brdf(name, wo * [-1.0, -1.0, 1.0], wi, alpha)
    assert np.array_equal(brdf(name, wo, wi, alpha, retroreflective=True), mirrored)


@every_node
def test_anisotropy_turns_with_the_tangent(name):
    wo, wi, alpha = pairs(50)
    turned = [np.stack([-w[:, 1], w[:, 0], w[:, 2]], axis=-1) for w in (wo, wi)]
    value = brdf(name, *turned, alpha[:, ::-1])
    assert np.allclose(value, brdf(name, wo, wi, alpha), rtol=tolerances.MICROFACET, atol=0.0)


@every_node
def test_values_are_finite_on_the_closed_domain(name):
    mu = np.array([0.0, 5e-324, 1e-160, 1e-8, 0.5, 1.0 - 1e-16, 1.0])
    ends = np.array([0.0, 5e-324, 1e-160, 1e-4, 0.5, 1.0])
    wo = direction(mu, 0.0)[:, None, None, None, None]
    wi = direction(mu[:, None], np.array([0.0, 2.0, np.pi]))[:, :, None, None]
    alpha = np.stack(np.meshgrid(ends, ends), axis=-1)
    values = brdf(name, wo, wi, alpha)
    assert np.isfinite(values).all()
    assert name == "generalized_schlick_bsdf" or (values >= 0.0).all()
    # A perfect mirror has no finite value, so 0 is returned.
    assert (values[..., 0, :, :] == 0.0).all()


def test_the_distribution_covers_the_surface_once():
    wh, weights = hemisphere(1.0)
    for alpha in ([0.3, 0.3], [0.4, 0.9], [1.0, 1.0]):
        assert abs(np.sum(ndf(wh.T, alpha) * wh[:, 2] * weights) - 1.0) < 1e-10


def test_masking_is_a_fraction_and_both_forms_agree_for_isotropic_roughness():
    wo, wi, alpha = pairs(200)
    isotropic = alpha[:, [0, 0]]
    G2 = models.smith_g2(wo[:, 2], wi[:, 2], alpha[:, 0])
    exact_G2 = models.smith_g2_anisotropic(wo, wi, isotropic)
    assert np.allclose(G2, exact_G2, rtol=tolerances.MICROFACET, atol=0.0)
    assert (G2 > 0.0).all() and (models.smith_g1(wo, isotropic) * (1.0 + 1e-15) >= G2).all()
    assert models.smith_g1([1.0, 0.0, 0.0], [0.5, 0.5]) == models.smith_g2(0.0, 0.0, 0.5) == 0.0
    assert models.smith_g1([1.0, 0.0, 0.0], [0.0, 0.0]) == models.smith_g2(0.5, 0.7, 0.0) == 1.0


DEFECTS = {defect.name: defect for defect in MICROFACET_DEFECTS}


@pytest.mark.parametrize("exponent, equal", [(5.0, True), (2.0, False)])
def test_the_average_by_its_ends_is_that_of_schlicks_curve_of_exponent_5(exponent, equal):
    wo, wi, alpha = pairs(20)
    colors = {"color0": COLORS[0], "color82": [1.0, 1.0, 1.0], "color90": COLORS[2]}
    inputs = colors | {"exponent": exponent, "roughness": alpha}
    value = models.generalized_schlick_brdf(wo, wi, *colors.values(), alpha, exponent)
    lobe = DEFECTS["compensation_average"].lobe
    same = node_brdf("generalized_schlick_bsdf", wo, wi, inputs, lobe)
    assert np.allclose(same, value, rtol=tolerances.MICROFACET, atol=0.0) == equal


@pytest.mark.parametrize("row", MICROFACET_NODES)
def test_the_text_permits_the_average_by_its_ends(row):
    wo, wi, alpha = pairs(20)
    inputs = {"roughness": alpha[:, [0, 0]]}
    for name, value in INPUTS[row.category].items():
        inputs[name] = np.broadcast_to(value, (20, *np.shape(value)))
    title = DEFECTS["compensation_average_fitted"].title
    value, albedo = (each for each in row.variants if each.title == title and each.permitted)
    assert value.value(wo, wi, inputs).shape == albedo.albedo(wo, inputs).shape == (20, 3)


def test_defects_agree_with_the_specification_where_they_should():
    wo, wi, alpha = pairs(20)
    white = {"color0": 1.0, "color82": 1.0, "color90": 1.0, "exponent": 5.0, "roughness": alpha}
    value = models.generalized_schlick_brdf(wo, wi, 1.0, 1.0, 1.0, alpha, 5.0, True)
    for name in ("half", "f0", "view", "average"):
        lobe = DEFECTS[f"compensation_{name}"].lobe
        same = node_brdf("generalized_schlick_bsdf", wo, wi, white, lobe, True)
        assert np.allclose(same, value, rtol=tolerances.MICROFACET, atol=0.0)
    isotropic = white | {"roughness": alpha[:, [0, 0]]}
    value = models.generalized_schlick_brdf(wo, wi, 1.0, 1.0, 1.0, alpha[:, [0, 0]], 5.0)
    same = node_brdf("generalized_schlick_bsdf", wo, wi, isotropic, DEFECTS["smith_mean"].lobe)
    assert np.allclose(same, value, rtol=tolerances.MICROFACET, atol=0.0)


# --- E_ss --------------------------------------------------------------------------------------

ALPHA = np.geomspace(1e-4, 1.0, 9)
MU = np.unique(np.concatenate([np.geomspace(1e-4, 1.0, 13), 1.0 - np.geomspace(1e-12, 0.1, 4)]))
CUBICS = 5e-13  # difference of two computations of the same value, caused by rounding
EXACT = {"epsabs": 1e-13, "epsrel": 1e-12, "limit": 200}


def test_the_albedo_is_converged(monkeypatch):
    mu = np.append(MU, [0.0, 1e-14, 1e-10, 1e-8, 1e-6])[:, None]
    small = np.geomspace(1e-9, 1e-5, 5)
    values, small_values = models.ggx_albedo_dir(mu, ALPHA), models.ggx_albedo_dir(mu, small)
    monkeypatch.setattr(ggx, "RULE", np.polynomial.legendre.leggauss(96))
    assert np.abs(values - models.ggx_albedo_dir(mu, ALPHA)).max() < tolerances.E_SS
    assert np.abs(small_values - models.ggx_albedo_dir(mu, small)).max() < tolerances.E_SS_SMALL


def test_the_albedo_agrees_with_a_quadrature_over_slopes(monkeypatch):
    monkeypatch.setattr(slopes, "SLOPE_NODES", 32)
    monkeypatch.setattr(slopes, "QUADRANT", 48)
    alpha, mu = np.array([0.03, 0.1, 0.3, 1.0]), np.array([1e-3, 0.1, 0.7])[:, None]
    E = models.ggx_albedo_dir_anisotropic(direction(mu), np.stack([alpha, alpha], axis=-1))
    assert np.abs(E - models.ggx_albedo_dir(mu, alpha)).max() < tolerances.E_SS


def test_the_albedo_agrees_with_adaptive_quadrature_of_the_printed_integral():
    mu, alpha = 0.3, 0.5

    def integrand(phi, mu_i):
        s = np.sqrt((1.0 - mu**2) * (1.0 - mu_i**2)) * np.cos(phi)
        hz2 = (mu + mu_i) ** 2 / (2.0 + 2.0 * (s + mu * mu_i))
        D = 1.0 / (np.pi * alpha**2 * ((1.0 - hz2) / alpha**2 + hz2) ** 2)
        smith = [np.sqrt(alpha**2 + (1.0 - alpha**2) * m**2) for m in (mu, mu_i)]
        return D * mu_i / (2.0 * (smith[0] * mu_i + smith[1] * mu))

    half, _ = dblquad(integrand, 0.0, 1.0, 0.0, np.pi, epsabs=1e-12, epsrel=1e-12)
    assert abs(models.ggx_albedo_dir(mu, alpha) - 2.0 * half) < tolerances.E_SS


def test_the_albedo_lies_between_its_limits_on_the_closed_domain():
    mu = np.array([0.0, 5e-324, 1e-160, 1e-8, 1e-3, 0.5, 1.0 - 1e-16, 1.0])
    alpha = np.array([0.0, 5e-324, 1e-160, 1e-9, 1e-4, 0.5, 1.0])
    E = models.ggx_albedo_dir(mu[:, None], alpha)
    assert (E > 0.3).all() and (E <= 1.0).all() and (E[:, 0] == 1.0).all()
    assert abs(models.ggx_albedo_dir(1.0, 1.0) - (1.0 - np.log(2.0))) < tolerances.E_SS


def test_the_table_of_what_facets_miss_agrees_with_the_quadrature():
    rng = np.random.default_rng(0)
    mu, alpha = rng.random((2, 3000)) ** [[6.0], [3.0]]
    # Small alphas, with cosines near 0, near 1, and proportional to alpha.
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
    scaled = [models.ggx_albedo_dir(np.array([0.3, 1.0, 4.0]) * a, a) for a in (1e-12, 1e-10, 1e-8)]
    assert np.ptp(scaled, axis=0).max() < 1e-7


# --- albedos with Fresnel ----------------------------------------------------------------------


@every_node
@pytest.mark.parametrize("alpha", [(0.5, 0.5), (0.3, 0.8)], ids=str)
def test_the_albedo_is_the_integral_of_the_value(name, alpha):
    for mu, phi in ((0.9, 0.0), (0.3, 1.0)):
        wo = direction(mu, phi)
        wi, weights = hemisphere(mu, 64)
        for retroreflective in (False, True):
            value = brdf(name, wo, wi, alpha, FEWER, retroreflective=retroreflective)
            integral = np.einsum("nc,n,n->c", value, wi[:, 2], weights)
            assert np.abs(albedo_dir(name, wo, alpha) - integral).max() < tolerances.SLOPES


@every_node
def test_the_albedo_is_converged_over_slopes(name, monkeypatch):
    wo = direction(np.array([1e-4, 1e-2, 0.5, 1.0]), 0.7)[:, None]
    equal = [[each, each] for each in (1e-4, 1e-3, 0.02, 0.3, 1.0)]
    alpha = np.array([*equal, [0.05, 0.6]])
    values = albedo_dir(name, wo, alpha)
    monkeypatch.setattr(slopes, "SLOPE_NODES", 32)
    monkeypatch.setattr(slopes, "QUADRANT", 32)
    more = albedo_dir(name, wo, alpha)
    assert (np.abs(values - more) / np.maximum(more, 1.0)).max() < tolerances.SLOPES


@pytest.mark.parametrize("ior", [0.3, 1.0 / 1.5, 0.95])
def test_the_albedo_is_converged_at_a_critical_angle(ior, monkeypatch):
    wo = direction(np.array([1e-4, 0.1, 0.5, 0.72, 0.75, 0.9, 1.0]), 0.7)[:, None]
    alpha = np.array([[1e-4, 1e-4], [0.02, 0.02], [0.3, 0.3], [1.0, 1.0], [0.05, 0.6], [1.0, 0.1]])
    values = models.dielectric_albedo_dir(wo, 1.0, alpha, ior)[..., 0]
    monkeypatch.setattr(slopes, "SPLIT_NODES", 64)
    monkeypatch.setattr(slopes, "SPLIT_PART", 64)
    error = np.abs(values - models.dielectric_albedo_dir(wo, 1.0, alpha, ior)[..., 0])
    assert error[:, :4].max() < tolerances.E_SS  # lobes with isotropic roughness
    assert error.max() < tolerances.SLOPES


@pytest.mark.parametrize(
    "mu, alpha, ior", [(0.5, 0.5, 1 / 1.5), (0.8, 0.3, 1 / 1.5), (0.3, 1.0, 0.7)]
)
def test_the_albedo_agrees_with_a_quadrature_around_the_view_at_a_critical_angle(mu, alpha, ior):
    def around(c):
        """Integral over the azimuth of half vectors whose cosine with wo is c."""
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
        # The substitution of t for the cosine c avoids the infinite slope at the critical angle.
        c = low + (high - low) * t * t * (3.0 - 2.0 * t)
        return models.fresnel_dielectric(c, ior) * around(c) * 6.0 * t * (1.0 - t) * (high - low)

    theta, quarter = np.arccos(mu), 0.5 * np.pi
    bends = [np.cos(0.5 * (quarter + theta)), np.cos(0.5 * (quarter - theta))]
    parts = pairwise(sorted([1e-9, np.sqrt(1.0 - ior**2), *bends, 1.0 - 1e-15]))
    expected = sum(quad(share, 0.0, 1.0, part, **EXACT)[0] for part in parts)
    E = models.dielectric_albedo_dir(direction(mu), 1.0, [alpha, alpha], ior, compensate=False)[0]
    assert abs(E - expected) < tolerances.SPLIT


def test_a_critical_angle_that_is_not_split_would_be_seen():
    wo, alpha, ior = direction(0.3), np.array([1.0, 1.0]), 1.0 / 1.5
    c, weight = slopes.slope_nodes(wo, alpha)
    unsplit = np.sum(models.fresnel_dielectric(c, ior) * weight)
    E = models.dielectric_albedo_dir(wo, 1.0, alpha, ior, compensate=False)[0]
    assert abs(unsplit - E) > 1e-3


def test_a_white_surface_returns_all_light():
    mu = np.array([1e-4, 0.01, 0.3, 1.0])[:, None]
    alpha = np.array([0.0, 1e-4, 0.01, 0.3, 1.0])
    pairs = np.stack([alpha, alpha], axis=-1)
    for E in (
        models.generalized_schlick_albedo_dir(direction(mu), 1.0, 1.0, 1.0, pairs, 5.0),
        models.dielectric_albedo_dir(direction(mu), 1.0, pairs, 0.0),
        models.conductor_albedo_dir(direction(mu), pairs, 0.0, 3.0),
    ):
        assert np.abs(E - 1.0).max() < tolerances.SLOPES


def test_without_compensation_light_is_lost():
    E = models.dielectric_albedo_dir(direction(0.5), 1.0, [1.0, 1.0], 0.0, compensate=False)
    assert abs(E[0] - models.ggx_albedo_dir(0.5, 1.0)) < tolerances.SLOPES


def test_a_mirror_has_the_albedo_of_its_fresnel_reflectance():
    mu = np.array([0.01, 0.3, 1.0])
    E = models.dielectric_albedo_dir(direction(mu), 1.0, [0.0, 0.0], 1.5)[:, 0]
    assert np.abs(E - models.fresnel_dielectric(mu, 1.5)).max() < tolerances.SLOPES


def test_anisotropic_facets_gain_no_energy():
    mu, phi = np.meshgrid([1e-3, 0.01, 0.3, 1.0], np.linspace(0.0, 0.5 * np.pi, 7))
    for roughness in ([0.001, 1.0], [0.02, 1.0], [0.18, 0.35], [0.9, 0.1]):
        E = models.ggx_albedo_dir_anisotropic(direction(mu.ravel(), phi.ravel()), roughness)
        assert (E > 0.3).all() and (E < 1.0 + tolerances.SLOPES).all()


@every_node
def test_albedos_are_finite_on_the_closed_domain(name):
    mu = np.array([0.0, 5e-324, 1e-8, 1.0 - 1e-16, 1.0])
    ends = np.array([0.0, 5e-324, 1e-160, 1e-4, 1.0])
    alpha = np.stack(np.meshgrid(ends, ends), axis=-1)
    E = albedo_dir(name, direction(mu)[:, None, None], alpha)
    assert np.isfinite(E).all() and (E >= 0.0).all()


@pytest.mark.parametrize("alpha", [(0.3, 0.12), (0.3, 0.6), (0.01, 0.004), (0.02, 1.0)])
def test_many_views_of_two_alphas_share_a_polynomial_that_follows_the_quadrature(alpha):
    mu, phi = np.random.default_rng(3).random((2, 600)) * [[1.0], [2.0 * np.pi]]
    wo = np.concatenate([direction(mu**2, phi), direction(np.array([1e-4, 1.0]), 0.0)])
    few = wo[::10]

    def factor(wo):
        compensated, plain = (
            models.conductor_brdf(wo, wo, alpha, 0.0, 3.0, compensate=each)
            for each in (True, False)
        )
        return compensated / plain

    np.testing.assert_allclose(factor(wo)[::10], factor(few), rtol=tolerances.SLOPES)


def test_a_sum_over_visible_normals_is_the_albedo_but_for_its_masking():
    rng, count = np.random.default_rng(7), 1 << 18
    wo, same, other = np.array(direction(0.4, 0.7)), np.array([0.3, 0.3]), np.array([0.2, 0.6])
    for alpha in (same, other):
        wi, _ = ggx_sample(np.broadcast_to(wo, (count, 3)), rng.random((count, 2)), alpha)
        mean = np.full(2, np.sqrt(alpha.prod()))
        lit = wi[:, 2] > 0.0
        # The density of samples is D G_1 / (4 mu_o). MaterialX's sum weights each sample by G_2 /
        # G_1, both computed with the mean alpha.
        weight = np.where(lit, ggx.smith_g2(wo[2], np.abs(wi[:, 2]), mean[0]), 0.0)
        weight = weight / ggx.smith_g1(wo[np.newaxis], mean[np.newaxis])
        found = slopes.slope_nodes(wo[:, np.newaxis], alpha[:, np.newaxis], summed=True)[1].sum()
        assert abs(found - weight.mean()) < 5.0 * weight.std() / np.sqrt(count)
    exact = slopes.slope_nodes(wo[:, np.newaxis], same[:, np.newaxis])[1].sum()
    found = slopes.slope_nodes(wo[:, np.newaxis], same[:, np.newaxis], summed=True)[1].sum()
    assert abs(found - exact) < 1e-12
