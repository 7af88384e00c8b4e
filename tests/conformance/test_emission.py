# SPDX-License-Identifier: Apache-2.0
"""Nodes that emit light, and media: verdicts on MaterialX, on eonlib, and on wrong shaders."""

import numpy as np
import pytest

from mxeon.conformance.accuracy.emission import POWER_RADIANCE, TRANSMITTANCE
from mxeon.conformance.accuracy.engine import widen_for_engine
from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.probes.families import EMISSION_SUBJECTS, PROBES, probe_type_of
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.pictures import PictureProbe
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED
from mxeon.conformance.run.plan import make_plan
from tests.support.wrong_libraries import wrong_eonlib_node, wrong_stock_node

SUBJECTS = {subject.title: subject for subject in EMISSION_SUBJECTS}
ROWS = {check.key: check for check in CHECKS}
ABSENT = (
    "conical_edf",
    "absorption_vdf",
    "measured_edf",
    "mix, VDF",
    "add, VDF",
    "multiply, VDF, in2 float",
    "multiply, VDF, in2 color3",
)
STOCK = {
    **{title: {"implemented": f"glsl has no implementation of {title}"} for title in ABSENT},
    "anisotropic_vdf": {
        "inputs": "inputs without effect: scattering",
        "transmittance": "best match: absorption alone (rms ",
    },
    "surface, an EDF alone": {"opacity": "the opacity is ignored"},
}
COLOR, HALF = "result = color;", "color * 0.31830989"
UNIFORM, SCHLICK = "mx_uniform_edf.glsl", "mx_generalized_schlick_edf.glsl"
MIX, MEDIUM = "mx_mix_edf.glsl", "mx_anisotropic_vdf.glsl"
CURVE = "result = base * f;"

# By name: subject, file, text, the text in its place, key of the check, words of the diagnosis.
WRONG = {
    "exitance": (
        "uniform_edf", UNIFORM, COLOR, f"result = {HALF};", "radiance",
        "best match: the color as an exitance, over pi (rms ",
    ),
    "power": (
        "uniform_edf", UNIFORM, COLOR, f"result = {HALF};", "exitance",
        "best match: the color as an exitance, over pi (rms ",
    ),
    "exponent": (
        "generalized_schlick_edf", SCHLICK, ", exponent)", ", 5.0)", "inputs",
        "inputs without effect: exponent",
    ),
    "curve": (
        "generalized_schlick_edf", SCHLICK, CURVE, "result = base;", "radiance",
        "best match: the base without its curve (rms ",
    ),
    "back of a curve": (
        "generalized_schlick_edf", SCHLICK, "closureData.V), M_FLOAT_EPS",
        "closureData.V) * 0.5, M_FLOAT_EPS", "back", "",
    ),
    "share": ("mix, EDF", MIX, "mix(bg, fg, ", "mix(fg, bg, ", "radiance", ""),
    "medium": (
        "anisotropic_vdf", MEDIUM, "exp(-absorption)", "vec3(1.0)", "transmittance",
        "best match: no medium at all (rms ",
    ),
}  # fmt: skip


def judged(host, title, library, *keys):
    """Results of the checks of a subject, or of those of these keys, by key."""
    subject = SUBJECTS[title]
    probe = PROBES[PairProbe][subject.kind](host, subject, library)
    rows = [row for row in CHECKS if applies(row, subject, probe.kind, host.name)]
    return {row.key: judge_check(row, probe) for row in rows if row.key in (keys or ROWS)}


@pytest.mark.parametrize("title", SUBJECTS)
def test_stock_materialx_has_its_known_departures_and_no_others(gl, title):
    results, words = judged(gl, title, "stock"), STOCK.get(title, {})
    rest = NOT_RUN if title in ABSENT else PASSED
    assert {key: result.verdict for key, result in results.items()} == {
        key: FAILED if key in words else rest for key in results
    }
    assert all(words.get(key, "") in result.diagnosis for key, result in results.items())
    assert all(result.control.caught for result in results.values() if result.control)


@pytest.mark.parametrize("title", [each.title for each in EMISSION_SUBJECTS if not each.libraries])
def test_eonlib_has_every_emission_and_medium_that_it_is_asked_for(gl, title):
    results = judged(gl, title, "eonlib")
    assert len(results) >= 3
    assert {result.verdict for result in results.values()} == {PASSED}
    assert all(result.control.caught for result in results.values())


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_fails_a_check_and_is_named(gl, tmp_path, name):
    title, file, text, other, key, words = WRONG[name]
    [result] = judged(gl, title, wrong_stock_node(tmp_path, file, text, other), key).values()
    assert result.verdict == FAILED and result.control.caught
    assert words in result.diagnosis


def test_a_cone_of_the_wrong_angles_is_named(gl, tmp_path):
    result = cone(gl, tmp_path, "u = angle", "u = min(2.0 * angle, 360.0)", "radiance")
    assert result.verdict == FAILED
    assert "a cone whose angles count from its axis (rms " in result.diagnosis


