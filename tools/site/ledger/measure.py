# SPDX-License-Identifier: Apache-2.0
"""Measure the tables of the ledger's pages: `python -m tools.site.ledger.measure [HOST ...]`."""

import json
import sys
from collections.abc import Collection, Sequence
from contextlib import closing
from dataclasses import asdict
from itertools import product
from typing import Any

import MaterialX as mx

from mxeon.conformance.results import SOURCE, Cause, Kind, Result
from mxeon.conformance.results.known_issues import EONLIB, STOCK, Issue, Row, issues
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import ALL, make_plan, node_names
from mxeon.errors import NotRun
from mxeon.shaders.document.policy import DEFAULT
from tools.site.ledger import figure, measured, write_measured

CHECKED = [each for each in issues().values() if each.rows]  # their pages have a table of checks
# Renderers whose own nodes need no MaterialX.
OWN_NODES = ("three", "babylon", "shadewire", "three-gpu-pathtracer")


def judged(host: str, rows: Collection[Row] = (), library: str = STOCK) -> tuple[list[Result], str]:
    """Results of some checks on a host or on "source", with device and versions.

    Without `rows`, the checks in the tables of this host's pages on `library`; STOCK includes a
    renderer's own nodes.

    Raises
    ------
    NotRun
        If the host cannot run here.
    """
    rows = rows or {row for e in CHECKED if shows(e, host, library) for row in e.rows}
    hosts = () if host == SOURCE else (host,)
    tasks = make_plan((), hosts, (library,), nodes=(ALL, *node_names())).tasks
    chosen = [
        each
        for each in tasks
        if each.host == host and (host == SOURCE or (each.check, each.subject) in rows)
    ]
    with closing(Judge(DEFAULT)) as judge:
        findings = [judge.work(task) for task in chosen]
    devices = [f"{each.device}, {each.version}" for each in findings[0].hosts]
    own = host in OWN_NODES
    place = ", ".join([*devices, *([] if own else [f"MaterialX {mx.__version__}"])])
    return [result for each in findings for result in each.results], place


def shows(issue: Issue, host: str, library: str) -> bool:
    """Whether the table of a page is measured on a host with a library."""
    return issue.host == host and (issue.library == EONLIB) == (library == EONLIB)


def record(issue: Issue, results: Sequence[Result], place: str) -> dict[str, Any]:
    """The data of an issue's page, from results that include its rows."""
    found = {(each.check, each.subject): each for each in results}
    shown = [found[row] for row in issue.rows]
    rows = [
        [each.check, each.subject, figure(each), f"{each.tolerance:.2g}", each.quantity.value]
        for each in shown
        if each.quantity
    ]
    diagnosis = shown[0].diagnosis
    measures: dict[str, Any] = {"rows": rows, "place": place, "cause": fields(diagnosis.first)}
    others = sorted((far, title) for title, far in diagnosis.distances.items())
    nearest = [title for _, title in others if title != diagnosis.first.key]
    if diagnosis.kind is Kind.MODEL and nearest:
        measures["next"] = nearest[0]
    return dict(json.loads(json.dumps(measures)))  # same types as when read


def fields(cause: Cause) -> dict[str, Any]:
    """The driver-independent fields of a cause, without empty ones."""
    found = asdict(cause) | {"kind": cause.kind.value}
    if cause.region:
        found["region"] = {
            name: each for name, each in found["region"].items() if each not in (None, (), "")
        }
    left_out = ("values", "rms", "point", "text")
    return {name: each for name, each in found.items() if each and name not in left_out}


def main(names: Sequence[str]) -> None:
    """Measure the defects of some hosts; without names, of all hosts, together with the largest errors."""
    found = measured()
    everywhere = [host for each in issues().values() for host in each.hosts if host]
    if not names:
        found = {page: each | {"sizes": {}} for page, each in found.items()}
    for host, library in product(names or dict.fromkeys(everywhere), (STOCK, EONLIB)):
        here = [
            each
            for each in issues().values()
            if host in each.hosts and shows(each, each.host, library)
        ]
        if not here:
            continue
        rows = {row for each in here for row in (*each.rows, *each.implied)}
        try:
            results, place = judged(host, rows, library)
        except NotRun as reason:
            print(f"not run: {reason}", file=sys.stderr)
            continue
        errors = {(each.check, each.subject): each for each in results if each.error is not None}
        for issue in here:
            page = found.setdefault(issue.page, {})
            if issue.rows and host == issue.host:
                page.pop("next", None)
                page |= record(issue, results, place)
            sizes = page.setdefault("sizes", {})
            for check, subject in (*issue.rows, *issue.implied):
                if (check, subject) in errors:
                    of, error = sizes.setdefault(check, {}), figure(errors[check, subject])
                    of[subject] = max(float(error), of.get(subject, 0.0))
    write_measured(found)


if __name__ == "__main__":
    main(sys.argv[1:])
