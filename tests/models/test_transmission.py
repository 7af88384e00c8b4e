# SPDX-License-Identifier: Apache-2.0
"""Microfacet BTDFs have the right limits, and match quadrature and Mitsuba."""

import numpy as np
import pytest

from mxeon.models import fresnel_dielectric, smith_g1, smith_g2, smith_g2_anisotropic
from mxeon.models.microfacet import dielectric_albedo_dir, generalized_schlick_albedo_dir
from mxeon.models.transmission import (
    READINGS,
    dielectric_btdf,
    dielectric_transmittance_dir,
    generalized_schlick_btdf,
    generalized_schlick_transmittance_dir,
    refraction_direction,
    reversed_transmittance,
    schlick_ior,
    transmitting_facet,
)
from tests.support import tolerances
from tests.support.availability import available, package
from tests.support.cases import direction, directions

INDICES = (0.7, 1.2, 1.5, 3.0)
DOWN = np.array([1.0, 1.0, -1.0])
COLORS = [0.04, 0.3, 0.9], [1.0, 0.5, 0.8], [1.0, 0.7, 0.4]
GRID = 300


def below():
    """Quadrature directions below the horizon, and their weights, which include the cosine."""
    x, w = np.polynomial.legendre.leggauss(GRID)
    mu, weight = 0.5 * (1.0 + x), 0.5 * w
    phi = 2.0 * np.pi * (np.arange(GRID) + 0.5) / GRID
    wi = DOWN * direction(mu[:, np.newaxis], phi)
    return wi, (weight * mu)[:, np.newaxis] * (2.0 * np.pi / GRID)


def pairs(count=500, least=0.05):
    """Random pairs of directions: wo lies above the surface, wi below."""
    wo, wi = directions((2, count), 3, least)
    return wo, wi * DOWN


@pytest.mark.parametrize("ior", INDICES)
def test_refraction_obeys_snell_and_has_the_half_vector_as_its_normal(ior):
    wo, _ = pairs()
    normal = np.array([0.0, 0.0, 1.0])
    wi = refraction_direction(wo, normal, ior)
    passes = wi.any(axis=-1)
    np.testing.assert_array_equal(passes, 1.0 - wo[:, 2] ** 2 < ior * ior)
    np.testing.assert_allclose(ior * wi[passes, :2], -wo[passes, :2], atol=1e-15 * max(ior, 1.0))
    np.testing.assert_allclose((wi[passes] ** 2).sum(axis=-1), 1.0, rtol=1e-14)
    found = transmitting_facet(wo[passes].T, wi[passes].T, ior)[0]
    np.testing.assert_allclose(found.T, np.broadcast_to(normal, found.T.shape), atol=1e-13)


def test_no_index_bends_nothing_and_has_no_half_vector():
    wo, wi = pairs()
    np.testing.assert_allclose(refraction_direction(wo, [0.0, 0.0, 1.0], 1.0), -wo, atol=1e-15)
    assert not transmitting_facet(wo.T, wi.T, 1.0)[0].any()
    assert not dielectric_btdf(wo, wi, 1.0, [0.3, 0.3], 1.0).any()


@pytest.mark.parametrize("ior", INDICES)
@pytest.mark.parametrize("alpha", [(0.5, 0.5), (0.3, 0.6)])
def test_the_density_of_refracted_directions_is_normalized(ior, alpha):
    wi, weight = below()
    wo = direction(0.6, 1.0)
    views = np.broadcast_to(wo, wi.shape).T
    (x, y, z), cosine, jacobian = transmitting_facet(views, wi.T, np.array(ior))
    area = alpha[0] * alpha[1]
    squared = (x / alpha[0]) ** 2 + (y / alpha[1]) ** 2 + z * z
    D = np.where(squared > 0.0, 1.0 / (np.pi * area * np.maximum(squared, 1e-99) ** 2), 0.0)
    pdf = smith_g1(wo, alpha) * D * cosine * jacobian / wo[2]
    pdf = pdf.T * weight / np.abs(wi[..., 2])
    if ior > 1.0:
        assert np.sum(pdf) == pytest.approx(1.0, abs=tolerances.REFRACTED_GRID)
    passed = np.sum(pdf * (1.0 - fresnel_dielectric(cosine.T, ior)))
    seen = dielectric_transmittance_dir(wo, 1.0, alpha, ior, shadow=False)[0]
    assert seen == pytest.approx(passed, abs=tolerances.REFRACTED_GRID)


