# SPDX-License-Identifier: Apache-2.0
"""Diffuse models have the right limits, match 50-digit arithmetic, and accept arrays."""

import tracemalloc

import mpmath as mp
import numpy as np
import pytest

from mxeon.models import diffuse
from mxeon.models.table import (
    DIFFUSE_MODELS,
    KNOWN_DEFECTS,
    OTHERS,
    PARAMETRIZATIONS,
    diffuse_model,
)
from tests.support import oracle, tolerances
from tests.support.cases import direction, directions, pairs, parameter

ALL = DIFFUSE_MODELS + KNOWN_DEFECTS


def digits(numbers):
    return [mp.mpf(float(number)) for number in numbers]


def largest_quotient(wo, wi):
    """Larger of 1 and the largest |s / t| for the cosines of a pair of directions."""
    mu_o, mu_i = wo[..., 2], wi[..., 2]
    return np.maximum(1.0, 1.0 / np.maximum(mu_o, mu_i))


def assert_same(value, again, wo, wi):
    """Assert that two evaluations agree. NumPy's rounding may depend on the shape of the arrays."""
    scale = largest_quotient(np.atleast_2d(wo), np.atleast_2d(wi))
    assert (np.pi * np.abs(value - again) <= 2.0 * tolerances.BRDF * scale[..., np.newaxis]).all()


# --- limits ----------------------------------------------------------------------------------


@pytest.mark.parametrize("row", [row for row in DIFFUSE_MODELS if row.parameter])
def test_roughness_zero_is_lambert_to_the_last_bit(row):
    wo, wi, rho, _ = pairs(1000, seed=1)
    assert np.array_equal(row.brdf(wo, wi, rho, 0.0), rho / np.pi)


@pytest.mark.parametrize("row", DIFFUSE_MODELS)
def test_black_reflects_nothing(row):
    wo, wi, _, fraction = pairs(1000, seed=2)
    assert not row.brdf(wo, wi, 0.0, *parameter(row, fraction)).any()


# --- invariants ------------------------------------------------------------------------------


@pytest.mark.parametrize("row", ALL)
def test_model_is_reciprocal_to_the_last_bit(row):
    wo, wi, rho, fraction = pairs(1000, seed=3)
    arguments = (rho, *parameter(row, fraction))
    assert np.array_equal(row.brdf(wo, wi, *arguments), row.brdf(wi, wo, *arguments))


@pytest.mark.parametrize("row", ALL)
def test_model_does_not_change_when_the_pair_turns_about_the_normal(row):
    wo, wi, rho, fraction = pairs(1000, seed=4)
    arguments = (rho, *parameter(row, fraction))
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    change = row.brdf(wo @ turn.T, wi @ turn.T, *arguments) - row.brdf(wo, wi, *arguments)
    scale = largest_quotient(wo, wi)[:, np.newaxis]
    assert (np.pi * np.abs(change) / scale).max() <= tolerances.ROTATION


@pytest.mark.parametrize("row", [row for row in DIFFUSE_MODELS if row.name != "oren_nayar"])
def test_model_is_never_negative(row):
    wo, wi, rho, fraction = pairs(20000, seed=5)
    assert row.brdf(wo, wi, rho, *parameter(row, fraction)).min() >= 0.0


def test_full_oren_nayar_falls_below_zero_as_far_as_documented():
    mu = np.geomspace(1e-9, 1.0, 100)
    wo, wi = direction(mu[:, np.newaxis], 0.0), direction(mu, np.pi)
    lowest = np.pi * diffuse.oren_nayar_brdf(wo, wi, 1e-6, np.pi / 2.0).min() / 1e-6
    assert -0.275 <= lowest <= -0.265


def test_eon_is_a_mixture_of_its_own_white_and_of_white_fon():
    wo, wi, rho, r = pairs(1000, seed=6)
    average = diffuse.fon_albedo_avg(r)[:, np.newaxis]
    weight = rho**2 * average / (1.0 - rho * (1.0 - average))
    fon, eon = diffuse.fon_brdf(wo, wi, 1.0, r), diffuse.eon_brdf(wo, wi, 1.0, r)
    mixture = (rho - weight) * fon + weight * eon
    scale = largest_quotient(wo, wi)[:, np.newaxis]
    error = np.pi * np.abs(mixture - diffuse.eon_brdf(wo, wi, rho, r)) / scale
    assert error.max() <= 2.0 * tolerances.BRDF


