# SPDX-License-Identifier: Apache-2.0
"""Samples are distributed according to their density.

Seeds are fixed. With random seeds, a test of this file would fail by chance with the probability
FALSE_ALARM, which the comparisons share evenly.
"""

from functools import partial

import pytest

from mxeon.models.sampling import eon_pdf, eon_sample
from tests.support.cases import direction
from tests.support.hemispheres import COSINES, SCENES, every_scene, probability, uniforms
from tools.paper.samplers import BY_NAME, SAMPLERS, Sampler

FALSE_ALARM = 1e-4

# Exact sampler for gray surfaces.
GRAY = [
    Sampler(f"eon_{rho}", partial(eon_sample, rho=rho), partial(eon_pdf, rho=rho), f"rho = {rho}")
    for rho in (0.0, 0.5)
]
ALL = [*SAMPLERS, *GRAY]

LEVEL = FALSE_ALARM / (len(ALL) * len(SCENES))

every_sampler = pytest.mark.parametrize("sampler", ALL, ids=lambda sampler: sampler.name)


def chi_square(sampler, density, mu, roughness):
    """p-value of a sampler's samples against a density; each comparison has its own seed."""
    u = uniforms(100_000, [ALL.index(sampler), SCENES.index((mu, roughness))])
    sample, pdf = (partial(each, roughness=roughness) for each in (sampler.sample, density.pdf))
    return probability(sample, pdf, direction(mu), u)


@every_sampler
@every_scene
def test_samples_pass_the_chi_square_test_against_their_pdf(sampler, mu, roughness):
    assert chi_square(sampler, sampler, mu, roughness) > LEVEL


@pytest.mark.parametrize("mu", COSINES)
def test_chi_square_tells_the_samplers_apart(mu):
    for name in ("uniform", "cosine", "ltc"):
        assert chi_square(BY_NAME[name], BY_NAME["eon"], mu, 1.0) < LEVEL
