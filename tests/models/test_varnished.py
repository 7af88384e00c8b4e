# SPDX-License-Identifier: Apache-2.0
"""EON under a varnish: energy, reciprocity, edge cases, and random walks of light.

Seeds are fixed. With random seeds, the comparisons with random walks would fail by chance with the
probability FALSE_ALARM.
"""

import numpy as np
import pytest
from scipy import special

from mxeon.fit import MeasuredBrdf, fit_brdf
from mxeon.models import (
    dielectric_over_eon_albedo_dir,
    eon_albedo_avg,
    eon_albedo_dir,
    eon_brdf,
    varnished_albedo_avg,
    varnished_albedo_dir,
    varnished_brdf,
    varnished_sample,
)
from tests.support.cases import direction, directions
from tests.support.hemispheres import uniforms
from tools.fits.varnish_walk import RHO, model_bins, walk, walked_bins

FALSE_ALARM = 1e-4
CLAY = {"rho": np.array([0.7, 0.35, 0.12]), "roughness": 0.6}
WHITE = {"rho": 1.0, "roughness": 0.6}
VARNISH = {"alpha": 0.3, "ior": 1.5}
EDGES = [{"rho": [0.0, 1.0], "roughness": r, "alpha": a, "ior": n}
         for r in (0.0, 1.0) for a in (0.01, 1.0) for n in (1.0, 4.0)]  # fmt: skip
# Errors that the module states for the albedo and for twelfths of the hemisphere.
WALKED, SHAPED = 0.012, 0.21
PATHS = 1 << 14


def test_index_1_is_eon_to_the_last_bit():
    (wo, wi), none = directions((2, 200), 1), {"alpha": 0.3, "ior": 1.0}
    assert np.array_equal(varnished_brdf(wo, wi, **CLAY, **none), eon_brdf(wo, wi, **CLAY))
    mu = wo[:, 2]
    assert np.array_equal(varnished_albedo_dir(mu, **CLAY, **none), eon_albedo_dir(mu, **CLAY))
    off = varnished_albedo_avg(**CLAY, **none) - eon_albedo_avg(**CLAY)
    assert np.abs(off).max() < 1e-15


@pytest.mark.parametrize("ior", (1.02, 1.5, 4.0))
@pytest.mark.parametrize("alpha", (0.01, 0.3, 1.0))
def test_the_value_is_reciprocal_and_a_white_base_loses_nothing(alpha, ior):
    (wo, wi), inputs = directions((2, 200), 2), {"alpha": alpha, "ior": ior}
    value, exchanged = (varnished_brdf(*w, **CLAY, **inputs) for w in ((wo, wi), (wi, wo)))
    assert np.allclose(value, exchanged, 1e-12, 0.0)
    mu = np.append([0.0, 1e-8, 1e-3], wo[:, 2])
    assert np.abs(varnished_albedo_dir(mu, **WHITE, **inputs) - 1.0).max() < 1e-14


@pytest.mark.parametrize(("ior", "alpha", "roughness", "mu"),
    [(1.1, 0.7, 1.0, 0.15), (1.5, 0.05, 0.0, 0.15), (1.5, 0.4, 1.0, 0.5), (2.0, 0.2, 1.0, 1.0)])  # fmt: skip
def test_light_that_walks_has_the_albedo_and_under_a_layer_another(ior, alpha, roughness, mu):
    total, out = walk(mu, roughness, alpha, ior, PATHS)
    deviate = -special.ndtri(0.5 * FALSE_ALARM / (4 * (RHO.size + 48)))
    noise = deviate * total.std(axis=0) / np.sqrt(PATHS)
    inputs = mu, RHO, roughness, alpha, ior
    error = np.abs(total.mean(axis=0) - varnished_albedo_dir(*inputs))
    assert (error < WALKED + noise).all() and error[-1] < 1e-4
    off = dielectric_over_eon_albedo_dir(*inputs) - total.mean(axis=0)
    assert off[2] > WALKED + noise[2]
    # Compare the light in twelfths of the hemisphere; without an interface it differs.
    walked = walked_bins(total, out)
    noise = deviate * np.sqrt(walked_bins(total**2, out) / PATHS) / walked
    for n, right in ((ior, True), (1.0, False)):
        error = np.abs(model_bins(mu, roughness, alpha, n) / walked - 1.0)
        assert (error < SHAPED + noise).all() == right


FUNCTIONS = (
    lambda **inputs: varnished_brdf(direction(0.6), direction(0.3, 1.0), **inputs),
    lambda **inputs: varnished_albedo_dir(0.6, **inputs),
    varnished_albedo_avg,
    lambda **inputs: varnished_sample(direction(0.6), uniforms(4, 1), **inputs)[1],
)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_values_are_finite_at_the_edges(function):
    assert all(np.isfinite(function(**edge)).all() for edge in EDGES)


def test_a_fit_finds_the_pigment_where_the_layer_finds_another():
    wo, wi = directions((2, 200), 3)
    inputs = CLAY | VARNISH
    value = varnished_brdf(wo, wi, **inputs)
    fit = fit_brdf(MeasuredBrdf(wo, wi, value, 0.01 * value), "varnished")
    for name, right in inputs.items():
        name = {"rho": "color"}.get(name, name)  # the model names rho `color`
        assert fit.values[name] == pytest.approx(right, abs=1e-4)
    layer = fit_brdf(MeasuredBrdf(wo, wi, value, 0.01 * value), "dielectric_over_eon")
    assert (layer.values["color"] < 0.8 * CLAY["rho"]).all()
