# SPDX-License-Identifier: Apache-2.0
"""Sheen, Burley and translucent models have the right limits, and match 50-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest

from mxeon.models.core.quadrature import albedo_dir_quadrature, hemisphere_nodes
from mxeon.models.diffuse import burley_albedo_dir, burley_brdf, translucent_btdf
from mxeon.models.sheen import (
    _rule,
    conty_kulla_albedo_dir,
    conty_kulla_brdf,
    zeltner_albedo_dir,
    zeltner_brdf,
)
from tests.support import tolerances
from tests.support.cases import direction

BRDFS = (conty_kulla_brdf, zeltner_brdf, burley_brdf)
ROUGHNESS = np.array([0.0, 5e-324, 1e-300, 1e-8, 1e-4, 0.005, 0.01, 0.1, 0.5, 1.0])
MU = np.array([0.0, 5e-324, 1e-300, 1e-160, 1e-16, 1e-8, 1e-3, 0.1, 0.5, 0.9, 1.0 - 1e-16, 1.0])


@pytest.mark.parametrize("brdf", BRDFS)
def test_values_are_finite_on_the_closed_domain(brdf):
    wo = direction(MU, 0.0)[:, None, None, None]
    wi = direction(MU[:, None], np.array([0.0, 0.3, 0.5 * np.pi, np.pi, -2.0]))[:, :, None]
    values = brdf(wo, wi, 1.0, ROUGHNESS)
    assert values.shape == (len(MU), len(MU), 5, len(ROUGHNESS), 1)
    assert np.isfinite(values).all() and (values >= (brdf is zeltner_brdf) * -1.0).all()


def test_conty_kulla_has_its_limit_at_roughness_0_and_where_the_half_vector_is_the_normal():
    wo = direction(np.array(0.4), 0.0)
    wi = wo * [-1.0, 1.0, 1.0]
    assert (conty_kulla_brdf(wo, wi, 1.0, ROUGHNESS) == 0.0).all()
    assert (conty_kulla_brdf(wo, wo, 1.0, [1e-3, 1e-4, 0.0]) < 1e-36).all()
    assert conty_kulla_brdf([1, 0, 0], [-1, 0, 0], 1.0, 0.5) == 0.0


def conty_kulla_exact(wo, wi, roughness):
    """Conty-Kulla sheen, computed by the published equations in 50 digits."""
    wo, wi = ([mp.mpf(float(x)) for x in w] for w in (wo, wi))
    half = [a + b for a, b in zip(wo, wi, strict=True)]
    cosine = half[2] / mp.sqrt(sum(x * x for x in half))
    r = mp.mpf(float(roughness))
    d = (2 + 1 / r) * (1 - cosine**2) ** (1 / (2 * r)) / (2 * mp.pi)
    return d / (4 * (wo[2] + wi[2] - wo[2] * wi[2]))


def zeltner_albedo_exact(x, y):
    """Albedo of Zeltner's sheen, computed by the published Gaussian fit in 50 digits."""
    c = [mp.mpf(number) for number in (0.0206607, 1.58491, 0.0379424, 1.32227)]
    s = y * (c[0] + c[1] * y) / (c[2] + y * (c[3] + y))
    c = [mp.mpf(number) for number in (0.193854, 1.14885, 1.7932, 0.95943, 0.046391)]
    m = y * (-c[0] + y * (-c[1] + y * (c[2] - c[3] * y**2))) / (c[4] + y)
    c = [mp.mpf(number) for number in (0.000654023, 0.0207818, 0.119681, 1.26264, 1.92021)]
    o = y * (c[0] + (-c[1] + c[2] * y) * y) / (c[3] + y * (-c[4] + y))
    return mp.npdf(x, m, s) + o


def zeltner_exact(wo, wi, roughness):
    """Zeltner's sheen, computed by the published equations in 50 digits.

    The published lobe D_o includes a cosine, so the function divides the lobe by the cosine of wi.
    """
    wo, wi = ([mp.mpf(float(v)) for v in w] for w in (wo, wi))
    x, y = wo[2], max(mp.mpf(float(roughness)), mp.mpf(0.01))
    c = [mp.mpf(number) for number in (2.58126, 0.813703, 0.310327, 2.60994)]
    a = (c[0] * x + c[1] * y) * y / (1 + c[2] * x**2 + c[3] * x * y)
    c = [mp.mpf(number) for number in (0.0000254053, 1.71228, 1.71506, 1.34174)]
    b = mp.sqrt(1 - x) * (y - 1) * y**3 / (c[0] + c[1] * x - c[2] * x * y + c[3] * y**2)
    sine = mp.sqrt(wo[0] ** 2 + wo[1] ** 2)
    wx = (wo[0] * wi[0] + wo[1] * wi[1]) / sine
    wy = (wo[0] * wi[1] - wo[1] * wi[0]) / sine
    v = [a * wx + b * wi[2], a * wy, wi[2]]
    length = mp.sqrt(sum(k * k for k in v))
    lobe = v[2] / length / mp.pi * a**2 / length**3 / wi[2]
    return lobe * zeltner_albedo_exact(x, y)


