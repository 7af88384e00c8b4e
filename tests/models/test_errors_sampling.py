# SPDX-License-Identifier: Apache-2.0
"""Bad arguments of samplers and inversions: name, rule, value, place."""

import re

import numpy as np
import pytest

from mxeon.models import diffuse as inversion
from mxeon.models import sampling

UP = [0.0, 0.0, 1.0]
BELOW = [[0.0, 0.0, 1.0], [0.6, 0.0, -0.8]]
HALF = [0.5, 0.5]

SEEN = ("ltc0", "ltc", "cltc", "eon_cltc", "eon")
INVERSIONS = (
    inversion.eon_rho_from_albedo_normal,
    inversion.eon_rho_from_albedo_normal_approx,
    inversion.eon_rho_from_albedo_normal_refit_approx,
    inversion.eon_rho_from_albedo_avg,
    inversion.eon_rho_from_albedo_avg_approx,
    inversion.eon_rho_from_albedo_avg_refit_approx,
)

every_sampler = pytest.mark.parametrize("sampler", sampling.SAMPLERS, ids=lambda row: row.name)
seen = pytest.mark.parametrize(
    "sampler", [row for row in sampling.SAMPLERS if row.name in SEEN], ids=lambda row: row.name
)
every_inversion = pytest.mark.parametrize("function", INVERSIONS)


def refuses(message):
    """A ValueError that says this."""
    return pytest.raises(ValueError, match=f"^{re.escape(message)}$")


@every_sampler
def test_random_numbers_outside_the_half_open_interval_are_refused(sampler):
    with refuses("u must lie in [0, 1); got 1.0 at index (1, 0)"):
        sampler.sample(UP, [[0.0, 0.0], [1.0, 0.0]], 0.5)
    with refuses("u must lie in [0, 1); got -0.5 at index (1,)"):
        sampler.sample(UP, [0.0, -0.5], 0.5)
    with refuses("u must lie in [0, 1); got nan at index (0,)"):
        sampler.sample(UP, [np.nan, 0.5], 0.5)


@every_sampler
def test_random_numbers_come_in_pairs(sampler):
    with refuses("u must have shape (..., 2); got shape (3,)"):
        sampler.sample(UP, [0.1, 0.2, 0.3], 0.5)


@every_sampler
def test_samples_below_the_horizon_have_no_pdf(sampler):
    with refuses("wi must not point below the horizon (z >= 0); got z = -0.8 at index (1,)"):
        sampler.pdf(UP, BELOW, 0.5)


@every_sampler
def test_samples_are_unit_vectors(sampler):
    with refuses("wi must be unit vectors to 1e-06; got squared length 4.0"):
        sampler.pdf(UP, [0.0, 0.0, 2.0], 0.5)


@seen
def test_views_below_the_horizon_are_refused(sampler):
    message = "wo must not point below the horizon (z >= 0); got z = -0.8 at index (1,)"
    with refuses(message):
        sampler.sample(BELOW, HALF, 0.5)
    with refuses(message):
        sampler.pdf(BELOW, UP, 0.5)


@seen
def test_roughness_out_of_range_is_refused(sampler):
    with refuses("roughness must lie in [0, 1]; got 1.2 at index (1,)"):
        sampler.sample(UP, HALF, [0.5, 1.2])
    with refuses("roughness must lie in [0, 1]; got -0.1"):
        sampler.pdf(UP, UP, -0.1)


def test_reflectance_out_of_range_is_refused():
    with refuses("rho must lie in [0, 1]; got 1.5"):
        sampling.eon_sample(UP, HALF, 0.5, rho=1.5)
    with refuses("rho must lie in [0, 1]; got -1.0"):
        sampling.eon_pdf(UP, UP, 0.5, rho=-1.0)


@every_inversion
def test_colors_that_no_rho_reaches_are_refused(function):
    with refuses("color must lie in [0, 1]; got 1.2 at index (2,)"):
        function([0.5, 1.0, 1.2], 0.5)
    with refuses("color must lie in [0, 1]; got -0.1 at index (0,)"):
        function([-0.1, 0.0, 1.0], 0.5)


@every_inversion
def test_inversion_at_a_roughness_out_of_range_is_refused(function):
    with refuses("roughness must lie in [0, 1]; got 2.0"):
        function(0.5, 2.0)


@seen
def test_shapes_that_do_not_broadcast_are_refused_by_name(sampler):
    views, rough = [UP] * 4, [0.5] * 5
    rule = r"must broadcast \(last axis of wo, {} apart\); got shapes \(4, 3\), \({},\), \(5,\)"
    with pytest.raises(ValueError, match="^wo, u, roughness.* " + rule.format("u", 2)):
        sampler.sample(views, HALF, rough)
    with pytest.raises(ValueError, match="^wo, wi, roughness.* " + rule.format("wi", 3)):
        sampler.pdf(views, UP, rough)


@every_inversion
def test_colors_and_roughness_that_do_not_broadcast_are_refused_by_name(function):
    message = "color, roughness must broadcast (last axis of color apart); got shapes (4, 3), (5,)"
    with refuses(message):
        function(np.full((4, 3), 0.5), [0.5] * 5)


@every_inversion
def test_masked_colors_are_refused(function):
    with refuses("color must not be a masked array, whose mask would be lost; fill it"):
        function(np.ma.masked_less([0.1, 0.5], 0.2), 0.5)
