# SPDX-License-Identifier: Apache-2.0
"""Measures the tables in the ledger: `python -m tools.site.ledger.measure [HOST ...]`."""

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

CHECKED = [each for each in issues().values() if each.rows]  # issues with a table of checks
# Renderers whose own nodes do not use MaterialX.
OWN_NODES = ("three", "babylon", "shadewire", "three-gpu-pathtracer")


def judged(host: str, rows: Collection[Row] = (), library: str = STOCK) -> tuple[list[Result], str]:
    """Results of the checks in `rows` on a host or "source", and names of the device and versions.

    By default, `rows` are all rows of pages about `host` and `library`. STOCK includes a renderer's
    own nodes.

    Raises
    ------
    NotRun
        If the host cannot run here.
    """
    rows = rows or {row for e in CHECKED if shows(e, host, library) for row in e.rows}
    hosts = () if host == SOURCE else (host,)
    tasks = make_plan((), hosts, (library,), nodes=(ALL, *node_names())).tasks
    tasks = [each for each in tasks if each.host == host]
    if host != SOURCE:
        tasks = [each for each in tasks if (each.check, each.subject) in rows]
    with closing(Judge(DEFAULT)) as judge:
        findings = [judge.work(task) for task in tasks]
    place = [f"{each.device}, {each.version}" for each in findings[0].hosts]
    if host not in OWN_NODES:
        place.append(f"MaterialX {mx.__version__}")
    return [result for each in findings for result in each.results], ", ".join(place)


def shows(issue: Issue, host: str, library: str) -> bool:
    return issue.host == host and (issue.library == EONLIB) == (library == EONLIB)


def record(issue: Issue, results: Sequence[Result], place: str) -> dict[str, Any]:
    by_row = {(each.check, each.subject): each for each in results}
    judged = [by_row[row] for row in issue.rows]
    rows = [
        [each.check, each.subject, figure(each), f"{each.tolerance:.2g}", each.quantity.value]
        for each in judged
        if each.quantity
    ]
    diagnosis = judged[0].diagnosis
    measures: dict[str, Any] = {"rows": rows, "place": place, "cause": fields(diagnosis.first)}
    ranking = sorted((distance, title) for title, distance in diagnosis.distances.items())
    nearest = [title for _, title in ranking if title != diagnosis.first.key]
    if diagnosis.kind is Kind.MODEL and nearest:
        measures["next"] = nearest[0]
    return dict(json.loads(json.dumps(measures)))  # converts tuples to lists


def fields(cause: Cause) -> dict[str, Any]:
    """The fields of a cause, except empty fields and fields that depend on the driver."""
    found = asdict(cause) | {"kind": cause.kind.value}
    if cause.region:
        region = found["region"].items()
        found["region"] = {name: each for name, each in region if each not in (None, (), "")}
    omitted = ("values", "rms", "point", "text")
    return {name: each for name, each in found.items() if each and name not in omitted}


def main(names: Sequence[str]) -> None:
    """Measure defects on the named hosts. Without names, reset all errors and measure all hosts."""
    found = measured()
    hosts = [host for each in issues().values() for host in each.hosts if host]
    if not names:
        found = {page: each | {"sizes": {}} for page, each in found.items()}
    for host, library in product(names or dict.fromkeys(hosts), (STOCK, EONLIB)):
        here = [each for each in issues().values() if host in each.hosts]
        here = [each for each in here if shows(each, each.host, library)]
        if not here:
            continue
        rows = {row for each in here for row in (*each.rows, *each.implied)}
        try:
            results, place = judged(host, rows, library)
        except NotRun as reason:
            print(f"not run: {reason}", file=sys.stderr)
            continue
        errors = {(e.check, e.subject): float(figure(e)) for e in results if e.error is not None}
        for issue in here:
            page = found.setdefault(issue.page, {})
            if issue.rows and host == issue.host:
                page.pop("next", None)
                page |= record(issue, results, place)
            sizes = page.setdefault("sizes", {})
            for check, subject in (*issue.rows, *issue.implied):
                if (check, subject) in errors:
                    largest = sizes.setdefault(check, {})
                    largest[subject] = max(errors[check, subject], largest.get(subject, 0.0))
    write_measured(found)


if __name__ == "__main__":
    main(sys.argv[1:])
