# SPDX-License-Identifier: Apache-2.0
"""Fitted coefficients have the stated errors, and scripts reproduce fits of the loss and angle.

The scripts compute with 40 digits. A different digit therefore means a different fit, not a
different machine.
"""

import re

import numpy as np
import pytest

from mxeon.conformance.specs import microfacets
from mxeon.models import thin_film as film_model
from mxeon.models.core.colorimetry import XYZ_TO_REC709_E
from mxeon.models.microfacet.ggx import ggx_albedo_dir
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.shaders import functions as twins
from mxeon.shaders.functions import source_file
from tests.support import tolerances
from tools.fits import (
    arc_tangent,
    blackbody,
    conty_kulla_albedo,
    eon_sampling,
    fon_loss,
    fresnel_average,
    ggx_albedo,
    ggx_anisotropic,
    ggx_cosine,
    ggx_inside,
    lattices,
    thin_film,
    thin_film_nodes,
)
from tools.fits.minimax import defines, mp, roots
from tools.fits.minimax import shipped as shipped_coefficients

by_language = pytest.mark.parametrize("language", twins.LANGUAGES)


def numbers(pattern, text):
    return [float(each) for each in re.findall(rf"#define EON_{pattern} (\S+)", text)]


@by_language
def test_the_script_gives_the_coefficients_of_the_loss(language):
    lines = re.findall(r"^#define EON_[PQ]\d .*$", twins.source(language), re.MULTILINE)
    assert lines == fon_loss.defines()


@by_language
def test_coefficients_of_the_loss_have_the_error_that_stands_beside_them(language):
    p, q = (numbers(rf"{name}\d", twins.source(language)) for name in "PQ")
    double, single = fon_loss.largest_errors(np.float64(p), np.float64(q))
    assert double <= tolerances.FIT_LOSS and single <= tolerances.FIT_LOSS_32


def test_the_root_of_the_sampling_twins_has_the_error_that_stands_beside_it():
    root = numbers(r"ROOT\d", twins.source("glsl"))
    rows = eon_sampling.root_rows(roots(1001))
    assert max(abs(mp.fdot(row, root) - 1) for row in rows) <= tolerances.FIT_ROOT


@by_language
def test_the_script_gives_the_series_of_the_angle(language):
    body = re.search(r"float series = (.*);", twins.source(language))[1]
    series = [float(each) for each in re.findall(r"-?\d\.\d+", body)]
    coefficients = arc_tangent.coefficients(**arc_tangent.TWINS)
    assert series == [round(each, 8) for each in coefficients]
    error = arc_tangent.largest_error(series, arc_tangent.TWINS["top"], 101)
    assert error <= tolerances.FIT_ANGLE


def conty_kulla_error(coefficients):
    mu, roughness = np.meshgrid(np.linspace(1e-4, 1.0, 60), np.geomspace(1e-4, 1.0, 40))
    exact = np.minimum(conty_kulla_albedo_dir(mu, roughness), 1.0)
    return np.abs(conty_kulla_albedo.fitted(mu, roughness, coefficients) - exact).max()


@pytest.mark.parametrize(
    "stem, name, error, stated",
    [
        ("ggx_albedo", "ggx_missing", ggx_albedo.largest_error, tolerances.FIT_GGX),
        ("conty_kulla_albedo", "conty_kulla_albedo_dir", conty_kulla_error, tolerances.FIT_CONTY_KULLA),
        ("fresnel_dielectric", "eonlib_fresnel_dielectric_avg", fresnel_average.dielectric_error, 5.35e-5),
    ],
)  # fmt: skip
def test_a_fit_has_the_error_that_stands_beside_it(stem, name, error, stated):
    first, *others = shipped_coefficients(stem, name)
    assert error((first, *others)) <= stated < error((first + 1e-2, *others))