# --- agreement -------------------------------------------------------------------------------


@pytest.mark.parametrize("row", DIFFUSE_MODELS)
def test_model_agrees_with_fifty_digits_of_the_printed_equations(row):
    wo, wi, rho, fraction = pairs(300, seed=7)
    values = row.brdf(wo, wi, rho[:, :1], *parameter(row, fraction))[:, 0]
    exact_of = getattr(oracle, row.name)
    for index, value in enumerate(values):
        arguments = (rho[index, 0], *parameter(row, fraction[index]))
        exact = exact_of(digits(wo[index]), digits(wi[index]), *digits(arguments))
        error = abs(mp.pi * (mp.mpf(float(value)) - exact))
        assert error <= tolerances.BRDF * largest_quotient(wo[index], wi[index])


def test_quartic_agrees_with_eon_to_its_documented_error():
    wo, wi, rho, r = pairs(20000, seed=8)
    approximation = diffuse_model("eon_approx").brdf(wo, wi, rho, r)
    error = np.pi * np.abs(approximation - diffuse.eon_brdf(wo, wi, rho, r))
    assert error.max() <= tolerances.QUARTIC_BRDF


def test_quartic_differs_from_the_listing_by_its_epsilon_alone():
    wo, wi, rho, r = pairs(20000, seed=15)
    r = 10.0 ** (-5.0 * r)
    mu_o, mu_i = wo[:, 2], wi[:, 2]
    lost = [np.maximum(1e-7, 1.0 - diffuse.fon_albedo_dir_approx(mu, r)) for mu in (mu_o, mu_i)]
    average = diffuse.fon_albedo_avg(r)
    lobe = (lost[0] * lost[1] / np.maximum(1e-7, 1.0 - average))[:, np.newaxis]
    average = average[:, np.newaxis]
    listing = diffuse.fon_brdf(wo, wi, rho, r)
    listing += rho**2 * average / (1.0 - rho * (1.0 - average)) / np.pi * lobe
    error = np.pi * np.abs(listing - diffuse_model("eon_approx").brdf(wo, wi, rho, r))
    scale = largest_quotient(wo, wi)[:, np.newaxis]
    assert (error <= tolerances.LISTING_EPSILON + tolerances.BRDF * scale).all()


# --- the closed domain -----------------------------------------------------------------------

EDGE_COSINES = np.array([0.0, 5e-324, 1e-310, 3e-308, 1e-160, 1e-8, 0.5, 1.0 - 2.0**-53, 1.0])


@pytest.mark.parametrize("row", ALL)
@pytest.mark.parametrize("fraction", [0.0, 1e-300, 1e-9, 1.0])
def test_model_is_finite_on_the_whole_closed_domain(row, fraction):
    azimuths = np.array([0.0, 1e-9, np.pi / 2.0, np.pi])
    wo = direction(EDGE_COSINES[:, np.newaxis, np.newaxis], 0.0)
    wi = direction(EDGE_COSINES[:, np.newaxis], azimuths)
    rho = [0.0, 1e-300, 0.5, 1.0]
    assert np.isfinite(row.brdf(wo, wi, rho, *parameter(row, fraction))).all()


@pytest.mark.parametrize("row", ALL)
def test_directions_rounded_to_float32_are_valid_and_give_float64(row):
    wo, wi, rho, fraction = pairs(5000, seed=9)
    wo[:100] = direction(1.0 - np.geomspace(1e-16, 1e-6, 100), 0.3)
    longer = np.float32(wo) * np.float32(1.0000002)
    value = row.brdf(longer, np.float32(wi), np.float32(rho), *parameter(row, np.float32(fraction)))
    assert longer[..., 2].max() > 1.0
    assert value.dtype == np.float64 and np.isfinite(value).all()


def test_towards_the_light_at_grazing_the_quotient_without_a_limit_counts_as_zero():
    grazing, up = (diffuse.fon_brdf(w, w, 1.0, 1.0) for w in ([1, 0, 0], [0, 0, 1]))
    assert grazing == up


