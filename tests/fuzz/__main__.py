# SPDX-License-Identifier: Apache-2.0
"""Runs the fuzzer's cases by family and prints figures. The exit status is 1 if a case had a fault.

python -m tests.fuzz [FAMILY ...] [--cases N]
"""

import argparse
import json
import sys
from collections import Counter

from tqdm import tqdm

from mxeon.jobs import pool
from tests.fuzz.cases import COUNTS, cases
from tests.fuzz.trial import judged

LIMIT = 300.0  # time limit of a case in seconds, long enough for a busy machine
STATUSES = {0: "accepted", 1: "failed", 2: "refused", 3: "not_run"}


def main():
    parser = argparse.ArgumentParser(prog="tests.fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=", ".join(COUNTS))
    parser.add_argument("--cases", type=int, help="of each family")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    figures = {}
    for family in options.families or COUNTS:
        tried = cases(family, options.cases)
        tally = figures[family] = Counter(tried=len(tried))
        outcomes = pool.run(judged, tried, options.workers, LIMIT)
        for place, outcome in tqdm(outcomes, total=len(tried), desc=family, disable=None):
            status, fault = outcome.value or (None, outcome.failure)
            tally["faults" if fault else STATUSES.get(status, "ended")] += 1
            if fault:
                print(f"{family}: {tried[place]}: {fault}", file=sys.stderr, flush=True)
    print(json.dumps(figures, indent=1))
    return any(each["faults"] for each in figures.values())


if __name__ == "__main__":
    sys.exit(main())
