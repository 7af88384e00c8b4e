# SPDX-License-Identifier: Apache-2.0
"""Curves and albedos of a dielectric over EON, and of EON under a varnish."""

import numpy as np
import pytest

import mxeon
from mxeon.models import (
    dielectric_over_eon_albedo_avg,
    dielectric_over_eon_albedo_dir,
    dielectric_over_eon_brdf,
    dielectric_over_eon_sample,
    eon_albedo_avg,
    fresnel_dielectric_avg,
    ggx_albedo_dir,
    varnished_albedo_avg,
    varnished_albedo_dir,
    varnished_brdf,
)
from mxeon.models.coat import constant_coat
from mxeon.models.microfacet import slopes
from mxeon.models.microfacet.fresnel import dielectric
from tests.support.availability import package
from tests.support.cases import direction
from tests.support.hemispheres import gauss_legendre, hemisphere, uniforms
from tests.support.tolerances import COAT, COAT_INTEGRAL

CLAY = {"rho": np.array([0.7, 0.35, 0.12]), "roughness": 0.6}
DIELECTRIC = {"alpha": 0.3, "ior": 1.5}
CURVES = 2e-5  # error of a varnish's curves by 28 nodes at alpha 0.01, index 1.02
# Functions of each interface (value, directional albedo, average albedo), and the average's error.
INTERFACES = (
    (
        dielectric_over_eon_brdf,
        dielectric_over_eon_albedo_dir,
        dielectric_over_eon_albedo_avg,
        COAT,
    ),
    (varnished_brdf, varnished_albedo_dir, varnished_albedo_avg, CURVES),
)
every_interface = pytest.mark.parametrize("interface", INTERFACES, ids=("layer", "varnish"))
COSINES = np.append([0.0, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4], np.geomspace(1e-3, 1.0, 9))


@pytest.mark.parametrize("ior", (1.0, 1.02, 1.5, 4.0))
@pytest.mark.parametrize("alpha", (0.01, 0.05, 0.3, 1.0))
def test_curves_are_those_of_a_finer_quadrature(monkeypatch, alpha, ior):
    coat = constant_coat(alpha, ior)
    missing, reflected = coat.at(COSINES)
    # Integrate again with more nodes, which are denser near grazing.
    finer = {"LEAST_SCALE": 0.0, "SLOPE_NODES": 40, "PANELS": 6, "QUADRANT": 120}
    for name, value in finer.items():
        monkeypatch.setattr(slopes, name, value)
    views = np.stack([np.sqrt((1.0 - COSINES) * (1.0 + COSINES)), 0.0 * COSINES, COSINES])
    c, weight = slopes.slope_nodes(views, np.full((2, len(COSINES)), alpha))
    expected = 1.0 / ggx_albedo_dir(COSINES, alpha) - 1.0
    assert np.abs(missing - expected).max() < COAT
    E = np.sum(dielectric(c, np.asarray(ior)) * weight, axis=(0, 1))
    assert coat.average == fresnel_dielectric_avg(ior)
    assert np.abs(reflected - E * (1.0 + coat.average * expected)).max() < COAT


@every_interface
@pytest.mark.parametrize(
    ("mu", "alpha", "ior"), [(1.0, 0.5, 1.5), (0.5, 1.0, 4.0), (0.1, 0.5, 1.1)]
)
def test_the_directional_albedo_is_the_integral_of_the_value(interface, mu, alpha, ior):
    brdf, albedo_dir, *_ = interface
    wi, weights = hemisphere(mu)
    inputs = CLAY | {"rho": np.array([0.7, 0.12, 1.0]), "alpha": alpha, "ior": ior}
    value, albedo = brdf(direction(mu), wi, **inputs), albedo_dir(mu, **inputs)
    assert np.abs((weights * wi[:, 2]) @ value - albedo).max() < COAT_INTEGRAL


@every_interface
@pytest.mark.parametrize(("alpha", "ior"), [(0.02, 1.5), (0.3, 1.1), (1.0, 4.0)])
def test_the_average_albedo_is_the_average(interface, alpha, ior):
    _, albedo_dir, albedo_avg, error = interface
    x, weight = gauss_legendre(400)
    mu = (0.5 + 0.5 * x) ** 2  # nodes are dense near grazing
    E = albedo_dir(mu, **CLAY, alpha=alpha, ior=ior)
    average = (0.5 * weight * 4.0 * (0.5 + 0.5 * x) ** 3) @ E
    assert np.abs(albedo_avg(**CLAY, alpha=alpha, ior=ior) - average).max() < error


def test_a_white_base_returns_all_light_and_an_index_of_1_hides_nothing():
    albedo = dielectric_over_eon_albedo_dir(COSINES, 1.0, 0.6, **DIELECTRIC)
    assert np.abs(albedo - 1.0).max() < 1e-15
    bare = CLAY | {"alpha": 0.3, "ior": 1.0}
    off = dielectric_over_eon_albedo_avg(**bare) - eon_albedo_avg(**CLAY)
    assert np.abs(off).max() < COAT


def test_a_black_base_and_no_interface_reflect_nothing_and_are_sampled():
    inputs = {"rho": 0.0, "roughness": 0.5, "alpha": 0.3, "ior": 1.0}
    wi, pdf = dielectric_over_eon_sample(direction(0.5), uniforms(100, 1), **inputs)
    assert (wi[:, 2] > 0.0).all() and (pdf > 0.0).all()
    assert not dielectric_over_eon_brdf(direction(0.5), wi, **inputs).any()


def test_the_model_by_name_has_a_coat_for_each_row():
    row = mxeon.model("dielectric_over_eon")
    wo, alpha = direction([0.5, 0.9, 0.1]), [0.1, 0.3, 0.1]
    value = row.brdf(wo, direction(0.7), **CLAY, alpha=alpha, ior=1.5)
    wi, pdf = row.sample(wo, [0.3, 0.6], **CLAY, alpha=alpha)
    for k in range(3):
        own = CLAY | {"alpha": alpha[k], "ior": 1.5}
        assert np.array_equal(value[k], dielectric_over_eon_brdf(wo[k], direction(0.7), **own))
        one, density = dielectric_over_eon_sample(wo[k], [0.3, 0.6], **own)
        assert np.array_equal(wi[k], one) and pdf[k] == density


def test_a_coat_each_is_refused_for_other_arrays():
    torch = package("torch")
    row, alpha = mxeon.model("dielectric_over_eon"), torch.tensor([0.1, 0.3])
    with pytest.raises(ValueError, match="^alpha must be one number"):
        row.brdf(direction(0.5), direction(0.7), alpha=alpha)
