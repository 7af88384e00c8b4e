# SPDX-License-Identifier: Apache-2.0
"""With the minimal repairs of MaterialX's data, the checks that reveal the defects pass."""

import json
import os
import re
import sys
from functools import cache, partial
from pathlib import Path

import MaterialX as mx
import pytest

from mxeon.conformance.results.known_issues import issues
from mxeon.errors import NotRun
from tests.support.availability import available
from tests.support.command import output
from tests.support.sharing import every_node, shared
from tests.support.verdicts import FAILED, NOT_RUN, PASSED, SOURCE, STOCK
from tests.support.wheels import MAIN, wheel
from tools.site import ledger

pytestmark = pytest.mark.whole

# Program that judges rows of the ledger of defects and prints the results.
JUDGE = """
import json, sys
from mxeon.errors import NotRun
from tests.support.verdicts import NOT_RUN, SOURCE, Verdicts
judged = Verdicts()
results = {}
for check, subject, host, library in json.loads(sys.argv[1]):
    text, key = host == SOURCE, "|".join((check, subject, host))
    try:
        result = judged.texts(check, library)[subject] if text else judged(check, subject, host, library)
        cause = result.diagnosis.first
        found = cause.kind.value, cause.key, cause.region and cause.region.name
        results[key] = result.verdict, found, result.pages
    except NotRun as reason:
        results[key] = NOT_RUN, str(reason), ()
print(json.dumps(results))
"""


ISSUES = issues()
PATCHES = ledger.patches("materialx")
# Patches of the main branch that repair defects which no pull request has repaired.
OF_MAIN = [path for page, path in PATCHES.items() if not ISSUES[page].pull]
# Pages on defects whose patched files differ on the main branch.
CHANGED = re.findall(r"^--- a/.*$", MAIN.read_text(), re.MULTILINE)
ON_MAIN = [page for page in PATCHES if {*CHANGED} & {*PATCHES[page].read_text().splitlines()}]


def rows_of(names):
    """Checks that the named pages list, with causes by which a check may fail after the repair."""
    return {
        (*row, ISSUES[page].host or "gl"): ISSUES[page].remains.get(row, ())
        for page in names
        for row in ISSUES[page].mended
    }


def is_one_of(found, causes):
    """Whether a cause in `causes` has the kind, key and region of a failure's cause."""
    regions = [each.region and each.region.name for each in causes]
    return found in [[e.kind.value, e.key, name] for e, name in zip(causes, regions, strict=True)]


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """Check, subject and host of each page's rows that fail or differ without a repair."""
    with available("gl"):
        on_gl = {(e.check, e.subject) for e in every_node(tmp_path_factory, STOCK).results}
    return [
        (*row, issue.host)
        for issue in ISSUES.values()
        if issue.library == STOCK and issue.host in ("gl", SOURCE)
        for row in (*issue.rows, *issue.implied)
        if row in (on_gl if issue.host == "gl" else issue.rows)
    ]


# Library that a listed check judges, by check, subject and host.
LIBRARIES = {
    (*row, ISSUES[page].host): ISSUES[page].library for page in PATCHES for row in ISSUES[page].rows
}
ROWS = {"release": rows_of(PATCHES), "main": rows_of(ON_MAIN)}
CASES = [(version, row) for version, rows in ROWS.items() for row in sorted(rows)]


@pytest.fixture(scope="module")
def judged(tmp_path_factory, failing):
    """Function that returns verdict and diagnosis by row of the ledger, for a repaired MaterialX.

    On the main branch, defects that are already repaired must pass without a patch.
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
    """Judge a patched MaterialX. Return verdict and diagnosis by row of the ledger of defects."""
    ledger.apply(ledger.linked(package, folder / "MaterialX"), *files)
    path = [str(folder), str(ledger.ROOT / "python"), str(ledger.ROOT)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path)}
    rows = [(*row, LIBRARIES.get(row, STOCK)) for row in rows]
    found = json.loads(output(sys.executable, "-c", JUDGE, json.dumps(rows), env=environment))
    return {tuple(key.split("|")): result for key, result in found.items()}


@pytest.mark.parametrize(
    "version, row", CASES, ids=lambda each: each if each in ROWS else " ".join(each)
)
def test_a_repair_makes_the_checks_pass_that_show_the_defect(judged, version, row):
    """A check may fail after the repair only if another known defect is the cause."""
    verdict, found, _ = judged(version)[row]
    with available(row[2]):
        if verdict == NOT_RUN:
            raise NotRun(found)
    assert verdict == PASSED or is_one_of(found, ROWS[version][row]), found


def test_with_all_patches_no_check_accuses_what_they_repair(judged, failing):
    results = judged("release")
    accused = [(*row, page) for row in failing for page in results[row][2]]
    assert [row for row in accused if row[:2] in ISSUES[row[-1]].mended] == []


def test_what_still_fails_with_all_patches_has_a_page_or_a_known_cause(judged, failing):
    known = ROWS["release"]
    for row in failing:
        verdict, found, pages = judged("release")[row]
        explained = pages or is_one_of(found, known.get(row, ()))
        assert verdict != FAILED or explained, (*row, *found)
