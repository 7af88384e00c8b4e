# SPDX-License-Identifier: Apache-2.0
"""The utility nodes of pbrlib: verdicts on stock MaterialX and eonlib, and on shaders with one wrong line."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.utilities import UTILITY_SUBJECTS
from mxeon.conformance.probes.utilities import UtilityOslProbe, UtilityProbe
from mxeon.conformance.results import DIFFERS, FAILED, PASSED
from mxeon.hosts import open_host
from mxeon.shaders.nodes import document_text
from tests.support.availability import available
from tests.support.wrong_libraries import wrong_stock_node

SUBJECTS = {subject.title: subject for subject in UTILITY_SUBJECTS}
ROWS = {check.key: check for check in CHECKS}
KEYS = ("output", "round_trip", "output_inputs", "output_finite")
ROUGHNESS, ALBEDO = "chiang_hair_roughness", "deon_hair_absorption_from_melanin"
COLOR = "chiang_hair_absorption_from_color"

# What fails with stock MaterialX, and words of the diagnosis; all else passes.
STOCK_GLSL = {
    ("output", "blackbody"): "Kang's cubic, extrapolated below 1667 K",
    ("output_finite", ALBEDO): "outputs are not finite",
}
IN_OSL = ("artistic_ior, extinction", "blackbody", f"{ROUGHNESS}, roughness_TRT", ALBEDO, COLOR)
STOCK_OSL = {("output", title): "whatever the inputs are (rms 0)" for title in IN_OSL[2:]}

# By name: title, file, text, the text in its place, key of the check, verdict, words of the diagnosis.
ANISOTROPY, DUAL = "roughness_anisotropy", "roughness_dual"
ARTISTIC, TRT = "artistic_ior", f"{ROUGHNESS}, roughness_TRT"
WRONG = {
    "Burley's aspect": (
        ANISOTROPY, "sqrt(1.0 - clamp(anisotropy, 0.0, 0.98))", "sqrt(1.0 - 0.9 * anisotropy)",
        "output", DIFFERS, "Burley's aspect of 2012",
    ),
    "OpenPBR's aspect": (
        ANISOTROPY,
        "        result.x = min(roughness_sqr / aspect, 1.0);\n        result.y = roughness_sqr * aspect;",
        "        aspect = 1.0 - anisotropy;\n" "        result.x = roughness_sqr * sqrt(2.0 / (1.0 + aspect * aspect));\n" "        result.y = aspect * result.x;",
        "output", DIFFERS, "OpenPBR's aspect",
    ),
    "turned": (
        ANISOTROPY, "result.y = roughness_sqr * aspect", "result.y = roughness_sqr / aspect",
        "output", FAILED, "",
    ),
    "no square": (
        DUAL,
        "roughness.x * roughness.x, M_FLOAT_EPS, 1.0);\n    result.y = clamp(roughness.y * roughness.y",
        "roughness.x, M_FLOAT_EPS, 1.0);\n    result.y = clamp(roughness.y", "output", FAILED,
        "a roughness that is not squared",
    ),
    "exchanged ends": (
        f"{ARTISTIC}, ior", "mix(n_max, n_min, edge_color)", "mix(n_min, n_max, edge_color)",
        "output", FAILED, "the ends of n exchanged",
    ),
    "no light back": (
        f"{ARTISTIC}, ior", "(np1*np1 * r - nm1*nm1)", "(np1*np1 * r)", "round_trip", FAILED, "",
    ),
    "extinction without a root": (
        f"{ARTISTIC}, extinction", "sqrt(k2)", "k2", "output", FAILED, "",
    ),
    "roughness of no lobe": (
        TRT, "v * scale_TRT * scale_TRT", "v * 4.0", "output_inputs", FAILED,
        "inputs without effect: scale_TRT",
    ),
    "scales without squares": (
        TRT, "v * scale_TRT * scale_TRT", "v * scale_TRT", "output", FAILED,
        "scales that are not squared",
    ),
    "deviation": (TRT, "v = v * v;", "", "output", FAILED, "a deviation in place of the variance"),
    "exchanged melanins": (
        ALBEDO, "eumelanin * -log(eumelanin_color) + pheomelanin * -log(pheomelanin_color)",
        "pheomelanin * -log(eumelanin_color) + eumelanin * -log(pheomelanin_color)", "output",
        FAILED, "the shares of both melanins exchanged",
    ),
    "wrong digit": (COLOR, "5.574 * b4", "5.547 * b4", "output", FAILED, ""),
    "black hair": (
        COLOR, "min(max(color, 0.001), vec3(1.0))", "color", "output_finite", FAILED,
        "with color 0 or below",
    ),
}  # fmt: skip


FEWER = replace(UtilityProbe.usual, pairs=1 << 9, few=1 << 7)  # wrong ones are wrong for most


@pytest.fixture(scope="module")
def cycles():
    with available("cycles"):
        host = open_host("cycles")
        host.identity()
    yield host
    host.close()


def judged(probe_type, host, library, keys=KEYS, titles=SUBJECTS):
    """Results of the checks of some subjects."""
    found = [probe_type(host, SUBJECTS[title], library, FEWER) for title in titles]
    return [
        judge_check(ROWS[key], probe)
        for probe in found
        for key in keys
        if applies(ROWS[key], probe.subject, probe.kind, host.name)
    ]


def assert_known(results, known):
    """Check that these rows fail, by these words, that all others pass, and that controls fail."""
    assert {(each.check, each.subject) for each in results if each.verdict != PASSED} == set(known)
    assert all(known.get((each.check, each.subject), "") in each.diagnosis for each in results)
    assert all(each.control.caught for each in results)


def test_stock_glsl_has_its_known_departures_and_no_others(gl):
    assert_known(judged(UtilityProbe, gl, "stock"), STOCK_GLSL)


def test_stock_osl_has_constants_for_hair(cycles):
    assert_known(judged(UtilityOslProbe, cycles, "stock", ("output",), IN_OSL), STOCK_OSL)


def test_no_input_has_an_effect_in_the_constants_of_osl(cycles):
    [result] = judged(UtilityOslProbe, cycles, "stock", ("output_inputs",), (COLOR,))
    assert result.verdict == FAILED and result.error == 2.0


def test_eonlib_has_every_node_in_glsl(gl):
    assert_known(judged(UtilityProbe, gl, "eonlib"), {})


def test_eonlib_has_the_nodes_of_hair_in_osl(cycles):
    assert_known(judged(UtilityOslProbe, cycles, "eonlib", ("output",), IN_OSL[2:]), {})


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_of_a_utility_node_fails_a_check_and_is_named(gl, tmp_path, name):
    title, text, other, key, verdict, words = WRONG[name]
    library = wrong_stock_node(tmp_path, SUBJECTS[title].node, text, other)
    [result] = judged(UtilityProbe, gl, library, (key,), (title,))
    assert result.verdict == verdict and result.control.caught
    assert words in result.diagnosis


def test_every_check_of_the_utility_nodes_has_a_shader_that_it_fails():
    failing = {key for _, _, _, key, *_ in WRONG.values()}
    assert failing == set(KEYS) == {row.key for row in CHECKS if "artistic_ior" in row.models}


# --- subjects and hosts -------------------------------------------------------------------------


def test_a_shader_without_a_uniform_edf_has_no_graph(gl):
    text = document_text('<surface_unlit name="shading" type="surfaceshader"/>')
    wo = np.array([[0.0, 0.0, 1.0]])
    with pytest.raises(ValueError, match="element 'look' must call a uniform EDF"):
        gl.evaluate(gl.compile(text)[0], wo, wo, {}, "graph")
