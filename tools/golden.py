#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes all verdicts of the suite to a file, and compares two such files after a refactoring.

    python tools/golden.py write out/before.jsonl [--host gl ...]  # default: all hosts here
    python tools/golden.py compare out/before.jsonl out/after.jsonl

Each line has the result of a check on a subject with a library on a host. A result has the verdict,
the tolerance, whether the check detected the negative control, the diagnosis, and the pages of the
ledger. Numbers in a diagnosis are rounded to two digits, because engines differ in further digits.
"""

import argparse
import json
import subprocess
import sys
from itertools import product
from pathlib import Path

from mxeon import survey
from mxeon.hosts import host_rows, register

LIBRARIES = ("eonlib", "stock", "diffuse")
PLACE = ("host", "library", "subject", "check")
COMPARED = ("verdict", "tolerance", "caught", "diagnosis", "pages", "reason")
Line = dict[str, object]


def lines(host: str, library: str) -> list[Line]:
    """Results of `mxeon check --node all` on a host, or of `mxeon check` if `--node all` fails."""
    command = ["mxeon", "check", "--host", host, "--library", library, "--json"]
    for nodes in (["--node", "all"], []):
        run = subprocess.run([*command, *nodes], capture_output=True, text=True, check=False)
        if run.stdout.startswith("{"):
            return [line(each) for each in json.loads(run.stdout)["results"]]
    place = dict(zip(PLACE, (host, library, "", ""), strict=True))
    return [{**place, "reason": run.stderr.strip()}]


def line(result: Line) -> Line:
    control, tolerance = result["control"], result["tolerance"]
    return {
        **{key: result[key] for key in (*PLACE, "verdict", "pages", "reason")},
        "tolerance": None if tolerance is None else float(f"{tolerance:.3g}"),
        "caught": control["caught"] if isinstance(control, dict) else None,
        "diagnosis": rounded(result["diagnosis"]),
    }


def rounded(value: object) -> object:
    if isinstance(value, dict):
        return {name: rounded(each) for name, each in value.items()}
    if isinstance(value, list):
        return [rounded(each) for each in value]
    return float(f"{value:.2g}") if isinstance(value, float) else value


def compare(before: Path, after: Path) -> int:
    """Print all checks that differ, and return how many differ."""
    old, new = (
        {tuple(each[key] for key in PLACE): each for each in map(json.loads, path.open())}
        for path in (before, after)
    )
    count = 0
    for place in dict.fromkeys((*old, *new)):
        if place in old and place in new:
            values = {key: (old[place].get(key), new[place].get(key)) for key in COMPARED}
            rows = [f"{key}: {a!r} -> {b!r}" for key, (a, b) in values.items() if a != b]
        else:
            rows = ["gone" if place in old else "new"]
        for row in rows:
            print(*place, row, sep=" | ")
        count += bool(rows)
    print(f"{count} of {len(old.keys() | new.keys())} checks differ")
    return count


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    register(*survey.ROWS)
    hosts = [row.name for row in host_rows()]
    jobs = parser.add_subparsers(dest="job", required=True)
    write = jobs.add_parser("write")
    write.add_argument("file", type=Path)
    write.add_argument("--host", action="append", choices=hosts)
    comparison = jobs.add_parser("compare")
    comparison.add_argument("before", type=Path)
    comparison.add_argument("after", type=Path)
    options = parser.parse_args()
    if options.job == "compare":
        return int(compare(options.before, options.after) > 0)
    options.file.parent.mkdir(parents=True, exist_ok=True)
    with options.file.open("w", encoding="utf-8") as file:
        for host, library in product(options.host or hosts, LIBRARIES):
            results = lines(host, library)
            print(f"{host} {library}: {len(results)}", file=sys.stderr)
            file.writelines(json.dumps(each, sort_keys=True) + "\n" for each in results)
            file.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