def test_away_from_the_light_at_grazing_full_oren_nayar_takes_its_limit():
    wo, wi = direction([0.0, 1e-7], 0.0), direction([0.0, 1e-7], np.pi)
    at, near = diffuse.oren_nayar_brdf(wo, wi, 1.0, 1.0)
    assert at == pytest.approx(near, abs=1e-6)


# --- evaluation ------------------------------------------------------------------------------

SHAPES = (
    *(((3,), (3,), (3,), ()), ((5, 3), (3,), (1,), (5,)), ((0, 3), (3,), (3,), ())),
    *(((4, 1, 3), (5, 3), (4, 5, 2), (5,)), ((3,), (3,), (2, 6, 3), (6,))),
)


@pytest.mark.parametrize("row", DIFFUSE_MODELS)
@pytest.mark.parametrize("shapes", SHAPES, ids=str)
def test_arguments_broadcast_as_if_each_pair_stood_alone(row, shapes):
    rng = np.random.default_rng(10)
    wo, wi = (direction(*rng.random((2, *shape[:-1]))) for shape in shapes[:2])
    rho, fraction = rng.random(shapes[2]), rng.random(shapes[3])
    value = row.brdf(wo, wi, rho, *parameter(row, fraction))
    lead = np.broadcast_shapes(*(shape[:-1] for shape in shapes[:3]), shapes[3])
    assert value.shape == lead + shapes[2][-1:]
    wo, wi = (np.broadcast_to(w, lead + (3,)) for w in (wo, wi))
    rho, fraction = np.broadcast_to(rho, value.shape), np.broadcast_to(fraction, lead)
    for index in np.ndindex(lead):
        alone = row.brdf(wo[index], wi[index], rho[index], *parameter(row, fraction[index]))
        assert_same(value[index], alone, wo[index], wi[index])


@pytest.mark.parametrize("row", ALL)
def test_many_pairs_have_the_values_of_their_parts(row):
    wo, wi, rho, fraction = pairs(6000, seed=11)
    wi, rest = wi[:7], parameter(row, fraction[:7])
    whole = row.brdf(wo[:, np.newaxis], wi, rho[:, np.newaxis], *rest)
    for part in (slice(0, 1), slice(1, 1700), slice(1700, 6000)):
        alone = row.brdf(wo[part, np.newaxis], wi, rho[part, np.newaxis], *rest)
        assert_same(alone, whole[part], *np.broadcast_arrays(wo[part, np.newaxis], wi))


@pytest.mark.parametrize("row", [diffuse_model("oren_nayar"), diffuse_model("eon")])
def test_memory_beyond_arguments_and_result_stays_below_64_mebibytes(row):
    wo, wi, rho, fraction = pairs(800_000, seed=14)
    tracemalloc.start()
    result = row.brdf(wo, wi, rho, *parameter(row, fraction))
    beyond = tracemalloc.get_traced_memory()[1] - result.nbytes
    tracemalloc.stop()
    assert beyond < 2**26


def test_arguments_are_left_as_they_were():
    wo, wi, rho, r = pairs(10, seed=12)
    copies = [argument.copy() for argument in (wo, wi, rho, r)]
    diffuse.eon_brdf(wo, wi, rho, r)
    assert all(np.array_equal(old, new) for old, new in zip(copies, (wo, wi, rho, r), strict=True))


def test_a_number_is_one_channel():
    assert diffuse.lambert_brdf([0, 0, 1], [0, 0, 1], 1).shape == (1,)


# --- the table -------------------------------------------------------------------------------


@pytest.mark.parametrize("row", [row for row in DIFFUSE_MODELS if row.parameter])
def test_row_knows_the_interval_of_its_parameter(row):
    wo = [0, 0, 1]
    for end in (0.0, row.largest):
        row.brdf(wo, wo, 1.0, end)
    with pytest.raises(ValueError, match=row.parameter):
        row.brdf(wo, wo, 1.0, -1e-6)
    with pytest.raises(ValueError, match=row.parameter):
        row.brdf(wo, wo, 1.0, row.largest + 1e-6)
    beyond = row.brdf(wo, wo, 1.0, np.nextafter(row.largest, 2.0))
    assert beyond == row.brdf(wo, wo, 1.0, row.largest)


