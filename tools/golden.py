#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every verdict of the suite in one file, to hold a redesign: what it must not change.

    python tools/golden.py write out/before.jsonl [--host gl ...]   every host that runs here x every library
    python tools/golden.py compare out/before.jsonl out/after.jsonl

A line is one check: host, library, subject and key; its verdict, tolerance, whether its control was
caught, diagnosis and pages. Distances in a diagnosis keep two digits, since engines differ in the rest.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

HOSTS = [
    "gl",
    "webgl",
    "vulkan",
    "wgsl",
    "slang",
    "osl",
    "materialx",
    "storm",
    "cycles",
    "cycles-native",
    "mitsuba",
    "three",
    "babylon",
    "three-gpu-pathtracer",
    "msl",
    "mdl",
]
LIBRARIES = ("eonlib", "stock", "diffuse")
PLACE = ("host", "library", "subject", "check")
SAME = ("verdict", "tolerance", "caught", "diagnosis", "pages", "reason")
Line = dict[str, object]


def lines(host: str, library: str) -> list[Line]:
    """The results of all nodes and the bundled examples on a host."""
    command = ["mxeon", "check", "--host", host, "--library", library, "--node", "all", "--json"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if not run.stdout.startswith("{"):  # a renderer with materials of its own takes no --node
        run = subprocess.run([*command[:6], "--json"], capture_output=True, text=True, check=False)
    if not run.stdout.startswith("{"):
        place = dict(zip(PLACE, (host, library, "", ""), strict=True))
        return [{**place, "reason": run.stderr.strip()}]
    return [line(each) for each in json.loads(run.stdout)["results"]]


def line(result: Line) -> Line:
    control = result["control"]
    tolerance = result["tolerance"]
    return {
        **{key: result[key] for key in PLACE},
        "verdict": result["verdict"],
        "tolerance": None if tolerance is None else float(f"{tolerance:.3g}"),
        "caught": control["caught"] if isinstance(control, dict) else None,
        "diagnosis": re.sub(r"\d+(\.\d+)?(e[-+]?\d+)?", rounded, str(result["diagnosis"])),
        "pages": result["pages"],
        "reason": result["reason"],
    }


def rounded(number: re.Match[str]) -> str:
    return f"{float(number[0]):.2g}"


def compare(before: Path, after: Path) -> int:
    """Print what differs, and count it."""
    old, new = (
        {tuple(each.get(key) for key in PLACE): each for each in map(json.loads, path.open())}
        for path in (before, after)
    )
    count = 0
    for place in dict.fromkeys((*old, *new)):
        was, now = old.get(place), new.get(place)
        rows = (
            [
                f"{key}: {was.get(key)!r} -> {now.get(key)!r}"
                for key in SAME
                if was.get(key) != now.get(key)
            ]
            if was and now
            else ["gone" if was else "new"]
        )
        for row in rows:
            print(*place, row, sep=" | ")
        count += bool(rows)
    print(f"{count} of {len(old.keys() | new.keys())} checks differ")
    return count


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    jobs = parser.add_subparsers(dest="job", required=True)
    write = jobs.add_parser("write")
    write.add_argument("file", type=Path)
    write.add_argument("--host", action="append", choices=HOSTS)
    both = jobs.add_parser("compare")
    both.add_argument("before", type=Path)
    both.add_argument("after", type=Path)
    options = parser.parse_args()
    if options.job == "compare":
        return int(compare(options.before, options.after) > 0)
    options.file.parent.mkdir(parents=True, exist_ok=True)
    with options.file.open("w", encoding="utf-8") as file:
        for host in options.host or HOSTS:
            for library in LIBRARIES:
                results = lines(host, library)
                print(f"{host} {library}: {len(results)}", file=sys.stderr)
                file.writelines(json.dumps(each, sort_keys=True) + "\n" for each in results)
                file.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
