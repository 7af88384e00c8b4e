# SPDX-License-Identifier: Apache-2.0
"""The sampler of the Zeltner sheen: its density, its weight, and its distribution.

FALSE_ALARM is the probability that the chi-square tests fail although all is right.
"""

import numpy as np
import pytest
from scipy import special  # scipy.stats is slow to import

from mxeon.models.sampling import Sampler, ltc0_pdf, zeltner_pdf, zeltner_sample
from mxeon.models.sheen import zeltner_albedo_dir, zeltner_brdf
from tests.support.hemispheres import binned, expected, uniforms, view

FALSE_ALARM = 1e-4
SCENES = [(mu, r) for mu in (1.0, 0.7, 0.1, 0.0) for r in (0.3, 0.6, 1.0)]
SAMPLER = Sampler("zeltner", zeltner_sample, zeltner_pdf, "sheen")

every_scene = pytest.mark.parametrize("mu, roughness", SCENES)


def chi_square(pdf_of, mu, roughness, samples=50_000, count=12):
    """Probability of a chi-square as large, for the sampler against a density."""
    wi, _ = zeltner_sample(
        view(mu), uniforms(samples, [7, SCENES.index((mu, roughness))]), roughness
    )
    edges = np.arccos(np.sqrt(np.linspace(1.0, 0.0, 17)))
    counts = binned(wi, edges, count)
    mean = samples * expected(pdf_of, mu, roughness, edges, count)
    rare = mean < 10.0
    counts, mean = (
        np.append(counts[~rare], counts[rare].sum()),
        np.append(mean[~rare], mean[rare].sum()),
    )
    if mean[-1] < 10.0:
        counts, mean = counts[:-1], mean[:-1]
    return special.chdtrc(len(mean) - 1, np.sum((counts - mean) ** 2 / mean))


@every_scene
def test_samples_pass_the_chi_square_test_against_their_density(mu, roughness):
    assert chi_square(SAMPLER, mu, roughness) > FALSE_ALARM / len(SCENES)


@pytest.mark.parametrize("mu", (0.7, 0.1))
def test_chi_square_tells_another_density(mu):
    other = Sampler("ltc0", zeltner_sample, ltc0_pdf, "EON")
    assert chi_square(other, mu, 1.0) < FALSE_ALARM / len(SCENES)


@pytest.mark.parametrize("roughness", (0.0, 0.05, 0.3, 1.0))
@pytest.mark.parametrize("mu", (1.0, 0.5, 1e-3, 0.0))
def test_every_sample_weighs_the_albedo(mu, roughness):
    wo = view(mu, 2.0)
    wi, pdf = zeltner_sample(wo, uniforms(200, 3), roughness)
    weight = zeltner_brdf(wo, wi, 1.0, roughness)[:, 0] * wi[:, 2] / pdf
    assert np.allclose(weight, zeltner_albedo_dir(mu, roughness), rtol=1e-9, atol=0.0)
    assert np.allclose(zeltner_pdf(wo, wi, roughness), pdf, rtol=1e-9, atol=0.0)
