# SPDX-License-Identifier: Apache-2.0
"""Participating media: attenuation and phase function."""

import numpy as np
import pytest

from mxeon.models import media as volume
from mxeon.models.nodes.media import AMOUNT, COMBINED_MEDIA, FACTOR, FIRST, MEDIA, METER, SECOND

ANISOTROPIES = (-0.999999, -0.9, -0.3, 0.0, 1e-9, 0.3, 0.9, 0.999999)
ROUNDING = 1e-13
MOMENT = 1e-10  # quadrature error of `moments`


def moments(g):
    """Integrals over the sphere of the phase function, and of the phase function times the cosine.

    Nodes are uniform in log(1 - cos), or log(1 + cos) for g < 0, so they are dense at the peak.
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
    """Phase function of the cosine of the deflection angle."""
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
    # The rounding error of 1 - e dominates.
    assert np.isclose(phase(1.0, 1.0 - e), peak, rtol=1e-3)
    last = np.nextafter(1.0, 0.0)
    assert np.isfinite(phase([-1.0, 0.0, 1.0], last)).all()
    assert np.isfinite(phase([-1.0, 0.0, 1.0], -last)).all()


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
