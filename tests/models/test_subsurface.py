# SPDX-License-Identifier: Apache-2.0
"""Subsurface scattering: the albedo inversion against transport, and the diffusion profile."""

import numpy as np
import pytest

from mxeon.models.media import (
    LINEAR,
    SQUARED,
    diffusion_blur,
    diffusion_profile,
    subsurface_albedo,
    subsurface_coefficients,
)
from tests.models.random_walk import distances, reflectance_of_h
from tests.support.tolerances import SUBSURFACE_FIT, SUBSURFACE_PEAK, SUBSURFACE_SIMILARITY

LOSS, GAIN = (
    0.139,
    1.17,
)  # of [vandeHulst1974]: rho = (1 - s) (1 - LOSS s) / (1 + GAIN s), s^2 = 1 - w
COLORS = np.linspace(0.0, 1.0, 1001)
PATHS = 20_000
DEVIATIONS = 5.0  # standard errors: one false alarm in 190,000 runs of the nine walks


def test_the_inversion_solves_van_de_hulsts_fit():
    """LOSS s^2 - (1 + LOSS + GAIN rho) s + 1 - rho = 0, divided by 2 LOSS."""
    half = 1.0 / (2.0 * LOSS)
    exact = ((1.0 + LOSS) * half, GAIN * half)
    square = (exact[0] ** 2 - 2.0 * half, 2.0 * exact[0] * exact[1] + 2.0 * half, exact[1] ** 2)
    np.testing.assert_allclose(LINEAR, exact, atol=5e-6)
    np.testing.assert_allclose(SQUARED, square, rtol=1e-6)


def test_the_albedo_rises_with_the_color_up_to_its_peak():
    near = 1.0 - np.geomspace(1e-3, 1e-7, 1001)
    rises = np.diff(subsurface_albedo(near)) > 0.0
    assert rises[near[1:] < 1.0 - SUBSURFACE_PEAK].all() and not rises[-1]
    assert (np.diff(subsurface_albedo(COLORS)) > 0.0).all()


def test_an_isotropic_half_space_has_the_color():
    colors = np.linspace(0.02, 0.98, 25)
    exact = np.array([reflectance_of_h(each) for each in subsurface_albedo(colors)])
    assert np.abs(exact - colors).max() < SUBSURFACE_FIT


@pytest.mark.parametrize("anisotropy", [-0.5, 0.0, 0.5])
@pytest.mark.parametrize("color", [0.2, 0.5, 0.8])
def test_a_random_walk_has_the_color(color, anisotropy):
    walk = distances(float(subsurface_albedo(color, anisotropy)), anisotropy, PATHS)
    noise = DEVIATIONS * np.sqrt(color * (1.0 - color) / PATHS)
    assert abs(len(walk) / PATHS - color) < SUBSURFACE_SIMILARITY + noise


def test_without_the_similarity_relation_the_color_is_missed():
    walk = distances(float(subsurface_albedo(0.5)), 0.5, PATHS)
    assert 0.5 - len(walk) / PATHS > 0.05


def test_an_inverted_similarity_relation_is_missed_further():
    isotropic, g = float(subsurface_albedo(0.5)), 0.5
    inverted = isotropic * (1.0 - g) / (1.0 - isotropic * g)
    assert 0.5 - len(distances(inverted, g, PATHS)) / PATHS > 0.15


def test_coefficients_are_over_the_mean_free_path():
    scattering, absorption = subsurface_coefficients(COLORS, 0.25, 0.3)
    np.testing.assert_allclose(scattering + absorption, 4.0, rtol=1e-15)
    np.testing.assert_allclose(scattering * 0.25, subsurface_albedo(COLORS, 0.3), rtol=1e-15)


@pytest.mark.parametrize("radius", [0.01, 1.0, 30.0])
def test_the_profile_integrates_to_1_over_the_plane(radius):
    x, w = np.polynomial.laguerre.laggauss(40)
    r = 3.0 * radius * x  # the slower exponential is the weight of the quadrature
    ring = 2.0 * np.pi * r * diffusion_profile(r, radius) * np.exp(x) * 3.0 * radius
    assert (w * ring).sum() == pytest.approx(1.0, abs=1e-9)
    assert (w * ring * r).sum() == pytest.approx(2.5 * radius, rel=1e-9)


@pytest.mark.parametrize("reach", [0.05, 0.4, 3.0])
def test_a_blur_is_the_profile_s_mean_over_the_unit_sphere(reach):
    # A ring at a chord d of the sphere has the area 2 pi d dd, and the profile has the factor 1 / d.
    x, w = np.polynomial.legendre.leggauss(400)
    d, w = 1.0 + x, w * (1.0 + x) * diffusion_profile(1.0 + x, reach)
    phi = 2.0 * np.pi * (np.arange(400) + 0.5) / 400
    along, across = 1.0 - 0.5 * d * d, d * np.sqrt(1.0 - 0.25 * d * d)
    for mu in (-0.6, 0.0, 0.3, 0.95):
        cosine = mu * along[:, np.newaxis] + np.sqrt(1.0 - mu * mu) * np.outer(across, np.cos(phi))
        rings = np.maximum(cosine, 0.0).mean(axis=1)
        # The kinks of both sums cost 400^-2 times the slopes of what they sum.
        assert diffusion_blur(mu, reach) == pytest.approx(w @ rings / w.sum(), abs=1e-4)