def test_anisotropic_facets_have_the_errors_that_their_tolerances_state():
    wrong = ggx_anisotropic.largest_error(coefficients=(*ggx_anisotropic.MISSED[:3], 0.0))
    assert ggx_anisotropic.largest_error() <= microfacets.ANISOTROPIC_FIT < wrong
    assert ggx_anisotropic.largest_visible_error() <= microfacets.ANISOTROPIC_LOBE_FIT
    text = source_file("glsl", "ggx_anisotropic").read_text()
    assert all(f"{abs(each):g}" in text for each in (*ggx_anisotropic.MISSED, 0.7, 0.35))


def test_the_albedo_of_smooth_ggx_has_the_error_that_its_tolerance_states():
    mu, coefficients = (
        np.linspace(0.05, 1.0, 400),
        shipped_coefficients("ggx_albedo", "ggx_missing"),
    )
    fitted = ggx_albedo.fitted(mu, np.full_like(mu, 1e-6), coefficients)
    error = np.abs(1.0 - fitted).max()
    assert 0.9 * microfacets.SMOOTH_ESS_FIT < error <= microfacets.SMOOTH_ESS_FIT


def test_compensated_values_have_the_errors_that_their_tolerance_states():
    coefficients = shipped_coefficients("ggx_albedo", "ggx_missing")
    error, factor = ggx_albedo.value_errors(coefficients)
    assert 0.9 * microfacets.ESS_VALUE_FIT < error <= microfacets.ESS_VALUE_FIT
    assert 0.9 * microfacets.COMPENSATED < factor <= microfacets.COMPENSATED
    wrong = (coefficients[0] + 1e-2, *coefficients[1:])
    assert ggx_albedo.value_errors(wrong)[0] > microfacets.ESS_VALUE_FIT


def test_the_average_of_a_metal_has_the_error_that_its_tolerance_states():
    weights, cosines = fresnel_average.shipped_conductor()
    assert tuple(cosines) == fresnel_average.COSINES
    metals = np.linspace(0.05, 5.0, 100), np.linspace(0.5, 10.0, 150)
    error = fresnel_average.conductor_error(weights, *metals)
    assert 0.9 * microfacets.METAL_FIT < error <= microfacets.METAL_FIT
    weights[0] += 1e-3
    assert fresnel_average.conductor_error(weights, *metals) > microfacets.METAL_FIT


def test_the_albedo_of_an_index_below_1_has_the_error_that_its_tolerance_states():
    worst = [0.5923, 0.3016, 0.9512, 0.5254], [0.9933, 0.2271, 0.02834, 0.01362]
    mu, alpha = np.concatenate([worst, ggx_inside.points(count=100)], axis=1)
    sampled = ggx_inside.sample(mu, alpha)
    coefficients = ggx_inside.shipped()
    error = np.abs(ggx_inside.errors(coefficients, mu, alpha, *sampled)).max()
    assert 0.9 * microfacets.INSIDE_FIT < error <= microfacets.INSIDE_FIT
    coefficients[0] += 0.5
    wrong = np.abs(ggx_inside.errors(coefficients, mu, alpha, *sampled)).max()
    assert wrong > microfacets.INSIDE_FIT


def test_the_share_that_passes_from_inside_has_the_error_that_its_tolerance_states():
    mu, alpha, n = (
        np.array([0.2031, 0.9424, 0.0882, 0.1209, 0.0716, 0.4096]),
        [0.1336, 0.0556, 0.7221, 0.077, 0.3211, 0.9718],
        [0.9784, 0.3663, 0.972, 0.9682, 0.9719, 0.4882],
    )
    fitted = ggx_inside.passing(mu, np.array(alpha), np.array(n), ggx_inside.shipped())[1]
    error = np.abs(fitted - ggx_inside.passed(mu, alpha, n)).max()
    assert 0.9 * microfacets.PASSING_FIT < error <= microfacets.PASSING_FIT


def test_the_quadrature_of_the_fit_is_that_of_the_models():
    mu, alpha = ggx_albedo.points(11, 9)
    exact = ggx_albedo_dir(mu, alpha)
    np.testing.assert_allclose(ggx_albedo.albedo(mu, alpha), exact, atol=tolerances.FIT_QUADRATURE)