def burley_exact(wo, wi, roughness):
    """Burley's diffuse model, computed by the published equations in 50 digits."""
    wo, wi = ([mp.mpf(float(x)) for x in w] for w in (wo, wi))
    half = [a + b for a, b in zip(wo, wi, strict=True)]
    length = mp.sqrt(sum(x * x for x in half))
    cosine = sum(a * b for a, b in zip(wi, half, strict=True)) / length
    f90 = mp.mpf(1) / 2 + 2 * mp.mpf(float(roughness)) * cosine**2
    return (1 + (f90 - 1) * (1 - wi[2]) ** 5) * (1 + (f90 - 1) * (1 - wo[2]) ** 5) / mp.pi


@pytest.mark.parametrize(
    "brdf, exact",
    [
        (conty_kulla_brdf, conty_kulla_exact),
        (zeltner_brdf, zeltner_exact),
        (burley_brdf, burley_exact),
    ],
)
def test_values_agree_with_50_digits(brdf, exact):
    random = np.random.default_rng(1)
    mu, phi = random.random((2, 60, 2)), random.uniform(-np.pi, np.pi, (2, 60))
    wo, wi = direction(mu[0, :, 0] ** 2, phi[0]), direction(mu[1, :, 0] ** 2, phi[1])
    roughness = 0.01 + 0.99 * random.random(60) ** 2
    values = brdf(wo, wi, 1.0, roughness)[:, 0]
    truth = np.array([float(exact(*each)) for each in zip(wo, wi, roughness, strict=True)])
    assert np.all(np.abs(values - truth) <= tolerances.SHEEN / roughness * (truth + 1.0 / np.pi))


def test_conty_kulla_albedo_has_its_closed_forms_at_grazing_and_along_the_normal():
    for r in (1e-4, 1e-3, 0.01, 0.1, 1.0):
        n = 1 / mp.mpf(r)
        grazing = (2 + n) / (2 * mp.sqrt(mp.pi)) * mp.gammaprod([(n + 3) / 2], [(n + 4) / 2])
        normal = mp.mpf(2) ** (-n / 2) / (n + 4)
        assert abs(conty_kulla_albedo_dir(0.0, r) / grazing - 1) < 1e-11
        assert abs(conty_kulla_albedo_dir(1.0, r) - normal) < 1e-11
    assert conty_kulla_albedo_dir([0.0, 0.3, 1.0], 0.0).tolist() == [0.0, 0.0, 0.0]


def test_conty_kulla_albedo_is_the_integral_of_the_value():
    # The cosines cover both methods for the inner integral: the closed form and the quadrature.
    mu, roughness = np.array([0.02, 0.1, 0.24, 0.26, 0.7]), np.array([0.05, 0.1, 0.3, 0.5])
    truth = []
    for wo, wi, weights in (hemisphere_nodes(each, 128) for each in mu):
        truth.append([weights @ conty_kulla_brdf(wo, wi, 1.0, r)[:, 0] for r in roughness])
    error = np.abs(conty_kulla_albedo_dir(mu[:, None], roughness) - truth).max()
    assert error < 2.0 * tolerances.QUADRATURE  # the albedos are at most 1.5


def test_zeltner_albedo_is_the_integral_of_the_value():
    wo, wi, w = hemisphere_nodes(0.2, 200)
    for r in (0.0, 0.1, 0.5, 1.0):
        integral = np.dot(w, zeltner_brdf(wo, wi, 1.0, r)[:, 0])
        assert abs(integral - zeltner_albedo_dir(0.2, r)) < tolerances.QUADRATURE


def test_burley_albedo_is_the_integral_of_the_value():
    mu, roughness = np.array([0.0, 0.1, 0.6, 1.0])[:, None], np.array([0.0, 0.3, 1.0])
    truth = albedo_dir_quadrature(burley_brdf, mu, 1.0, roughness)
    assert np.abs(burley_albedo_dir(mu, 1.0, roughness) - truth).max() < 2.0 * tolerances.QUADRATURE


def test_transmission_is_lamberts():
    assert translucent_btdf([0, 0, 1], [0.6, 0, -0.8], [0.0, 1.0]).tolist() == [0.0, 1.0 / np.pi]


def test_the_rule_of_conty_kulla_integrates_what_ends_in_a_root():
    x, weights = _rule.__wrapped__()  # bypasses the cache
    np.testing.assert_allclose([weights.sum(), weights @ np.sqrt(x)], [1.0, 2.0 / 3.0], rtol=1e-10)
