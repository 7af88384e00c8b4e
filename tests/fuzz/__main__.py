# SPDX-License-Identifier: Apache-2.0
"""Tries cases in processes of their own, keeps those that fail, and writes the figures.

With --keep the figures go to out/reliability.json under "fuzz".
"""

import argparse
import json
import sys
import time

from tqdm import tqdm

from mxeon.jobs import pool
from tests.fuzz.cases import case
from tests.fuzz.found import FOUND
from tests.fuzz.trial import guarded, numbered, trial
from tests.reliability.__main__ import keep


def main(arguments=None):
    """Run the command; the exit status is 1 if a case failed."""
    options = _options(arguments)
    if options.case is not None:
        tried = case(options.seed, options.case)
        fault = trial(tried)
        print(*tried.files, tried.arguments, fault or "no fault", sep="\n")
        return 1 if fault else 0
    numbers = range(options.start, options.start + options.cases)
    start = time.monotonic()
    failed = tuple(_failed([(options.seed, number) for number in numbers], options))
    seconds = time.monotonic() - start
    found = pool.run(guarded, FOUND, 1, options.limit)
    fixed = sum(not outcome.value and not outcome.failure for _, outcome in found)
    figures = {
        "cases": len(numbers),
        "seed": options.seed,
        "seconds": round(seconds),
        "limit": options.limit,
        "failed": len(failed),
        "faults_found": len(FOUND),
        "faults_fixed": fixed,
    }
    if options.keep:
        keep("fuzz", figures)
    else:
        print(json.dumps(figures, indent=1))
    return 1 if failed or fixed < len(FOUND) else 0


def _options(arguments):
    parser = argparse.ArgumentParser(prog="tests.fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=20_000)
    parser.add_argument("--start", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--case", type=int, metavar="NUMBER", help="try this one alone, here")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--limit", type=float, default=20.0, help="seconds for one case")
    parser.add_argument("--keep", action="store_true", help="keep the figures in out/")
    return parser.parse_args(arguments)


def _failed(keys, options):
    """The cases that fail, told as they come."""
    outcomes = pool.run(numbered, keys, options.workers, options.limit)
    for place, outcome in tqdm(outcomes, total=len(keys), disable=None):
        if reason := outcome.failure or outcome.value:
            print(f"case {keys[place][1]}: {reason}", file=sys.stderr, flush=True)
            yield keys[place]


if __name__ == "__main__":
    sys.exit(main())
