# SPDX-License-Identifier: Apache-2.0
"""The sampler of visible GGX normals: range, density, and distribution.

The seeds are fixed. FALSE_ALARM is the probability that the chi-square tests of this file fail
although all is right.
"""

from functools import partial

import numpy as np
import pytest
from scipy import special  # scipy.stats is slow to import

from mxeon.albedo import dielectric_albedo_dir
from mxeon.models import (
    dielectric_brdf,
    fresnel_dielectric,
    smith_g1,
    smith_g2,
    smith_g2_anisotropic,
)
from mxeon.sampling import ggx_pdf, ggx_sample
from tests.support import tolerances
from tests.support.hemispheres import probability, uniforms, view

FALSE_ALARM = 1e-4
SCENES = [
    (1.0, (0.3, 0.3)),
    (0.5, (0.2, 0.7)),
    (0.1, (0.5, 0.5)),
    (0.0, (1.0, 0.4)),
]
every_scene = pytest.mark.parametrize(("mu", "alpha"), SCENES, ids=str)
AZIMUTH = 0.4


def chi_square(mu, alpha, sampled_alpha):
    """Probability of a chi-square as large, for samples at one roughness and the density of another."""
    u = uniforms(100_000, [SCENES.index((mu, alpha)), 7])
    sample = partial(ggx_sample, roughness=sampled_alpha)
    return probability(sample, partial(ggx_pdf, roughness=alpha), view(mu, AZIMUTH), u)


@every_scene
def test_samples_pass_the_chi_square_test_against_their_density(mu, alpha):
    assert chi_square(mu, alpha, alpha) > FALSE_ALARM / len(SCENES)


@every_scene
def test_the_chi_square_test_notices_another_roughness(mu, alpha):
    assert chi_square(mu, alpha, [1.1 * alpha[0] % 1.0, alpha[1]]) < FALSE_ALARM


@every_scene
def test_the_density_is_that_of_the_direction(mu, alpha):
    wi, pdf = ggx_sample(view(mu, AZIMUTH), uniforms(1000, 3), alpha)
    assert np.abs(np.sum(wi * wi, axis=-1) - 1.0).max() < tolerances.DIRECTION
    above = wi[:, 2] >= 0.0
    # The half vector of the direction is off by 4 roundings over the cosine between it and wo.
    ahead = np.sqrt(0.5 + 0.5 * wi[above] @ view(mu, AZIMUTH))
    error = np.abs(ggx_pdf(view(mu, AZIMUTH), wi[above], alpha) / pdf[above] - 1.0)
    assert (error * ahead).max() < tolerances.MICROFACET


@every_scene
def test_the_weight_is_fresnel_times_the_quotient_of_maskings(mu, alpha):
    if mu == 0.0:
        mu = 1e-3
    wo = view(mu, AZIMUTH)
    wi, pdf = ggx_sample(wo, uniforms(200, 5), alpha)
    wi, pdf = wi[wi[:, 2] > 1e-3], pdf[wi[:, 2] > 1e-3]
    value = dielectric_brdf(wo, wi, 1.0, alpha, 1.5, False, False)[:, 0]
    F = fresnel_dielectric(np.sqrt(0.5 + 0.5 * wi @ wo), 1.5)
    G2 = smith_g2(mu, wi[:, 2], np.sqrt(alpha[0] * alpha[1]))
    weight = F * G2 / smith_g1(wo, alpha)
    assert np.allclose(value * wi[:, 2] / pdf, weight, rtol=1e-11, atol=0.0)
    assert (smith_g2_anisotropic(wo, wi, alpha) <= smith_g1(wo, alpha) * (1.0 + 1e-15)).all()


def test_the_mean_weight_is_the_albedo():
    wo, alpha = view(0.5, AZIMUTH), [0.2, 0.7]
    wi, pdf = ggx_sample(wo, uniforms(40_000, 9), alpha)
    above = wi[:, 2] >= 0.0
    weight = np.zeros(len(wi))
    weight[above] = dielectric_brdf(wo, wi[above], 1.0, alpha, 1.5)[:, 0] * wi[above, 2]
    weight /= pdf
    error = abs(weight.mean() - dielectric_albedo_dir(wo, 1.0, alpha, 1.5)[0])
    assert error < -special.ndtri(0.5 * FALSE_ALARM) * weight.std() / np.sqrt(len(wi))


def test_a_mirror_reflects_in_the_mirror_direction():
    for alpha in ([0.0, 0.0], [0.0, 0.5]):
        wi, pdf = ggx_sample(view(0.5), [0.3, 0.6], alpha)
        assert np.isfinite(wi).all() and pdf == 0.0
    assert np.allclose(ggx_sample(view(0.5), [0.3, 0.6], [0.0, 0.0])[0], view(0.5, np.pi))
    assert np.allclose(ggx_sample(view(0.0), [0.3, 0.6], [0.0, 0.0])[0], view(0.0, np.pi))
    assert ggx_pdf(view(0.0), view(0.0, np.pi), [0.5, 0.5]) > 0.0
