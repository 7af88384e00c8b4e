# SPDX-License-Identifier: Apache-2.0
"""The pages on defects of MaterialX: each is still there, at its place, and as large."""

import re
import shutil
from functools import cache, partial

import numpy as np
import pytest

from mxeon.conformance.results.known_issues.issue import Issue, read_issues
from mxeon.errors import NotRun
from tests.support.availability import available
from tests.support.sharing import shared
from tests.support.tolerances import PRINTED
from tools.site.upstream import ledger as rows
from tools.site.upstream import marks
from tools.site.upstream import update as ledger

PAGES = [defect.page for defect in ledger.CHECKED] + list(ledger.OF_QUANTITIES)
# Hosts whose packages the pages name files of, by the beginning of a page.
HOSTS = {
    "three": "three",
    "babylon": "babylon",
    "pathtracer": "three-gpu-pathtracer",
    "cycles": "cycles",
}
HEADINGS = ("Measured", "Cause", "Smallest repair", "Why common tests miss it")

# Those of three.js and Babylon.js are measured in tests/hosts/test_browser.py.
DEFECTS = [defect for defect in ledger.CHECKED if defect.host not in ("three", "babylon")]
of_each_defect = pytest.mark.parametrize("defect", DEFECTS, ids=lambda each: each.page)


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """A function of a host: results and place of its defects, judged by one process for all."""

    @cache
    def outcome(host):
        """Results and place, or the reason why there are none."""
        try:
            make = partial(ledger.judged, host)
            return shared(tmp_path_factory, f"defects on {host}", make), None
        except NotRun as reason:
            return None, reason

    def results(host):
        found, reason = outcome(host)
        with available(host):
            if reason:
                raise reason
        return found

    return results


@pytest.mark.parametrize("page", PAGES)
def test_files_and_functions_that_a_page_names_exist(page):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    root = ledger.FOLDER.parents[1]
    for file, function in re.findall(
        r"`((?:docs|genglsl|genosl|python|tests)/[^`:]*)`(?:, `(\w+)`)?", text
    ):
        assert (root / file).is_file(), file
        assert not function or f" {function}(" in (root / file).read_text(), function


def test_every_page_is_in_the_ledger():
    pages = {path.stem for path in ledger.FOLDER.glob("*.md")} - {"README"}
    assert pages == set(PAGES)


@pytest.mark.parametrize("page", PAGES)
def test_every_page_has_all_parts(page):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    assert [heading for heading in HEADINGS if f"\n## {heading}\n" not in text] == []


# --- what comes from the rows -----------------------------------------------------------------


GENERATED = rows.generated()


@pytest.mark.parametrize("path", GENERATED, ids=lambda path: path.name)
def test_what_comes_from_the_rows_of_the_pages_is_current(path):
    assert path.read_text(encoding="utf-8") == GENERATED[path]


NEW = """# A new defect

<!-- ledger
group = "sheen"
host = "gl"
differs = true
[rows]
value = ["sheen_bsdf, mode zeltner"]
-->
"""


def test_a_page_takes_one_file(tmp_path):
    """Its row comes into the index, the navigation, and the issues of the package."""
    folder = shutil.copytree(ledger.FOLDER, tmp_path / "upstream")
    (folder / "a_new_page.md").write_text(NEW)
    index, navigation, issues = rows.generated(folder).values()
    assert "- [A new defect](a_new_page.md) (*differs*)\n" in index
    assert "          - upstream/a_new_page.md\n" in navigation
    [issue] = [each for each in read_issues(issues) if each.page == "a_new_page"]
    row = ("value", "sheen_bsdf, mode zeltner")
    assert issue == Issue("a_new_page", "A new defect", "gl", (row,), sizes={row: 4.9e15})


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("<!-- ledger", "<!--", "a_new_page.md must have a comment <!-- ledger"),
        ("differs", "verdict", r"keys of a_new_page.md must be some of .*; got \['verdict'\]"),
        ("sheen", "cloth", "group of a_new_page must be one of rough_diffuse, .*; got cloth"),
    ],
)
def test_a_wrong_row_is_refused(tmp_path, old, new, message):
    (tmp_path / "a_new_page.md").write_text(NEW.replace(old, new, 1))
    with pytest.raises(ValueError, match=message):
        rows.generated(tmp_path)


def measured(defect, judged):
    """The block of a page as it is measured here."""
    results, place = judged(defect.host)
    return ledger.block(ledger.shown(defect, results), place)


