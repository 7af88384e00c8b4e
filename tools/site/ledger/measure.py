# SPDX-License-Identifier: Apache-2.0
"""Measure the tables of the ledger's pages: `python -m tools.site.ledger.measure [HOST ...]`."""

import re
import sys
from collections.abc import Sequence
from contextlib import closing
from typing import Any

import MaterialX as mx

from mxeon.conformance import words
from mxeon.conformance.results import SOURCE, Cause, Result
from mxeon.conformance.results.known_issues import ISSUES, RENDERERS, STOCK, Issue
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import ALL, make_plan
from mxeon.errors import NotRun
from mxeon.shaders.document.policy import DEFAULT
from tools.site.ledger import figure, measured, pages, write_measured

CHECKED = tuple(each for each in ISSUES if each.rows)  # issues whose pages have a table of checks


def judged(host: str) -> tuple[list[Result], str]:
    """The results of the checks that show defects on a host or on "source", and device and versions.

    Raises
    ------
    NotRun
        If the host cannot run here.
    """
    rows = {row for issue in CHECKED if issue.host == host for row in issue.rows}
    tasks = make_plan((), () if host == SOURCE else (host,), (STOCK,), nodes=(ALL,)).tasks
    chosen = [
        each
        for each in tasks
        if each.host == host and (host == SOURCE or (each.check, each.subject) in rows)
    ]
    with closing(Judge(DEFAULT)) as judge:
        findings = [judge.work(task) for task in chosen]
    devices = [f"{each.device}, {each.version}" for each in findings[0].hosts]
    own = host in RENDERERS and host != "cycles"  # its nodes need no MaterialX
    place = ", ".join([*devices, *([] if own else [f"MaterialX {mx.__version__}"])])
    return [result for each in findings for result in each.results], place


def record(issue: Issue, results: Sequence[Result], place: str) -> dict[str, Any]:
    """What the page of an issue shows of results, among which are those of its rows."""
    found = {(each.check, each.subject): each for each in results}
    shown = [found[row] for row in issue.rows]
    rows = [
        [
            each.check,
            each.subject,
            figure(each),
            f"{each.tolerance:.2g}",
            each.quantity and each.quantity.value,
        ]
        for each in shown
    ]
    # Without distances, which depend on the driver.
    found_words = words.diagnosis(shown[0].diagnosis)
    says = re.sub(r" \((?:rms )?\d[\d.e+-]*\)", "", found_words)
    return {"rows": rows, "place": place, "says": says, "cause": identity(shown[0].diagnosis.first)}


def identity(cause: Cause) -> dict[str, Any]:
    """What `mxeon.conformance.results.known_issues` compares of a cause: its fields but the numbers."""
    fields: dict[str, Any] = {"kind": cause.kind.value, "key": cause.key}
    if cause.names:
        fields["names"] = list(cause.names)
    if cause.branch:
        fields["branch"] = cause.branch
    if place := cause.region:
        channels = list(place.channels)
        fields["region"] = {"name": place.name, "part": place.part, "channels": channels}
    return fields


def main(hosts: Sequence[str]) -> None:
    """Measure the pages that show on the hosts, on all of them if there are none, and write them."""
    found = measured()
    for host in dict.fromkeys(each.host for each in CHECKED):
        if hosts and host not in hosts:
            continue
        try:
            results, place = judged(host)
        except NotRun as reason:
            print(f"not run: {reason}", file=sys.stderr)
            continue
        for issue in CHECKED:
            if issue.host == host:
                found[issue.page] = found.get(issue.page, {}) | record(issue, results, place)
    write_measured(found)
    pages.main()


if __name__ == "__main__":
    main(sys.argv[1:])
