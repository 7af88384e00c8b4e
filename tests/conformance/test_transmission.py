# SPDX-License-Identifier: Apache-2.0
"""Light through microfacets: verdicts on stock MaterialX and eonlib, and on shaders with a wrong line."""

from dataclasses import replace

import pytest

from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.transmission import TRANSMITTING
from mxeon.conformance.probes.bsdf import TransmissionProbe
from mxeon.conformance.results import FAILED, PASSED
from mxeon.hosts import raster
from tests.support.wrong_libraries import wrong_stock_node

SUBJECTS = {subject.model: subject for subject in TRANSMITTING}
ROWS = [check for check in CHECKS if check.models and set(check.models) <= set(SUBJECTS)]
UNSHADOWED = "the mean of 1 - F over the visible normals, divided by G_1 of the view"
NAN = "NaN or infinity"
STOCK = {
    "dielectric_t": {"transmitted": UNSHADOWED, "transmitted_finite": NAN},
    "schlick_rt": {"transmitted": UNSHADOWED, "clear": UNSHADOWED, "transmitted_finite": NAN},
}
DIELECTRIC = "mx_dielectric_bsdf.glsl"
CALL = "mx_surface_transmission(N, V, X, safeAlpha, distribution, fd, safeTint)"
OTHER = "mx_init_fresnel_dielectric({}, thinfilm_thickness, thinfilm_ior)"
# By name: model, text, the text in its place, and key of the check.
WRONG = {
    "reflection in mode T": ("dielectric_t", "scatter_mode == 1)", "scatter_mode == 7)", "kept"),
    "transmission in mode R": ("dielectric_rt", "scatter_mode != 0)", "scatter_mode != 7)", "kept"),
    "throughput of mode RT": (
        "dielectric_rt", "1.0 - dirAlbedo * weight;", "scatter_mode == 2 ? vec3(1.0) : 1.0 - dirAlbedo;", "kept",
    ),
    "no Fresnel curve": ("dielectric_t", CALL, CALL.replace("fd,", OTHER.format("1.0") + ","), "critical"),
    "index upside down": ("dielectric_t", CALL, CALL.replace("fd,", OTHER.format("1.0 / ior") + ","), "refraction"),
    "no tint": ("dielectric_rt", CALL, CALL.replace("safeTint", "vec3(1.0)"), "transmitted_inputs"),
    "tint squared": ("dielectric_rt", CALL, CALL.replace("safeTint", "safeTint * safeTint"), "critical"),
    "retroreflective light": (
        "dielectric_t", "retroreflective && (closureData.closureType != CLOSURE_TYPE_TRANSMISSION)",
        "retroreflective", "transmitted_inputs",
    ),
}  # fmt: skip


# Few views: what is wrong here is wrong by far.
FEWER = replace(TransmissionProbe.usual, pairs=1 << 8, few=1 << 7, albedos=1 << 5, mirrored=1 << 8)


@pytest.fixture(scope="module", autouse=True)
def few_directions():
    """Let environments have few directions: what is wrong here is wrong by far."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(raster.EVALUATION, "u_envRadianceSamples", 128)
        yield


def judged(host, model, library, *keys):
    """Results of the checks of a node, or of those of these keys."""
    subject = SUBJECTS[model]
    probe = TransmissionProbe(host, subject, library, FEWER)
    return [
        judge_check(row, probe)
        for row in ROWS
        if row.key in (keys or {each.key for each in ROWS})
        and applies(row, subject, probe.kind, host.name)
    ]


@pytest.mark.parametrize("model", STOCK)
def test_stock_materialx_has_its_known_departures_and_no_others(gl, model):
    results = judged(gl, model, "stock")
    failed = {each.check: each.diagnosis for each in results if each.verdict != PASSED}
    assert failed.keys() == STOCK[model].keys()
    assert all(words in failed[check] for check, words in STOCK[model].items())
    assert all(each.control.caught for each in results)


@pytest.mark.parametrize("model", STOCK)
def test_eonlib_passes_all_that_it_does_not_reflect(gl, model):
    assert {each.check: each.verdict for each in judged(gl, model, "eonlib")} == {
        row.key: PASSED for row in ROWS if model in row.models
    }


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_of_transmission_fails_a_check(gl, tmp_path, name):
    model, text, other, key = WRONG[name]
    [result] = judged(gl, model, wrong_stock_node(tmp_path, DIELECTRIC, text, other), key)
    assert result.verdict == FAILED and result.control.caught


def test_every_check_of_transmission_has_a_shader_that_it_fails():
    failing = {key for rows in STOCK.values() for key in rows}
    assert failing | {key for *_, key in WRONG.values()} == {row.key for row in ROWS}
