# SPDX-License-Identifier: Apache-2.0
"""The hair node: verdicts on stock MaterialX, on eonlib, and on shaders with one wrong line."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.accuracy.bsdf import QUADRATURES
from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.hair import HAIRS
from mxeon.conformance.probes.hair import HairProbe
from mxeon.conformance.results import FAILED, PASSED
from mxeon.models.hair import TINTS
from tests.support.wrong_libraries import wrong_eonlib_node

(SUBJECT,) = HAIRS
ROWS = {row.key: row for row in CHECKS if applies(row, SUBJECT, kinds.HAIR, "gl")}
FEWER = replace(
    HairProbe.usual, pairs=1 << 9, few=1 << 8, nodes=32
)  # wrong ones are wrong for many

# What fails with stock MaterialX, and words of each diagnosis; every other check passes.
STOCK = {
    "value": "NaN or infinity",
    "environment": "the closest is a GGX lobe of the mean roughness and tint, without absorption",
    "black": "NaN or infinity",
    "finite": "NaN or infinity",
    "integral": "",
    "each_lobe": "best match: N of TRRT+ pi/2 instead of 1/(2 pi) (rms ",
    "narrow_lobes": "best match: I_0 from ten terms, and half a term of its logarithm (rms ",
    "tilted_lobes": "NaN or infinity with a tilted cuticle",
    "wide_lobes": "best match: roughness clamped to [0.001, 1] (rms ",
    "straight_views": "",
    "low_index": "NaN or infinity",
    "surroundings": "",
}

# By name: text of eonlib's shader, the text in its place, key of the check and words of the diagnosis.
TURNED = "complex_multiply(inclined_i, complex_multiply(alpha, alpha))"
WRONG = {
    "the viewer tilted": (
        "M = chiang_hair_longitudinal(tilted, inclined_o, r.x)",
        "M = chiang_hair_longitudinal(complex_multiply(inclined_o, complex_multiply(tilted,"
        " inclined_i * vec2(1.0, -1.0)) / dot(inclined_i, inclined_i)), inclined_i, r.x)",
        "tilted_lobes",
        "best match: the viewer's inclination tilted in place of the light's (rms ",
    ),
    "no tilt": (TURNED, "inclined_i", "each_lobe", ""),
    "uniform lobe": (
        "M * 0.5 * M_PI_INV", "M * 0.5 * M_PI", "each_lobe",
        "best match: N of TRRT+ pi/2 instead of 1/(2 pi) (rms ",
    ),
    "narrow lobes": ("1e-8, 1e-4)", "0.01, 0.001)", "narrow_lobes", ""),
    "wide lobes": (
        "max(roughness[p], vec2(1e-8, 1e-4))", "clamp(roughness[p], 0.001, 1.0)", "wide_lobes",
        "best match: roughness clamped to [0.001, 1] (rms ",
    ),
    "sine by a cosine": (
        "vec2(wo.z, -wo.y) / c", "vec2(wo.z / c, -sign(wo.y) * sqrt(1.0 - wo.z * wo.z / (c * c)))",
        "straight_views", "",
    ),
    "index below 1": (
        "(ior - wo.x) * (ior + wo.x)", "(max(ior, 1.0) - wo.x) * (max(ior, 1.0) + wo.x)",
        "low_index", "",
    ),
    "exit on the other side": ("vec2(wo.z, -wo.y)", "wo.zy", "value", ""),
    "too bright": (
        "total * closureData", "4.0 * total * closureData", "energy",
        "fault: every value is 4 times the right one (rms ",
    ),
    "no absorption": ("exp(-absorption", "exp(-0.0 * absorption", "inputs", "inputs without effect: absorption"),
    "occlusion": (
        "closureData.occlusion", "1.0", "value", "fault: the occlusion is ignored",
    ),
    "light of its own": ("* closureData.occlusion *", "* closureData.occlusion + 0.001 *", "black", ""),
    "light passes": ("throughput = vec3(0.0)", "throughput = vec3(0.5)", "throughput", "throughput 0.5"),
    "another direction": (
        "X = normalize(X - dot(X, N) * N);", "X = normalize(cross(vec3(0.0, 1.0, 0.0), N));", "frame",
        "branch direct: curve_direction is ignored",
    ),
    "horizon": ("max(1.0 - F * T, 1e-7)", "(1.0 - F * T)", "finite", "NaN or infinity"),
    "environment": (
        "back * mx_environment_irradiance(-N)", "vec3(0.0)", "environment", "no known model matches",
    ),
    "sides exchanged": (
        "front * mx_environment_irradiance(N) + back * mx_environment_irradiance(-N)",
        "back * mx_environment_irradiance(N) + front * mx_environment_irradiance(-N)", "surroundings",
        "the environment is looked up on the other side of the surface",
    ),
    "too dark": ("total * closureData", "0.9 * total * closureData", "integral", ""),
}  # fmt: skip


def judged(host, library, keys=tuple(ROWS)):
    """Results of checks of the node by their keys."""
    probe = HairProbe(host, SUBJECT, library, FEWER)
    return {key: judge_check(ROWS[key], probe) for key in keys}


def test_stock_materialx_has_its_known_departures_and_no_others(gl):
    results = judged(gl, "stock")
    assert {key for key, each in results.items() if each.verdict != PASSED} == set(STOCK)
    assert all(STOCK.get(key, "") in each.diagnosis for key, each in results.items())
    assert all(each.control.caught for each in results.values())


def test_eonlib_passes(gl):
    results = judged(gl, "eonlib")
    assert {key: each.diagnosis for key, each in results.items() if each.verdict != PASSED} == {}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_fails_a_check_and_is_named(gl, tmp_path, name):
    text, other, key, words = WRONG[name]
    (result,) = judged(
        gl, wrong_eonlib_node(tmp_path, "chiang_hair_bsdf", text, other), [key]
    ).values()
    assert result.verdict == FAILED and result.control.caught
    assert words in result.diagnosis


def test_every_check_has_a_shader_that_it_fails():
    assert {key for _, _, key, _ in WRONG.values()} == set(ROWS)


def test_the_quadrature_of_the_equations_is_as_exact_as_its_probe_says():
    probe = HairProbe(None, SUBJECT, "stock")
    batch, weights = probe.integrated
    values = SUBJECT.expected(batch).reshape(*weights.shape, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    assert np.abs(albedo - probe.integrals).max() <= QUADRATURES[kinds.HAIR]


def test_inputs_are_those_of_the_node_and_float32_numbers():
    inputs = SUBJECT.random_inputs(np.random.default_rng(1), 1 << 8)
    assert set(inputs) == set(SUBJECT.inputs) - {"normal", "curve_direction"}
    assert set(SUBJECT.changes) == set(SUBJECT.inputs)
    assert all(np.array_equal(each, each.astype(np.float32)) for each in inputs.values())
    assert SUBJECT.black == dict.fromkeys(TINTS, (0.0, 0.0, 0.0))
