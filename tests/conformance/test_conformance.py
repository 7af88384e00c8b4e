# SPDX-License-Identifier: Apache-2.0
"""`check` judges each task or reports the task as not run, and refuses invalid arguments."""

import re

import pytest

from mxeon import check
from mxeon.conformance.run.plan import ALL, make_plan
from mxeon.errors import InputError
from mxeon.hosts import HOSTS
from mxeon.shaders.methods import Methods
from mxeon.shaders.nodes import INVERSIONS
from tests.support.plans import keep_checks
from tests.support.sharing import EXAMPLES
from tests.support.verdicts import FAILED, NOT_RUN, PASSED, SHADER_FUNCTIONS


def test_a_named_node_is_judged_alone_and_with_its_draws():
    results = check(None, ["gl"], nodes=["conical_edf"]).results
    assert {each.subject for each in results} == {"conical_edf"}
    drawn = check(None, ["gl"], nodes=["translucent_bsdf"]).results
    assert {"pdf", "sample"} <= {each.check for each in drawn}


@pytest.mark.parametrize(
    "host, node, message",
    [
        ("gl", "velvet", "^no node 'velvet'; see mxeon check --node list$"),
        ("msl", "mix", "hosts msl; got mix, judged with --library eonlib on gl, "),
        ("cycles", "sheen_bsdf", "hosts cycles; .* with --library stock on .*, cycles, "),
        *((host, node, f"hosts {host}; got {node}, judged with ") for host, node in (
            ("storm", "mix"), ("storm", "uniform_edf"), ("materialx", "layer"),
            ("materialx", "subsurface_bsdf"), ("materialx", "chiang_hair_bsdf"),
            ("cycles", "chiang_hair_bsdf"), ("testrender", "uniform_edf"), ("testrender", "blackbody"),
        )),
    ],
)  # fmt: skip
def test_a_node_that_is_judged_nowhere_is_refused(host, node, message):
    with pytest.raises(InputError, match=message):
        check(None, [host], nodes=[node])


@pytest.mark.whole
def test_texts_are_judged_by_values_and_where_a_host_runs_them_by_the_host(run):
    read = [each for each in run.results if each.host == "source"]
    checks = {"source", "closure", "languages", "clash", "arguments"}
    assert {each.check for each in read} == checks
    languages = {each.subject.rsplit(", ", 1)[1] for each in read if each.check == "source"}
    assert languages == {"msl", "mdl"}


def test_a_host_that_is_missing_is_reported_as_not_run(monkeypatch):
    monkeypatch.setenv("MXEON_CYCLES_PYTHON", "/nowhere/python")
    run = check(EXAMPLES[:1], ["cycles"], nodes=["common"])
    results = [each for each in run.results if each.host == "cycles"]
    assert {each.subject for each in results} > {"eon_diffuse_bsdf", str(EXAMPLES[0])}
    assert {each.verdict for each in results} == {NOT_RUN}
    assert all(each.reason.startswith("cycles: ") for each in results)


@pytest.mark.parametrize("host", [row.name for row in HOSTS if row.needs])
def test_a_target_of_which_only_the_text_can_be_checked_is_not_run(host):
    run = check(EXAMPLES[:1], [host], nodes=["common"])
    (result,) = [each for each in run.results if (each.host, each.check) == (host, "host")]
    assert result.verdict == NOT_RUN and result.reason.startswith(f"{host}: running it needs ")
    (shaders,) = [each for each in run.results if each.check == "document"]
    assert shaders.verdict == PASSED and shaders.control.caught
    texts = [each for each in run.results if each.subject.endswith(f", {host}")]
    assert texts and {each.verdict for each in texts} == {PASSED}


def test_a_document_is_not_run_on_a_renderer(monkeypatch):
    keep_checks(monkeypatch, "document")
    run = check(EXAMPLES[:1], ["mitsuba"])
    [result] = [each for each in run.results if each.check == "document"]
    assert result.verdict == NOT_RUN
    assert re.fullmatch("mitsuba: this renderer .*; it cannot read documents", result.reason)


@pytest.mark.whole
def test_two_libraries_are_asked_the_same(run, stock):
    """The same checks judge both libraries, unless a library lacks a node, function or repair."""
    results = [[each for each in of.results if each.host == "gl"] for of in (stock, run)]
    checks = [{(each.check, each.subject) for each in of} for of in results]
    own = {"eon_diffuse_bsdf", SHADER_FUNCTIONS, *INVERSIONS}
    # `picture` judges different documents per library. `release` judges only stock MaterialX.
    unlike = ("picture", "release")
    eonlib = {row for row in checks[1] if row[1] not in own and row[0] not in unlike}
    assert eonlib < checks[0]
    found = {check for check, _ in checks[0] - eonlib} - {*unlike}
    assert found == {"implemented", "lobe", "opacity"}
    assert {e.check for e in stock.results} - {e.check for e in run.results} == {"opacity"}


def test_misuse_loses_nothing_of_an_earlier_run(tmp_path, monkeypatch):
    keep_checks(monkeypatch, "host")
    check(EXAMPLES[:1], ["msl"], folder=tmp_path)
    before = {path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    for wrong in ({"workers": -1}, {"timeout": 0.0}, {"scheduler": " "}):
        with pytest.raises(ValueError, match=r"^(workers|timeout|scheduler) must be "):
            check(EXAMPLES[:1], ["msl"], folder=tmp_path, **wrong)
    assert {path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.whole
@pytest.mark.parametrize("check", ["transmitted", "transmitted_inputs", "states"])
@pytest.mark.parametrize(
    "names", ["fis opacity", "prefilter opacity", "prefilter refraction", "none opacity"]
)
def test_glass_passes_by_every_method_and_as_stock_has_it_does_not(judged, check, names):
    glass, methods = "dielectric_bsdf, scatter_mode RT", Methods(*names.split())
    assert judged(check, glass, methods=methods).verdict == PASSED
    if check == "transmitted":
        assert judged(check, glass, library="stock", methods=methods).verdict == FAILED


def test_a_negative_color_is_asked_of_opacity_only_where_glass_has_a_tint():
    plan = make_plan((), ("gl",), ("eonlib",), nodes=(ALL,), methods=Methods("", "opacity"))
    asked = {task.subject for task in plan.tasks if task.check == "negative"}
    assert "dielectric_bsdf, scatter_mode T" in asked
    assert "generalized_schlick_bsdf, scatter_mode T" not in asked


@pytest.mark.parametrize("environment", ["fis", "prefilter"])
def test_other_lobes_are_lit_alike_by_eonlib_s_lookups(judged, environment):
    methods = Methods(environment, searched=True)
    assert judged("environment", "burley_diffuse_bsdf", methods=methods).verdict == PASSED


@pytest.mark.parametrize(
    "check, methods, verdict, reason",
    [
        # MaterialX's sum applies masking twice. Only eonlib's environment lookups avoid this error.
        ("anisotropic_albedo", Methods("fis", searched=True), NOT_RUN, "library stock: has no genglsl/environment to search"),
        # The energy compensation of stock MaterialX does not use the exact average albedo.
        ("environment", Methods("prefilter"), FAILED, ""),
    ],
)  # fmt: skip
def test_metal_passes_by_eonlib_s_methods_alone(judged, check, methods, verdict, reason):
    assert judged(check, "conductor_bsdf", methods=methods).verdict == PASSED
    stock = judged(check, "conductor_bsdf", library="stock", methods=methods)
    assert (stock.verdict, stock.reason) == (verdict, reason)
