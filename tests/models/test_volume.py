# SPDX-License-Identifier: Apache-2.0
"""Participating media: attenuation, and the phase function with its sampling.

FALSE_ALARM is the probability that a test of this file fails by chance.
"""

import numpy as np
import pytest
from scipy import special

from mxeon.models import media as volume
from mxeon.models.nodes.media import AMOUNT, COMBINED_MEDIA, FACTOR, FIRST, MEDIA, METER, SECOND

FALSE_ALARM = 1e-4
ANISOTROPIES = (-0.999999, -0.9, -0.3, 0.0, 1e-9, 0.3, 0.9, 0.999999)
VIEWS = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.48, 0.64, 0.6]])
SAMPLES, BINS, SECTORS = 20_000, 12, 5
ROUNDING = 1e-13
MOMENT = 1e-10  # error of the quadrature below


def moments(g):
    """Integrals over all directions of the phase function, and of it times the cosine.

    Nodes are uniform in the logarithm of 1 - cos, or of 1 + cos for g < 0: dense at the peak.
    """
    x, w = np.polynomial.legendre.leggauss(400)
    low = np.log((1.0 - abs(g)) ** 2 * 1e-12)
    y = 0.5 * (np.log(2.0) - low) * (x + 1.0) + low
    less, weight = np.exp(y), np.exp(y) * 0.5 * (np.log(2.0) - low) * w
    values = volume._phase(less, np.float64(g))
    sign = -1.0 if g < 0.0 else 1.0
    total, loss = 2.0 * np.pi * weight @ values, 2.0 * np.pi * weight @ (less * values)
    return total, sign * (1.0 - loss)


@pytest.mark.parametrize("g", ANISOTROPIES)
def test_the_phase_function_integrates_to_1_and_has_the_mean_cosine_g(g):
    total, mean = moments(g)
    assert abs(total - 1.0) <= MOMENT and abs(mean - g) <= MOMENT


def phase(cosine, g):
    """The density of a deflection by the angle with this cosine."""
    x = np.sqrt(1.0 - np.square(cosine))
    return volume.hg_pdf([0.0, 0.0, 1.0], np.stack([x, 0.0 * x, -np.asarray(cosine)], axis=-1), g)


def test_the_phase_function_is_the_printed_one():
    cosine, g = np.linspace(-1.0, 1.0, 21), np.linspace(-0.9, 0.9, 7)[:, np.newaxis]
    printed = (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * cosine) ** 1.5)
    assert np.allclose(phase(cosine, g), printed, rtol=ROUNDING)
    assert np.allclose(phase(cosine, -g), phase(-cosine, g), rtol=ROUNDING)


def test_the_peak_does_not_cancel():
    e = 1e-12
    peak = (2.0 - e) * e / (4.0 * np.pi * e**3)
    # The rounding of 1 - e dominates.
    assert np.isclose(phase(1.0, 1.0 - e), peak, rtol=1e-3)
    last = np.nextafter(1.0, 0.0)
    assert np.isfinite(phase([-1.0, 0.0, 1.0], last)).all()
    assert np.isfinite(phase([-1.0, 0.0, 1.0], -last)).all()


@pytest.mark.parametrize("g", ANISOTROPIES)
def test_samples_have_their_density(g):
    u = np.random.default_rng(11).random((SAMPLES, 2))
    for view in VIEWS:
        wi, pdf = volume.hg_sample(view, u, g)
        assert np.abs((wi**2).sum(axis=-1) - 1.0).max() < ROUNDING
        if abs(g) < 0.99:  # directions are too coarse at the peak
            assert np.allclose(volume.hg_pdf(view, wi, g), pdf, rtol=1e-9)


@pytest.mark.parametrize("g", [-0.9, 0.0, 0.3, 0.9])
@pytest.mark.parametrize("view", VIEWS, ids=str)
def test_samples_pass_the_chi_square_test_against_the_phase_function(g, view):
    assert chi_square(g, g, view) > FALSE_ALARM / 16


def test_the_chi_square_test_tells_anisotropies_apart():
    assert chi_square(0.3, 0.35, VIEWS[2]) < FALSE_ALARM / 16


def chi_square(g, drawn, view):
    """Probability of a larger chi-square of samples for `drawn` compared with the distribution for g."""
    rng = np.random.default_rng([7, int(10 * g) + 10])
    wi, _ = volume.hg_sample(view, rng.random((SAMPLES, 2)), drawn)
    tangent = np.cross(view, [0.0, 1.0, 0.0])
    tangent /= np.linalg.norm(tangent)
    azimuth = np.arctan2(wi @ np.cross(view, tangent), wi @ tangent)
    rank = distribution(-wi @ view, g)
    cells = np.floor(rank * BINS).clip(0, BINS - 1) * SECTORS
    cells += np.floor((azimuth / (2.0 * np.pi) + 0.5) * SECTORS).clip(0, SECTORS - 1)
    counts = np.bincount(cells.astype(int), minlength=BINS * SECTORS)
    mean = SAMPLES / (BINS * SECTORS)
    return special.chdtrc(BINS * SECTORS - 1, np.sum((counts - mean) ** 2 / mean))


def distribution(cosine, g):
    """Probability of a smaller cosine: the integral of the printed phase function."""
    if g == 0.0:
        return 0.5 * (1.0 + cosine)
    root = np.sqrt(1.0 + g * g - 2.0 * g * cosine)
    return (1.0 - g * g) / (2.0 * g) * (1.0 / root - 1.0 / (1.0 + g))


def test_light_through_two_lengths_passes_both():
    sigma = [0.0, 0.5, 3.0], [0.0, 1.5, 0.25]
    once = volume.transmittance(*sigma, 3.0)
    assert np.allclose(once, volume.transmittance(*sigma, 1.0) * volume.transmittance(*sigma, 2.0))
    assert once[0] == 1.0 and volume.transmittance(1e50, 1e50, 0.0) == 1.0


def test_combined_media_have_the_coefficients_of_their_parts():
    rows = {row.name: row for row in COMBINED_MEDIA}
    first, second = np.array([[0.0, 0.5, 3.0]]), np.array([[1.0, 0.25, 0.0]])
    inputs = {FIRST: first, SECOND: second}
    passed = [volume.transmittance(each, 0.0, METER) for each in (second, first)]
    for share, expected in enumerate(passed):
        value = rows["medium_mix"].value({**inputs, AMOUNT: np.array([float(share)])})
        assert np.allclose(value, expected)
    assert np.allclose(rows["medium_add"].value(inputs), passed[0] * passed[1])
    for name, factor in (("float", np.array([2.0])), ("color3", np.full((1, 3), 2.0))):
        value = rows[f"medium_multiply_{name}"].value({**inputs, FACTOR: factor})
        assert np.allclose(value, passed[1] ** 2)


@pytest.mark.parametrize("row", [*MEDIA, *COMBINED_MEDIA], ids=lambda row: row.name)
def test_the_variants_of_a_medium_are_others(row):
    inputs = {name: np.array([[0.3, 0.6, 0.9]]) for name in row.inputs}
    inputs |= {name: np.array([0.4]) for name in (AMOUNT, FACTOR) if name in inputs}
    inputs |= {name: 2.0 * inputs[name] for name in (SECOND, "scattering") if name in inputs}
    value = row.value(inputs)
    assert all(np.abs(each.value(inputs) - value).max() > 1e-3 for each in row.variants)
