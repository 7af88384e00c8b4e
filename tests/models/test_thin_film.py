# SPDX-License-Identifier: Apache-2.0
"""Thin films match the transfer-matrix method. The specified approximation has known errors."""

from dataclasses import replace

import numpy as np
import pytest
import tmm

from mxeon.models import thin_film as formulas
from mxeon.models.core.colorimetry import CIE_1931, WAVELENGTHS, XYZ_TO_REC709, XYZ_TO_REC709_E
from mxeon.models.microfacet.fresnel import fresnel_conductor, fresnel_dielectric, fresnel_schlick
from mxeon.models.nodes.microfacets import FILM_NODES
from mxeon.models.thin_film import (
    MATERIALX,
    TEXT,
    Form,
    film_brdf,
    film_curve,
    film_reflectance,
    polynomial_curve,
)
from tests.models.test_pbrlib import WO, inputs
from tests.support.availability import package

MU = np.linspace(0.05, 1.0, 40)
GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)
WHITE, HALF = np.ones(3), np.full(3, 0.5)
AVERAGED = 2e-5  # error of 14-node polynomials for the average reflectance of random films
HEIGHTS = 1.3e-3  # amount by which the sum of the sensitivities' heights exceeds 1
ORDERS = 1e-8  # error of the summed interference orders, for cosines above 0.05
TRANSFER = 1e-12  # relative difference from the Python package tmm
# Documented errors of XYZ colors, for dielectrics and for metals. XYZ_ALL includes all interference
# orders, and XYZ_TWO includes only two.
XYZ_ALL, XYZ_TWO = (0.012, 0.017), (0.016, 0.07)
CURVE = 1e-4  # error of the polynomial of degree 48 for the reflectance curve
# Substrates by index of refraction and extinction: diamond, glass, water, dark and bright metal.
SUBSTRATES = ((2.4, 0.0), (1.5, 0.0), (1.33, 0.0), (2.9, 3.1), (0.2, 3.4))

VISIBLE = np.arange(360.0, 831.0)  # wavelengths in nm


def film_spectrum(wavelength, mu, thickness, n2, n, k):
    """Reflectance of a thin film on a substrate for unpolarized light. The wavelength is in nm."""
    sin2, n3 = (1.0 - mu) * (1.0 + mu), n + 1j * k
    c2 = np.sqrt(1.0 - sin2 / n2**2)
    w3 = np.sqrt(n3**2 - sin2 + 0j)  # n3 times the cosine of the refracted angle
    turn = np.exp(4j * np.pi * n2 * c2 * thickness / wavelength)
    s = amplitude(mu, n2 * c2), amplitude(n2 * c2, w3)
    p = amplitude(n2 * mu, c2), amplitude(n3**2 * c2, n2 * w3)
    both = [(upper + lower * turn) / (1.0 + upper * lower * turn) for upper, lower in (s, p)]
    return 0.5 * sum(np.abs(each) ** 2 for each in both)


def film_spectrum_xyz(*film):
    """CIE XYZ color of a thin film under equal-energy light, summed in steps of 1 nm."""
    spectrum = film_spectrum(VISIBLE, *(np.asarray(each)[..., np.newaxis] for each in film))
    weights = np.stack([np.interp(VISIBLE, WAVELENGTHS, each) for each in CIE_1931.T], axis=-1)
    return spectrum @ (weights / weights.sum(axis=0))


def amplitude(above, below):
    """Reflected amplitude between media with two admittances; 0 if the admittances are equal."""
    total = above + below
    return (above - below) / np.where(total == 0.0, 1.0, total)


def grid():
    """Cosine, film thickness, refractive indices of film and substrate, extinction.

    Each array has the shape (5, 4, 26, 8).
    """
    ior, extinction = np.array(SUBSTRATES).T.reshape(2, -1, 1, 1, 1)
    thickness, index = np.linspace(0.0, 2000.0, 26)[:, None], np.array([1.0, 1.33, 1.6, 2.3])
    cosine = np.linspace(0.05, 1.0, 8)
    return np.broadcast_arrays(cosine, thickness, index[:, None, None], ior, extinction)


