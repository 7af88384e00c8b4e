# SPDX-License-Identifier: Apache-2.0
"""Albedos and their inverses have the right limits, and match quadrature and mpmath."""

import mpmath as mp
import numpy as np
import pytest

from mxeon.models import diffuse
from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.table import DIFFUSE_MODELS, KNOWN_DEFECTS, diffuse_model
from tests.support import oracle, tolerances
from tests.support.cases import parameter

# Cosines in the closed range [0, 1], dense at both ends.
DENSE = np.geomspace(1e-16, 1.0, 60)
MU = np.unique([0.0, 5e-324, 1e-300, *DENSE, *(1.0 - DENSE)])
RHO = np.array([0.0, 0.2, 0.5, 0.8, 1.0])
FRACTIONS = (0.0, 0.1, 0.5, 1.0)
CLOSED = [row for row in DIFFUSE_MODELS if row.albedo_dir]


# --- results ---------------------------------------------------------------------------------

NAMES = ("fon_loss", "fon_albedo_avg", "fon_albedo_dir", "fon_albedo_dir_approx", "qon_albedo_avg")


@pytest.mark.parametrize("name", [*NAMES, "qon_albedo_dir"])
def test_an_albedo_of_numbers_is_a_number(name):
    function, count = getattr(diffuse, name), 2 if "dir" in name else 1
    assert type(function(*[0.5] * count)) is np.float64
    result = function(*[np.full((2, 1), 0.5, np.float32)] * count)
    assert result.shape == (2, 1) and result.dtype == np.float64


# --- limits ----------------------------------------------------------------------------------


@pytest.mark.parametrize("row", CLOSED)
def test_at_parameter_zero_the_albedos_are_rho(row):
    albedo = row.albedo_dir(MU[:, np.newaxis], RHO, *parameter(row, 0.0))
    assert np.array_equal(albedo, np.broadcast_to(RHO, (MU.size, 1, RHO.size)))
    assert np.array_equal(row.albedo_avg(RHO, *parameter(row, 0.0)), RHO)


# --- invariants ------------------------------------------------------------------------------


@pytest.mark.parametrize("r", FRACTIONS)
def test_eon_returns_all_energy_at_unit_reflectance(r):
    assert np.abs(diffuse.eon_albedo_dir(MU, 1.0, r) - 1.0).max() <= tolerances.ONE_ROUNDING
    assert np.abs(diffuse.eon_albedo_dir_approx(MU, 1.0, r) - 1.0).max() <= tolerances.ONE_ROUNDING
    assert abs(diffuse.eon_albedo_avg(1.0, r) - 1.0) <= tolerances.ONE_ROUNDING


def test_fon_and_eon_never_reflect_more_than_they_receive():
    mu, r = MU[:, np.newaxis], np.linspace(0.0, 1.0, 11)
    fon = diffuse.fon_albedo_dir(mu, r)
    eon = diffuse.eon_albedo_dir(mu, RHO, r[:, np.newaxis, np.newaxis])
    assert fon.min() > 0.0 and fon.max() <= 1.0
    assert eon.min() >= 0.0 and (eon <= RHO).all()


def test_qon_exceeds_one_near_grazing_as_documented():
    sigma = np.linspace(0.0, np.pi / 2.0, 401)
    largest = diffuse.qon_albedo_dir(MU[:, np.newaxis], sigma).max(axis=0)
    assert 1.01 < largest.max() < 1.02
    assert largest[sigma >= 0.6].max() <= 1.0


# --- agreement -------------------------------------------------------------------------------


WRONG = [diffuse_model(name) for name in ("eon_rho_cubed", "fon_white_lobe", "qon_tinted_twice")]


@pytest.mark.parametrize("row", CLOSED + WRONG)
@pytest.mark.parametrize("fraction", FRACTIONS)
def test_directional_albedo_agrees_with_quadrature_of_the_value(row, fraction):
    mu = np.array([0.0, 1e-6, 1e-3, 0.05, 0.3, 0.7, 0.99, 1.0])
    extra = parameter(row, fraction)
    error = albedo_dir_quadrature(row.brdf, mu, RHO, *extra) - row.albedo_dir(mu, RHO, *extra)
    assert np.abs(error).max() <= tolerances.QUADRATURE


