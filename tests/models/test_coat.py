# SPDX-License-Identifier: Apache-2.0
"""EON under a dielectric interface or a varnish has the right limits, and matches random walks.

Seeds are fixed. With random seeds, the comparisons with random walks would fail by chance with the
probability FALSE_ALARM.
"""

from itertools import product

import numpy as np
import pytest
from scipy import special

import mxeon
from mxeon import models
from mxeon.fit import MeasuredBrdf, fit_brdf
from mxeon.models.coat import constant_coat
from mxeon.models.microfacet import slopes
from mxeon.models.microfacet.fresnel import dielectric
from tests.support.availability import package
from tests.support.cases import direction, directions
from tests.support.hemispheres import gauss_legendre, hemisphere, uniforms
from tests.support.tolerances import COAT, COAT_INTEGRAL
from tools.fits.varnish_walk import RHO, model_bins, walk, walked_bins

CLAY = {"rho": np.array([0.7, 0.35, 0.12]), "roughness": 0.6}
VARNISH = {"alpha": 0.3, "ior": 1.5}
# Error of the average albedo of each interface. The curves of a varnish have 28 nodes, and an error
# of 2e-5 at alpha 0.01 and an index of refraction of 1.02.
INTERFACES = {"dielectric_over_eon": COAT, "varnished": 2e-5}
every_interface = pytest.mark.parametrize("name", INTERFACES)
COSINES = np.append([0.0, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4], np.geomspace(1e-3, 1.0, 9))


@pytest.mark.parametrize("ior", (1.0, 1.02, 1.5, 4.0))
@pytest.mark.parametrize("alpha", (0.01, 0.05, 0.3, 1.0))
def test_curves_are_those_of_a_finer_quadrature(monkeypatch, alpha, ior):
    coat = constant_coat(alpha, ior)
    missing, reflected = coat.at(COSINES)
    # Repeat the integration with more nodes.
    finer = {"LEAST_SCALE": 0.0, "SLOPE_NODES": 40, "PANELS": 6, "QUADRANT": 120}
    for name, value in finer.items():
        monkeypatch.setattr(slopes, name, value)
    views = np.stack([np.sqrt((1.0 - COSINES) * (1.0 + COSINES)), 0.0 * COSINES, COSINES])
    c, weight = slopes.slope_nodes(views, np.full((2, len(COSINES)), alpha))
    expected = 1.0 / models.ggx_albedo_dir(COSINES, alpha) - 1.0
    assert np.abs(missing - expected).max() < COAT
    E = np.sum(dielectric(c, np.asarray(ior)) * weight, axis=(0, 1))
    assert coat.average == models.fresnel_dielectric_avg(ior)
    assert np.abs(reflected - E * (1.0 + coat.average * expected)).max() < COAT


@every_interface
@pytest.mark.parametrize(
    ("mu", "alpha", "ior"), [(1.0, 0.5, 1.5), (0.5, 1.0, 4.0), (0.1, 0.5, 1.1)]
)
def test_the_directional_albedo_is_the_integral_of_the_value(name, mu, alpha, ior):
    wi, weights = hemisphere(mu)
    inputs = CLAY | {"rho": np.array([0.7, 0.12, 1.0]), "alpha": alpha, "ior": ior}
    value = getattr(models, f"{name}_brdf")(direction(mu), wi, **inputs)
    albedo = getattr(models, f"{name}_albedo_dir")(mu, **inputs)
    assert np.abs((weights * wi[:, 2]) @ value - albedo).max() < COAT_INTEGRAL


@every_interface
@pytest.mark.parametrize(("alpha", "ior"), [(0.02, 1.5), (0.3, 1.1), (1.0, 4.0)])
def test_the_average_albedo_is_the_average(name, alpha, ior):
    x, weight = gauss_legendre(400)
    mu = (0.5 + 0.5 * x) ** 2  # nodes are dense near grazing
    E = getattr(models, f"{name}_albedo_dir")(mu, **CLAY, alpha=alpha, ior=ior)
    average = (0.5 * weight * 4.0 * (0.5 + 0.5 * x) ** 3) @ E
    found = getattr(models, f"{name}_albedo_avg")(**CLAY, alpha=alpha, ior=ior)
    assert np.abs(found - average).max() < INTERFACES[name]


def test_a_white_base_returns_all_light_and_an_index_of_1_hides_nothing():
    albedo = models.dielectric_over_eon_albedo_dir(COSINES, 1.0, 0.6, **VARNISH)
    assert np.abs(albedo - 1.0).max() < 1e-15
    bare = CLAY | {"alpha": 0.3, "ior": 1.0}
    off = models.dielectric_over_eon_albedo_avg(**bare) - models.eon_albedo_avg(**CLAY)
    assert np.abs(off).max() < COAT


def test_a_black_base_and_no_interface_reflect_nothing_and_are_sampled():
    inputs = {"rho": 0.0, "roughness": 0.5, "alpha": 0.3, "ior": 1.0}
    wi, pdf = models.dielectric_over_eon_sample(direction(0.5), uniforms(100, 1), **inputs)
    assert (wi[:, 2] > 0.0).all() and (pdf > 0.0).all()
    assert not models.dielectric_over_eon_brdf(direction(0.5), wi, **inputs).any()