def text_xyz(orders):
    """XYZ colors of the grid, computed by the specified approximation, shape (..., 3)."""
    mu, thickness, index, ior, extinction = grid()
    opd = formulas.path_difference(mu, thickness, index)
    both = formulas.over_index(mu, index, ior, extinction)
    return np.moveaxis(0.5 * sum(formulas.tristimulus(each, opd, orders) for each in both), 0, -1)


def errors(orders):
    """Largest errors of the specified XYZ colors, for dielectrics and for metals."""
    error = np.abs(text_xyz(orders) - film_spectrum_xyz(*grid()))
    metal = np.array(SUBSTRATES)[:, 1] > 0.0
    return error[~metal].max(), error[metal].max()


def dielectric(mu, thickness, index, ior):
    film = {"thinfilm_thickness": thickness, "thinfilm_ior": index}
    return film_reflectance("dielectric_bsdf", mu, {"ior": ior, **film})


def conductor(mu, thickness, index, ior, extinction, form=TEXT):
    film = {"thinfilm_thickness": thickness, "thinfilm_ior": index}
    inputs = {"ior": ior, "extinction": extinction, **film}
    return film_reflectance("conductor_bsdf", mu, inputs, form)


def schlick(mu, thickness, index, color0, form=TEXT):
    """Reflectance of a film over a Schlick curve: exponent 5, white `color82` and `color90`."""
    film = {"thinfilm_thickness": thickness, "thinfilm_ior": index}
    inputs = {"color0": color0, "color82": 1.0, "color90": 1.0, "exponent": 5.0, **film}
    return film_reflectance("generalized_schlick_bsdf", mu, inputs, form)


def bare(thickness):
    """Reflectance of three substrates, with a film of the given thickness and without a film."""
    return (
        (dielectric(MU, thickness, 1.4, 1.8), fresnel_dielectric(MU, 1.8)[:, np.newaxis]),
        (conductor(MU, thickness, 1.4, *GOLD), fresnel_conductor(MU, *GOLD)),
        (
            schlick(MU, thickness, 1.4, HALF),
            fresnel_schlick(MU, HALF, WHITE, WHITE, 5.0),
        ),
    )


def test_a_film_of_thickness_0_is_the_plain_curve():
    for coated, plain in bare(0.0):
        np.testing.assert_allclose(coated, np.broadcast_to(plain, coated.shape), rtol=1e-14)


def test_a_film_is_continuous_where_its_thickness_vanishes_but_over_schlick():
    *others, jumping = bare(1e-6)
    for coated, plain in others:
        np.testing.assert_allclose(coated, np.broadcast_to(plain, coated.shape), atol=HEIGHTS)
    assert np.abs(jumping[0] - jumping[1]).max() > 0.1


def test_a_film_of_index_1_vanishes():
    ones = conductor(MU, 400.0, 1.0, *GOLD), schlick(MU, 400.0, 1.0, HALF)
    np.testing.assert_allclose(ones[0], fresnel_conductor(MU, *GOLD), rtol=1e-13)
    np.testing.assert_allclose(ones[1], fresnel_schlick(MU, HALF, WHITE, WHITE, 5.0), rtol=1e-13)


def test_a_film_of_the_index_of_its_substrate_is_that_substrate():
    coated = dielectric(MU, 400.0, 1.7, 1.7)
    plain = fresnel_dielectric(MU, 1.7)[:, np.newaxis]
    np.testing.assert_allclose(coated, np.broadcast_to(plain, coated.shape), rtol=1e-12)


def test_a_substrate_that_reflects_everything_does_so_under_a_film():
    np.testing.assert_allclose(dielectric(MU, 400.0, 1.5, 0.0), 1.0, rtol=1e-12)