@pytest.mark.parametrize("row", CLOSED)
@pytest.mark.parametrize("fraction", FRACTIONS)
def test_average_albedo_agrees_with_quadrature_of_the_directional_one(row, fraction):
    x, weight = np.polynomial.legendre.leggauss(64)
    theta, weight = np.pi / 4.0 * (1.0 + x), np.pi / 4.0 * weight
    extra = parameter(row, fraction)
    share = 2.0 * np.sin(theta) * np.cos(theta) * weight
    average = share @ row.albedo_dir(np.cos(theta), RHO, *extra)
    assert np.abs(average - row.albedo_avg(RHO, *extra)).max() <= tolerances.QUADRATURE


SMOOTH = [
    row for row in DIFFUSE_MODELS + KNOWN_DEFECTS if row.name not in ("eon_approx", "eon_clamped")
]


@pytest.mark.parametrize("row", SMOOTH)
def test_quadrature_has_converged(row):
    mu, extra = [0.0, 1e-6, 1e-3, 0.1, 0.9], parameter(row, 1.0)
    fewer = albedo_dir_quadrature(row.brdf, mu, RHO, *extra)
    more = albedo_dir_quadrature(row.brdf, mu, RHO, *extra, nodes=100)
    assert np.abs(fewer - more).max() <= tolerances.QUADRATURE


def test_loss_keeps_its_digits_down_to_grazing():
    for mu in MU[MU >= 1e-16]:
        exact = mp.mpf(1) / 2 - 2 / (3 * mp.pi) - oracle.g_f(mp.mpf(float(mu))) / mp.pi
        assert abs(mp.mpf(float(diffuse.fon_loss(mu))) / exact - 1) <= tolerances.LOSS


@pytest.mark.parametrize("name", ["qon", "fon", "eon"])
def test_albedos_agree_with_fifty_digits_of_the_printed_equations(name):
    row = diffuse_model(name)
    rng = np.random.default_rng(1)
    exact_of = getattr(oracle, f"{name}_albedo_dir")
    for mu, rho, fraction in [*rng.random((100, 3)), (0.0, 0.5, 1.0), (1e-9, 0.5, 1.0)]:
        extra = parameter(row, fraction)
        exact = exact_of(*(mp.mpf(float(x)) for x in (mu, rho, *extra)))
        value = mp.mpf(float(row.albedo_dir(mu, rho, *extra)[0]))
        assert abs(value / exact - 1) <= tolerances.LOSS


def test_average_albedos_agree_with_fifty_digits_of_the_printed_equations():
    for r in (1e-9, 0.3, 1.0):
        exact = oracle.fon_albedo_avg(1, mp.mpf(r))
        assert abs(mp.mpf(float(diffuse.fon_albedo_avg(r))) / exact - 1) <= tolerances.LOSS
        exact = oracle.eon_albedo_avg(mp.mpf(0.4), mp.mpf(r))
        assert abs(mp.mpf(float(diffuse.eon_albedo_avg(0.4, r)[0])) / exact - 1) <= tolerances.LOSS
    share = oracle.fraction(mp.mpf(0.7), "0.45", "0.09")
    exact = 1 - oracle.fraction(mp.mpf(0.7), "0.5", "0.33")
    exact += (mp.mpf(2) / 3 - 64 / (45 * mp.pi)) * share
    assert abs(mp.mpf(float(diffuse.qon_albedo_avg(0.7))) / exact - 1) <= tolerances.LOSS


def test_quartic_keeps_its_documented_error():
    mu, r = np.linspace(0.0, 1.0, 2001)[:, np.newaxis], np.linspace(0.0, 1.0, 11)
    fon = diffuse.fon_albedo_dir_approx(mu, r) - diffuse.fon_albedo_dir(mu, r)
    assert np.abs(fon).max() <= tolerances.QUARTIC_FON_ALBEDO
    eon = diffuse.eon_albedo_dir_approx(mu, r, r) - diffuse.eon_albedo_dir(mu, r, r)
    assert np.abs(eon).max() <= tolerances.QUARTIC_EON_ALBEDO


