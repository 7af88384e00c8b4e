# SPDX-License-Identifier: Apache-2.0
"""Variance and largest value of the samplers' throughput weights.

At unit reflectance the weight is f cos(theta_i) / p, with mean 1. The exact sampler returns a
density p for which the weight is 1 everywhere. Here p is the true density of its samples, which
differs slightly because of two fits.
"""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from mxeon.models import sampling as eon_sampling
from mxeon.models.diffuse import C1, C2, eon_brdf, fon_quotient
from mxeon.models.diffuse import fon_loss_mu as fon_loss
from mxeon.models.sampling import eon_pdf
from tests.support import tolerances
from tests.support.cases import direction
from tests.support.hemispheres import every_scene, hemisphere
from tools.paper.samplers import BY_NAME

UNBIASED = [BY_NAME[name] for name in ("uniform", "cosine", "eon_cltc", "eon")]
ANGLES = (0.0, 1e-3, 0.03, 0.1, 0.3, 0.6, 0.9, 1.0)
# At the smallest roughness, cosine sampling is nearly exact.
ROUGHNESS = (1e-9, 1e-6, 1e-3, 0.05, 0.25, 0.5, 0.75, 1.0)
# The fits' variable, a root of a random number, dense at both ends of [0, 1].
ROOTS = np.sin(0.5 * np.pi * (np.arange(4001) + 0.5) / 4001) ** 2


def weights_of(sampler, mu, roughness):
    """Throughput weights at quadrature nodes with a positive pdf, and the nodes' probabilities."""
    wi, solid_angle = hemisphere(mu, 32)
    pdf = sampler.pdf(direction(mu), wi, roughness)
    wi, pdf, solid_angle = wi[pdf > 0.0], pdf[pdf > 0.0], solid_angle[pdf > 0.0]
    value = eon_brdf(direction(mu), wi, 1.0, roughness)[..., 0] * wi[..., 2]
    return value / pdf, pdf * solid_angle


def largest(name, quantity, roughness, cosines):
    """Maximum over views of a quantity computed from weights and probabilities."""
    return max(quantity(*weights_of(BY_NAME[name], mu, roughness)) for mu in cosines)


def variance(weight, probability):
    """Variance of throughput weights, whose mean is 1."""
    return (weight - 1.0) ** 2 @ probability


@pytest.mark.parametrize("sampler", UNBIASED, ids=lambda sampler: sampler.name)
@every_scene
def test_mean_weight_is_one(sampler, mu, roughness):
    weight, probability = weights_of(sampler, mu, roughness)
    assert abs(weight @ probability - 1.0) < tolerances.QUADRATURE


def multiple_error():
    """Cosines drawn by the fit MULTIPLE, and the relative error of their density."""
    w = Polynomial([0.0, 1.0])
    a, b, c, d, e, f = eon_sampling.MULTIPLE
    t = 1.0 - w**2
    mu = t * (1.0 + w**2 * (a + w**2 * (b + w * (c + w * (d + w * (e + w**4 * f))))))
    np.testing.assert_allclose(
        eon_sampling.eon_multiple_cosine(t(ROOTS)), mu(ROOTS), atol=tolerances.DIRECTION
    )
    # The random number is t^3, and its derivative with respect to w is -6 w t^2.
    slope = mu.deriv()(ROOTS) / (-6.0 * ROOTS * t(ROOTS) ** 2)
    return mu(ROOTS), 1.0 / (slope * 2.0 * fon_loss(mu(ROOTS)) * mu(ROOTS) / (C1 - C2)) - 1.0


def upper_error(mu_o):
    """Cosines drawn by the fit UPPER, and the relative error of their density."""
    y = Polynomial([0.0, 1.0])
    fit = y * (1.0 + (1.0 - y) * Polynomial(eon_sampling.UPPER))
    S_o = np.sqrt((1.0 - mu_o) * (1.0 + mu_o))
    K_o = eon_sampling.eon_segment(mu_o, S_o)
    y_o = eon_sampling.eon_upper_limit(mu_o, S_o)
    scale = (1.0 - mu_o) / fit(y_o)
    mu = eon_sampling.eon_upper_cosine(ROOTS, mu_o, y_o)
    S = np.sqrt((1.0 - mu) * (1.0 + mu))
    np.testing.assert_allclose(mu, 1.0 - scale * fit(y_o * ROOTS), atol=tolerances.DIRECTION)
    # The random number is y^2.5, where y is in ROOTS.
    slope = scale * y_o * fit.deriv()(y_o * ROOTS) / (2.5 * ROOTS**1.5)
    return mu, K_o / (slope * S * (1.0 - mu)) - 1.0


def excess(mu, roughness):
    """Relative excess of exact samples' true density over `eon_pdf`, and probabilities."""
    wi, solid_angle = hemisphere(mu, 32)
    mu_i, s = wi[:, 2], direction(mu)[0] * wi[:, 0]
    multiple = roughness * fon_loss(mu_i) * fon_loss(mu) / (C1 - C2)
    upper = np.where(mu_i >= mu, roughness * np.maximum(s, 0.0) * (1.0 / mu_i - 1.0), 0.0)
    total = 1.0 + roughness * fon_quotient(mu, mu_i, s) + multiple
    extra = multiple * np.interp(mu_i, *(row[::-1] for row in multiple_error()))
    if mu < 1.0:
        extra += upper * np.interp(mu_i, *(row[::-1] for row in upper_error(mu)))
    return extra / total, eon_pdf(direction(mu), wi, roughness) * solid_angle


def test_what_the_fits_leave_is_what_the_documentation_states():
    errors = [multiple_error()[1]] + [upper_error(mu)[1] for mu in np.linspace(0.0, 0.99, 100)]
    assert max(np.abs(error).max() for error in errors) < tolerances.EON_DENSITY


@pytest.mark.parametrize("mu", ANGLES)
@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_exact_sampling_has_no_variance_left(mu, roughness):
    relative, probability = excess(mu, roughness)
    weight = 1.0 / (1.0 + relative)
    assert weight.max() <= 1.0 + tolerances.EON_WEIGHT
    assert variance(weight, probability) < tolerances.EON_VARIANCE


@pytest.mark.parametrize("mu", ANGLES)
@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_exact_sampling_is_never_worse_than_cosine(mu, roughness):
    relative, probability = excess(mu, roughness)
    exact = variance(1.0 / (1.0 + relative), probability)
    assert exact <= variance(*weights_of(BY_NAME["cosine"], mu, roughness))
