# SPDX-License-Identifier: Apache-2.0
"""The page of the field: one row for each node of each renderer, whatever runs they are from."""

import re
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from mxeon.cli import main
from mxeon.conformance.results import (
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    Control,
    Picture,
    Result,
    Run,
)
from mxeon.hosts.base import Identity
from mxeon.models import table as reference
from mxeon.report import write
from mxeon.survey.field import CHECKS, read_field, write_field

FIELD = Path(__file__).parents[2] / "docs" / "field.html"
EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
TITLE = reference.model("eon").title
HOSTILE = "<script>alert(1)</script>"
TOLERANCE = 1e-6


def made(check, error, **changes):
    """A result of a check of EON's node on gl."""
    verdict = PASSED if error <= TOLERANCE else FAILED
    result = Result(
        check, "claim.", EON, "gl", "stock", verdict, error, "pi f cos", TOLERANCE,
        worst={"roughness": [0.875], "color": [0.2, 0.5, 0.8]}, control=Control("wrong", 1.0, True),
    )  # fmt: skip
    return replace(result, **changes)


def portrait(scene, offset, host="gl"):
    """A portrait that is brighter than its reference by an offset."""
    model = np.full((8, 8, 3), 0.25, dtype=np.float32)
    metadata = {"host": host, "points": host}
    names = (PORTRAIT, EON, host, "stock", scene)
    return Picture(*names, model + np.float32(offset), model, metadata)


WRONG = (
    made("value", 0.4, diagnosis="best match: QON (rms 1e-9), then FON", pages=("a",)),
    made("environment", 1e-7),
    made("furnace", 1e-7),
    made("albedo", 0.3, pages=("a", "b")),
    made("black", 0.0),
    made("flag", 0.2),
    made("value", 0.4, subject="sheen_bsdf, mode zeltner"),  # claims no rough diffuse model
)
RUN = Run("0.1.0", {}, (Identity("gl", "OpenGL 4.5", "llvmpipe"),), WRONG)


def written(folder, **changes):
    write(replace(RUN, **changes), folder)
    return folder


def of_node(run_folder):
    (entry,) = read_field([run_folder])
    return entry


def test_a_row_has_the_claimed_model_the_model_that_is_there_and_the_pages(tmp_path):
    entry = of_node(written(tmp_path))
    assert (entry.host, entry.version, entry.device) == ("gl", "OpenGL 4.5", "llvmpipe")
    assert (entry.claimed, entry.found, entry.found_around) == (TITLE, "QON", TITLE)
    assert entry.verdict == FAILED and entry.pages == ("a", "b")
    errors = {column: cell.error for column, cell in entry.cells.items()}
    assert errors == {
        "direct": 0.4, "surroundings": 1e-7, "energy": 1e-7, "color": 0.3, "black": 0.0, "flag": 0.2
    }  # fmt: skip


def test_a_form_of_the_model_that_is_judged_is_what_passes(tmp_path):
    passed = made("value", 1e-7, claimed="EON, printed", model="EON, fitted")
    entry = of_node(written(tmp_path, results=(passed,)))
    assert (entry.claimed, entry.found, entry.verdict) == ("EON, printed", "EON, fitted", PASSED)


@pytest.mark.parametrize("error, verdict", [(1e-7, PASSED), (0.5, FAILED)])
def test_a_portrait_in_light_from_behind_tells_of_back_lit_pairs(tmp_path, error, verdict):
    pictures = portrait("side", 0.5), portrait("back", error)
    cell = of_node(written(tmp_path, pictures=pictures)).cells["back"]
    assert cell.verdict == verdict and cell.error == pytest.approx(error, rel=0.2)


def test_a_host_that_did_not_run_is_not_passed(tmp_path):
    missing = replace(made("value", 0.0), verdict=NOT_RUN, error=None, reason="gl: nowhere")
    entry = of_node(written(tmp_path, results=(missing,), hosts=()))
    assert (entry.verdict, entry.found, entry.version) == (NOT_RUN, "not run", "")


def test_reports_of_a_folder_stand_together_and_the_later_one_counts(tmp_path):
    written(tmp_path / "1")
    written(tmp_path / "2", results=(made("value", 1e-7),))
    written(tmp_path / "3", hosts=(Identity("gl", "OpenGL 4.6", "llvmpipe"),))
    found = [(entry.version, entry.found) for entry in read_field([tmp_path])]
    assert found == [("OpenGL 4.5", TITLE), ("OpenGL 4.6", "QON")]


class Page(HTMLParser):
    """Start tags of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    folder = tmp_path_factory.mktemp("field")
    hosts = (Identity("gl", HOSTILE, HOSTILE),)
    written(folder, hosts=hosts, pictures=(portrait("side", 0.5), portrait("back", 1e-7)))
    return write_field(read_field([folder]), folder / "field.html", "up/{}.html").read_text()


def test_the_page_loads_nothing_and_runs_its_own_script_alone(text):
    tags = Page(text).tags
    loaded = [given.get(name, "") for _, given in tags for name in ("src", "href") if name in given]
    assert all(each.startswith(("data:image/png;base64,", "#row-", "up/")) for each in loaded)
    (script,) = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    policy = next(given["content"] for tag, given in tags if given.get("http-equiv"))
    assert b64encode(sha256(script.encode()).digest()).decode() in policy
    assert HOSTILE not in text and "&lt;script&gt;" in text


def test_the_page_has_a_cell_for_every_column_and_a_picture_with_its_difference(text):
    tags = Page(text).tags
    cells = [given["data-label"] for tag, given in tags if tag == "td"]
    assert len(cells) == len(CHECKS) + 3
    assert [given["href"] for tag, given in tags if tag == "a"][:2] == ["up/a.html", "up/b.html"]
    pictures = [given["alt"] for tag, given in tags if tag == "img"]
    assert len(pictures) == 4 and all(pictures)
    assert "0.875" in text and "(0.2, 0.5, 0.8)" in text  # where the error occurs


def test_every_header_is_of_its_column_and_every_figure_of_a_row(text):
    tags = Page(text).tags
    headers = [given for tag, given in tags if tag == "th" and given.get("scope") == "col"]
    assert len(headers) == len(CHECKS) + 4
    rows = {given["id"] for tag, given in tags if tag == "tr" and "id" in given}
    assert {given["data-row"] for tag, given in tags if tag == "figure"} == rows == {"row-0"}


def test_the_command_writes_the_page_of_reports(tmp_path, capsys):
    page = tmp_path / "page.html"
    written(tmp_path / "gl")
    assert main(["report", "field", str(tmp_path), "--output", str(page)]) == 0
    assert capsys.readouterr().out == f"field: {page}, 1 rows\n"
    assert "docs/upstream/a.md" in page.read_text()


@pytest.mark.parametrize("results", [None, (made("value", 0.0, subject="a.mtlx, look"),)])
def test_what_has_no_renderer_is_refused_in_one_line(tmp_path, capsys, results):
    if results:
        written(tmp_path, results=results)
    assert main(["report", "field", str(tmp_path), "--output", str(tmp_path / "a.html")]) == 2
    error = capsys.readouterr().err
    assert "must " in error and error.count("\n") == 1 and not (tmp_path / "a.html").exists()


def test_the_pages_of_defects_lie_beside_the_page_in_the_checkout():
    links = [given["href"] for tag, given in Page(FIELD.read_text()).tags if tag == "a"]
    pages = {link for link in links if not link.startswith("#")}
    assert pages and [page for page in pages if not (FIELD.parent / page).is_file()] == []
