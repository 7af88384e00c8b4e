# SPDX-License-Identifier: Apache-2.0
"""Fresnel reflectances and their averages have the right limits, and match 50-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from mxeon.models.microfacet import fresnel as fresnel_formulas
from mxeon.models.microfacet.fresnel import (
    fresnel_conductor,
    fresnel_conductor_avg,
    fresnel_dielectric,
    fresnel_dielectric_avg,
    fresnel_schlick,
    fresnel_schlick_avg,
)
from tests.support import tolerances

MU = np.array([0.0, 5e-324, 1e-300, 1e-9, 1e-3, 0.1, 0.5, 0.9, 1.0 - 1e-12, 1.0])
IOR = np.array([0.0, 5e-324, 1e-9, 0.3, 0.9, 1.0 - 1e-12, 1.0, 1.0 + 1e-9, 1.5, 10.0, 1e50])
METALS = ((0.183, 3.424), (0.421, 2.346), (1.373, 1.77), (1.0, 1e-6), (3.0, 1e-9), (1e3, 2e3))
WEAK = ((0.5, 1e-3), (0.5, 1e-6), (0.1, 0.1), (1e-3, 1.0), (1e-3, 1e-3))


def exact(mu, ior, extinction=0.0):
    """Fresnel reflectance (|r_s|^2 + |r_p|^2) / 2, computed from the amplitudes in 50 digits."""
    mu, n = mp.mpf(mu), mp.mpc(ior, extinction)
    w = mp.sqrt(n * n - 1 + mu * mu)
    amplitudes = (mu - w) / (mu + w), (n * n * mu - w) / (n * n * mu + w)
    return sum(abs(r) ** 2 for r in amplitudes) / 2


def average(ior, extinction=0.0):
    """Average reflectance from adaptive quadrature. Panels shrink towards the critical angle."""
    split = min(max(mp.sqrt(1 - mp.mpc(ior, extinction) ** 2).real, 0), 1)
    steps = [mp.mpf(10) ** -k for k in (1, 2, 3, 4, 6, 8, 11)]
    points = {mp.mpf(0), mp.mpf(1), split}
    points |= {split - split * s for s in steps} | {split + (1 - split) * s for s in steps}
    points |= {split * s for s in steps}
    return mp.quad(lambda c: 2 * c * exact(c, ior, extinction), sorted(points))


def walsh(n):
    """Published closed form of the average reflectance of a dielectric."""
    n, log = mp.mpf(n), mp.log
    return (
        mp.mpf(1) / 2
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + n**2 * (n**2 - 1) ** 2 / (n**2 + 1) ** 3 * log((n - 1) / (n + 1))
        - 2 * n**3 * (n**2 + 2 * n - 1) / ((n**2 + 1) * (n**4 - 1))
        + 8 * n**4 * (n**4 + 1) / ((n**2 + 1) * (n**4 - 1) ** 2) * log(n)
    )


@pytest.mark.parametrize("ior", [1.0 + 1e-9, 1.001, 1.5, 2.4, 1e3])
def test_a_dielectric_agrees_with_50_digits(ior):
    with mp.workdps(50):
        for mu in MU:
            expected = exact(mu, ior)
            error = abs(fresnel_dielectric(mu, ior) - expected)
            assert error <= tolerances.FRESNEL * expected


@pytest.mark.parametrize("metal", [*METALS, *WEAK], ids=str)
def test_a_conductor_agrees_with_50_digits(metal):
    with mp.workdps(50):
        for mu in MU:
            error = abs(fresnel_conductor(mu, *metal)[0] - exact(mu, *metal))
            assert error <= tolerances.CONDUCTOR


def test_the_average_of_a_dielectric_agrees_with_50_digits():
    with mp.workdps(50):
        for n in (1.0 + 1e-9, 1.001, 1.2, 1.5, 1.6, 2.4, 3.0, 50.0, 1e6):
            expected = walsh(n)
            assert abs(fresnel_dielectric_avg(n) - expected) <= tolerances.FRESNEL * expected
        for ior in (1e-3, 0.3, 0.9, 1.0 - 2.0**-30):
            n = 1 / mp.mpf(ior)
            expected = 1 - (1 - walsh(n)) / n**2
            assert abs(fresnel_dielectric_avg(ior) - expected) <= tolerances.FRESNEL * expected


def test_the_printed_average_is_the_integral():
    with mp.workdps(20):
        assert abs(average(1.5) - walsh(1.5)) < 1e-15
        assert abs(fresnel_dielectric_avg(0.7) - average(0.7)) < 1e-13


@pytest.mark.parametrize("metal", [METALS[2], WEAK[0]], ids=str)
def test_the_average_of_a_conductor_agrees_with_adaptive_quadrature(metal):
    with mp.workdps(16):
        assert abs(fresnel_conductor_avg(*metal)[0] - average(*metal)) < tolerances.CONDUCTOR


def test_both_rules_of_a_conductors_average_agree_where_the_curve_is_smooth():
    rng = np.random.default_rng(0)
    n, k = 10.0 ** rng.uniform(-2.0, 2.0, (2, 3000))
    smooth = fresnel_formulas._is_smooth((n + 1j * k) ** 2)
    assert smooth.mean() > 0.2
    n, k = n[smooth], k[smooth]
    split = fresnel_formulas._split_avg(n, k)
    assert np.abs(fresnel_formulas._smooth_avg(n, k) - split).max() < tolerances.CONDUCTOR


@pytest.mark.parametrize("exponent", [0.0, 0.5, 5.0, 30.0])
def test_the_average_of_the_schlick_curve_is_its_integral(exponent):
    colors = (0.3, 0.4, 0.9)

    def integrand(mu):
        return 2.0 * mu * fresnel_schlick(mu, *colors, exponent)[0]

    integral, bound = quad(integrand, 0.0, 1.0, epsabs=1e-13)
    assert abs(fresnel_schlick_avg(*colors, exponent)[0] - integral) < bound + tolerances.FRESNEL


def test_reflectances_lie_between_0_and_1_on_the_closed_domain():
    dielectric = fresnel_dielectric(MU[:, None], IOR)
    conductor = fresnel_conductor(MU, IOR[:, None, None, None], IOR[:, None, None])
    averages = fresnel_dielectric_avg(IOR), fresnel_conductor_avg(IOR[:, None, None], IOR[:, None])
    for F in (dielectric, conductor, *averages):
        assert (F >= 0.0).all() and (F <= 1.0).all()


def test_without_extinction_a_conductor_is_a_dielectric():
    # The reflectance has an infinite slope at the critical angle, so samples avoid this angle.
    ior = IOR[(IOR != 0.0) & (np.abs(IOR - 1.0) > 1e-6)]
    conductor = fresnel_conductor(MU[:, None], ior[:, None], 0.0)[..., 0]
    error = np.abs(conductor - fresnel_dielectric(MU[:, None], ior))
    assert error.max() < tolerances.CONDUCTOR


def test_index_0_reflects_all_and_index_1_nothing():
    assert (fresnel_dielectric(MU, 0.0) == 1.0).all() and fresnel_dielectric_avg(0.0) == 1.0
    assert (fresnel_dielectric(MU, 1.0) == 0.0).all() and fresnel_dielectric_avg(1.0) == 0.0
    assert (fresnel_conductor(MU, 0.0, 3.0) == 1.0).all()
    assert (fresnel_conductor(MU, 1.0, 0.0) == 0.0).all()


def test_beyond_the_critical_angle_all_is_reflected():
    mu = np.sqrt(1.0 - 0.5**2) * np.array([0.0, 0.5, 1.0 - 1e-12, 1.0 + 1e-12])
    assert (fresnel_dielectric(mu, 0.5) == 1.0).tolist() == [True, True, True, False]


def test_schlick_curve_meets_its_three_colors():
    curve = fresnel_schlick([1.0, 1.0 / 7.0, 0.0], 0.3, 0.4, 0.9, 5.0)[:, 0]
    plain = fresnel_schlick(1.0 / 7.0, 0.3, 1.0, 0.9, 5.0)[0]
    assert np.allclose(curve, [0.3, 0.4 * plain, 0.9], rtol=tolerances.FRESNEL, atol=0.0)


def test_schlick_curve_is_not_clamped():
    assert fresnel_schlick(0.26, 0.0, 0.0, 1.0, 5.0).round(3) == -0.127
    assert fresnel_schlick_avg(0.0, 0.0, 1.0, 5.0).round(3) == -0.017
    color = np.linspace(0.0, 1.0, 6)
    F = fresnel_schlick(MU, *(color.reshape(-1, *(1,) * k, 1, 1) for k in (3, 2, 1)), 5.0)
    assert F.max() <= 1.0 + tolerances.FRESNEL