@pytest.mark.parametrize("ior", INDICES)
@pytest.mark.parametrize("alpha", [(0.5, 0.5), (0.3, 0.6)])
@pytest.mark.parametrize("mu", [0.95, 0.5])
def test_the_transmittance_is_the_integral_of_the_btdf(ior, alpha, mu):
    wi, weight = below()
    wo = direction(mu, 0.4)
    values = ior**2 * dielectric_btdf(wo, wi, 1.0, alpha, ior)[..., 0]
    expected = dielectric_transmittance_dir(wo, 1.0, alpha, ior)[0]
    assert np.sum(values * weight) == pytest.approx(expected, abs=tolerances.REFRACTED_GRID)


def around(wo, cosine, count):
    """Unit vectors at the given cosines with `wo` and `count` equally spaced azimuths.

    The result has the shape (N, count, 3).
    """
    across = np.cross(wo, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    phi = 2.0 * np.pi * np.arange(count) / count
    ring = np.cos(phi)[:, np.newaxis] * across + np.sin(phi)[:, np.newaxis] * np.cross(wo, across)
    sine = np.sqrt(1.0 - cosine**2)
    return cosine[:, np.newaxis, np.newaxis] * wo + sine[:, np.newaxis, np.newaxis] * ring


@pytest.mark.parametrize("shadow", [False, True])
@pytest.mark.parametrize("alpha", [(0.5, 0.5), (1.0, 1.0), (0.3, 0.6)])
@pytest.mark.parametrize("mu", [1.0, 0.9])
def test_the_transmittance_below_index_1_is_a_sum_over_the_critical_cone(mu, alpha, shadow):
    # All facets that transmit light lie within 30 degrees of the view and refract light downwards.
    ior, wo = 0.5, np.array(direction(mu, 0.4))
    least = np.sqrt(1.0 - ior**2)
    x, w = np.polynomial.legendre.leggauss(64)
    t = 0.5 * (1.0 + x)
    # Near the critical angle, 1 - F changes like a square root.
    cosine, weight = least + (1.0 - least) * t * t, w * t * (1.0 - least)
    wh = around(wo, cosine, 128)
    wi = refraction_direction(wo, wh, ior)
    stretched = np.sum((wh / [*alpha, 1.0]) ** 2, axis=-1)
    seen = 1.0 / (np.pi * alpha[0] * alpha[1] * stretched**2) / wo[2]
    seen *= smith_g2_anisotropic(wo, wi * DOWN, alpha) if shadow else smith_g1(wo, alpha)
    passed = (1.0 - fresnel_dielectric(cosine, ior)) * cosine * weight
    expected = np.sum(passed[:, np.newaxis] * seen) * 2.0 * np.pi / 128
    found = dielectric_transmittance_dir(wo, 1.0, alpha, ior, shadow=shadow)[0]
    assert wh[..., 2].min() > 0.1 and wi[..., 2].max() < 0.0
    assert found == pytest.approx(expected, abs=tolerances.TRANSMITTANCE_CRITICAL)


@pytest.mark.parametrize("alpha", [0.1, 0.4, 1.0])
def test_as_much_light_leaves_a_solid_as_enters(alpha):
    # The cosine-weighted average of the transmittance from outside is n^2 times the average from
    # inside.
    n, (x, w) = 1.5, np.polynomial.legendre.leggauss(32)
    mu, weight = 0.5 * (x + 1.0), 0.5 * w * (x + 1.0)

    def reflected(cosines):
        return dielectric_albedo_dir(direction(cosines), 1.0, [alpha, alpha], n)

    left = reversed_transmittance(mu, alpha, 1.0 / n, reflected)
    entered = 1.0 - reflected(mu)
    assert n**2 * weight @ left == pytest.approx(weight @ entered, abs=tolerances.REVERSED)
    assert (left >= 0.0).all() and (left <= 1.0).all()


@pytest.mark.parametrize("ior", INDICES)
def test_radiance_over_the_squared_index_is_reciprocal(ior):
    wo, wi = pairs()
    # Light travels from wi to wo. The index of refraction is 1 on the side of wo.
    there = dielectric_btdf(wo, wi, 1.0, [0.3, 0.6], ior)
    back = dielectric_btdf(DOWN * wi, DOWN * wo, 1.0, [0.3, 0.6], 1.0 / ior) / ior**2
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("reading", READINGS)
def test_readings_of_schlick_are_reciprocal(reading):
    wo, wi = pairs()
    inputs = *COLORS, [0.3, 0.6], 5.0, reading
    there = generalized_schlick_btdf(wo, wi, *inputs)
    back = generalized_schlick_btdf(DOWN * wi, DOWN * wo, *inputs, inside=True)
    back = back / schlick_ior(COLORS[0], reading) ** 2
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("ior", [1.5, 3.0])
def test_a_smooth_plane_passes_what_it_does_not_reflect(ior):
    wo = direction([0.1, 0.5, 1.0])
    T = dielectric_transmittance_dir(wo, 1.0, [0.0, 0.0], ior)[:, 0]
    np.testing.assert_allclose(T, 1.0 - fresnel_dielectric(wo[:, 2], ior), rtol=1e-12)
    for alpha in (1e-3, 1e-4):
        R = dielectric_albedo_dir(wo, 1.0, [alpha, alpha], ior, compensate=False)[:, 0]
        T = dielectric_transmittance_dir(wo, 1.0, [alpha, alpha], ior)[:, 0]
        np.testing.assert_allclose(R + T, 1.0, atol=10.0 * alpha)


def test_light_is_totally_reflected_inside_beyond_the_critical_angle():
    critical = np.sqrt(1.0 - 1.0 / 1.5**2)
    wo = direction([critical - 1e-3, critical + 1e-3])
    T = dielectric_transmittance_dir(wo, 1.0, [0.0, 0.0], 1.0 / 1.5)[:, 0]
    R = dielectric_albedo_dir(wo, 1.0, [0.0, 0.0], 1.0 / 1.5)[:, 0]
    assert T[0] == 0.0
    assert T[1] > 0.2
    np.testing.assert_allclose(R + T, 1.0, rtol=1e-12)
    assert not refraction_direction(wo[0], [0.0, 0.0, 1.0], 1.0 / 1.5).any()


@pytest.mark.parametrize("ior", INDICES)
def test_microfacets_neither_reflect_nor_transmit_more_than_all_light(ior):
    mu, alpha = (each.ravel() for each in np.meshgrid([0.02, 0.2, 0.6, 1.0], [0.01, 0.1, 0.5, 1.0]))
    wo = direction(mu)
    roughness = np.repeat(alpha[:, np.newaxis], 2, axis=1)
    T = dielectric_transmittance_dir(wo, 1.0, roughness, ior)
    for compensate in (False, True):
        R = dielectric_albedo_dir(wo, 1.0, roughness, ior, compensate=compensate)
        assert (R + T).max() <= 1.0 + tolerances.TRANSMITTANCE_CRITICAL * (ior < 1.0) + 1e-5


def test_no_light_passes_between_directions_that_no_facet_joins():
    # Refraction sends no light back to the side from which the light came.
    bent = (direction(0.3), direction(0.3) * DOWN)
    assert dielectric_btdf(*bent, 1.0, [0.5, 0.5], 1.5)[0] == 0.0


@pytest.mark.parametrize("reading", READINGS)
def test_readings_pass_what_they_do_not_reflect_only_where_they_take_the_same_curve(reading):
    wo = direction(0.4)
    T = generalized_schlick_transmittance_dir(wo, *COLORS, [0.0, 0.0], 5.0, reading)
    R = generalized_schlick_albedo_dir(wo, *COLORS, [0.0, 0.0], 5.0)
    kept = np.abs(R + T - 1.0).max() < tolerances.SLOPES
    assert kept == (reading in ("text", "unclamped", "channel"))


def test_one_index_for_all_channels_is_that_of_the_mean():
    index = schlick_ior([0.04, 0.06, 0.08])
    assert index[0] == pytest.approx((1.0 + np.sqrt(0.06)) / (1.0 - np.sqrt(0.06)))
    np.testing.assert_allclose(schlick_ior([0.0, 1.0], "channel"), [1.1 / 0.9, 397.997], rtol=1e-5)


@pytest.mark.parametrize("mode", ["Radiance", "Importance"])
def test_mitsuba_agrees_but_for_the_masking_function(mode):
    with available("mitsuba"):
        mi = package("mitsuba")
        mi.set_variant("scalar_rgb")
        facets = {"distribution": "ggx", "alpha": 0.3, "int_ior": 1.5, "ext_ior": 1.0}
        bsdf = mi.load_dict({"type": "roughdielectric", **facets})
        wo, wi = pairs(200)
        ours = dielectric_btdf(wo, wi, 1.0, [0.3, 0.3], 1.5)[:, 0]
        ours *= 1.0 if mode == "Radiance" else 1.5**2
        smith = smith_g1(wo, [0.3, 0.3]) * smith_g1(wi * DOWN, [0.3, 0.3])
        ours *= -wi[:, 2] * smith / smith_g2(wo[:, 2], -wi[:, 2], 0.3)
        theirs, point = [], mi.SurfaceInteraction3f()
        for view, light in zip(wo, wi, strict=True):
            point.wi = mi.Vector3f(view)
            context = mi.BSDFContext(getattr(mi.TransportMode, mode))
            theirs.append(bsdf.eval(context, point, mi.Vector3f(light))[0])
        assert np.count_nonzero(theirs) > 10
        np.testing.assert_allclose(theirs, ours, rtol=tolerances.MITSUBA_BTDF, atol=1e-6)
