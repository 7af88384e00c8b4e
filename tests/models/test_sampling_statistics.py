# SPDX-License-Identifier: Apache-2.0
"""The distribution of samples matches their density.

The seeds are fixed. FALSE_ALARM is the probability that a test of this file fails by chance, split
evenly among the comparisons.
"""

from functools import partial

import numpy as np
import pytest
from scipy import special  # scipy.stats is slow to import

from mxeon.models.sampling import eon_pdf, eon_sample
from tests.support.hemispheres import COSINES, SCENES, binned, every_scene, expected, uniforms, view
from tools.paper.samplers import BY_NAME, SAMPLERS, Sampler

FALSE_ALARM = 1e-4

# The exact sampler for gray surfaces.
GRAY = [
    Sampler(f"eon_{rho}", partial(eon_sample, rho=rho), partial(eon_pdf, rho=rho), f"rho = {rho}")
    for rho in (0.0, 0.5)
]
ALL = [*SAMPLERS, *GRAY]

LEVEL = FALSE_ALARM / (len(ALL) * len(SCENES))

every_sampler = pytest.mark.parametrize("sampler", ALL, ids=lambda sampler: sampler.name)


def seed_of(sampler, mu, roughness):
    """A different seed for each comparison."""
    return [ALL.index(sampler), SCENES.index((mu, roughness))]


def chi_square(sampler, pdf_of, mu, roughness, samples=100_000, count=12):
    """Probability of a larger chi-square of `sampler` compared with the density `pdf_of`."""
    u = uniforms(samples, seed_of(sampler, mu, roughness))
    edges = np.unique(np.append(np.arccos(np.sqrt(np.linspace(0.0, 1.0, 9))), np.arccos(mu)))
    counts = binned(sampler.sample(view(mu), u, roughness)[0], edges, count)
    mean = samples * expected(pdf_of, mu, roughness, edges, count)
    # Pool bins that are too small for a chi-square distribution.
    rare = mean < 10.0
    counts, mean = (
        np.append(counts[~rare], counts[rare].sum()),
        np.append(mean[~rare], mean[rare].sum()),
    )
    if mean[-1] < 10.0:
        counts, mean = counts[:-1], mean[:-1]
    return special.chdtrc(len(mean) - 1, np.sum((counts - mean) ** 2 / mean))


@every_sampler
@every_scene
def test_samples_pass_the_chi_square_test_against_their_pdf(sampler, mu, roughness):
    assert chi_square(sampler, sampler, mu, roughness) > LEVEL


@pytest.mark.parametrize("mu", COSINES)
def test_chi_square_tells_the_samplers_apart(mu):
    for name in ("uniform", "cosine", "ltc"):
        assert chi_square(BY_NAME[name], BY_NAME["eon"], mu, 1.0) < LEVEL
