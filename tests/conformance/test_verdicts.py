# SPDX-License-Identifier: Apache-2.0
"""On the host gl, eonlib passes all checks. Stock MaterialX fails as docs/upstream states."""

from dataclasses import astuple, replace
from itertools import product
from xml.etree import ElementTree

import numpy as np
import pytest

from mxeon import check
from mxeon.conformance import words
from mxeon.conformance.results import (
    DIFFERS,
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    Diagnosis,
    Result,
    node_of,
)
from mxeon.conformance.results.known_issues import issues, with_pages
from mxeon.conformance.specs import ALL
from mxeon.hosts import HOSTS
from mxeon.report import to_json
from mxeon.report.diff import compare, read_results
from mxeon.report.junit import to_junit
from mxeon.survey.field import read_field
from tests.support.plans import keep
from tests.support.results import caused
from tests.support.sharing import DOCUMENTS, DRAWN
from tests.support.verdicts import has

EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
QON = "oren_nayar_diffuse_bsdf, energy_compensation false"
SHEEN = "sheen_bsdf, mode conty_kulla"

HALF = ("model", "compensation with F at the half vector and MaterialX's fit of E_ss")
VIEW = ("model", "compensation with F at the view direction and MaterialX's fit of E_ss")
MEAN = ("model", "Smith at the geometric mean, and MaterialX's compensation")
# For each check, a formula that the specification permits.
OPEN = {"value": HALF, "integral": HALF, "shape": MEAN, "environment": VIEW}
CLAMPED_TITLE, FIT_TITLE = "EON with clamped dot(wo, wi)", "MaterialX's fit of its albedo"
CLAMPED, FIT = ("model", CLAMPED_TITLE), ("model", FIT_TITLE)
AVERAGED = ("model", f"{FIT_TITLE}, averaged over the channels")
AWAY, NAN = ("region", "normal_away"), ("not finite",)
ALL_LIGHT = ("model", "all light passes")
UNSHADOWED, LOBES = ("seen_over_masking",), ("sum_of_lobes",)
UNSCALED = ("model", "the throughput of the lobe before it is scaled")
ENDED = ("model", "a sum whose throughput is clamped at 0")
BLUR = "MaterialX's blur along a circle of radius {}"
CHOICES = "MaterialX's matrix, orders and mixed channels"
SUBSTRATE = "half of the substrate's reflectance, and MaterialX's choices"
BARE = "the bare lobe's fit, and the film in the compensation"
ABSENT = (
    "conical_edf", "absorption_vdf", "measured_edf", "mix, VDF", "add, VDF", "multiply, VDF, in2 float",
    "multiply, VDF, in2 color3",
)  # fmt: skip


def film(choices):
    """For each check of a thin film, the expected diagnosis. Names of models contain `choices`."""
    compensated = f"{choices}, with MaterialX's compensation"
    surroundings = "environment", "film_visible", "film_glossy"
    return {
        **dict.fromkeys(("value", "film_curve", "film_orders"), ("model", compensated)),
        "anisotropic_value": ("model", f"Smith at the geometric mean, and {compensated}"),
        "film_limit": ("model", choices),
        **dict.fromkeys(surroundings, ("model", f"{choices}, under an environment")),
        **dict.fromkeys(("film_average", "film_smooth"), ("average_at_half_vector",)),
    }