def test_the_model_by_name_has_a_coat_for_each_row():
    row = mxeon.model("dielectric_over_eon")
    wo, alpha = direction([0.5, 0.9, 0.1]), [0.1, 0.3, 0.1]
    value = row.brdf(wo, direction(0.7), **CLAY, alpha=alpha, ior=1.5)
    wi, pdf = row.sample(wo, [0.3, 0.6], **CLAY, alpha=alpha)
    for k in range(3):
        coat = CLAY | {"alpha": alpha[k], "ior": 1.5}
        expected = models.dielectric_over_eon_brdf(wo[k], direction(0.7), **coat)
        sample, density = models.dielectric_over_eon_sample(wo[k], [0.3, 0.6], **coat)
        assert np.array_equal(value[k], expected) and np.array_equal(wi[k], sample)
        assert pdf[k] == density


def test_rows_of_coats_are_refused_in_other_array_libraries():
    torch = package("torch")
    row, alpha = mxeon.model("dielectric_over_eon"), torch.tensor([0.1, 0.3])
    with pytest.raises(ValueError, match="^alpha must be one number"):
        row.brdf(direction(0.5), direction(0.7), alpha=alpha)


# --- a varnish -------------------------------------------------------------------------------

FALSE_ALARM = 1e-4
# Documented errors: WALKED of the albedo, SHAPED of the light in each twelfth of the hemisphere.
WALKED, SHAPED = 0.012, 0.21
PATHS = 1 << 14


def test_index_1_is_eon_to_the_last_bit():
    (wo, wi), bare = directions((2, 200), 1), CLAY | {"alpha": 0.3, "ior": 1.0}
    value, E = models.varnished_brdf(wo, wi, **bare), models.varnished_albedo_dir(wo[:, 2], **bare)
    assert np.array_equal(value, models.eon_brdf(wo, wi, **CLAY))
    assert np.array_equal(E, models.eon_albedo_dir(wo[:, 2], **CLAY))
    off = models.varnished_albedo_avg(**bare) - models.eon_albedo_avg(**CLAY)
    assert np.abs(off).max() < 1e-15


@pytest.mark.parametrize("ior", (1.02, 1.5, 4.0))
@pytest.mark.parametrize("alpha", (0.01, 0.3, 1.0))
def test_the_value_is_reciprocal_and_a_white_base_loses_nothing(alpha, ior):
    (wo, wi), inputs = directions((2, 200), 2), {"alpha": alpha, "ior": ior}
    value, exchanged = (models.varnished_brdf(*w, **CLAY, **inputs) for w in ((wo, wi), (wi, wo)))
    assert np.allclose(value, exchanged, 1e-12, 0.0)
    mu = np.append([0.0, 1e-8, 1e-3], wo[:, 2])
    assert np.abs(models.varnished_albedo_dir(mu, 1.0, 0.6, **inputs) - 1.0).max() < 1e-14


@pytest.mark.parametrize(("ior", "alpha", "roughness", "mu"),
    [(1.1, 0.7, 1.0, 0.15), (1.5, 0.05, 0.0, 0.15), (1.5, 0.4, 1.0, 0.5), (2.0, 0.2, 1.0, 1.0)])  # fmt: skip
def test_light_that_walks_has_the_albedo_and_under_a_layer_another(ior, alpha, roughness, mu):
    total, out = walk(mu, roughness, alpha, ior, PATHS)
    deviate = -special.ndtri(0.5 * FALSE_ALARM / (4 * (RHO.size + 48)))
    noise = deviate * total.std(axis=0) / np.sqrt(PATHS)
    inputs = mu, RHO, roughness, alpha, ior
    error = np.abs(total.mean(axis=0) - models.varnished_albedo_dir(*inputs))
    assert (error < WALKED + noise).all() and error[-1] < 1e-4
    off = models.dielectric_over_eon_albedo_dir(*inputs) - total.mean(axis=0)
    assert off[2] > WALKED + noise[2]
    # Compare the light in twelfths of the hemisphere. The comparison must fail for an IOR of 1.
    walked = walked_bins(total, out)
    noise = deviate * np.sqrt(walked_bins(total**2, out) / PATHS) / walked
    for n, right in ((ior, True), (1.0, False)):
        error = np.abs(model_bins(mu, roughness, alpha, n) / walked - 1.0)
        assert (error < SHAPED + noise).all() == right


def test_values_are_finite_at_the_edges():
    wo = direction(0.6)
    for roughness, alpha, ior in product((0.0, 1.0), (0.01, 1.0), (1.0, 4.0)):
        edge = {"rho": [0.0, 1.0], "roughness": roughness, "alpha": alpha, "ior": ior}
        assert np.isfinite(models.varnished_brdf(wo, direction(0.3, 1.0), **edge)).all()
        assert np.isfinite(models.varnished_albedo_dir(0.6, **edge)).all()
        assert np.isfinite(models.varnished_albedo_avg(**edge)).all()
        assert np.isfinite(models.varnished_sample(wo, uniforms(4, 1), **edge)[1]).all()


def test_a_fit_finds_the_pigment_where_the_layer_finds_another():
    wo, wi = directions((2, 200), 3)
    inputs = CLAY | VARNISH
    value = models.varnished_brdf(wo, wi, **inputs)
    fit = fit_brdf(MeasuredBrdf(wo, wi, value, 0.01 * value), "varnished")
    for name, right in inputs.items():
        name = {"rho": "color"}.get(name, name)  # the fitted model calls rho `color`
        assert fit.values[name] == pytest.approx(right, abs=1e-4)
    layer = fit_brdf(MeasuredBrdf(wo, wi, value, 0.01 * value), "dielectric_over_eon")
    assert (layer.values["color"] < 0.8 * CLAY["rho"]).all()
