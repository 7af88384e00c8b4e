# SPDX-License-Identifier: Apache-2.0
"""Stock MaterialX judged: its known defects by name, and what it has right."""

from dataclasses import replace

import pytest

from mxeon.conformance.diagnosis.comparisons import VALUE
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.pictures import PictureProbe
from mxeon.conformance.results import DIFFERS, FAILED, PASSED, Result, known_issues

EON, QON, _ = SUBJECTS


@pytest.mark.parametrize(
    "host, key, subject, words",
    [
        ("gl", "value", EON.title, "EON with clamped dot(wo, wi)"),
        ("gl", "albedo", EON.title, "EON with clamped dot(wo, wi)"),
        ("gl", "environment", QON.title, "QON with MaterialX's fit of its albedo"),
        ("gl", "lobe", "open_pbr_surface", "EON with clamped dot(wo, wi)"),
        ("gl", "lobe", "open_pbr_surface, thin-walled", "QON tinted twice"),
        ("gl", "flag", EON.title, "see docs/upstream/genglsl_clamped_dot.md"),
        ("source", "closure", f"{EON.title}, mdl", "FON + white lobe"),
        ("source", "closure", f"{EON.title}, osl", "energy_compensation is not the node's"),
    ],
)
def test_known_defects_of_stock_materialx_are_found_and_named(stock, host, key, subject, words):
    (result,) = [
        each
        for each in stock.results
        if (each.host, each.check, each.subject) == (host, key, subject)
    ]
    assert result.verdict == FAILED and words in result.explanation
    assert result.pages


def test_a_text_that_a_host_runs_is_not_judged_by_a_pattern(stock):
    assert {each.check for each in stock.results if each.host == "source"} == {
        "definition",
        "closure",
        "source",
    }
    assert not any(
        each.subject.endswith(("glsl", "osl")) for each in stock.results if each.check == "source"
    )


def test_the_lobes_of_surface_shaders_are_judged_and_those_that_are_right_pass(stock, run):
    right = {"standard_surface", "UsdPreviewSurface", "gltf_pbr"}
    for findings, expected in ((stock, right), (run, right | {"open_pbr_surface"})):
        lobes = [each for each in findings.results if each.check == "lobe"]
        assert {each.subject for each in lobes if each.verdict == PASSED} == expected
        assert all(each.control.caught for each in lobes)


def test_a_defect_that_was_repaired_upstream_is_said_to_be_once_all_its_rows_pass(stock):
    def noted(*repaired):
        results = [
            replace(each, verdict=PASSED) if each.check in repaired else each
            for each in stock.results
        ]
        return dict(map(reversed, known_issues.repaired(results, {"MaterialX": "2.0"})))

    page = "docs/upstream/genglsl_clamped_dot.md"
    assert noted() == {}
    assert page not in noted("value", "albedo")
    assert noted("value", "albedo", "lobe")[page].startswith("repaired in MaterialX 2.0")


@pytest.mark.parametrize("library, pages", [("stock", ("cycles_rho_cubed",)), ("eonlib", ())])
def test_what_follows_from_a_defect_of_stock_refers_to_its_page(library, pages):
    result = Result("inputs", "claim.", QON.title, "cycles", library, FAILED)
    assert known_issues.with_pages(result).pages == pages


@pytest.mark.parametrize("verdict, named", [(DIFFERS, True), (FAILED, False), (PASSED, False)])
def test_the_page_of_what_the_text_leaves_open_explains_no_failure_alone(verdict, named):
    result = Result("value", "claim.", "conductor_bsdf", "wgsl", "stock", verdict)
    pages = known_issues.with_pages(result).pages
    assert ("genglsl_microfacet_compensation" in pages) == named


@pytest.mark.parametrize("subject", [EON, QON], ids=lambda subject: subject.title)
def test_stock_materialx_in_cycles_is_called_by_its_name(hosts, subject):
    probe = PictureProbe(hosts("cycles"), subject, "stock")
    assert "best match: EON with rho^3 (rms " in VALUE.diagnose(probe).text


def test_what_stock_materialx_has_right_passes(stock):
    passed = {(e.check, e.subject) for e in stock.results if e.verdict == PASSED}
    assert passed >= {("value", QON.title), ("black", EON.title), ("furnace", EON.title)}