HIDING = {"throughput": ("not_zero", "throughput", 0.0, "weight_not_1", "direct")}
SUMS = ("lobes_albedo", "lobes_mean", "lobes_furnace", "lobes_energy", "glass")
SURFACE = {**dict.fromkeys(SUMS, LOBES), "lobes": ("throughput_of_lobes",)}
PASSED_THROUGH = {"transmitted": UNSHADOWED, "transmitted_finite": NAN, "methods": ()}
# For each node title, checks that stock MaterialX fails, and parts of an expected cause.
STOCK = {
    EON: {"value": CLAMPED, "integral": CLAMPED, "environment": (), **HIDING},
    QON: {"environment": ("model", "QON with MaterialX's fit of its albedo"), **HIDING},
    f"{EON}, mdl": {"closure": ("white_lobe",)},
    "open_pbr_surface": {"lobe": CLAMPED},
    "open_pbr_surface, thin-walled": {"lobe": ("model", "QON tinted twice")},
    "plaster.mtlx: ochre_plaster": {"picture": ("follows",)},
    "openpbr_rough_base.mtlx: concrete": {"picture": ("follows",)},
    "burley_diffuse_bsdf": {"environment": FIT, **HIDING},
    "translucent_bsdf": {"frame": AWAY, "surroundings": AWAY, **HIDING},
    SHEEN: {
        "value": ("accuracy",), "transmission": ALL_LIGHT, **dict.fromkeys(("environment", "layering", "layer"), FIT),
    },
    "sheen_bsdf, mode zeltner": {
        "value": ("region", "viewer_above_1"), "transmission": ALL_LIGHT,
        "states": ("a surface that bends: a sphere",),  # wrong only for a viewer along the normal
    },
    "dielectric_bsdf, scatter_mode R": {
        **OPEN, **dict.fromkeys(("layering", "transmission", "layer", "denser"), FIT),
        "finite": NAN, "lossless": HALF, "anisotropic_value": MEAN, "anisotropic_throughput": (),
    },
    "conductor_bsdf": {
        **OPEN, **dict.fromkeys(("lossless", "energy"), HALF), "finite": NAN, **HIDING,
        "anisotropic_albedo": (), "anisotropic_value": MEAN,
    },
    "generalized_schlick_bsdf, scatter_mode R": {
        **OPEN, **dict.fromkeys(("layering", "transmission", "layer", "dip"), AVERAGED), "dark": ("curve_below_0",),
        **dict.fromkeys(("lossless", "energy"), HALF), "finite": ("not finite", "opposite"),
        "anisotropic_albedo": (), "anisotropic_value": MEAN, "anisotropic_throughput": (),
    },
    "multiply, in2 float": {"combined_throughput": UNSCALED},
    "multiply, in2 color3": {"combined_throughput": UNSCALED},
    "multiply, of a sum": {"combined_throughput": UNSCALED},
    "mix, of a sum": {"combined_throughput": ENDED},
    "mix, of a layer under a sum": {"combined_throughput": ENDED},
    "layer, under a mix of a sum": {
        "combination": ENDED, "combined_throughput": ENDED, "combined_albedo": (),
    },
    "layer, under connected masks": {
        "combination": ("model", "opaque lobes that hide their base at any weight"), "combined_albedo": (),
        "combined_throughput": ("model", "opaque lobes that hide their base at any weight"),
        "inputs": ("inputs_without_effect", "base/roughness"),
    },
    "chiang_hair_bsdf": {
        **dict.fromkeys(("value", "black", "finite", "integral", "low_index"), NAN),
        "environment": ("no_model", "a GGX lobe of the mean roughness and tint, without absorption"),
        "each_lobe": ("model", "N of TRRT+ pi/2 instead of 1/(2 pi)"),
        "narrow_lobes": ("model", "I_0 from ten terms, and half a term of its logarithm"),
        "tilted_lobes": ("not finite", "cuticle_tilted"),
        "wide_lobes": ("model", "roughness clamped to [0.001, 1]"),
        "straight_views": (), "surroundings": (),
    },
    **{title: {"implemented": ("not_implemented", "glsl", title)} for title in ABSENT},
    "anisotropic_vdf": {
        "inputs": ("inputs_without_effect", "scattering"),
        "transmittance": ("model", "absorption alone"), "between": ("medium_between",),
    },
    "surface, an EDF alone": {"opacity": ("input_ignored", "opacity")},
    **{
        f"{node}_bsdf, scatter_mode {mode}": PASSED_THROUGH
        | ({"clear": UNSHADOWED} if mode == "RT" else {})
        | ({"critical": NAN, "states": ()} if node == "generalized_schlick" else {"inside": UNSHADOWED})
        for node in ("dielectric", "generalized_schlick") for mode in ("T", "RT")
    },
    "subsurface_bsdf": {
        **dict.fromkeys(("value", "integral", "energy"), ("model", BLUR.format(100))),
        **dict.fromkeys(("sphere", "sphere_mean"), ("model", BLUR.format(1))), **HIDING,
        "frame": ("direct", "beside_equal_pixels"),
    },
    "dielectric_bsdf, thin film": film(CHOICES)
    | {"layering": ("model", f"{CHOICES}: {BARE}"), "anisotropic_throughput": ()},
    "conductor_bsdf, thin film": film(CHOICES),
    "generalized_schlick_bsdf, thin film": film(SUBSTRATE)
    | {"layering": ("model", f"{SUBSTRATE}: {BARE}"), "anisotropic_throughput": ()},
    "blackbody": {"output": ("model", "Kang's cubic, extrapolated below 1667 K")},
    "deon_hair_absorption_from_melanin": {"output_finite": NAN},
    **{
        f"{node}, every lobe": SURFACE | {"lobes_film": LOBES}
        for node in ("standard_surface", "open_pbr_surface", "gltf_pbr")
    },
    "UsdPreviewSurface, every lobe": SURFACE,
}  # fmt: skip
# The verdict is "differs" if the specification permits the function that stock MaterialX uses.
FREE = {
    *((title, key) for title in STOCK if "value" in STOCK[title] for key in OPEN if STOCK[title].get(key) == OPEN[key]),
    *((title, key) for title in ("dielectric_bsdf, thin film", "conductor_bsdf, thin film") for key in film("")),
    *(("generalized_schlick_bsdf, thin film", key) for key in ("film_average", "film_smooth")),
    *((title, "combined_throughput") for title in STOCK if title.startswith(("multiply, ", "mix, of "))),
    *((f"{name}_bsdf{mode}", "anisotropic_value") for name, mode in (
        ("conductor", ""), ("dielectric", ", scatter_mode R"), ("generalized_schlick", ", scatter_mode R"))),
    ("generalized_schlick_bsdf, scatter_mode R", "dark"),
}  # fmt: skip