# --- broadcasting ----------------------------------------------------------------------------


def test_albedos_broadcast_as_documented():
    mu, r, rho = np.full((4, 1), 0.5), np.full(5, 0.5), np.full((4, 5, 3), 0.5)
    assert diffuse.qon_albedo_dir(mu, r).shape == diffuse.fon_albedo_dir(mu, r).shape == (4, 5)
    assert diffuse.eon_albedo_dir(mu, rho, r).shape == (4, 5, 3)
    assert diffuse.eon_albedo_avg(rho, r).shape == (4, 5, 3)
    assert diffuse.eon_albedo_dir(0.5, 0.5, 0.5).shape == (1,)
    assert albedo_dir_quadrature(diffuse.eon_brdf, mu, rho, r, nodes=2).shape == (4, 5, 3)


# Colors and roughnesses in [0, 1], including all orders of magnitude near 0 and near 1.
SMALL = 10.0 ** np.arange(-300.0, 0.0, 7.0)
EDGES = np.unique(np.concatenate([SMALL, 1.0 - SMALL, np.linspace(0.0, 1.0, 201)]))
NORMAL = diffuse.eon_rho_from_albedo_normal
AVERAGE = diffuse.eon_rho_from_albedo_avg

every_inverse = pytest.mark.parametrize("function", [NORMAL, AVERAGE])


@every_inverse
def test_without_roughness_rho_is_the_color(function):
    np.testing.assert_allclose(function(EDGES, 0.0), EDGES, rtol=tolerances.RHO)


@every_inverse
def test_black_stays_black_and_white_stays_white(function):
    np.testing.assert_array_equal(function(0.0, EDGES), 0.0)
    np.testing.assert_allclose(function(1.0, EDGES), 1.0, rtol=tolerances.RHO)


@every_inverse
def test_rho_is_in_range_and_grows_with_the_color_and_the_roughness(function):
    rho = function(EDGES, EDGES)  # roughness on the first axis, colors on the last
    assert rho.min() >= 0.0 and rho.max() <= 1.0
    assert (np.diff(rho, axis=1) >= 0.0).all()
    smooth = function(np.linspace(0.0, 1.0, 101), np.linspace(0.0, 1.0, 101))
    assert (np.diff(smooth, axis=0) >= -tolerances.RHO).all()


def test_albedos_return_to_the_color():
    normal = diffuse.eon_albedo_dir(1.0, NORMAL(EDGES, EDGES), EDGES)
    average = diffuse.eon_albedo_avg(AVERAGE(EDGES, EDGES), EDGES)
    for albedo in (normal, average):
        colors = np.broadcast_to(EDGES, albedo.shape)
        np.testing.assert_allclose(albedo, colors, rtol=tolerances.ROUND_TRIP)


def exact_normal(color, r):
    """Solution of [Portsmouth2025], Eq. (30), in the current precision of mpmath."""
    normal, mean = oracle.fon_af(r), oracle.fon_albedo_avg(1, r)
    a, b = mean - normal, normal + color * (1 - mean)
    return (-b + mp.sqrt(b * b + 4 * a * color)) / (2 * a)


def exact_average(color, r):
    """Solution of [Portsmouth2025], Eq. (33), in the current precision of mpmath."""
    return color / (color + oracle.fon_albedo_avg(1, r) * (1 - color))


@pytest.mark.parametrize("function, exact", [(NORMAL, exact_normal), (AVERAGE, exact_average)])
def test_inversion_agrees_with_the_printed_equations_at_hundreds_of_digits(function, exact):
    values = function(EDGES, EDGES)[1:-1:4, 1:-1:4]
    with mp.workdps(700):
        grid = [[exact(mp.mpf(c), mp.mpf(r)) for c in EDGES[1:-1:4]] for r in EDGES[1:-1:4]]
    np.testing.assert_allclose(values, np.array(grid, dtype=float), rtol=tolerances.RHO)
