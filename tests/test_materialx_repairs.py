# SPDX-License-Identifier: Apache-2.0
"""The smallest repairs of MaterialX's data: with them, the checks that show the defects pass."""

import json
import os
import re
import subprocess
import sys
from functools import cache, partial
from pathlib import Path

import MaterialX as mx
import pytest

from mxeon.errors import NotRun
from tests.support.availability import available
from tests.support.sharing import every_node, shared
from tests.support.verdicts import FAILED, NOT_RUN, PASSED, SOURCE, STOCK
from tests.support.wheels import MAIN, wheel
from tools.site import ledger
from tools.site.ledger import pages

pytestmark = pytest.mark.whole

# Judges rows of stock MaterialX, and prints what it found.
JUDGE = """
import json, sys
from mxeon.errors import NotRun
from tests.support.verdicts import NOT_RUN, SOURCE, Verdicts, said
judged = Verdicts()
results = {}
for check, subject, host in json.loads(sys.argv[1]):
    text, key = host == SOURCE, "|".join((check, subject, host))
    try:
        result = judged.texts(check, "stock")[subject] if text else judged(check, subject, host, "stock")
        results[key] = result.verdict, said(result), result.pages
    except NotRun as reason:
        results[key] = NOT_RUN, str(reason), ()
print(json.dumps(results))
"""


ENTRIES = ledger.entries()
PATCHES = ledger.patches("materialx")
# The patches that main needs: those of pages that no pull request there repairs.
OF_MAIN = [path for page, path in PATCHES.items() if not ENTRIES[page].pull]
# Pages whose patches are of files that main has changed.
CHANGED = re.findall(r"^--- a/(.*)$", MAIN.read_text(), re.MULTILINE)
ON_MAIN = [
    page
    for page, path in PATCHES.items()
    if any(f"--- a/{file}\n" in path.read_text() for file in CHANGED)
]


def rows_of(names):
    """The rows of pages, and with what diagnosis a check may fail."""
    return {
        (check, subject, ENTRIES[page].host or "gl"): words
        for page in names
        for words, rows in {"": ENTRIES[page].repaired, **ENTRIES[page].remains}.items()
        for check, subject in ledger.pairs(rows)
    }


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """Whatever the release fails, or differs in."""
    with available("gl"):
        on_gl = {(e.check, e.subject) for e in every_node(tmp_path_factory, STOCK).results}
    return [
        (*row, entry.host)
        for entry in ENTRIES.values()
        if entry.library == STOCK and entry.host in ("gl", SOURCE)
        for row in (*ledger.pairs(entry.rows), *ledger.pairs(entry.implied))
        if row in (on_gl if entry.host == "gl" else ledger.pairs(entry.rows))
    ]


ROWS = {"release": rows_of(PATCHES), "main": rows_of(ON_MAIN)}
CASES = [(version, row) for version, rows in ROWS.items() for row in rows]


@pytest.fixture(scope="module")
def judged(tmp_path_factory, failing):
    """A function of a version: verdict and diagnosis of each row with it, repaired.

    What main has repaired passes there without the repair.
    """

    @cache
    def results(version):
        folder = tmp_path_factory.mktemp("repaired")
        package, files = Path(mx.__file__).parent, list(PATCHES.values())
        if version == "main":
            package, files = wheel("main") / "MaterialX", OF_MAIN
        with available("gl"):
            rows = sorted(
                {*ROWS[version], *(failing if version == "release" else ())},
                key=lambda row: row[::-1],
            )
            make = partial(verdicts, folder, package, files, rows)
            return shared(tmp_path_factory, f"repaired {version}", make)

    return results


def verdicts(folder, package, files, rows):
    """Verdict and diagnosis of each row with a package of MaterialX that has patches."""
    ledger.apply(ledger.linked(package, folder / "MaterialX"), *files)
    path = [str(folder), str(ledger.ROOT / "python"), str(ledger.ROOT)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path)}
    command = [sys.executable, "-c", JUDGE, json.dumps(rows)]
    run = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert run.returncode == 0, run.stderr
    return {tuple(key.split("|")): result for key, result in json.loads(run.stdout).items()}


@pytest.mark.parametrize(
    "version, row", CASES, ids=lambda each: each if each in ROWS else " ".join(each)
)
def test_a_repair_makes_the_checks_pass_that_show_the_defect(judged, version, row):
    """Or what is left has another cause."""
    verdict, diagnosis, _ = judged(version)[row]
    with available(row[2]):
        if verdict == NOT_RUN:
            raise NotRun(diagnosis)
    cause = ROWS[version][row]
    assert verdict == PASSED or (cause and diagnosis.startswith(cause)), diagnosis


def test_with_all_patches_no_check_accuses_what_they_repair(judged, failing):
    repaired = {
        page: [
            row for each in (entry.repaired, *entry.remains.values()) for row in ledger.pairs(each)
        ]
        for page, entry in ENTRIES.items()
    }
    results = judged("release")
    assert {
        (*row, page) for row in failing for page in results[row][2] if row[:2] in repaired[page]
    } == set()


def test_the_page_of_patches_lists_what_still_fails_with_them(judged, failing):
    block = pages.INDEX.read_text("utf-8").split("<!-- remains -->")[1].split("<!-- end -->")[0]
    listed = [
        (check, subject)
        for checks, subjects in re.findall(r"(`\w+`(?:, `\w+`)*) of ([^;|]+)", block)
        for check in re.findall(r"\w+", checks)
        for subject in re.findall("`([^`]+)`", subjects)
    ]
    failed = {row[:2] for row in failing if judged("release")[row][0] == FAILED}
    assert sorted(listed) == sorted(failed)
