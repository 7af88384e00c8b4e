# SPDX-License-Identifier: Apache-2.0
"""Media, emission and diffusion match the published equations and have the right limits."""

import numpy as np
import pytest

from mxeon.models import media
from mxeon.models.nodes import emissions
from mxeon.models.nodes.emissions import COMBINED_EMISSIONS, EMISSIONS
from mxeon.models.nodes.media import AMOUNT, COMBINED_MEDIA, FACTOR, FIRST, MEDIA, METER, SECOND
from tests.support.cases import direction

ANISOTROPIES = (-0.999999, -0.9, -0.3, 0.0, 1e-9, 0.3, 0.9, 0.999999)
ROUNDING = 1e-12
MOMENT = 1e-10  # error of the quadrature in `moments`


def moments(g):
    """Integrals of the phase function, and of the phase function times the cosine, over the sphere.

    Nodes are uniform in log(1 - cos) for g >= 0 and in log(1 + cos) for g < 0, and so are
    dense at the peak.
    """
    x, w = np.polynomial.legendre.leggauss(400)
    low = np.log((1.0 - abs(g)) ** 2 * 1e-12)
    y = 0.5 * (np.log(2.0) - low) * (x + 1.0) + low
    less, weight = np.exp(y), np.exp(y) * 0.5 * (np.log(2.0) - low) * w
    values = media._phase(less, np.float64(g))
    sign = -1.0 if g < 0.0 else 1.0
    total, loss = 2.0 * np.pi * weight @ values, 2.0 * np.pi * weight @ (less * values)
    return total, sign * (1.0 - loss)


@pytest.mark.parametrize("g", ANISOTROPIES)
def test_the_phase_function_integrates_to_1_and_has_the_mean_cosine_g(g):
    total, mean = moments(g)
    assert abs(total - 1.0) <= MOMENT and abs(mean - g) <= MOMENT


def phase(cosine, g):
    x = np.sqrt(1.0 - np.square(cosine))
    return media.hg_pdf([0.0, 0.0, 1.0], np.stack([x, 0.0 * x, -np.asarray(cosine)], axis=-1), g)


def test_the_phase_function_is_the_printed_one():
    cosine, g = np.linspace(-1.0, 1.0, 21), np.linspace(-0.9, 0.9, 7)[:, np.newaxis]
    printed = (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * cosine) ** 1.5)
    assert np.allclose(phase(cosine, g), printed, rtol=1e-13)
    assert np.allclose(phase(cosine, -g), phase(-cosine, g), rtol=1e-13)


def test_the_peak_does_not_cancel():
    e = 1e-12
    peak = (2.0 - e) * e / (4.0 * np.pi * e**3)
    # The rounding of 1 - e changes e by up to 6e-5 e, so the tolerance is large.
    assert np.isclose(phase(1.0, 1.0 - e), peak, rtol=1e-3)
    last = np.nextafter(1.0, 0.0)
    assert np.isfinite(phase([-1.0, 0.0, 1.0], last)).all()
    assert np.isfinite(phase([-1.0, 0.0, 1.0], -last)).all()


def test_light_through_two_lengths_passes_both():
    sigma = [0.0, 0.5, 3.0], [0.0, 1.5, 0.25]
    once = media.transmittance(*sigma, 3.0)
    assert np.allclose(once, media.transmittance(*sigma, 1.0) * media.transmittance(*sigma, 2.0))
    assert once[0] == 1.0 and media.transmittance(1e50, 1e50, 0.0) == 1.0


def test_combined_media_have_the_coefficients_of_their_parts():
    rows = {row.name: row for row in COMBINED_MEDIA}
    first, second = np.array([[0.0, 0.5, 3.0]]), np.array([[1.0, 0.25, 0.0]])
    inputs = {FIRST: first, SECOND: second}
    passed = [media.transmittance(each, 0.0, METER) for each in (second, first)]
    for share, expected in enumerate(passed):
        value = rows["medium_mix"].value({**inputs, AMOUNT: np.array([float(share)])})
        assert np.allclose(value, expected)
    assert np.allclose(rows["medium_add"].value(inputs), passed[0] * passed[1])
    for name, factor in (("float", np.array([2.0])), ("color3", np.full((1, 3), 2.0))):
        value = rows[f"medium_multiply_{name}"].value({**inputs, FACTOR: factor})
        assert np.allclose(value, passed[1] ** 2)


@pytest.mark.parametrize("row", [*MEDIA, *COMBINED_MEDIA])
def test_the_variants_of_a_medium_are_others(row):
    inputs = {name: np.array([[0.3, 0.6, 0.9]]) for name in row.inputs}
    inputs |= {name: np.array([0.4]) for name in (AMOUNT, FACTOR) if name in inputs}
    inputs |= {name: 2.0 * inputs[name] for name in (SECOND, "scattering") if name in inputs}
    value = row.value(inputs)
    assert all(np.abs(each.value(inputs) - value).max() > 1e-3 for each in row.variants)


