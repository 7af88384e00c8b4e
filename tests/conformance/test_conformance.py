# SPDX-License-Identifier: Apache-2.0
"""The conformance suite judged: what passes, what it must catch, and what it calls by name."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.checks.application import applies, judge_subject
from mxeon.conformance.checks.controls import Mistake
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.diagnosis.comparisons import VALUE
from mxeon.conformance.functions.shader_functions import (
    FUNCTION_CHECKS,
    FunctionProbe,
    judge_functions,
)
from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.diffuse import SUBJECTS, SURFACES
from mxeon.conformance.probes.families import (
    COMMON_SUBJECTS,
    PBR_SUBJECTS,
)
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, PORTRAIT, SHADER_FUNCTIONS
from mxeon.conformance.run import check, judge, plan
from mxeon.conformance.run.survey import survey_documents
from mxeon.conformance.samples.batch import Batch
from mxeon.conformance.samples.uneven_environment import sky
from mxeon.conformance.text import check_texts
from mxeon.conformance.text.checks import TEXT_ONLY
from mxeon.errors import InputError, NotRun, ShaderError
from mxeon.hosts import HOSTS
from mxeon.hosts.base import Host, Identity
from mxeon.jobs import dask
from mxeon.models import table as reference
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.nodes import INVERSIONS, connection_text, document_text, node_text
from tests.conformance.conftest import EXAMPLES
from tests.support.plans import keep_checks

EON, QON, NODE = SUBJECTS
VALUE_CHECKS = ("value", "albedo")


class ModelHost(Host):
    """A host that is one row of the reference, whatever shader it is given."""

    name, target = "gl", "glsl"

    def __init__(self, row, change=lambda wo, wi, inputs: (wo, wi, inputs)):
        self._row, self._change = row, change

    def identity(self):
        return Identity(self.name, "1", "device")

    def evaluate(self, shader, wo, wi, inputs, branch, *, output="response", irradiance=None):
        if output == "throughput":
            return np.zeros(wo.shape)
        wo, wi, inputs = self._change(wo, wi, inputs)
        normal = np.broadcast_to(inputs.get("normal", (0.0, 0.0, 1.0)), wo.shape)
        normal = normal * np.where((normal * wo).sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
        roughness = np.minimum(inputs["roughness"], 1.0)
        batch = Batch(local(normal, wo), local(normal, wi), {**inputs, "roughness": roughness})
        if branch == "environment":
            return batch.albedo("eon") * (1.0 if irradiance is None else sky(normal))
        return batch.expected(self._row.name) / np.pi


def local(normal, direction):
    """Directions in frames around normals; those of +z stay as they are."""
    helper = np.where(np.abs(normal[:, :1]) < 0.5, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    tangent = helper - normal * (helper * normal).sum(axis=1, keepdims=True)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    axes = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    return (axes @ direction[:, :, np.newaxis])[:, :, 0]


def judged(host, *keys):
    """Results of the checks of these keys, or of all."""
    rows = [row for row in CHECKS if not keys or row.key in keys]
    return {each.check: each for each in judge_subject(PairProbe(host, EON, "eonlib"), rows)}


# --- the domain and the table -------------------------------------------------------------------


def test_special_pairs_are_exact():
    _, special, outside = PairProbe(None, EON, "eonlib").batches
    mu_o, mu_i = special.wo[:, 2], special.wi[:, 2]
    for exact in (
        (special.wo == special.wi).all(axis=1),
        (special.wo == special.wi * [-1.0, -1.0, 1.0]).all(axis=1),
        mu_o == 1.0,
        mu_i == 1.0,
        mu_o == 0.0,
        mu_i == 0.0,
        np.maximum(mu_o, mu_i) < 1e-6,
        special.inputs["weight"] == np.float32(1e-4),
        special.inputs["occlusion"] == 0.0,
        special.inputs["roughness"] == np.float32(1e-3),
        outside.wi[:, 2] < 0.0,
        outside.wo[:, 2] > 1.0,
        outside.wi[:, 2] > 1.0,
    ):
        assert exact.any()
    for batch in (special, outside):
        for directions in (batch.wo, batch.wi):
            assert np.array_equal(directions, directions.astype(np.float32))
            assert np.abs((directions**2).sum(axis=1) - 1.0).max() < 1e-6


# --- eonlib on OpenGL ---------------------------------------------------------------------------


def test_eonlib_passes_every_check_on_gl(run):
    wrong = [result for result in run.results if result.verdict != PASSED]
    assert not wrong and not run.errors
    subjects = (*SUBJECTS, *SURFACES, *COMMON_SUBJECTS)
    asked = {row.key for row in CHECKS for each in subjects if applies(row, each, each.kind, "gl")}
    assert {result.check for result in run.results if result.host == "gl"} >= asked | {
        row.key for row in FUNCTION_CHECKS
    }


def test_every_control_is_caught(run):
    assert all(result.control and result.control.caught for result in run.results)


def test_pictures_come_with_the_reference_where_there_is_one(run):
    known = {picture.document: picture.reference is not None for picture in run.pictures}
    assert known == {"plaster.mtlx": True, "openpbr_rough_base.mtlx": True, PORTRAIT: True}


def test_a_portrait_of_each_node_is_its_model(run):
    found = [each for each in run.pictures if each.document == PORTRAIT]
    keys = {(each.element, each.scene) for each in found}
    assert keys == {(subject.title, scene) for subject in SUBJECTS for scene in ("side", "back")}
    for each in found:
        assert np.abs(each.image - each.reference).max() <= 2e-6 < 0.02 < each.reference.max()


def test_a_curve_follows_its_closed_form(run):
    assert {curve.subject for curve in run.curves} == {subject.title for subject in SUBJECTS}
    for curve in run.curves:
        assert np.abs(curve.measured - curve.expected).max() <= 2e-6


# --- what has to be caught ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    ["lambert", "oren_nayar", "qon", "fon", "eon_clamped", "eon_rho_cubed", "fon_white_lobe"],
)
def test_a_host_with_another_model_fails_and_is_named(name):
    row = reference.model(name)
    results = judged(ModelHost(row), *VALUE_CHECKS)
    for key in VALUE_CHECKS:
        assert results[key].verdict == FAILED
        assert results[key].diagnosis.startswith(f"best match: {row.title} (rms ")
        assert results[key].worst


@pytest.mark.parametrize(
    "key, change",
    [
        ("reciprocity", lambda wo, wi, inputs: (wo, wi[:, [1, 0, 2]] * [-1, 1, 1], inputs)),
        ("value", lambda wo, wi, inputs: (wi, wo, inputs)),
        ("value", lambda wo, wi, inputs: (wo, wi, {**inputs, "roughness": 0.0})),
        ("lambert", lambda wo, wi, inputs: (wo, wi, {**inputs, "roughness": 0.5})),
        ("inputs", lambda wo, wi, inputs: (wo, wi, {**inputs, "color": (0.5, 0.5, 0.5)})),
        ("black", lambda wo, wi, inputs: (wo, wi, {**inputs, "color": (0.5, 0.5, 0.5)})),
    ],
    ids=["azimuth", "swapped", "smooth", "rough", "grey", "not black"],
)
def test_a_defect_fails_the_check_made_for_it(key, change):
    assert judged(ModelHost(reference.model("eon"), change), key)[key].verdict == FAILED


@pytest.mark.parametrize("shown", [EON, QON], ids=lambda each: each.model)
@pytest.mark.parametrize("subject", [EON, QON], ids=lambda each: each.model)
def test_a_flag_without_effect_is_charged_to_the_mode_that_is_wrong(shown, subject):
    probe = PairProbe(ModelHost(reference.model(shown.model)), subject, "eonlib")
    (result,) = judge_subject(probe, [row for row in CHECKS if row.key == "flag"])
    assert result.verdict == (PASSED if shown is subject else FAILED)
    assert result.control.caught


def test_a_host_that_gives_no_numbers_fails():
    host = ModelHost(reference.model("eon"))
    host.evaluate = lambda shader, wo, *_, **options: np.full(wo.shape, np.nan)
    result = judged(host)["value"]
    assert result.verdict == FAILED and result.error == np.inf
    assert "NaN or infinity" in result.diagnosis


def test_a_control_that_passes_makes_the_verdict_failed():
    none = Mistake("nothing is wrong", lambda probe: probe)
    blind = [replace(row, control=none) for row in CHECKS if row.key == "reciprocity"]
    probe = PairProbe(ModelHost(reference.model("eon")), EON, "eonlib")
    (result,) = judge_subject(probe, blind)
    assert result.error <= result.tolerance and result.verdict == FAILED
    assert not result.control.caught


@pytest.mark.parametrize("error, verdict", [(NotRun, NOT_RUN), (ShaderError, FAILED)])
def test_what_does_not_run_is_never_passed(error, verdict):
    host = ModelHost(reference.model("eon"))

    def evaluate(*arguments, **options):
        raise error("0:1(1): error: here")

    host.evaluate = host.execute = evaluate
    results = [
        *judge_subject(PairProbe(host, EON, "eonlib")),
        *judge_functions(FunctionProbe(host, "eonlib")),
    ]
    assert {result.verdict for result in results} == {verdict}
    assert all("0:1(1): error" in result.reason + result.diagnosis for result in results)


def test_the_nearest_model_comes_with_the_next_one():
    words = VALUE.diagnose(PairProbe(ModelHost(reference.model("fon")), EON, "eonlib")).text
    assert words.startswith("best match: Fujii Oren-Nayar (FON) (rms ")
    assert ", then EON with rho^3 (0.0" in words


# --- sources, documents, hosts ------------------------------------------------------------------


def test_a_named_node_is_judged_alone():
    tasks = plan.make_plan([], ["gl"], ["eonlib"], nodes=["sheen_bsdf"]).tasks
    assert {task.subject for task in tasks} == {
        "sheen_bsdf, mode conty_kulla",
        "sheen_bsdf, mode zeltner",
    }
    every = plan.make_plan([], ["gl"], ["eonlib"], nodes=["all"]).tasks
    assert set(every) >= set(plan.make_plan([], ["gl"], ["eonlib"]).tasks)
    every = plan.make_plan([], ["gl"], ["stock"], nodes=["all"]).tasks
    assert {task.subject for task in every} >= {subject.title for subject in PBR_SUBJECTS}


@pytest.mark.parametrize(
    "host, node, message",
    [
        ("gl", "velvet", "^node must be one of oren_nayar_diffuse_bsdf, .*, all; got 'velvet'$"),
        (
            "msl",
            "mix",
            "^node must be judged on one of the hosts msl; got mix, judged with --library eonlib on gl, ",
        ),
        (
            "cycles",
            "sheen_bsdf",
            "^node must be judged on one of the hosts cycles; .* with --library stock on .*, cycles, ",
        ),
    ],
)
def test_a_node_that_is_judged_nowhere_is_refused(host, node, message):
    with pytest.raises(InputError, match=message):
        plan.make_plan([], [host], ["eonlib"], nodes=[node])


def test_texts_are_judged_by_values_and_where_a_host_runs_them_by_the_host():
    results = check_texts(SUBJECTS, "eonlib")
    calls = [each.subject for each in results if each.check == "source"]
    assert {each.rsplit(", ", 1)[1] for each in calls} == set(TEXT_ONLY)
    assert len(calls) == len(SUBJECTS) + len(BSDFS) * len(TEXT_ONLY)
    assert {each.check for each in results} == {"source", "closure", "languages"}
    assert {each.verdict for each in results} == {PASSED}
    assert all(each.control.caught for each in results)


def test_a_document_that_cannot_be_read_is_an_error_and_the_others_are_judged(
    tmp_path, monkeypatch
):
    keep_checks(monkeypatch, "picture")
    bad = tmp_path / "cut.mtlx"
    bad.write_text("<materialx")
    run = check([bad, EXAMPLES[0]], ["gl"])
    assert [str(bad) in error for error in run.errors] == [True]
    assert any(each.subject.startswith("plaster") for each in run.results)


def test_a_host_that_is_missing_is_reported_as_not_run(monkeypatch):
    def missing(name):
        raise NotRun(f"{name}: nowhere")

    monkeypatch.setattr(judge, "open_engine", missing)
    run = check(EXAMPLES[:1], ["gl"], nodes=["common"])
    results = [each for each in run.results if each.host == "gl"]
    assert {each.subject for each in results} > {EON.title, str(EXAMPLES[0]), SHADER_FUNCTIONS}
    assert {(each.verdict, each.reason) for each in results} == {(NOT_RUN, "gl: nowhere")}


@pytest.mark.parametrize("host", [row.name for row in HOSTS if not row.module])
def test_a_target_of_which_only_the_text_can_be_checked_is_not_run(host):
    run = check(EXAMPLES[:1], [host], nodes=["common"])
    (result,) = [each for each in run.results if (each.host, each.check) == (host, "host")]
    assert result.verdict == NOT_RUN and result.reason.startswith(f"{host}: running it needs ")
    texts = [each for each in run.results if each.subject.endswith(f", {host}")]
    assert texts and {each.verdict for each in texts} == {PASSED}


@pytest.mark.parametrize("word", ["host", "library"])
def test_an_unknown_name_lists_the_known_ones(word):
    options = {"hosts": ["abacus"]} if word == "host" else {"libraries": ["abacus"]}
    with pytest.raises(ValueError, match=f"^{word} must be one of .*; got 'abacus'$"):
        check(EXAMPLES, **options)


@pytest.mark.parametrize("shown", ["all", "a document"])
def test_two_libraries_are_asked_the_same(shown, tmp_path):
    """But for nodes and functions that one does not have."""
    libraries = ("stock", "eonlib")
    file = tmp_path / "glow.mtlx"
    edf = connection_text("edf", "EDF", "glow")
    glow = node_text("uniform_edf", "EDF", "glow")
    file.write_text(document_text(glow + node_text("surface", "surfaceshader", "shading", edf)))
    files = [str(file)] if shown != "all" else []
    survey = survey_documents(files, libraries, DEFAULT, 0, 1.0)
    nodes = () if files else ("all",)
    tasks = plan.make_plan(files, ["gl"], libraries, nodes=nodes, survey=survey).tasks
    stock, eonlib = (
        {
            (each.check, each.subject)
            for each in tasks
            if each.library == library and each.check != "picture"
        }
        for library in libraries
    )
    own = {NODE.title, SHADER_FUNCTIONS, *INVERSIONS}
    assert stock == {each for each in eonlib if each[1] not in own}
    assert ("opacity", "surface, an EDF alone") in stock


def test_a_black_material_passes(tmp_path, monkeypatch):
    keep_checks(monkeypatch, "picture")
    path = tmp_path / "black.mtlx"
    path.write_text(SUBJECTS[0].document({"color": (0.0, 0.0, 0.0)}), encoding="utf-8")
    (result,) = [each for each in check([path]).results if each.check == "picture"]
    assert result.verdict == PASSED and result.control.caught and result.error == 0.0


def test_misuse_leaves_the_journal_of_an_earlier_run_alone(tmp_path, monkeypatch):
    keep_checks(monkeypatch, plan.HOST)
    monkeypatch.setattr(dask, "ANSWER", 1.0)
    check(EXAMPLES[:1], ["msl"], folder=tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    for wrong in ({"workers": -1}, {"timeout": 0.0}, {"scheduler": "tcp://127.0.0.1:9"}):
        with pytest.raises(ValueError, match=r"^(workers|timeout|scheduler) must be "):
            check(EXAMPLES[:1], ["msl"], folder=tmp_path, **wrong)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