# --- known wrong variants --------------------------------------------------------------------


@pytest.mark.parametrize("row", [row for row in KNOWN_DEFECTS if row.parameter == "roughness"])
def test_defect_is_right_on_white_front_lit_pairs_and_wrong_elsewhere(row):
    wo, wi, rho, r = pairs(2000, seed=13)
    front = np.sum(wo * wi, axis=-1) > 1e-6
    white = np.pi * np.abs(row.brdf(wo, wi, 1.0, r) - diffuse.eon_brdf(wo, wi, 1.0, r))[front]
    scale = largest_quotient(wo, wi)[front, np.newaxis]
    assert (white / scale).max() <= 2.0 * tolerances.BRDF
    assert np.pi * np.abs(row.brdf(wo, wi, rho, r) - diffuse.eon_brdf(wo, wi, rho, r)).max() > 1e-2


def test_eon_floor_is_the_quartic_but_for_dark_reflectances():
    row, right = diffuse_model("eon_floor"), diffuse_model("eon_approx").brdf
    wo, wi, _, r = pairs(2000, seed=15)
    assert np.array_equal(row.brdf(wo, wi, [0.1, 0.5, 1.0], r), right(wo, wi, [0.1, 0.5, 1.0], r))
    assert not row.brdf(wo, wi, 0.0, r).any()
    assert (row.brdf(wo, wi, 0.05, r) >= right(wo, wi, 0.05, r)).all()
    assert (row.brdf(wo, wi, 0.05, r) / right(wo, wi, 0.05, r)).max() > 1.02


def test_qon_tinted_twice_is_right_where_it_is_white():
    row = diffuse_model("qon_tinted_twice")
    wo, wi, rho, sigma = pairs(2000, seed=14)
    right = diffuse_model("qon").brdf
    assert np.array_equal(row.brdf(wo, wi, 1.0, sigma), right(wo, wi, 1.0, sigma))
    assert np.array_equal(row.brdf(wo, wi, rho, sigma), rho * right(wo, wi, rho, sigma))


def test_fitted_albedo_of_qon_is_lambert_when_smooth_and_off_when_rough():
    fitted, exact = diffuse_model("qon_fitted").albedo_dir, diffuse_model("qon").albedo_dir
    mu = np.linspace(0.0, 1.0, 101)
    assert np.array_equal(fitted(mu, [0.3, 1.0], 0.0), np.tile([0.3, 1.0], (101, 1)))
    assert 0.05 < np.abs(fitted(mu, 1.0, 0.5 * np.pi) - exact(mu, 1.0, 0.5 * np.pi)).max() < 0.07


# --- variants of renderers ---------------------------------------------------------------------

WO, WI = directions((2, 1000), seed=1, least=0.05)
# Parameters that correspond to an EON roughness of 0.6. Keys are endings of model names.
PARAMETERS = {"half_pi": 0.3 * np.pi, "slope": 0.6 / np.sqrt(2.0), "squared": 0.36}


@pytest.mark.parametrize("row", PARAMETRIZATIONS)
def test_a_model_of_another_roughness_is_the_model_of_its_parameter(row):
    [(word, parameter)] = [pair for pair in PARAMETERS.items() if row.name.endswith(pair[0])]
    base = diffuse_model(row.name.removesuffix(f"_{word}"))
    rho = [0.8, 0.2]
    np.testing.assert_allclose(row.brdf(WO, WI, rho, 0.6), base.brdf(WO, WI, rho, parameter))
    assert bool(row.albedo_dir) == bool(base.albedo_dir)
    if row.albedo_dir:
        albedo = row.albedo_dir(WO[:, 2], rho, 0.6)
        np.testing.assert_allclose(albedo, base.albedo_dir(WO[:, 2], rho, parameter))


@pytest.mark.parametrize("row", OTHERS)
def test_a_row_is_found_by_its_name_and_vanishes_on_black(row):
    assert diffuse_model(row.name) is row
    assert not row.brdf(WO, WI, 0.0, 0.5).any()