def test_a_cone_falls_off_by_the_printed_smoothstep():
    mu = np.linspace(0.0, 1.0, 101)
    inner, outer = np.cos(np.radians([30.0, 45.0]))
    t = np.clip((mu - outer) / (inner - outer), 0.0, 1.0)
    values = media.conical_edf(direction(mu), [2.0], 60.0, 90.0)[:, 0]
    assert np.abs(values - 2.0 * t * t * (3.0 - 2.0 * t)).max() <= ROUNDING


@pytest.mark.parametrize("exponent", [0.0, 0.5, 5.0, 20.0])
def test_a_schlick_curve_is_the_printed_one(exponent):
    mu = np.linspace(0.0, 1.0, 101)
    values = media.generalized_schlick_edf(direction(mu), [2.0], [0.2], [0.7], exponent)[:, 0]
    assert np.abs(values - 2.0 * (0.2 + 0.5 * (1.0 - mu) ** exponent)).max() <= ROUNDING


def test_a_narrow_falloff_nears_the_hard_edge():
    mu = np.linspace(0.0, 1.0, 999)
    hard, narrow = (media.conical_edf(direction(mu), [1.0], 60.0, 60.0 + x) for x in (0, 1e-9))
    assert np.array_equal(hard, narrow)


def test_the_back_of_a_cone_is_dark_unless_it_holds_the_horizon():
    back = np.array([0.0, 0.6, -0.8])
    assert media.conical_edf(back, [1.0], 179.0, 0.0) == 0.0
    assert media.conical_edf(back, [1.0], 180.0, 0.0) == 1.0
    assert 0.0 < media.conical_edf(back, [1.0], 170.0, 200.0) < 1.0


def test_a_schlick_curve_ends_at_both_factors_on_both_sides():
    for side in (1.0, -1.0):
        ends = np.array([[0.0, 0.0, side], [1.0, 0.0, 0.0]])
        values = media.generalized_schlick_edf(ends, [2.0], [0.3], [0.7], 5.0)
        assert np.abs(values[:, 0] - [0.6, 1.4]).max() <= ROUNDING


@pytest.mark.parametrize("row", EMISSIONS)
def test_the_variants_of_an_emission_are_others(row):
    wo, inputs = direction([0.75]), inputs_of(row, 1)
    for each in row.variants:
        error = np.abs(each.value(wo, inputs) - row.value(wo, inputs)).max()
        assert error > 1e-3 or each.permitted


@pytest.mark.parametrize("row", COMBINED_EMISSIONS)
def test_combined_emissions_have_the_radiance_of_their_parts(row):
    inputs = inputs_of(row, 1)
    first, amount = inputs[emissions.FIRST], inputs.get(emissions.AMOUNT)
    second, factor = (inputs.get(path) for path in (emissions.SECOND, emissions.FACTOR))
    expected = {
        "emission_mix": lambda: amount * first + (1.0 - amount) * second,
        "emission_add": lambda: first + second,
        "emission_multiply_float": lambda: factor * first,
        "emission_multiply_color3": lambda: factor * first,
    }
    for side in (0.75, -0.75):
        found = row.value(direction([side]), inputs)
        np.testing.assert_allclose(found, expected[row.name](), rtol=ROUNDING)


def inputs_of(row, count):
    rng = np.random.default_rng(3)
    values = {}
    for name in row.inputs:
        number = name.endswith(("mix", "exponent", "angle")) or row.name.endswith("_float")
        shape = (count,) if number and "color" not in name else (count, 3)
        values[name] = 0.2 + 0.7 * rng.random(shape)
        values[name] *= {"exponent": 4.0}.get(name, 1.0)
        if name.endswith("angle"):
            values[name] = np.full(count, {"inner_angle": 60.0, "outer_angle": 100.0}[name])
    return values


@pytest.mark.parametrize("reach", [0.05, 0.4, 3.0])
def test_a_blur_is_the_profile_s_mean_over_the_unit_sphere(reach):
    # On the unit sphere, a ring at the chord length d has the area 2 pi d dd, in which d cancels
    # the factor 1 / d of the diffusion profile.
    x, w = np.polynomial.legendre.leggauss(400)
    d = 1.0 + x
    w = w * (np.exp(-d / reach) + np.exp(-d / (3.0 * reach)))
    phi = 2.0 * np.pi * (np.arange(400) + 0.5) / 400
    along, across = 1.0 - 0.5 * d * d, d * np.sqrt(1.0 - 0.25 * d * d)
    for mu in (-0.6, 0.0, 0.3, 0.95):
        cosine = mu * along[:, np.newaxis] + np.sqrt(1.0 - mu * mu) * np.outer(across, np.cos(phi))
        rings = np.maximum(cosine, 0.0).mean(axis=1)
        # Kinks of the integrands cause an error of 400^-2 times the change of slope.
        assert media.diffusion_blur(mu, reach) == pytest.approx(w @ rings / w.sum(), abs=1e-4)