@pytest.mark.whole
def test_eonlib_passes_every_check(run):
    assert {each.verdict for each in run.results} == {PASSED} and not run.errors
    assert all(each.control and each.control.caught for each in run.results)
    assert len(run.results) > 400


@pytest.mark.whole
def test_eonlib_passes_every_check_of_its_text_for_path_tracers(monkeypatch):
    keep(monkeypatch, lambda task: task.check in DRAWN)
    results = check(None, ["gl"], nodes=["all"]).results
    assert {(each.check, each.verdict) for each in results} == {(each, PASSED) for each in DRAWN}
    assert all(each.control and each.control.caught for each in results)


@pytest.mark.whole
def test_stock_materialx_fails_where_its_pages_say_and_nowhere_else(stock):
    ran = [each for each in stock.results if each.verdict != NOT_RUN]
    found = {(e.subject, e.check): e.verdict for e in ran if e.verdict != PASSED}
    rows = [(title, check) for title, checks in STOCK.items() for check in checks]
    assert found == {row: DIFFERS if row in FREE else FAILED for row in rows}
    # The check `domain` is not run after an error inside the inputs' ranges. The check
    # `film_brushed` is not run if the check `film_visible` already differs.
    skipped = {(e.subject, e.check) for e in stock.results if e.verdict == NOT_RUN}
    assert {title for title, check in skipped if check not in ("domain", "film_brushed")} < {
        *ABSENT
    }
    assert all(each.control and each.control.caught for each in ran)
    assert all(np.isfinite(each.error) for each in ran if each.verdict == DIFFERS)
    assert {each.check for each in ran if each.host == "source"} == {"closure", "source"}


@pytest.mark.whole
@pytest.mark.parametrize("title", STOCK)
def test_the_diagnosis_of_stock_materialx_has_the_defect(stock, title):
    for each in stock.results:
        if each.subject == title:
            assert has(each, *STOCK[title].get(each.check, ()))


@pytest.mark.parametrize("title", [title for title in STOCK if "." not in title])
def test_the_ledger_has_each_departure_of_stock_and_shows_no_other(title):
    host = "source" if "closure" in STOCK[title] else "gl"
    known = [each for each in issues().values() if (each.host, each.library) == (host, "stock")]
    shown = {check for issue in known for check, subject in issue.rows if subject == title}
    implied = {check for issue in known for check, subject in issue.implied if subject == title}
    assert shown <= {*STOCK[title]} <= shown | implied


CLAMPED_MODEL = caused("model", CLAMPED_TITLE, distances={CLAMPED_TITLE: 0.001, "Lambert": 0.2})
FITTED = caused("model", FIT_TITLE, distances={FIT_TITLE: 9e-9, "Conty-Kulla sheen": 0.01})
OTHER = caused("model", "Lambert", distances={"Lambert": 0.001, "EON": 0.2})
COSINE, UNKNOWN = caused("fault", "cosine_missing"), caused("unknown", "no_model")
NO_CAUSE, CHOICE = Diagnosis(), "genglsl_microfacet_compensation"


