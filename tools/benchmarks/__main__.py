# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmarks and prints their tables.

    python -m tools.benchmarks [GROUP ...] [--quick]

The exit status is 1 if a timed function computes a wrong value, otherwise 0. A missed goal is
reported, but is not an error.
"""

import argparse
import os
import sys
from importlib import import_module
from unittest.mock import patch

from mxeon.errors import NotRun
from tools.benchmarks import rounds
from tools.benchmarks.command import CACHE, ONE

QUICK = {  # arguments of `measure` with --quick, by group
    "shaders": {"rounds": 5},
    "materials": {"processes": 3, "size": 256},
    "registers": {"nodes": ("oren_nayar", "dielectric_bsdf")},
    "models": {"rounds": 2, "pairs": 100_000},
    "command": {"rounds": 1, "jobs": (ONE,)},
}


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(QUICK))
    parser.add_argument("--quick", action="store_true", help="small sizes, few rounds")
    options = parser.parse_args(arguments)
    unknown = set(options.groups) - QUICK.keys()
    if unknown:
        parser.error(f"group must be one of {', '.join(QUICK)}; got {', '.join(unknown)}")
    wrong = []
    for name in options.groups or QUICK:
        sizes = dict(QUICK[name]) if options.quick else {}
        try:
            with patch.dict(os.environ, {CACHE: "true"}):  # disables the cache of shaders
                group = import_module(f"tools.benchmarks.{name}").measure(**sizes)
        except NotRun as reason:
            print(f"benchmarks: {name} not run: {reason}", file=sys.stderr)
            continue
        print(rounds.table(group), flush=True)
        wrong += [each.name for each in group.checks if not each.passed]
    if wrong:
        print(f"benchmarks: wrong values: {', '.join(wrong)}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
