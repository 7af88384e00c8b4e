# SPDX-License-Identifier: Apache-2.0
"""The nodes that combine lobes in GLSL: eonlib's carry what the text carries, stock ones do not."""

import pytest

from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.combinations import COMBINED_NODES, SINGLE
from mxeon.conformance.probes.bsdf import CombinedProbe
from mxeon.conformance.results import DIFFERS, FAILED, PASSED
from tests.support.checks import undiagnosed
from tests.support.wrong_libraries import copy_of_eonlib, place_of, replace_text

UNSCALED = "the throughput of the lobe before it is scaled"
ENDED = "a sum whose throughput is clamped at 0"
COMBINED_WRONG = {  # of stock MaterialX: verdict of its combinations that are off, and diagnosis
    "multiply_float": (DIFFERS, UNSCALED, {"combined_throughput"}),
    "multiply_color3": (DIFFERS, UNSCALED, {"combined_throughput"}),
    "multiply_sum": (DIFFERS, UNSCALED, {"combined_throughput"}),
    "mix_sum": (FAILED, ENDED, {"combined_throughput"}),
    "mix_layer": (FAILED, ENDED, {"combined_throughput"}),
    "layer_sum": (FAILED, ENDED, {"combination", "combined_albedo", "combined_throughput"}),
    # Stock's sheen passes light by its albedo without the color.
    "layer_colored": (FAILED, "", {"combination", "combined_albedo", "combined_throughput"}),
}
# Wrong lines of eonlib: file, text, the text in its place, and the rows and the check that see them.
PASSES = "combined_throughput"
SUM = "in1.throughput + in2.throughput - 1.0"
LIT = "max(top.throughput, 0.0)"
WRONG = (
    ("add_bsdf", f"= {SUM}", f"= max({SUM}, 0.0)", "mix_sum", PASSES),
    ("add_bsdf", "in2.throughput - 1.0", "in2.throughput - 1.1", "add", PASSES),
    ("add_bsdf", "in1.response + in2.response", "in1.response", "add", "combination"),
    ("layer_bsdf", LIT, "top.throughput", "layer_sum", "combination"),
    ("layer_bsdf", "base.response * passed", "base.response", "layer", "combination"),
    ("layer_bsdf", "passed * base.throughput", "passed", "layer", PASSES),
    ("layer_bsdf", "min(top.throughput, 0.0) + ", "", "mix_layer", PASSES),
    (
        "multiply_bsdf_color3", "= 1.0 - weight * (1.0 - in1.throughput)", "= in1.throughput",
        "multiply_sum", PASSES,
    ),
    (
        "multiply_bsdf_color3", "- in1.throughput)", "- max(in1.throughput, 0.0))", "multiply_sum",
        PASSES,
    ),
    ("multiply_bsdf_float", "response * weight", "response", "multiply_float", "combination"),
)  # fmt: skip


def combined_results(gl, subject, library):
    probe = CombinedProbe(gl, subject, library)
    rows = [row for row in CHECKS if applies(row, subject, subject.kind, "gl")]
    return {row.key: judge_check(row, probe) for row in rows}


@pytest.mark.parametrize("subject", COMBINED_NODES, ids=lambda each: each.title)
def test_a_combination_is_that_of_the_layer_algebra(gl, subject):
    results = combined_results(gl, subject, "eonlib")
    asked = {"inputs", "combination", "combined_albedo", "combined_throughput"}
    assert asked | ({"factor"} if subject.model in SINGLE else set()) == {*results}
    assert {result.verdict for result in results.values()} == {PASSED}
    assert all(result.control.caught for result in results.values())


@pytest.mark.parametrize("subject", COMBINED_NODES, ids=lambda each: each.title)
def test_a_combination_of_stock_is_off_where_its_page_says(gl, subject):
    results = combined_results(gl, subject, "stock")
    verdict, words, wrong = COMBINED_WRONG.get(subject.model, (PASSED, "", set()))
    assert {key for key, result in results.items() if result.verdict != PASSED} == wrong
    assert {results[key].verdict for key in wrong} <= {verdict}
    for key in wrong - {"combined_albedo"}:  # where few pairs are wrong, and their place is named
        assert words in results[key].diagnosis


@pytest.mark.parametrize("wrong", WRONG, ids=lambda each: f"{each[0]}: {each[2]}")
def test_a_wrong_line_of_a_combination_is_seen(gl, tmp_path, wrong):
    name, old, new, model, check = wrong
    [subject] = [each for each in COMBINED_NODES if each.model == model]
    library = str(copy_of_eonlib(tmp_path))
    [row] = [undiagnosed(each) for each in CHECKS if each.key == check]
    assert judge_check(row, CombinedProbe(gl, subject, library)).verdict == PASSED
    replace_text(tmp_path, old, new, place_of(name))
    assert judge_check(row, CombinedProbe(gl, subject, library)).verdict == FAILED
