# SPDX-License-Identifier: Apache-2.0
"""Checking a folder gives one verdict per document, and a summary by cause."""

import shutil
from dataclasses import replace

from mxeon import check
from mxeon.cli import main
from mxeon.cli.answer import MANY, summary_by_cause
from mxeon.errors import MISUSE
from tests.support.command import CLAY
from tests.support.results import made, made_run, quoted
from tests.support.verdicts import FAILED

NAMES = ("a/clay.mtlx", "a/glass.mtlx", "b/noise.mtlx", "light.mtlx")


RUN = made_run(
    made(key="picture", subject="clay.mtlx: look"),
    made(key="picture", subject="clay.mtlx: other"),
    made(
        key="finite",
        subject="glass.mtlx: look",
        diagnosis=quoted("reference: there is no model for 'x/y'"),
    ),
    made(key="picture", subject="noise.mtlx: look", measured=("lobe.color",)),
    made(FAILED, subject="noise.mtlx: node"),
    documents=NAMES[:3],
    refused={"light.mtlx": ('light.mtlx: must contain a renderable element; got "a"',)},
)


def test_a_folder_stands_for_the_documents_in_it_and_below_it(tmp_path):
    for name in ("b.mtlx", "sub/a.mtlx", "notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    single = str(tmp_path / "b.mtlx")
    run = check([tmp_path, single], ["msl"])  # no file is a MaterialX document
    assert {*run.refused} == {single, str(tmp_path / "sub" / "a.mtlx")}


def test_causes_count_documents_the_worst_first():
    first, *rows = (each.strip() for each in summary_by_cause(RUN))
    assert first.startswith("4 documents, 2 ")
    assert rows == [
        "1 refused: must contain a renderable element; got ... (light.mtlx)",
        "1 no reference: there is no model for ... (a/glass.mtlx)",
        "1 passed: matches the reference (a/clay.mtlx)",
        "1 passed: matches the reference, with inputs that the host computed (b/noise.mtlx)",
    ]


def test_a_document_that_one_library_lacks_counts_once():
    run = replace(RUN, refused={"a/clay.mtlx with stock": ("a/clay.mtlx: no x (with stock)",)})
    first, *rows = summary_by_cause(run)
    assert first.startswith("3 documents, 1 ")
    assert rows[0] == "     1 refused: no x (with stock) (a/clay.mtlx)"


def test_a_bad_document_of_a_folder_is_one_line_and_the_run_goes_on(tmp_path, capsys):
    for number in range(MANY):
        (tmp_path / f"bad{number}.mtlx").write_text("<materialx")
    shutil.copy(CLAY, tmp_path)
    options = ["--workers", "0", "--node", "conical_edf"]
    assert main(["check", str(tmp_path), *options]) == MISUSE
    output, error = capsys.readouterr()
    assert len(error.splitlines()) == MANY
    assert f"{MANY + 1} documents" in output and f"\n    {MANY} refused" in output
