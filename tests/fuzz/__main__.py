# SPDX-License-Identifier: Apache-2.0
"""Tries the cases of families, prints and keeps the figures; the exit status is 1 if there was a fault.

python -m tests.fuzz [FAMILY ...] [--cases N]
"""

import argparse
import sys
from collections import Counter

from tqdm import tqdm

from mxeon.jobs import pool
from tests.fuzz.families import FAMILIES, cases
from tests.reliability.__main__ import keep

LIMIT = 300.0  # seconds for one case, on a machine that is busy
STATUSES = {0: "accepted", 1: "failed", 2: "refused", 3: "not_run"}


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="tests.fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=", ".join(FAMILIES))
    parser.add_argument("--cases", type=int, help="of each family")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args(arguments)
    figures = {
        family: measured(family, options.cases, options.workers)
        for family in options.families or FAMILIES
    }
    keep("fuzz", figures)
    return 1 if any(each.get("faults") for each in figures.values()) else 0


def measured(family, count, workers):
    """Figures of a family, whose faults are told as they come."""
    tried, tally, most = cases(family, count), Counter(), [0.0, 0]
    outcomes = pool.run(FAMILIES[family].trial, tried, workers, LIMIT)
    for place, outcome in tqdm(outcomes, total=len(tried), desc=family, disable=None):
        status, fault, *taken = outcome.value or (None, outcome.failure)
        most = list(map(max, most, taken)) if taken else most
        tally["faults" if fault else STATUSES.get(status, "ended")] += 1
        if fault:
            print(f"{family}: {tried[place]}: {fault}", file=sys.stderr, flush=True)
    taken = {"seconds": round(most[0], 1), "mebibytes": most[1]} if most[1] else {}
    return {"tried": len(tried), **tally, **taken}


if __name__ == "__main__":
    sys.exit(main())
