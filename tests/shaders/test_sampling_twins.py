# SPDX-License-Identifier: Apache-2.0
"""Sampling in the shader twins: float32 on OpenGL and in Cycles against float64 in NumPy.

The seeds are fixed. FALSE_ALARM is the probability that a chi-square test of this file fails
although all is right: each of them runs at its part of it.
"""

import numpy as np
import pytest
from scipy import special  # scipy.stats is slow to import

from mxeon.models.sampling import SAMPLERS
from mxeon.shaders import functions as twins
from tests.support.cases import directions_32
from tests.support.hemispheres import BY_NAME, binned, every_sampler, expected, view
from tests.support.tolerances import (
    TWIN_DIRECTION,
    TWIN_DIRECTION_SHARE,
    TWIN_LENGTH,
    TWIN_PDF,
    TWIN_WEIGHT,
)

FALSE_ALARM = 1e-4
DRAWS = [(sampler, mu, r) for sampler in SAMPLERS for mu, r in ((0.1, 1.0), (0.7, 0.3))]
DRAWS += [(BY_NAME["eon"], mu, r) for mu, r in ((0.0, 1.0), (1e-3, 0.5), (0.97, 1.0), (1.0, 1.0))]
LEVEL = FALSE_ALARM / len(DRAWS)


@pytest.fixture(scope="module", params=("gl", "cycles"))
def host(request, hosts):
    return hosts(request.param)


def call(host, function, **columns):
    """Values of a twin's function for the columns that its parameters name."""
    columns |= {"u1": columns["u"][:, 0], "u2": columns["u"][:, 1], "rho": np.float32([1.0])}
    names = [name for _, name in twins.signature("glsl", function)]
    return host.call(function, *(columns[name] for name in names))


def uniforms_32(count, seed):
    """Random numbers with the 24 bits that a shader's generator gives."""
    return np.float32(np.random.default_rng(seed).integers(0, 2**24, (count, 2)) * 2.0**-24)


def random_arguments(count, seed):
    """Views, random numbers and roughnesses in float32; the first two roughnesses are 0 and 1."""
    rng = np.random.default_rng(seed)
    roughness = np.append([0.0, 1.0], rng.random(count - 2)).astype("f4")
    return {"wo": directions_32(rng, count), "u": uniforms_32(count, seed), "roughness": roughness}


def unit(w):
    """Directions of float32 to the length that float64 asks for."""
    return w / np.linalg.norm(np.float64(w), axis=-1, keepdims=True)


@every_sampler
def test_twin_samples_agree_with_float64(host, sampler):
    arguments = random_arguments(20_000, 1)
    wi = call(host, f"{sampler.name}_sample", **arguments)
    exact, _ = sampler.sample(unit(arguments["wo"]), arguments["u"], arguments["roughness"])
    assert np.mean(np.abs(wi - exact).max(axis=-1) > TWIN_DIRECTION) <= TWIN_DIRECTION_SHARE


@every_sampler
def test_twin_samples_are_unit_directions(host, sampler):
    wi = call(host, f"{sampler.name}_sample", **random_arguments(100_000, 6))
    assert np.abs(np.sum(np.float64(wi) ** 2, axis=-1) - 1.0).max() <= TWIN_LENGTH


@every_sampler
def test_twin_densities_agree_with_float64(host, sampler):
    arguments = random_arguments(20_000, 2)
    wi = directions_32(np.random.default_rng(3), 20_000)
    pdf = call(host, f"{sampler.name}_pdf", wi=wi, **arguments)[:, 0]
    exact = sampler.pdf(unit(arguments["wo"]), unit(wi), arguments["roughness"])
    assert np.max(np.abs(np.pi * (pdf - exact))) <= TWIN_PDF


@every_sampler
def test_twin_samples_on_the_edges_are_unit_directions_above_the_horizon(host, sampler):
    u = np.float32([0.0, 2.0**-24, 0.25, 0.5, 1.0 - 2.0**-24])
    mu = np.float32([0.0, 1e-30, 2.0**-24, 0.5, 1.0 - 2.0**-24, 1.0])
    u1, u2, mu, r = map(np.ravel, np.meshgrid(u, u, mu, np.float32([0.0, 1e-30, 1e-4, 1.0])))
    wo = np.moveaxis(view(np.float64(mu), azimuth=1.0), 0, -1).astype("f4")
    arguments = {"wo": wo, "u": np.stack([u1, u2], axis=-1), "roughness": r}
    wi = call(host, f"{sampler.name}_sample", **arguments)
    pdf = call(host, f"{sampler.name}_pdf", wi=wi, **arguments)
    assert np.abs(np.sum(np.float64(wi) ** 2, axis=-1) - 1.0).max() <= TWIN_LENGTH
    assert sampler.name == "ltc" or wi[:, 2].min() >= 0.0
    assert np.isfinite(pdf).all() and pdf.min() >= 0.0
    assert sampler.name != "eon" or pdf.min() > 0.0


def chi_square(gl, sampler, pdf_of, mu, roughness, count=1_000_000):
    """Probability of a chi-square as large, for the twin of `sampler` against a density."""
    arguments = {"wo": np.float32([view(mu)]), "roughness": np.float32([roughness])}
    wi = call(gl, f"{sampler.name}_sample", u=uniforms_32(count, 4), **arguments)
    edges = np.unique(np.append(np.arccos(np.sqrt(np.linspace(0.0, 1.0, 13))), np.arccos(mu)))
    counts, mean = binned(wi, edges, 24), count * expected(pdf_of, mu, roughness, edges, 24)
    counts, mean = counts[mean > 10.0], mean[mean > 10.0]
    return special.chdtrc(len(mean) - 1, np.sum((counts - mean) ** 2 / mean))


@pytest.mark.parametrize(("sampler", "mu", "roughness"), DRAWS)
def test_float32_samples_pass_the_chi_square_test_against_their_pdf(gl, sampler, mu, roughness):
    assert chi_square(gl, sampler, sampler, mu, roughness) > LEVEL


def test_chi_square_tells_the_exact_sampler_from_the_mixture(gl):
    assert chi_square(gl, BY_NAME["eon_cltc"], BY_NAME["eon"], 0.7, 0.3) < LEVEL


def test_weights_of_exact_samples_are_one_in_float32(host):
    arguments = random_arguments(100_000, 5)
    wi = call(host, "eon_sample", **arguments)
    value = host.call(
        "eon_brdf", arguments["wo"], wi, np.float32([[1.0] * 3]), arguments["roughness"]
    )
    weight = value[:, 0] * wi[:, 2] / call(host, "eon_pdf", wi=wi, **arguments)[:, 0]
    assert np.abs(weight - 1.0).max() <= TWIN_WEIGHT