def test_wavelengths_agree_with_the_transfer_matrix_method():
    for mu in (1.0, 0.6, 0.1):
        for index, extinction in ((1.5, 0.0), (1.1, 0.0), (0.2, 3.4), (2.9, 3.1)):
            stack = [1.0, 1.4, index + 1j * extinction], [np.inf, 350.0, np.inf]
            both = [tmm.coh_tmm(pol, *stack, np.arccos(mu), 550.0)["R"] for pol in "sp"]
            ours = film_spectrum(550.0, mu, 350.0, 1.4, index, extinction)
            np.testing.assert_allclose(ours, np.mean(both), rtol=TRANSFER)


def test_the_airy_terms_of_one_wavelength_are_the_transfer_matrix():
    # At a single wavelength, the sum of all interference orders is a geometric series.
    for index, extinction in ((1.5, 0.0), (1.1, 0.0), (0.2, 3.4), (2.9, 3.1)):
        arrays = [np.full_like(MU, value) for value in (1.4, index, extinction)]
        opd, total = formulas.path_difference(MU, 350.0, arrays[0]), 0.0
        for first, (real, imaginary), R23 in formulas.over_index(MU, *arrays):
            R12 = first**2
            rest = (1.0 - R12) ** 2 * R23 / (1.0 - R12 * R23)
            w = first * (real + 1j * imaginary) * np.exp(2j * np.pi * opd / 550e-9)
            total = total + 0.5 * (R12 + rest + 2.0 * (rest - (1.0 - R12)) * (w / (1.0 - w)).real)
        expected = film_spectrum(550.0, MU, 350.0, 1.4, index, extinction)
        np.testing.assert_allclose(total, expected, atol=1e-12)


def test_the_sum_of_all_orders_is_that_of_many():
    for thickness in (1.0, 30.0, 300.0, 2000.0):
        arrays = [np.full_like(MU, value) for value in (1.4, 0.2, 3.4)]
        opd = formulas.path_difference(MU, thickness, arrays[0])
        for each in formulas.over_index(MU, *arrays):
            many = formulas.tristimulus(each, opd, 400)
            np.testing.assert_allclose(formulas.tristimulus(each, opd), many, atol=ORDERS)


@pytest.mark.parametrize(("orders", "most"), [(None, XYZ_ALL), (2, XYZ_TWO)])
def test_the_text_is_this_near_to_a_sum_over_wavelengths(orders, most):
    measured = errors(orders)
    assert np.all(np.array(measured) <= most)
    assert np.all(np.array(measured) > 0.8 * np.array(most))


def test_the_text_takes_phases_of_the_right_sign():
    mu, thickness, *rest = grid()
    exact = film_spectrum_xyz(mu, thickness, *rest)
    arrays = mu, *(np.array(each) for each in rest)
    opd = formulas.path_difference(mu, thickness, rest[0])
    interfaces = formulas.over_index(*arrays)
    flipped = [each._replace(second=(each.second[0], -each.second[1])) for each in interfaces]
    xyz = 0.5 * sum(formulas.tristimulus(each, opd) for each in flipped)
    assert np.abs(np.moveaxis(xyz, 0, -1) - exact).max() > 0.1


def test_the_reflectance_lies_in_0_to_1_and_leaves_it_before_the_clamp():
    rng = np.random.default_rng(1)
    films = 1000.0 * rng.random(500), 1.0 + rng.random(500), 0.2 + 2.0 * rng.random((500, 3))
    metal = rng.random(500), *films, 4.0 * rng.random((500, 3))
    clamped, free = (conductor(*metal, form) for form in (TEXT, replace(TEXT, clamped=False)))
    assert clamped.min() >= 0.0 and clamped.max() <= 1.0
    assert free.min() < -0.05 and free.max() > 1.05
    np.testing.assert_array_equal(clamped, np.clip(free, 0.0, 1.0))


def test_tristimulus_values_stay_in_0_to_1_with_all_orders():
    xyz = text_xyz(None)
    assert xyz.min() >= -HEIGHTS and xyz.max() <= 1.0 + HEIGHTS


