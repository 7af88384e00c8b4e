# SPDX-License-Identifier: Apache-2.0
"""Copies of the library with one wrong line each: the check meant for it fails and says why."""

import pytest

from mxeon.conformance.checks.application import judge_subject
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.families import PBR_SUBJECTS, probe_type_of
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.results import FAILED, PASSED
from tests.support.wrong_libraries import wrong_copy, wrong_eonlib_node

EON, QON, NODE = SUBJECTS
LOBE = "genglsl/lib/oren_nayar_lobe.glsl"
DIRECT = "brdf * mu_i * weight * closureData.occlusion"
ENVIRONMENT = "mx_environment_irradiance(N) * weight"
FACING = "N = mx_forward_facing_normal(N, wo);"
RESPONSE = "bsdf.response = brdf"
ROUGHNESS = f"roughness = 0.3;\n    {FACING}"

# By name: subject, text, the text in its place, key of the check and words of the diagnosis.
WRONG = {
    "weight": (
        EON, DIRECT, DIRECT.replace(" * weight", ""), "value", "fault: the weight is ignored",
    ),
    "occlusion": (
        NODE, DIRECT, DIRECT.replace(" * closureData.occlusion", ""), "value",
        "fault: the occlusion is ignored (rms ",
    ),
    "weight of the environment": (
        QON, ENVIRONMENT, ENVIRONMENT.replace(" * weight", ""), "environment",
        "fault: the weight is ignored",
    ),
    "occlusion of the environment": (
        EON, ENVIRONMENT, f"{ENVIRONMENT} * closureData.occlusion", "environment",
        "fault: the occlusion is applied here and again by the caller (rms ",
    ),
    "small weight": (
        NODE, "weight <= 0.0", "weight <= 0.01", "value", "all with a weight in (0, 0.01]",
    ),
    "throughput": (
        EON, "bsdf.throughput = vec3(0.0);", "", "throughput",
        "throughput 1 (branches: direct, environment, transmission, emission)",
    ),
    "throughput of one branch": (
        QON, RESPONSE, f"bsdf.throughput = vec3(0.5); {RESPONSE}", "throughput",
        "throughput 0.5 (branches: direct)",
    ),
    "opposite look-up": (
        NODE, "irradiance(N)", "irradiance(-N)", "surroundings",
        "the environment is looked up opposite to the normal",
    ),
    "normal not turned": (
        EON, FACING, "", "frame", "all where the normal faces away from the viewer",
    ),
    "normal ignored": (
        QON, "mx_forward_facing_normal(N, wo)", "mx_forward_facing_normal(closureData.N, wo)",
        "frame", "the node's normal is ignored; the surface's is used instead",
    ),
    "normal incidence": (
        EON, RESPONSE, f"if (mu_o == 1.0) brdf *= 2.0;\n        {RESPONSE}", "value",
        "all with the viewer along the normal",
    ),
    "retro-reflection": (
        QON, RESPONSE, f"if (wo == wi) brdf *= 1.5;\n        {RESPONSE}", "value",
        "all in exact retro-reflection (L = V)",
    ),
    "on the horizon": (
        NODE, RESPONSE, f"if (mu_o == 0.0) brdf *= 0.0;\n        {RESPONSE}", "value",
        "all with the viewer on the horizon",
    ),
    "grazing": (
        EON, RESPONSE, f"if (mu_o < 1.0e-6) brdf *= 0.0;\n        {RESPONSE}", "value",
        "all with the viewer's cosine in [0, 1e-06]",
    ),
    "cosine above 1": (
        EON, "min(dot(N, wo), 1.0)", "dot(N, wo)", "environment",
        "NaN or infinity with dot(N, V) rounded above 1",
    ),
    "light from below": (
        QON, "clamp(dot(N, wi), 0.0, 1.0)", "min(abs(dot(N, wi)), 1.0)", "value",
        "all with light from below the horizon",
    ),
    "roughness constant": (NODE, FACING, ROUGHNESS, "inputs", "inputs without effect: roughness"),
    "roughness squared": (
        NODE, FACING, ROUGHNESS.replace("= 0.3", "*= roughness"), "environment",
        "fault: the roughness is squared (rms ",
    ),
    "channels": (
        EON, FACING, f"color = color.bgr;\n    {FACING}", "value",
        "fault: the color channels are exchanged: they arrive as blue, green, red (rms ",
    ),
    "factor": (
        QON, "brdf * mu_i", "3.14159265 * brdf * mu_i", "value",
        "fault: the factor 1/pi is missing (rms ",
    ),
    "flag": (
        EON, "energy_compensation ? eon_brdf_mu", "!energy_compensation ? eon_brdf_mu", "value",
        ", as with energy_compensation false",
    ),
    "another model": (
        NODE, "brdf * mu_i", "(brdf + 0.05 * color * mu_o * mu_o) * mu_i", "value",
        "no known model matches, the closest is ",
    ),
    "nothing like it": (
        NODE, "brdf * mu_i", "1e6 * color.zxy * mu_o * mu_o", "value",
        "no known model matches; wrong for ",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_fails_the_check_meant_for_it_and_is_named(gl, tmp_path, name):
    subject, text, other, key, words = WRONG[name]
    result = judged(gl, wrong_copy(tmp_path, text, other, LOBE), subject, key)
    assert result.verdict == FAILED and words in result.diagnosis


def test_a_copy_without_a_wrong_line_passes_every_check(gl, tmp_path):
    library = wrong_copy(tmp_path, FACING, FACING, LOBE)
    for subject in SUBJECTS:
        results = judge_subject(PairProbe(gl, subject, library))
        assert {result.verdict for result in results} == {PASSED}


@pytest.mark.parametrize("host", ["webgl", "vulkan", "wgsl", "slang"])
@pytest.mark.parametrize(
    "name", ["occlusion", "throughput", "opposite look-up", "normal not turned"]
)
def test_the_other_hosts_see_what_is_around_the_model(hosts, tmp_path, host, name):
    subject, text, other, key, words = WRONG[name]
    result = judged(hosts(host), wrong_copy(tmp_path, text, other, LOBE), subject, key)
    assert result.verdict == FAILED and words in result.diagnosis


# Of nodes beside the rough diffuse ones, by name: node, file, text, the other text, key, words.
BLUR = "curvature * max(radius, vec3(0.0))"
BESIDE = {
    "light from the viewer's side": (
        "translucent_bsdf", "translucent_bsdf", "mx_environment_irradiance(N)",
        "mx_environment_irradiance(-N)", "surroundings", "on the other side of the surface",
    ),
    "radius ignored": (
        "subsurface_bsdf", "subsurface_bsdf", BLUR,
        "curvature * vec3(0.5) * step(0.0, radius.x + 1.0)", "sphere",
        "best match: the profile of a mean free path of 0.5, whatever the radius",
    ),
    "sine of a cone to the seventh power": (
        "conical_edf", "conical_edf", "w / 42.0 * tail", "w / 42.0", "exitance",
        "correct except for",
    ),
    "far profile at half of its reach": (
        "subsurface_bsdf", "subsurface_blur", "(1.0 + t * t)", "(2.0 * t + t * t)", "sphere",
        "best match: a far exponential of 1.5 mean free paths instead of 3",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BESIDE)
def test_a_wrong_line_of_another_node_fails_the_check_meant_for_it(gl, tmp_path, name):
    title, file, text, other, key, words = BESIDE[name]
    [subject] = [each for each in PBR_SUBJECTS if each.title == title]
    probe = probe_type_of(subject, PairProbe)
    for library, verdict in (
        ("eonlib", PASSED),
        (wrong_eonlib_node(tmp_path, file, text, other), FAILED),
    ):
        [result] = judge_subject(
            probe(gl, subject, library), [row for row in CHECKS if row.key == key]
        )
        assert result.verdict == verdict and result.control.caught
    assert words in result.diagnosis


def judged(host, library, subject, key):
    """The result of one check."""
    (row,) = [row for row in CHECKS if row.key == key]
    (result,) = judge_subject(PairProbe(host, subject, library), [row])
    return result