def test_a_cone_that_ignores_its_normal_fails_the_inputs(gl, tmp_path):
    result = cone(gl, tmp_path, "dot(N, ", "dot(closureData.N, ", "inputs")
    assert result.verdict == FAILED and result.diagnosis == "inputs without effect: normal"


def cone(gl, folder, text, other, key):
    """Result of a check of eonlib's cone with one text in place of another."""
    library = wrong_eonlib_node(folder, "conical_edf", text, other)
    return judged(gl, "conical_edf", library, key)[key]


# By the file that implements a combination of media: its subject, a text, and the text in its place.
COMBINED = {
    "mix_vdf": ("mix, VDF", "vec3(1.0 - share)", "vec3(share)"),
    "add_vdf": ("add, VDF", "in1.throughput * in2", "0.5 * in1.throughput + 0.5 * in2"),
    "multiply_vdf_float": ("multiply, VDF, in2 float", "max(in2, 0.0)", "min(in2, 0.5)"),
    "multiply_vdf_color3": ("multiply, VDF, in2 color3", "max(in2, vec3(0.0))", "in2.zyx"),
}


@pytest.mark.parametrize("file", COMBINED)
def test_a_wrong_combination_of_media_is_seen(gl, tmp_path, file):
    title, text, other = COMBINED[file]
    for new, verdict in ((text, PASSED), (other, FAILED)):
        library = tmp_path / verdict
        library.mkdir()
        path = wrong_eonlib_node(library, file, text, new)
        assert judged(gl, title, path, "transmittance")["transmittance"].verdict == verdict


def test_an_emission_from_one_side_alone_is_permitted(gl, tmp_path):
    side = "result = (dot(closureData.N, closureData.V) < 0.0) ? vec3(0.0) : color;"
    library = wrong_stock_node(tmp_path, UNIFORM, COLOR, side)
    results = judged(gl, "uniform_edf", library, "radiance", "back")
    assert results["radiance"].verdict == PASSED and results["back"].verdict == DIFFERS
    assert "emission from the front alone (rms 0)" in results["back"].diagnosis


def test_every_check_of_emission_has_a_shader_that_it_fails():
    failing = {key for rows in STOCK.values() for key in rows} | {row[4] for row in WRONG.values()}
    models = {subject.model for subject in EMISSION_SUBJECTS}
    assert failing == {row.key for row in CHECKS if models & {*row.models}}


def test_nodes_that_no_library_repairs_are_judged_with_stock_alone():
    for library, expected in (("stock", True), ("eonlib", False)):
        tasks = make_plan((), ("gl",), (library,), nodes=("all",)).tasks
        titles = {task.subject for task in tasks}
        assert ("measured_edf" in titles) is expected and "uniform_edf" in titles
    assert "uniform_edf" not in {task.subject for task in make_plan((), ("gl",), ("stock",)).tasks}


# --- other hosts --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("title", "library"),
    [("generalized_schlick_edf", "stock"), ("conical_edf", "eonlib"), ("add, EDF", "stock")],
)
def test_emission_is_exact_in_osl(hosts, title, library):
    host, subject = hosts("cycles"), SUBJECTS[title]
    probe = probe_type_of(subject, PictureProbe)(host, subject, library)
    result = judge_check(ROWS["radiance"], probe)
    assert result.verdict == PASSED and result.control.caught, result.diagnosis


def test_osl_applies_the_opacity_of_emission_and_lacks_the_same_nodes(hosts):
    host = hosts("cycles")
    for title, key, verdict in (
        ("surface, an EDF alone", "opacity", PASSED),
        ("conical_edf", "implemented", FAILED),
        ("anisotropic_vdf", "transmittance", NOT_RUN),
    ):
        probe = probe_type_of(SUBJECTS[title], PictureProbe)(host, SUBJECTS[title], "stock")
        assert judge_check(ROWS[key], probe).verdict == verdict


def test_a_cone_is_exact_whatever_the_cosine_of_the_engine(hosts):
    result = judged(hosts("webgl"), "conical_edf", "eonlib", "radiance")["radiance"]
    assert result.verdict == PASSED and result.error < 1e-6


def test_the_engines_own_functions_enter_the_tolerances():
    class Engine:
        def __init__(self, share):
            self.share = share

        def execute(self, source, function, x, y=None):
            exact = x**y if "power" in function else np.exp(-x)
            return np.repeat((exact * (1.0 + self.share))[:, np.newaxis], 3, axis=1)

    for title, tolerance in (
        ("generalized_schlick_edf", POWER_RADIANCE),
        ("anisotropic_vdf", TRANSMITTANCE),
    ):
        subject = SUBJECTS[title]
        exact, off = (
            widen_for_engine(tolerance, subject, subject.kind, Engine(share)).value
            for share in (0.0, 1e-4)
        )
        assert exact == tolerance.value and 1e-4 <= off <= 4e-4
