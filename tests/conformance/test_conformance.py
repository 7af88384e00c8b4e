# SPDX-License-Identifier: Apache-2.0
"""Runs: what is judged, what is not run, and what is refused."""

import pytest

from mxeon.conformance.checks import CHECKS
from mxeon.conformance.results import NOT_RUN, PASSED, SHADER_FUNCTIONS
from mxeon.conformance.run import check, judge, plan
from mxeon.conformance.run.plan import survey_documents
from mxeon.errors import InputError, NotRun
from mxeon.hosts import HOSTS
from mxeon.jobs import dask
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.nodes import INVERSIONS, connection_text, document_text, node_text
from tests.support.plans import keep_checks
from tests.support.sharing import EXAMPLES


def test_a_named_node_is_judged_alone():
    tasks = plan.make_plan([], ["gl"], ["eonlib"], nodes=["sheen_bsdf"]).tasks
    assert {task.subject for task in tasks} == {
        "sheen_bsdf, mode conty_kulla",
        "sheen_bsdf, mode zeltner",
    }
    assert {"pdf", "sample"} <= {task.check for task in tasks}
    every = plan.make_plan([], ["gl"], ["eonlib"], nodes=["all"]).tasks
    assert "pdf" not in {task.check for task in plan.make_plan([], ["gl"], ["eonlib"]).tasks}
    assert set(every) >= set(plan.make_plan([], ["gl"], ["eonlib"]).tasks)
    for library, judged in (("stock", True), ("eonlib", False)):  # what neither library repairs
        tasks = plan.make_plan([], ["gl"], [library], nodes=["all"]).tasks
        assert ("measured_edf" in {task.subject for task in tasks}) is judged
    assert "uniform_edf" not in {
        task.subject for task in plan.make_plan([], ["gl"], ["stock"]).tasks
    }


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


def test_texts_are_judged_by_values_and_where_a_host_runs_them_by_the_host(run):
    read = [each for each in run.results if each.host == "source"]
    assert {each.check for each in read} == {"definition", "source", "closure", "languages"}
    languages = {each.subject.rsplit(", ", 1)[1] for each in read if each.check == "source"}
    assert languages == {"msl", "mdl"}


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
    assert {each.subject for each in results} > {
        *("eon_diffuse_bsdf", str(EXAMPLES[0]), SHADER_FUNCTIONS)
    }
    assert {(each.verdict, each.reason) for each in results} == {(NOT_RUN, "gl: nowhere")}


@pytest.mark.parametrize("host", [row.name for row in HOSTS if not row.module])
def test_a_target_of_which_only_the_text_can_be_checked_is_not_run(host):
    run = check(EXAMPLES[:1], [host], nodes=["common"])
    (result,) = [each for each in run.results if (each.host, each.check) == (host, "host")]
    assert result.verdict == NOT_RUN and result.reason.startswith(f"{host}: running it needs ")
    texts = [each for each in run.results if each.subject.endswith(f", {host}")]
    assert texts and {each.verdict for each in texts} == {PASSED}


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
    own = {"eon_diffuse_bsdf", SHADER_FUNCTIONS, *INVERSIONS}
    drawn = {check.key for check in CHECKS if check.profile}  # by the text for path tracers
    assert stock == {each for each in eonlib if each[1] not in own and each[0] not in drawn}
    assert ("opacity", "surface, an EDF alone") in stock


def test_misuse_leaves_the_journal_of_an_earlier_run_alone(tmp_path, monkeypatch):
    keep_checks(monkeypatch, plan.HOST)
    monkeypatch.setattr(dask, "ANSWER", 1.0)
    check(EXAMPLES[:1], ["msl"], folder=tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    for wrong in ({"workers": -1}, {"timeout": 0.0}, {"scheduler": "tcp://127.0.0.1:9"}):
        with pytest.raises(ValueError, match=r"^(workers|timeout|scheduler) must be "):
            check(EXAMPLES[:1], ["msl"], folder=tmp_path, **wrong)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
