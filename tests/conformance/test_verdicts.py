# SPDX-License-Identifier: Apache-2.0
"""Every node on gl: eonlib passes, and stock MaterialX fails where its pages say and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.results import (
    DIFFERS,
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    Result,
    known_issues,
)
from mxeon.conformance.results.known_issues import ISSUES, with_pages
from mxeon.conformance.results.known_issues import STOCK as STOCK_LIBRARY
from tests.support.sharing import DOCUMENTS

EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
QON = "oren_nayar_diffuse_bsdf, energy_compensation false"
SHEEN = "sheen_bsdf, mode conty_kulla"

HALF = "compensation with F at the half vector and MaterialX's fit of E_ss (rms "
VIEW = "compensation with F at the view direction and MaterialX's fit of E_ss (rms "
OPEN = {"value": HALF, "integral": HALF, "shape": HALF, "environment": VIEW}  # they differ
G_1 = "anisotropic visible normals are weighted by G_1 at the mean alpha"
UNTINTED = "MaterialX's fit of its albedo without a tint (rms "
AVERAGED = "MaterialX's fit of its albedo, averaged over the channels (rms "
CLAMPED = "EON with clamped dot(wo, wi)"
AWAY = "all where the normal faces away from the viewer"
UNCOLORED = "its albedo without the color (rms "
FIT = "MaterialX's fit of its albedo (rms "
NAN = "NaN or infinity"
OPPOSITE = f"{NAN} with the light opposite the view (L = -V)"
UNSHADOWED = "the mean of 1 - F over the visible normals, divided by G_1 of the view"
UNSCALED = "the throughput of the lobe before it is scaled"
ENDED = "a sum whose throughput is clamped at 0"
BLUR = "MaterialX's blur along a circle of radius "
CHOICES = "MaterialX's matrix, orders and mixed channels"
SUBSTRATE = "half of the substrate's reflectance, and MaterialX's choices"
BARE = "the bare lobe's fit, and the film in the compensation"
AVERAGE = "the compensation uses F at the half vector instead of its average"
LOBES = "see the checks of each lobe and of `layer`"
ABSENT = (
    "conical_edf", "absorption_vdf", "measured_edf", "mix, VDF", "add, VDF", "multiply, VDF, in2 float",
    "multiply, VDF, in2 color3",
)  # fmt: skip


def film(choices):
    """What a film is named by, whose curve and compensation are these."""
    return {
        **dict.fromkeys(
            ("value", "film_curve", "film_orders"), f"{choices}, with MaterialX's compensation"
        ),
        "film_limit": choices,
        **dict.fromkeys(
            ("environment", "film_visible", "film_glossy"),
            f"{choices}, under an environment",
        ),
        **dict.fromkeys(("film_average", "film_smooth"), AVERAGE),
    }


HIDING = {"throughput": "throughput 0 with a weight other than 1 (branches: direct, "}
SURFACE = dict.fromkeys(
    ("lobes_albedo", "lobes_mean", "lobes_furnace", "lobes_energy", "glass"), LOBES
)
SURFACE |= {"lobes": "no single lobe explains it"}
FILMS = {"lobes_film": LOBES}
SPHERE = {
    "states": "all with a surface that bends: a sphere"
}  # Zeltner's lobe, seen along the normal
PASSED_THROUGH = {"transmitted": UNSHADOWED, "transmitted_finite": NAN}
# By title, what does not pass with stock MaterialX, and words of each diagnosis.
STOCK = {
    EON: {"value": CLAMPED, "integral": CLAMPED, "environment": "", **HIDING},
    QON: {"environment": "QON with MaterialX's fit of its albedo", **HIDING},
    f"{EON}, mdl": {"closure": "FON + white lobe"},
    "open_pbr_surface": {"lobe": CLAMPED},
    "open_pbr_surface, thin-walled": {"lobe": "QON tinted twice"},
    "plaster.mtlx: ochre_plaster": {"picture": "% of white too bright in light from behind"},
    "openpbr_rough_base.mtlx: concrete": {"picture": "% of white too bright in light from behind"},
    "burley_diffuse_bsdf": {"environment": FIT, **HIDING},
    "translucent_bsdf": {"frame": AWAY, "surroundings": AWAY, **HIDING},
    SHEEN: {
        "value": "not accurate enough", "environment": FIT, "transmission": "all light passes (rms 0)",
        **dict.fromkeys(("layering", "layer"), "MaterialX's fit of its albedo without the color (rms "),
    },
    "sheen_bsdf, mode zeltner": {
        "value": "all with dot(N, V) rounded above 1",
        "transmission": "all light passes (rms 0)", **dict.fromkeys(("layering", "layer"), UNCOLORED), **SPHERE,
    },
    **dict.fromkeys(("layer", "mix", "add"), SPHERE),
    "dielectric_bsdf, scatter_mode R": {
        **OPEN, **dict.fromkeys(("layering", "transmission", "layer", "denser"), UNTINTED),
        "finite": NAN, "lossless": HALF, "anisotropic_albedo": G_1,
    },
    "conductor_bsdf": {
        **OPEN, **dict.fromkeys(("lossless", "energy"), HALF), "anisotropic_albedo": G_1, "finite": NAN, **HIDING,
    },
    "generalized_schlick_bsdf, scatter_mode R": {
        **OPEN, **dict.fromkeys(("layering", "transmission", "layer", "dip"), AVERAGED),
        **dict.fromkeys(("lossless", "energy"), HALF), "anisotropic_albedo": G_1, "finite": OPPOSITE,
    },
    "multiply, in2 float": {"combined_throughput": UNSCALED, **SPHERE},
    "multiply, in2 color3": {"combined_throughput": UNSCALED, **SPHERE},
    "multiply, of a sum": {"combined_throughput": UNSCALED, **SPHERE},
    "mix, of a sum": {"combined_throughput": ENDED, **SPHERE},
    "mix, of a layer under a sum": {"combined_throughput": ENDED, **SPHERE},
    "layer, under a mix of a sum": {
        "combination": ENDED, "combined_throughput": ENDED, "combined_albedo": "", **SPHERE,
    },
    "layer, under connected masks": {
        "combination": "opaque lobes that hide their base at any weight", "combined_albedo": "",
        "combined_throughput": "opaque lobes that hide their base at any weight",
        "inputs": "inputs without effect: base/roughness", **SPHERE,
    },
    # Stock's sheen passes light by its albedo without the color.
    "layer, under a colored sum": dict.fromkeys(
        ("combination", "combined_albedo", "combined_throughput"), ""
    ) | SPHERE,
    "chiang_hair_bsdf": {
        **dict.fromkeys(("value", "black", "finite", "integral", "low_index"), NAN),
        "environment": "the closest is a GGX lobe of the mean roughness and tint, without absorption",
        "each_lobe": "best match: N of TRRT+ pi/2 instead of 1/(2 pi) (rms ",
        "narrow_lobes": "best match: I_0 from ten terms, and half a term of its logarithm (rms ",
        "tilted_lobes": f"{NAN} with a tilted cuticle",
        "wide_lobes": "best match: roughness clamped to [0.001, 1] (rms ",
        "straight_views": "", "surroundings": "",
    },
    **{title: {"implemented": f"glsl has no implementation of {title}"} for title in ABSENT},
    "anisotropic_vdf": {
        "inputs": "inputs without effect: scattering",
        "transmittance": "best match: absorption alone (rms ",
    },
    "surface, an EDF alone": {"opacity": "the opacity is ignored"},
    **{
        f"{node}_bsdf, scatter_mode {mode}": PASSED_THROUGH
        | ({"clear": UNSHADOWED} if mode == "RT" else {})
        | ({"critical": NAN} if node == "generalized_schlick" else {})
        for node in ("dielectric", "generalized_schlick") for mode in ("T", "RT")
    },
    "subsurface_bsdf": {
        **dict.fromkeys(("value", "integral", "energy"), f"{BLUR}100"),
        **dict.fromkeys(("sphere", "sphere_mean"), f"{BLUR}1 "), **HIDING,
    },
    "dielectric_bsdf, thin film": film(CHOICES) | {"layering": f"{CHOICES}: {BARE}"},
    "conductor_bsdf, thin film": film(CHOICES),
    "generalized_schlick_bsdf, thin film": film(SUBSTRATE) | {"layering": f"{SUBSTRATE}: {BARE}"},
    "blackbody": {"output": "Kang's cubic, extrapolated below 1667 K"},
    "deon_hair_absorption_from_melanin": {"output_finite": "outputs are not finite"},
    **{
        f"{node}, every lobe": SURFACE | FILMS
        for node in ("standard_surface", "open_pbr_surface", "gltf_pbr")
    },
    "UsdPreviewSurface, every lobe": SURFACE,
}  # fmt: skip
# Where the specification leaves a choice, a permitted function differs.
FREE = {
    *((title, key) for title in STOCK if "value" in STOCK[title] for key in OPEN if STOCK[title].get(key) == OPEN[key]),
    *((title, key) for title in ("dielectric_bsdf, thin film", "conductor_bsdf, thin film") for key in film("")),
    *(("generalized_schlick_bsdf, thin film", key) for key in ("film_average", "film_smooth")),
    *((title, "combined_throughput") for title in STOCK if title.startswith("multiply, ")),
}  # fmt: skip


def test_eonlib_passes_every_check_that_stock_is_asked_too(run, stock):
    assert {each.verdict for each in run.results} == {PASSED} and not run.errors
    # No library of ours repairs a surface's opacity.
    assert {e.check for e in stock.results} - {e.check for e in run.results} == {"opacity"}
    assert len(run.results) > 400


def test_stock_materialx_fails_where_its_pages_say_and_nowhere_else(stock):
    found = {
        (e.subject, e.check): e.verdict for e in stock.results if e.verdict not in (PASSED, NOT_RUN)
    }
    rows = [(title, check) for title, checks in STOCK.items() for check in checks]
    assert found == {row: DIFFERS if row in FREE else FAILED for row in rows}
    # What is wrong inside its inputs' ranges is not asked outside.
    not_run = {e.subject for e in stock.results if e.verdict == NOT_RUN and e.check != "domain"}
    assert not_run < {*ABSENT}


@pytest.mark.parametrize("title", STOCK)
def test_the_diagnosis_of_stock_materialx_names_the_defect(stock, title):
    for each in stock.results:
        if each.subject == title:
            assert STOCK[title].get(each.check, "") in each.diagnosis


def test_what_stock_materialx_has_right_passes(stock):
    passed = {(each.check, each.subject) for each in stock.results if each.verdict == PASSED}
    right = {("lobe", name) for name in ("standard_surface", "UsdPreviewSurface", "gltf_pbr")}
    assert passed >= right | {("value", QON), ("black", EON), ("furnace", EON)}
    read = {each.check for each in stock.results if each.host == "source"}
    assert read == {"definition", "closure", "source"}


def test_every_control_is_caught(run, stock):
    results = [each for each in (*run.results, *stock.results) if each.verdict != NOT_RUN]
    assert all(each.control and each.control.caught for each in results)


@pytest.mark.parametrize("title", [title for title in STOCK if "." not in title])
def test_the_ledger_has_each_departure_of_stock_and_shows_no_other(title):
    host = "source" if "closure" in STOCK[title] else "gl"
    issues = [each for each in ISSUES if each.host == host and each.library == STOCK_LIBRARY]
    shown = {check for issue in issues for check, subject in issue.rows if subject == title}
    implied = {check for issue in issues for check, subject in issue.implied if subject == title}
    assert shown <= {*STOCK[title]} <= shown | implied


def test_a_defect_that_was_repaired_upstream_is_said_to_be_once_all_its_rows_pass(stock):
    def noted(*repaired):
        results = [
            replace(each, verdict=PASSED) if each.check in repaired else each
            for each in stock.results
        ]
        return dict(map(reversed, known_issues.repaired(results, {"MaterialX": "2.0"})))

    page = "docs/upstream/genglsl_clamped_dot.md"
    assert noted() == {}
    assert page not in noted("value", "integral")
    assert noted("value", "integral", "lobe")[page].startswith("repaired in MaterialX 2.0")


CLAMPED_MODEL = f"best match: {CLAMPED} (rms 0.001), then Lambert (0.2)"
FITTED = f"best match: {FIT}9e-09), then Conty-Kulla sheen (0.01)"
OTHER = "best match: Lambert (rms 0.001), then EON (0.2)"
COSINE = "fault: the cosine of the light is missing (rms 1e-08)"
CHOICE = "genglsl_microfacet_compensation"


@pytest.mark.parametrize(
    "check, subject, host, library, verdict, error, diagnosis, pages",
    [
        # A page explains an error of its size and its model.
        ("value", EON, "gl", "stock", FAILED, 0.369, CLAMPED_MODEL, {"genglsl_clamped_dot"}),
        ("value", EON, "gl", "stock", FAILED, 3.69, CLAMPED_MODEL, set()),
        ("value", EON, "gl", "stock", FAILED, 0.3, OTHER, set()),
        ("value", EON, "gl", "stock", FAILED, 0.3, COSINE, set()),
        ("environment", SHEEN, "gl", "stock", FAILED, 0.0889, FITTED, {"genglsl_conty_kulla_fit"}),
        ("environment", SHEEN, "gl", "stock", FAILED, 1e7, FITTED, set()),
        ("environment", SHEEN, "gl", "stock", FAILED, 0.05, "no known model matches", set()),
        # What follows from a defect of stock refers to its page.
        ("inputs", QON, "cycles", "stock", FAILED, 0.1, "", {"cycles_rho_cubed"}),
        ("inputs", QON, "cycles", "eonlib", FAILED, 0.1, "", set()),
        # The page of what the text leaves open explains no failure alone.
        ("value", "conductor_bsdf", "wgsl", "stock", DIFFERS, 0.1, "", {CHOICE}),
        ("value", "conductor_bsdf", "wgsl", "stock", FAILED, 0.1, "", set()),
        # A failure that no text can avoid has its page with each library.
        ("inputs", "conductor_bsdf", "osl", "stock", FAILED, 1.0, "", {"genosl_dropped_retroreflection"}),
        ("inputs", "conductor_bsdf", "osl", "eonlib", FAILED, 1.0, "", {"genosl_dropped_retroreflection"}),
        ("value", "sheen_bsdf, mode zeltner", "osl", "stock", FAILED, 1.0, "", {"genosl_dropped_mode"}),
        ("value", "sheen_bsdf, mode zeltner", "osl", "eonlib", FAILED, 1.0, "", set()),
    ],
)  # fmt: skip
def test_a_failure_has_the_pages_that_explain_it(
    check, subject, host, library, verdict, error, diagnosis, pages
):
    result = Result(
        check, "", subject, host, library, verdict, error, "", 1e-6, diagnosis=diagnosis
    )
    assert {*with_pages(result).pages} == pages


def test_what_is_left_of_a_mended_defect_has_not_its_page():
    near = {"energy-preserving Oren-Nayar (EON)": 1e-6, CLAMPED: 0.02}
    place = ("value", "", EON, "gl", "stock", FAILED)
    left = (Result(*place, each, "", 1e-6, distances=near) for each in (1e-4, 0.3))
    assert [with_pages(each).pages for each in left] == [(), ("genglsl_clamped_dot",)]


# --- pictures -----------------------------------------------------------------------------------


def test_pictures_come_with_the_reference_where_there_is_one(run):
    known = {picture.document: picture.reference is not None for picture in run.pictures}
    names = {path.name for path in DOCUMENTS["eonlib"]}
    assert known == dict.fromkeys((*names, PORTRAIT), True) and len(names) > 15


def test_a_portrait_of_each_diffuse_node_is_its_model(run):
    found = {(each.element, each.scene): each for each in run.pictures if each.document == PORTRAIT}
    assert {*found} == {
        (title, scene) for title in (EON, QON, "eon_diffuse_bsdf") for scene in ("side", "back")
    }
    for each in found.values():
        assert np.abs(each.image - each.reference).max() <= 2e-6 < 0.02 < each.reference.max()


def test_a_curve_follows_its_closed_form(run):
    assert {curve.subject for curve in run.curves} == {EON, QON, "eon_diffuse_bsdf"}
    for curve in run.curves:
        assert np.abs(curve.measured - curve.expected).max() <= 2e-6
