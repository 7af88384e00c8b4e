# SPDX-License-Identifier: Apache-2.0
"""Thin films: verdicts on stock MaterialX and eonlib, and on shaders with one wrong line."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mxeon.conformance.accuracy import thin_films as tolerances
from mxeon.conformance.accuracy.bsdf import FRESNEL_FIT
from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.thin_films import CHECKS
from mxeon.conformance.nodes.thin_films import FILMS
from mxeon.conformance.probes.thin_films import FilmProbe
from mxeon.conformance.results import DIFFERS, FAILED, PASSED
from mxeon.models.microfacet import fresnel_formulas as fresnel
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import document_text, input_text, node_text
from mxeon.shaders.scene import SIDE
from tests.support.checks import undiagnosed
from tests.support.wrong_libraries import wrong_copy
from tools.fits import thin_film as fit
from tools.fits import thin_film_search as search
from tools.fits import thin_film_sets as sets

SUBJECTS = {subject.node: subject for subject in FILMS}
ROWS = {check.key: check for check in CHECKS}
CHOICES = "MaterialX's matrix, orders and mixed channels"
HALF = "half of the substrate's reflectance, and MaterialX's choices"
FITTED = "the bare lobe's fit, and the film in the compensation"
AVERAGE = "the compensation uses F at the half vector instead of its average"
FEWER = replace(
    FilmProbe.usual, pairs=1 << 6, albedos=12, materials=8
)  # wrong ones are wrong for most

# What fails or differs with stock MaterialX, with words of the diagnosis; all else passes.
CHOSEN = {
    **dict.fromkeys(("film", "film_curve", "film_orders"), f"{CHOICES}, and its compensation"),
    "film_limit": CHOICES,
    **dict.fromkeys(
        ("film_environment", "film_visible", "film_glossy"), f"{CHOICES}, under an environment"
    ),
}
AVERAGED = dict.fromkeys(("film_average", "film_smooth"), (DIFFERS, AVERAGE))
METAL = {key: (DIFFERS, words) for key, words in CHOSEN.items()} | AVERAGED
STOCK = {
    "dielectric_bsdf": METAL | {"film_throughput": (FAILED, f"{CHOICES}: {FITTED}")},
    "conductor_bsdf": METAL,
    "generalized_schlick_bsdf": AVERAGED
    | {key: (FAILED, words.replace(CHOICES, HALF)) for key, words in CHOSEN.items()}
    | {"film_throughput": (FAILED, f"{HALF}: {FITTED}")},
}
# Largest errors by their names in `tools.fits.thin_film`.
STATED = {
    "orders": tolerances.FILM_ORDERS,
    "orders of curves": tolerances.FILM_SHARP_ORDERS,
    "slope of curves": tolerances.FILM_SLOPE,
    "waves of curves": tolerances.FILM_WAVES,
    "E_ss in curves": tolerances.FILM_KEPT,
    "F_ss": tolerances.FILM_AVERAGE,
    "visible facets": tolerances.FILM_VISIBLE,
    "albedo": tolerances.FILM_SEEN,
    "albedo from an index on": tolerances.FILM_OILED,
}
# Largest of sets by their names in `tools.fits.thin_film_sets`.
SETS = {
    "all orders": tolerances.FILM_FAINT_ORDERS,
    "F_ss": tolerances.FILM_MEAN.value,
    "compensation in two cosines": tolerances.FILM_SMOOTH_MEAN.value,
    "visible facets": tolerances.FILM_STEEP.value,
    "visible facets that are much alike": tolerances.FILM_GLOSSY.value,
}
FILMS_IN = ("genglsl/lib/thin_film.glsl", "genglsl/lib/microfacet_lobe.glsl")
# By name: node, text of the film, the text in its place, key of the check.
WRONG = {
    "phase": ("conductor_bsdf", "-r_s * im_s,", "r_s * im_s,", "film"),
    "one order": ("conductor_bsdf", "} while (order2 > limit);", "} while (false);", "film"),
    "too few orders": ("conductor_bsdf", "order2 *= ratio2;", "order2 *= ratio2 * ratio2;", "film_curve"),
    "one digit of a variance": (
        "conductor_bsdf", "4.3278e9, 4.5282e9", "4.3728e9, 4.5282e9", "film_curve",
    ),
    "six orders at most": (
        "conductor_bsdf", "THIN_FILM_ORDER_RATIO 0.6", "THIN_FILM_ORDER_RATIO 0.006", "film_orders",
    ),
    "no limit": ("dielectric_bsdf", "orders = vec3(0.0)", "orders = vec3(0.01)", "film_limit"),
    "too much light": (
        "conductor_bsdf", "clamp(0.5 * mean - orders, 0.0, 1.0)", "1.1 + 0.0 * mean", "film_energy",
    ),
    "one facet": (
        "conductor_bsdf", "int i = is_known ? last : 0;", "facets = 1; int i = 0;", "film_environment",
    ),
    "one cosine for the average": (
        "conductor_bsdf", "F.average += i < facets || i == last ? vec3(0.0) : share;",
        "F.average = thin_film_fresnel(2.0 / 3.0, 0.0, film, fd);", "film_average",
    ),
    "weights of two cosines": (
        "conductor_bsdf", "vec2(0.785, 0.725)", "vec2(0.785, 0.625)", "film_smooth",
    ),
    "facets of a smooth surface": (
        "conductor_bsdf", "mu + s * s * C.x", "mu", "film_visible",
    ),
    "two facets in one place": (
        "conductor_bsdf", "MICROFACET_HALF 0.5", "MICROFACET_HALF 0.01", "film_glossy",
    ),
    "half of the film": (
        "generalized_schlick_bsdf", "F.visible += i < facets ? share",
        "F.visible += i < facets ? 0.5 * share", "film_throughput",
    ),
    "one average for all curves": (
        "conductor_bsdf", "vec4 curve = vec4(F.average, float(fd.model));", "vec4 curve = vec4(1.0);",
        "film_sum",
    ),
    "not a number": (
        "dielectric_bsdf", "clamp(0.5 * mean - orders, 0.0, 1.0)", "mean / step(1.0, fd.tf_ior)", "film_finite",
    ),
}  # fmt: skip


@pytest.mark.parametrize("node", SUBJECTS)
def test_stock_materialx_has_its_known_films_and_no_others(gl, node):
    for result in judged(gl, node, "stock"):
        verdict, words = STOCK[node].get(result.check, (PASSED, ""))
        assert result.verdict == verdict, result.check
        assert words in result.diagnosis and result.control.caught


@pytest.mark.parametrize("node", SUBJECTS)
def test_the_films_of_eonlib_pass(gl, node):
    for result in judged(gl, node, "eonlib"):
        assert result.verdict == PASSED and result.control.caught, result.diagnosis


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_of_a_film_fails_a_check(gl, tmp_path, name):
    node, text, other, key = WRONG[name]
    library = wrong_copy(tmp_path, text, other, *FILMS_IN)
    result = judge_check(undiagnosed(ROWS[key]), probe_of(gl, node, library))
    assert result.verdict == FAILED and result.control.caught


def test_every_lobe_of_a_pixel_has_its_own_film(gl, tmp_path):
    whole, forgetful, mixed = (
        picture_of_lobes(gl, wrong_copy(tmp_path / name, text, other, *FILMS_IN))
        for name, text, other in (
            ("whole", "is_known", "is_known"),
            ("forgetful", "int i = is_known ? last : 0;", "is_known = false; int i = 0;"),
            ("mixed", "vec4 curve = vec4(F.average, float(fd.model));", "vec4 curve = vec4(1.0);"),
        )
    )
    np.testing.assert_allclose(whole, forgetful, atol=1e-5)
    assert np.abs(whole - mixed).max() > 0.01


def picture_of_lobes(host, library):
    """Picture of a metal beside a dielectric under one film, in a light and an environment."""
    values = {"metallic": 0.5, "iridescence": 1.0, "iridescence_thickness": 500.0}
    inputs = "".join(input_text(name, "float", value) for name, value in values.items())
    document = document_text(node_text("gltf_pbr", "surfaceshader", "shading", inputs))
    shader = generate(document, "glsl", library=library, lights=True)[0]
    return host.picture(shader, replace(SIDE, environment=1.0, size=16))


def test_every_check_of_a_film_has_a_shader_that_it_fails():
    assert {key for *_, key in WRONG.values()} == {*ROWS}


def test_the_shader_is_as_near_as_its_tolerances_say(monkeypatch):
    monkeypatch.setattr(search, "GENERATIONS", 1)
    cheap = ["orders", "orders of curves"]
    errors = fit.errors(cheap)
    monkeypatch.setattr(search, "COUNT", 1 << 5)  # of 2^9: averages take long
    monkeypatch.setattr(search, "STEPS", (0.1, 0.05))
    errors |= fit.errors([name for name in STATED if name not in cheap])
    for name, most in STATED.items():
        assert 0.2 * most < max(errors[name].values()) <= most, name


def test_five_cosines_average_a_curve_without_a_film_as_exactly_as_its_tolerance_says():
    cosines, weights = fit.gauss(5)

    def error(curve, average):
        nodes = (
            weight * curve(np.asarray(mu)) for mu, weight in zip(cosines, weights, strict=True)
        )
        return np.abs(sum(nodes) - average).max()

    ior = np.geomspace(1.0001, 10.0, 2000)
    metal = np.meshgrid(np.linspace(0.05, 5.0, 50), np.linspace(0.5, 10.0, 50))
    power = np.linspace(1.0, 8.0, 500)
    errors = (
        error(lambda mu: fresnel.dielectric(mu, ior), fresnel.dielectric_avg(ior)) + 5.3e-5,
        error(lambda mu: fresnel.conductor(mu, *metal), fresnel.conductor_avg(*metal))
        + FRESNEL_FIT,
        error(lambda mu: (1.0 - mu) ** power, 2.0 / ((power + 1.0) * (power + 2.0))),
    )
    assert 0.9 * tolerances.BARE_AVERAGE < max(errors) <= tolerances.BARE_AVERAGE


@pytest.mark.parametrize("name", SETS)
def test_sets_of_films_are_as_near_as_its_tolerances_say(name):
    found = max(sets.largest(*sets.MEASURED[name], sets=2).values())
    assert 0.3 * SETS[name] < found <= SETS[name]


@cache
def samples(node):
    """A probe whose samples the others of its node have."""
    return FilmProbe(None, SUBJECTS[node], "", FEWER)


def probe_of(host, node, library):
    """The probe of a node, of few pairs."""
    probe = FilmProbe(host, SUBJECTS[node], library, FEWER)
    for name in ("batches", "few", "films", "edges", "albedos"):
        setattr(probe, name, getattr(samples(node), name))
    return probe


def judged(host, node, library):
    """Results of the checks of a film."""
    probe = probe_of(host, node, library)
    rows = [row for row in CHECKS if applies(row, probe.subject, probe.kind, host.name)]
    return [judge_check(row, probe) for row in rows]