def test_the_cosines_of_ggx_have_the_errors_that_stand_beside_them():
    grid = ggx_cosine.points(9, 7)
    dielectric = [1.7e-3 if 1.05 <= n <= 2.5 else 3e-3 for n in ggx_cosine.IORS]
    schlick = [1.9e-3 if q == 5 else 3.2e-3 for q in ggx_cosine.EXPONENTS]
    for stem, curves, largest in (
        ("fresnel_dielectric", ggx_cosine.DIELECTRIC, dielectric),
        ("fresnel_schlick", ggx_cosine.SCHLICK, schlick),
    ):
        coefficients = shipped_coefficients(stem, curves.function)
        errors = ggx_cosine.errors(curves, coefficients, *grid)
        assert np.all(np.array(errors) <= largest)
        wrong = (coefficients[0] * 1.1, *coefficients[1:])
        assert np.any(np.array(ggx_cosine.errors(curves, wrong, *grid)) > largest)


def test_the_colors_of_a_black_body_have_the_errors_that_stand_beside_them():
    text = source_file("glsl", "blackbody").read_text(encoding="utf-8")
    stated = re.findall(r"absolute errors: (\S+) of X, (\S+) of Z\.", text)
    found = {name: re.findall(rf"#define BLACKBODY_{name}_\w\d (\S+)", text) for name in "XZ"}
    rows = {name: list(map(float, texts)) for name, texts in found.items()}
    errors = blackbody.largest_errors(rows, 150)
    for error, limit in zip(errors.values(), map(float, stated[0]), strict=True):
        assert 0.9 * limit < error <= limit
    lines = defines(blackbody.FORM, rows["X"], "BLACKBODY_X")
    assert all(line in text for line in lines)


def test_the_shader_has_the_nodes_of_a_film():
    files = (source_file("glsl", each) for each in ("thin_film", "microfacet_film"))
    text = "".join(each.read_text() for each in files)

    def rows(pattern):
        found = re.findall(rf"#define \w+_{pattern} (?:vec\d)?(.*)", text)
        return [list(map(float, re.findall(r"-?\d[\d.e-]*", each))) for each in found]

    np.testing.assert_array_equal(np.transpose(rows(r"AVERAGE_\d")), thin_film.NODES)
    facets = re.findall(r"vec3\(([-\d., ]+)\)", text.partition("vec3 C = ")[2].partition(";")[0])
    found = [list(map(float, each.split(","))) for each in facets]
    np.testing.assert_array_equal(np.transpose(found), thin_film.FACETS)
    orders = [thin_film.VALUE_ORDER, thin_film.WIDTH_ORDER, thin_film.ORDER_RATIO]
    count = np.ceil(np.log(1e-6 * thin_film.VALUE_ORDER) / np.log(thin_film.ORDER_RATIO))
    assert [each for [each] in rows(r"ORDER_\w+")] == [*orders, count]
    assert np.transpose(rows(r"COLOR_\w")) == pytest.approx(XYZ_TO_REC709_E)
    assert rows("HEIGHTS") == [pytest.approx(film_model.AREAS, rel=1e-7)]


@pytest.mark.whole
def test_the_nodes_of_a_film_are_what_their_script_finds():
    # The last digits of least squares fits depend on the machine.
    near = {"rtol": 1e-3, "atol": 1e-3}
    np.testing.assert_allclose(thin_film_nodes.hemisphere(), thin_film.NODES, **near)
    np.testing.assert_allclose(thin_film_nodes.facets(), np.ravel(thin_film.FACETS), **near)


@pytest.mark.parametrize("name", lattices.LATTICES)
def test_sums_over_directions_have_the_errors_that_checks_allow(name):
    count = 1024
    errors = [lattices.error(lattices.LATTICES[name], count, alpha) for alpha in (0.1, 0.55, 1.0)]
    allowed = microfacets.sum_over(count).value
    assert 0.3 * allowed < max(errors) <= allowed
