# SPDX-License-Identifier: Apache-2.0
"""The other BSDF nodes of pbrlib: verdicts on stock MaterialX, and on shaders with one wrong line."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.accuracy.bsdf import LEAST_ESS, QUADRATURES, SEEN_ESS
from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.probes.families import probe_type_of
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.results import DIFFERS, FAILED, PASSED
from mxeon.models.microfacet.ggx_albedo import ggx_albedo_dir
from mxeon.models.microfacet.ggx_formulas import half_vector, ndf, visibility
from tests.support.checks import undiagnosed
from tests.support.wrong_libraries import wrong_copy, wrong_stock_node

SUBJECTS = {subject.model: subject for subject in BSDFS}
ROWS = {check.key: check for check in CHECKS}
# Few pairs: what is wrong here is wrong for most.
FEWER = {"pairs": 1 << 9, "few": 1 << 8, "albedos": 1 << 5, "materials": 32, "mirrored": 1 << 9}
ALPHAS = np.linspace(0.02, 1.0, 50)
MICROFACETS = ("dielectric", "conductor", "schlick")

# What fails with stock MaterialX, and words of each diagnosis; every other check passes.
HALF = "compensation with F at the half vector and MaterialX's fit of E_ss (rms "
VIEW = "compensation with F at the view direction and MaterialX's fit of E_ss (rms "
G_1 = "anisotropic visible normals are weighted by G_1 at the mean alpha"
OPEN = {"value": HALF, "integral": HALF, "shape": HALF, "environment": VIEW}
UNTINTED = "MaterialX's fit of its albedo without a tint (rms "
AVERAGED = "MaterialX's fit of its albedo, averaged over the channels (rms "
STOCK = {
    "burley": {"environment": "MaterialX's fit of its albedo (rms "},
    "translucent": {
        "frame": "all where the normal faces away from the viewer",
        "surroundings": "all where the normal faces away from the viewer",
    },
    "conty_kulla": {
        "value": "not accurate enough",
        "environment": "MaterialX's fit of its albedo (rms ",
        "layering": "MaterialX's fit of its albedo without the color (rms ",
        "transmission": "all light passes (rms 0)",
        "layer": "MaterialX's fit of its albedo without the color (rms ",
    },
    "zeltner": {
        "value": "all with dot(N, V) rounded above 1",
        "layering": "its albedo without the color (rms ",
        "transmission": "all light passes (rms 0)",
        "layer": "its albedo without the color (rms ",
    },
    "dielectric": {
        "finite": "with an index of refraction of 0",
        "layering": UNTINTED,
        "transmission": UNTINTED,
        "layer": UNTINTED,
        "denser": UNTINTED,
        "lossless": HALF,
        "anisotropic_albedo": G_1,
    },
    "conductor": {"lossless": HALF, "anisotropic_albedo": G_1},
    "schlick": {
        "layering": AVERAGED,
        "transmission": AVERAGED,
        "layer": AVERAGED,
        "dip": AVERAGED,
        "lossless": HALF,
        "anisotropic_albedo": "",
    },
}

DIELECTRIC, CONDUCTOR, SCHLICK, SHEEN, BURLEY, TRANSLUCENT = (
    f"mx_{name}_bsdf.glsl"
    for name in (
        "dielectric",
        "conductor",
        "generalized_schlick",
        "sheen",
        "burley_diffuse",
        "translucent",
    )
)
COMPENSATION = "mx_ggx_energy_compensation(NdotV, avgAlpha, F)"
SMITH = "mx_ggx_smith_G2(NdotL, NdotV, avgAlpha)"
SEPARABLE = "mx_ggx_smith_G1(NdotL, avgAlpha) * mx_ggx_smith_G1(NdotV, avgAlpha)"
ALPHA = "clamp(roughness, M_FLOAT_EPS, 1.0)"
TANGENT = "X = normalize(X - dot(X, N) * N);"
BESIDE = ", and MaterialX's compensation (rms "

# By name: model, file, text, the text in its place, key of the check and words of the diagnosis.
WRONG = {
    "no factor 4": (
        "dielectric", DIELECTRIC, "(4.0 * NdotV)", "NdotV", "value",
        f"no factor 4 in the denominator{BESIDE}",
    ),
    "alpha squared": (
        "schlick", SCHLICK, ALPHA, ALPHA.replace("roughness", "roughness * roughness"), "shape",
        f"roughness squared once more{BESIDE}",
    ),
    "separable Smith": (
        "dielectric", DIELECTRIC, SMITH, SEPARABLE, "shape",
        f"masking and shadowing uncorrelated{BESIDE}",
    ),
    "F0 in the compensation": (
        "dielectric", DIELECTRIC, COMPENSATION, COMPENSATION.replace("F)", "vec3(F0))"), "value",
        "compensation with F along the normal and MaterialX's fit of E_ss (rms ",
    ),
    "no compensation": (
        "schlick", SCHLICK, COMPENSATION, "vec3(1.0)", "lossless",
        "no energy compensation (rms ",
    ),
    "tangent": (
        "schlick", SCHLICK, TANGENT, "X = normalize(cross(vec3(0.0, 1.0, 0.0), N));", "anisotropy",
        "tangent is ignored",
    ),
    "tangent in turned frames": (
        "dielectric", DIELECTRIC, TANGENT, "X = normalize(cross(vec3(0.0, 1.0, 0.0), N));", "frame",
        "branch direct: tangent is ignored",
    ),
    "retroreflection": (
        "conductor", CONDUCTOR, "V = retroreflective", "V = false", "retroreflection",
        "retroreflective is ignored",
    ),
    "thin film": (
        "dielectric", DIELECTRIC, "(ior, thinfilm_thickness, ", "(ior, 0.0, ", "inputs",
        "inputs without effect: thinfilm_thickness, thinfilm_ior",
    ),
    "albedo of 1 in place of its fit": (
        "schlick", SCHLICK, "dirAlbedo = mx_ggx_dir_albedo", "dirAlbedo = 1.0 + 0.0 * mx_ggx_dir_albedo",
        "layering", "",
    ),
    "all light through a base": (
        "dielectric", DIELECTRIC, "1.0 - dirAlbedo * weight;", "vec3(1.0);", "transmission",
        "all light passes (rms 0)",
    ),
    "light through diffuse": (
        "burley", BURLEY, "bsdf.throughput = vec3(0.0);", "bsdf.throughput = vec3(0.5);",
        "throughput", "throughput 0.5 (branches: direct, environment, transmission, emission)",
    ),
    "unclamped cosine": (
        "schlick", SCHLICK, "clamp(dot(N, V), M_FLOAT_EPS, 1.0)", "dot(N, V)", "finite",
        "NaN or infinity with the viewer on the horizon",
    ),
    "sheen of the other mode": (
        "conty_kulla", SHEEN, "mode == 0", "mode != 0", "environment",
        "best match: Zeltner sheen (rms ",
    ),
    "Conty-Kulla in its place": (
        "zeltner", SHEEN, "mode == 0", "mode != 0", "environment",
        "best match: Conty-Kulla sheen (rms ",
    ),
    "sheen without a least roughness": (
        "zeltner", SHEEN, "roughness = clamp(roughness, 0.01, 1.0);", "", "finite",
        "NaN or infinity with roughness 0",
    ),
    "sheen that takes all": (
        "zeltner", SHEEN, "1.0 - dirAlbedo * weight", "0.0", "layer", "",
    ),
    "no retro-reflection": (
        "burley", BURLEY, "LdotH, roughness)", "LdotH, 0.0)", "value",
        "Burley diffuse of roughness 0, without retro-reflection (rms ",
    ),
    "Lambert": (
        "burley", BURLEY, "bsdf.response *= mx", "bsdf.response *= 1.0 + 0.0 * mx", "value",
        "best match: Lambert (rms ",
    ),
    "one cosine twice": (
        "burley", BURLEY, "mx_burley_diffuse(NdotV, NdotL", "mx_burley_diffuse(NdotV, NdotV",
        "reciprocity", "correct except for ",
    ),
    "light of its own": (
        "burley", BURLEY, "* M_PI_INV;", "* M_PI_INV + 0.001;", "black", "",
    ),
    "too dark": (
        "burley", BURLEY, "bsdf.response *= mx", "bsdf.response *= 0.9 * mx", "integral",
        "fault: every value is 0.9 times the right one (rms ",
    ),
    "too bright": (
        "burley", BURLEY, "bsdf.response *= mx", "bsdf.response *= 1.5 * mx", "energy",
        "fault: every value is 1.5 times the right one (rms ",
    ),
    "normal": (
        "burley", BURLEY, "(N, V);", "(vec3(0.0, 0.0, 1.0), V);", "frame",
        "branch direct: the node's normal is ignored; the surface's is used instead",
    ),
    "occlusion": (
        "burley", BURLEY, "color * closureData.occlusion", "color", "value",
        "fault: the occlusion is ignored (rms ",
    ),
    "weight": (
        "translucent", TRANSLUCENT, "color * weight * NdotL", "color * NdotL", "value",
        "fault: the weight is ignored but for 0 and below (rms ",
    ),
    "a transmission that reflects": (
        "translucent", TRANSLUCENT, "N = -N;", "", "value",
        "best match: a reflection instead (rms ",
    ),
    "color": (
        "translucent", TRANSLUCENT, "Li * color", "Li * color.bgr", "environment",
        "fault: the color channels are exchanged: they arrive as blue, green, red (rms ",
    ),
}  # fmt: skip


# --- stock MaterialX ----------------------------------------------------------------------------


@pytest.mark.parametrize("model", SUBJECTS)
def test_stock_materialx_has_its_known_departures_and_no_others(gl, model):
    results = judged(gl, model, "stock")
    open_rows = OPEN if model in MICROFACETS else {}
    verdicts = {**dict.fromkeys(open_rows, DIFFERS), **dict.fromkeys(STOCK[model], FAILED)}
    words = {**open_rows, **STOCK[model]}
    assert {result.check: result.verdict for result in results} == {
        result.check: verdicts.get(result.check, PASSED) for result in results
    }
    assert all(words.get(result.check, "") in result.diagnosis for result in results)
    assert all(result.control.caught for result in results)


# --- wrong shaders ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_of_a_bsdf_fails_a_check_and_is_named(gl, tmp_path, name):
    model, file, text, other, key, words = WRONG[name]
    (result,) = judged(gl, model, wrong_stock_node(tmp_path, file, text, other), key)
    assert result.verdict == FAILED and result.control.caught
    assert words in result.diagnosis


# Wrong lines of `microfacet_lobe` in GLSL: text, the text in its place, and key of the check.
LOBE = "genglsl/lib/microfacet_lobe.glsl"
WRONG_LOBE = {
    "no retroreflection": ("mirrored ? reflect(-closureData.V, N) :", "", "retroreflection"),
    "normal not turned": ("mx_forward_facing_normal(N, lobe.wo)", "N", "frame"),
    "cosine of the light": ("clamp(dot(lobe.N, lobe.wo),", "clamp(dot(lobe.N, lobe.wi),", "value"),
    "exchanged roughnesses": (
        "clamp(roughness, M_FLOAT_EPS, 1.0)",
        "clamp(roughness.yx, M_FLOAT_EPS, 1.0)",
        "value",
    ),
}


@pytest.mark.parametrize("name", WRONG_LOBE)
def test_a_wrong_line_of_eonlibs_microfacet_lobe_is_seen(gl, tmp_path, name):
    text, other, key = WRONG_LOBE[name]
    library = wrong_copy(tmp_path, text, other, LOBE)
    result = judge_check(undiagnosed(ROWS[key]), probe_of(SUBJECTS["dielectric"], gl, library))
    assert result.verdict == FAILED and result.control.caught


def test_every_check_of_the_nodes_has_a_shader_that_it_fails():
    failing = {key for rows in STOCK.values() for key in rows}
    failing |= {key for *_, key, _ in WRONG.values()}
    assert failing == {
        row.key for row in CHECKS if any(map(set(SUBJECTS).__contains__, row.models))
    }


def probe_of(subject, host=None, library="stock"):
    """The probe of a node, of few pairs."""
    probe = probe_type_of(subject, PairProbe)
    return probe(host, subject, library, replace(probe.usual, **FEWER))


def judged(host, model, library, *keys):
    """Results of the checks of a node, or of those of these keys."""
    subject = SUBJECTS[model]
    probe = probe_of(subject, host, library)
    rows = [ROWS[key] for key in keys] or CHECKS
    return [judge_check(row, probe) for row in rows if applies(row, subject, probe.kind, host.name)]


# --- probes -------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", ["burley", "translucent", "conty_kulla", "zeltner", "schlick"])
def test_the_quadrature_of_the_equations_is_as_exact_as_its_probe_says(model):
    probe = probe_of(SUBJECTS[model])
    batch, weights = probe.integrated
    values = probe.subject.expected(batch).reshape(*weights.shape, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    assert np.abs(albedo - probe.integrals).max() <= QUADRATURES[probe.kind]


def test_the_least_albedo_of_microfacets_is_that_of_the_roughest_along_the_normal():
    assert np.isclose(ggx_albedo_dir(1.0, 1.0), LEAST_ESS, rtol=1e-10)
    mu, alpha = np.meshgrid(np.linspace(1e-4, 1.0, 12), np.linspace(1e-3, 1.0, 12))
    assert ggx_albedo_dir(mu, alpha).min() >= LEAST_ESS * (1.0 - 1e-10)


def test_values_count_with_the_largest_share_that_the_tolerance_has():
    mu, alpha = (each.ravel() for each in np.meshgrid(np.linspace(0.05, 1.0, 20), ALPHAS))
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu])[..., np.newaxis]
    cosine = np.linspace(0.0, 1.0, 201)
    wi = np.stack([-np.sqrt(1.0 - cosine * cosine), 0.0 * cosine, cosine])[:, np.newaxis]
    facets = ndf(half_vector(wo, wi)[0], (alpha[:, np.newaxis],) * 2)
    values = np.pi * facets * visibility(mu[:, np.newaxis], cosine, alpha[:, np.newaxis]) * cosine
    share = np.minimum(values.max(axis=1), 1.0) / ggx_albedo_dir(mu, alpha)
    assert SEEN_ESS - 0.02 < share.max() <= SEEN_ESS