def test_the_matrix_is_the_printed_one_after_a_bradford_adaptation():
    d65 = np.linalg.solve(XYZ_TO_REC709, np.ones(3))
    with np.printoptions():  # colour changes how NumPy prints arrays, which would break doctests
        colour = package("colour")  # slow to import
    adaptation = colour.adaptation.matrix_chromatic_adaptation_VonKries(np.ones(3), d65, "Bradford")
    np.testing.assert_allclose(XYZ_TO_REC709_E, XYZ_TO_REC709 @ adaptation, atol=5e-8)
    np.testing.assert_allclose(XYZ_TO_REC709_E.sum(axis=1), 1.0, atol=3e-7)


def test_half_of_a_schlick_substrate_darkens_a_white_metal():
    white = schlick(1.0, 300.0, 1.0001, WHITE, Form(share=0.5))
    np.testing.assert_allclose(white, 0.5, atol=1e-3)
    stock = schlick(0.5, 300.0, 1.5, WHITE, MATERIALX)
    assert stock.max() < 0.65


@pytest.mark.parametrize("row", FILM_NODES)
def test_an_albedo_takes_a_polynomial_that_is_its_curve(row):
    values = {name: value[:1] for name, value in inputs(row).items() if name != "roughness"}
    columns = {name: value.T if value.ndim == 2 else value for name, value in values.items()}
    spread = {k: v[:, None, None] if v.ndim == 2 else v for k, v in columns.items()}
    smooth = polynomial_curve(row.category, TEXT)(MU[:, None, None], **spread)[:, :, 0, 0]
    np.testing.assert_allclose(smooth, film_curve(row.category).at(MU, **columns), atol=CURVE)


@pytest.mark.parametrize("row", FILM_NODES)
def test_a_row_with_a_film_of_thickness_0_is_the_row_without(row):
    wo, wi, values = WO, WO[::-1], inputs(row)
    none = {**values, "thinfilm_thickness": np.zeros(len(wo))}
    plain = next(each for each in row.variants if each.title == "no film")
    np.testing.assert_allclose(row.value(wo, wi, none), plain.value(wo, wi, values), rtol=1e-13)
    assert not np.allclose(row.value(wo, wi, values), plain.value(wo, wi, values), rtol=1e-2)


@pytest.mark.parametrize("row", FILM_NODES)
def test_equal_inputs_of_all_directions_have_the_values_of_each(row):
    wo, wi, values = WO, WO[::-1], inputs(row)
    same = {name: np.repeat(value[:1], len(wo), axis=0) for name, value in values.items()}
    one = {name: value[:1] for name, value in values.items()}
    each = [row.value(wo[[k]], wi[[k]], one)[0] for k in range(len(wo))]
    np.testing.assert_allclose(row.value(wo, wi, same), each, rtol=1e-12)
    assert row.albedo(wo, same).shape == wo.shape
    twice = {name: np.repeat(value[:1], 2, axis=0) for name, value in values.items()}
    assert film_brdf(row.category, wo[0], wi[0], twice).shape == (2, 3)


@pytest.mark.parametrize("film", [(150.0, 1.4, 1.8), (600.0, 1.4, 1.8), (358.6, 1.925, 1.093)])
def test_the_average_of_a_curve_is_weighted_by_the_cosine(film):
    # In two channels, the curve of the last film is clamped at 0 between kinks.
    names = ("thinfilm_thickness", "thinfilm_ior", "ior")
    material = dict(zip(names, map(np.array, film), strict=True)) | {"tint": np.ones(1)}
    mu = (np.arange(2000) + 0.5) / 2000
    expected = (2.0 * mu[:, np.newaxis] * dielectric(mu, *film)).mean(axis=0)
    average = film_curve("dielectric_bsdf").average(**material)
    assert np.allclose(average, expected, rtol=0.0, atol=AVERAGED)
