# SPDX-License-Identifier: Apache-2.0
"""Albedos: limits, invariants, and agreement with quadrature and 50-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.diffuse import (
    eon_albedo_avg,
    eon_albedo_dir,
    eon_albedo_dir_approx,
    eon_brdf,
    fon_albedo_avg,
    fon_albedo_dir,
    fon_albedo_dir_approx,
    fon_loss,
    qon_albedo_avg,
    qon_albedo_dir,
)
from mxeon.models.table import DIFFUSE_MODELS, KNOWN_DEFECTS, diffuse_model
from tests.support import oracle, tolerances
from tests.support.cases import named, parameter

# Cosines over the closed range [0, 1], dense at both ends.
MU = np.unique(
    np.concatenate(
        [
            [0.0, 5e-324, 1e-300, 1.0],
            np.geomspace(1e-16, 1.0, 60),
            1.0 - np.geomspace(1e-16, 1.0, 60),
        ]
    )
)
RHO = np.array([0.0, 0.2, 0.5, 0.8, 1.0])
FRACTIONS = (0.0, 0.1, 0.5, 1.0)
CLOSED = [row for row in DIFFUSE_MODELS if row.albedo_dir]


# --- results ---------------------------------------------------------------------------------

NUMBERS = (
    (fon_loss, (0.5,)),
    (qon_albedo_dir, (0.5, 0.5)),
    (qon_albedo_avg, (0.5,)),
    (fon_albedo_dir, (0.5, 0.5)),
    (fon_albedo_dir_approx, (0.5, 0.5)),
    (fon_albedo_avg, (0.5,)),
)


@pytest.mark.parametrize(
    "function, arguments", NUMBERS, ids=lambda each: getattr(each, "__name__", "")
)
def test_an_albedo_of_numbers_is_a_number(function, arguments):
    assert type(function(*arguments)) is np.float64
    arrays = [np.full((2, 1), number, np.float32) for number in arguments]
    result = function(*arrays)
    assert result.shape == (2, 1) and result.dtype == np.float64


# --- limits ----------------------------------------------------------------------------------


@named(CLOSED)
def test_at_parameter_zero_the_albedos_are_rho(row):
    assert np.array_equal(
        row.albedo_dir(MU[:, np.newaxis], RHO, *parameter(row, 0.0)),
        np.broadcast_to(RHO, (MU.size, 1, RHO.size)),
    )
    assert np.array_equal(row.albedo_avg(RHO, *parameter(row, 0.0)), RHO)


# --- invariants ------------------------------------------------------------------------------


@pytest.mark.parametrize("r", FRACTIONS)
def test_eon_returns_all_energy_at_unit_reflectance(r):
    assert np.abs(eon_albedo_dir(MU, 1.0, r) - 1.0).max() <= tolerances.ONE_ROUNDING
    assert np.abs(eon_albedo_dir_approx(MU, 1.0, r) - 1.0).max() <= tolerances.ONE_ROUNDING
    assert abs(eon_albedo_avg(1.0, r) - 1.0) <= tolerances.ONE_ROUNDING


def test_fon_and_eon_never_reflect_more_than_they_receive():
    mu, r = MU[:, np.newaxis], np.linspace(0.0, 1.0, 11)
    fon = fon_albedo_dir(mu, r)
    eon = eon_albedo_dir(mu, RHO, r[:, np.newaxis, np.newaxis])
    assert fon.min() > 0.0 and fon.max() <= 1.0
    assert eon.min() >= 0.0 and (eon <= RHO).all()


def test_qon_exceeds_one_near_grazing_as_documented():
    largest = qon_albedo_dir(MU[:, np.newaxis], np.linspace(0.0, np.pi / 2.0, 401)).max(axis=0)
    rough = np.linspace(0.0, np.pi / 2.0, 401) >= 0.6
    assert 1.01 < largest.max() < 1.02
    assert largest[rough].max() <= 1.0


# --- agreement -------------------------------------------------------------------------------


@named([*CLOSED, *map(diffuse_model, ("eon_rho_cubed", "fon_white_lobe", "qon_tinted_twice"))])
@pytest.mark.parametrize("fraction", FRACTIONS)
def test_directional_albedo_agrees_with_quadrature_of_the_value(row, fraction):
    mu = np.array([0.0, 1e-6, 1e-3, 0.05, 0.3, 0.7, 0.99, 1.0])
    extra = parameter(row, fraction)
    error = albedo_dir_quadrature(row.brdf, mu, RHO, *extra) - row.albedo_dir(mu, RHO, *extra)
    assert np.abs(error).max() <= tolerances.QUADRATURE


@named(CLOSED)
@pytest.mark.parametrize("fraction", FRACTIONS)
def test_average_albedo_agrees_with_quadrature_of_the_directional_one(row, fraction):
    x, weight = np.polynomial.legendre.leggauss(64)
    theta, weight = np.pi / 4.0 * (1.0 + x), np.pi / 4.0 * weight
    extra = parameter(row, fraction)
    share = 2.0 * np.sin(theta) * np.cos(theta) * weight
    average = share @ row.albedo_dir(np.cos(theta), RHO, *extra)
    assert np.abs(average - row.albedo_avg(RHO, *extra)).max() <= tolerances.QUADRATURE


@named(
    [row for row in DIFFUSE_MODELS + KNOWN_DEFECTS if row.name not in ("eon_approx", "eon_clamped")]
)
def test_quadrature_has_converged(row):
    mu, extra = [0.0, 1e-6, 1e-3, 0.1, 0.9], parameter(row, 1.0)
    fewer = albedo_dir_quadrature(row.brdf, mu, RHO, *extra)
    more = albedo_dir_quadrature(row.brdf, mu, RHO, *extra, nodes=100)
    assert np.abs(fewer - more).max() <= tolerances.QUADRATURE


def test_loss_keeps_its_digits_down_to_grazing():
    for mu in MU[MU >= 1e-16]:
        exact = mp.mpf(1) / 2 - 2 / (3 * mp.pi) - oracle.g_f(mp.mpf(float(mu))) / mp.pi
        assert abs(mp.mpf(float(fon_loss(mu))) / exact - 1) <= tolerances.LOSS


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
        assert abs(mp.mpf(float(fon_albedo_avg(r))) / exact - 1) <= tolerances.LOSS
        exact = oracle.eon_albedo_avg(mp.mpf(0.4), mp.mpf(r))
        assert abs(mp.mpf(float(eon_albedo_avg(0.4, r)[0])) / exact - 1) <= tolerances.LOSS
    share = oracle.fraction(mp.mpf(0.7), "0.45", "0.09")
    exact = 1 - oracle.fraction(mp.mpf(0.7), "0.5", "0.33")
    exact += (mp.mpf(2) / 3 - 64 / (45 * mp.pi)) * share
    assert abs(mp.mpf(float(qon_albedo_avg(0.7))) / exact - 1) <= tolerances.LOSS


def test_quartic_keeps_its_documented_error():
    mu, r = np.linspace(0.0, 1.0, 2001)[:, np.newaxis], np.linspace(0.0, 1.0, 11)
    fon = fon_albedo_dir_approx(mu, r) - fon_albedo_dir(mu, r)
    assert np.abs(fon).max() <= tolerances.QUARTIC_FON_ALBEDO
    arguments = mu[..., np.newaxis], np.linspace(0.0, 1.0, 11), r[:, np.newaxis]
    eon = eon_albedo_dir_approx(mu, arguments[1], r) - eon_albedo_dir(mu, arguments[1], r)
    assert np.abs(eon).max() <= tolerances.QUARTIC_EON_ALBEDO


# --- broadcasting ----------------------------------------------------------------------------


def test_albedos_broadcast_as_documented():
    mu, r, rho = np.full((4, 1), 0.5), np.full(5, 0.5), np.full((4, 5, 3), 0.5)
    assert qon_albedo_dir(mu, r).shape == fon_albedo_dir(mu, r).shape == (4, 5)
    assert eon_albedo_dir(mu, rho, r).shape == eon_albedo_avg(rho, r).shape == (4, 5, 3)
    assert eon_albedo_dir(0.5, 0.5, 0.5).shape == (1,)
    assert albedo_dir_quadrature(eon_brdf, mu, rho, r, nodes=2).shape == (4, 5, 3)