@pytest.mark.parametrize(
    "check, subject, host, library, verdict, error, diagnosis, pages",
    [
        # A page on a defect explains only errors with the size and the model that the page states.
        ("value", EON, "gl", "stock", FAILED, 0.369, CLAMPED_MODEL, {"genglsl_clamped_dot"}),
        ("value", EON, "gl", "stock", FAILED, 3.69, CLAMPED_MODEL, set()),
        ("value", EON, "gl", "stock", FAILED, 0.3, OTHER, set()),
        ("value", EON, "gl", "stock", FAILED, 0.3, COSINE, set()),
        ("environment", SHEEN, "gl", "stock", FAILED, 0.0889, FITTED, {"genglsl_conty_kulla_fit"}),
        ("environment", SHEEN, "gl", "stock", FAILED, 1e7, FITTED, set()),
        ("environment", SHEEN, "gl", "stock", FAILED, 0.05, UNKNOWN, set()),
        # A page on a defect of stock MaterialX also explains other checks that the defect affects.
        ("inputs", QON, "cycles", "stock", FAILED, 0.1, NO_CAUSE, {"cycles_rho_cubed"}),
        ("inputs", QON, "cycles", "eonlib", FAILED, 0.1, NO_CAUSE, set()),
        # A page on an ambiguity of the specification explains no failed check.
        ("value", "conductor_bsdf", "wgsl", "stock", DIFFERS, 0.1, NO_CAUSE, {CHOICE}),
        ("value", "conductor_bsdf", "wgsl", "stock", FAILED, 0.1, NO_CAUSE, set()),
        # A failure that no generated shader can avoid links to its page for both libraries.
        ("inputs", "conductor_bsdf", "osl", "stock", FAILED, 1.0, NO_CAUSE, {"genosl_dropped_retroreflection"}),
        ("inputs", "conductor_bsdf", "osl", "eonlib", FAILED, 1.0, NO_CAUSE, {"genosl_dropped_retroreflection"}),
        ("value", "sheen_bsdf, mode zeltner", "osl", "stock", FAILED, 1.0, NO_CAUSE, {"genosl_dropped_mode"}),
        ("value", "sheen_bsdf, mode zeltner", "osl", "eonlib", FAILED, 1.0, NO_CAUSE, set()),
    ],
)  # fmt: skip
def test_a_failure_has_the_pages_that_explain_it(
    check, subject, host, library, verdict, error, diagnosis, pages
):
    place = check, "", subject, host, library, verdict
    result = Result(*place, error, None, 1e-6, diagnosis=diagnosis)
    assert {*with_pages(result).pages} == pages


def test_the_title_of_every_spec_begins_with_its_node():
    assert [each.title for each in ALL if node_of(each.title) != each.node] == []


def test_every_host_that_evaluates_generated_text_has_the_pages_of_gl():
    page, issue = "genglsl_clamped_dot", issues()["genglsl_clamped_dot"]
    for host in ("gl", *(row.name for row in HOSTS if row.way == "pairs")):
        result = Result(
            "value", "", EON, host, "stock", FAILED, issue.sizes["value", EON], None, 1e-6
        )
        assert with_pages(result).pages == (page,), host


@pytest.mark.whole
def test_nothing_reads_a_sentence(stock, monkeypatch, tmp_path):
    """Rewording all sentences in the results changes no verdict, page or table."""

    def decided(run):
        (tmp_path / "results.json").write_text(to_json(run))
        report = read_results(tmp_path)
        failures = ElementTree.fromstring(to_junit(run)).iter("failure")
        return (
            report.verdict,
            report.counts,
            report.elsewhere,
            [(*astuple(each.diagnosis), with_pages(each).pages) for each in report.results],
            [each.get("type") for each in failures],
            [(each.node, each.found, each.verdict) for each in read_field([tmp_path])],
        ), report

    before, with_sentences = decided(stock)
    for name in ("diagnosis", "region", "excess", "explanation", "sentence", "summary"):
        monkeypatch.setattr(words, name, lambda *_: "x")
    results = []
    for each in stock.results:
        control = each.control and replace(each.control, variant="x")
        results.append(replace(each, claim="x", derivation="x", reason="x", control=control))
    after, without = decided(replace(stock, notes=(), results=tuple(results)))
    assert after == before
    assert [each for each in compare(with_sentences, without) if each.subject] == []


def test_what_is_left_of_a_mended_defect_has_not_its_page():
    near = {"energy-preserving Oren-Nayar (EON)": 1e-6, CLAMPED_TITLE: 0.02}
    place = ("value", "", EON, "gl", "stock", FAILED)
    left = (Result(*place, each, None, 1e-6, diagnosis=Diagnosis((), near)) for each in (1e-4, 0.3))
    assert [with_pages(each).pages for each in left] == [(), ("genglsl_clamped_dot",)]


# --- pictures -----------------------------------------------------------------------------------


@pytest.mark.whole
def test_pictures_come_with_the_reference_where_there_is_one(run):
    known = {picture.document: picture.reference is not None for picture in run.pictures}
    names = {path.name for path in DOCUMENTS["eonlib"]}
    assert known == dict.fromkeys((*names, PORTRAIT), True) and len(names) > 15


@pytest.mark.whole
def test_a_portrait_of_each_diffuse_node_is_its_model(run):
    portraits = [each for each in run.pictures if each.document == PORTRAIT]
    titles = (EON, QON, "eon_diffuse_bsdf")
    assert {(e.element, e.scene) for e in portraits} == {*product(titles, ("side", "back"))}
    for each in portraits:
        assert np.abs(each.image - each.reference).max() <= 2e-6 < 0.02 < each.reference.max()