def of_this_driver(defect, judged):
    """Skip the test of a page about a driver that is not the one here."""
    place = judged(defect.host)[1]
    if defect.page in ledger.OF_DRIVERS and place not in ledger.written(defect.page):
        pytest.skip(f"docs/upstream/{defect.page}.md is about another driver than {place}")


@of_each_defect
def test_no_defect_has_been_repaired_upstream(judged, defect):
    of_this_driver(defect, judged)
    results = ledger.shown(defect, judged(defect.host)[0])
    repaired = [each for each in results if each.verdict == "passed"]
    assert not repaired, f"docs/upstream/{defect.page}.md is out of date: the defect is repaired"


@of_each_defect
def test_the_figures_of_each_page_are_those_of_the_suite(judged, defect):
    of_this_driver(defect, judged)
    written = ledger.figures(ledger.written(defect.page))
    np.testing.assert_allclose(ledger.figures(measured(defect, judged)), written, rtol=PRINTED)


@of_each_defect
def test_the_bounds_and_names_of_each_page_are_those_of_the_suite(judged, defect):
    of_this_driver(defect, judged)
    written = ledger.without_figures(ledger.written(defect.page))
    assert written == ledger.without_figures(measured(defect, judged))


@of_each_defect
def test_each_page_names_device_and_version(defect):
    assert "\nMeasured with " in ledger.written(defect.page)


def test_a_figure_twice_as_large_is_seen():
    text = ledger.written("genglsl_clamped_dot")
    assert ledger.figures(text)[0] == 0.37
    assert ledger.figures(text.replace("0.37", "0.74"))[0] > (1.0 + PRINTED) * 0.37


@pytest.mark.parametrize("page, measure", ledger.OF_QUANTITIES.items())
@pytest.mark.filterwarnings("ignore:.*brings code of its own")
def test_the_quantities_of_each_page_are_those_computed(page, measure):
    host = page.split("_")[0]
    with available(host if host in ("cycles", "storm", "testrender") else "gl"):
        assert ledger.written(page) == measure()


# --- numbers of the sentences ------------------------------------------------------------------


NUMBERED = pytest.mark.parametrize("path", ledger.pages(), ids=lambda path: path.stem)


@NUMBERED
def test_the_marked_numbers_of_each_page_are_those_measured(path):
    host = next((each for each in HOSTS if path.stem.startswith(each)), "gl")
    with available(HOSTS.get(host, host)):
        assert ledger.wrong_numbers(path) == []


@pytest.mark.parametrize("path", ledger.pages()[:-1], ids=lambda path: path.stem)
def test_every_number_of_a_page_has_a_mark_or_is_a_name_or_an_input(path):
    text = path.read_text()
    assert marks.unmarked(text, ledger.rows_of(text)) == []


@pytest.mark.parametrize("page, name", ledger.TABLES, ids=" ".join)
def test_the_tables_of_each_page_are_those_computed(page, name):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    assert f"<!-- measured {name} -->\n{ledger.TABLES[page, name]()}<!-- end -->" in text


PAGE = """# A defect of 0.3

The error is 0.31<!--error-->, or 31<!--row 1--> %, at roughness 0.5, in `a.glsl`.
"""


@pytest.mark.parametrize(
    "error, row, found", [(0.312, 0.306, []), (0.32, 0.306, ["0.31"]), (0.312, 0.32, ["31"])]
)
def test_a_number_that_is_not_measured_is_seen(error, row, found):
    wrong = marks.wrong(PAGE, lambda: {"error": error}, [row])
    assert [each.split("<")[0] for each in wrong] == found


@pytest.mark.parametrize("added, found", [(" It is 0.7.", ["0.7"]), (" It is 0.7<!--text-->.", [])])
def test_a_number_without_a_mark_is_seen(added, found):
    assert marks.unmarked(PAGE + added, [0.306]) == found


def test_the_title_has_to_round_a_number_of_the_page():
    assert marks.unmarked(PAGE.replace("of 0.3", "of 0.4"), [0.306]) == ["0.4"]


def test_the_line_of_a_text_is_found_once():
    file = "mx_multiply_bsdf_float.glsl"
    assert marks.line_of(file, "result.throughput = in1.throughput") == 7
    with pytest.raises(ValueError, match="one line of .* must hold 'in1'"):
        marks.line_of(file, "in1")
    with pytest.raises(FileNotFoundError, match="must be one installed file"):
        marks.line_of("mx_nowhere.glsl", "in1")
