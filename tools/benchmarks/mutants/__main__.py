# SPDX-License-Identifier: Apache-2.0
"""Runs checks on mutants of eonlib, and writes to out/mutants which check detects each mutant.

    python -m tools.benchmarks.mutants [--only PATTERN] [--resume]    mutants in `table/`
    python -m tools.benchmarks.mutants --seed N [--share 0.1]         random mutants of operators

A survivor is a mutant that no check detects. The exit status is 0 if the survivors are exactly the
known survivors, otherwise 1.
"""

import argparse
import json
import re
import sys
from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from typing import Any

from tqdm import tqdm

from mxeon.conformance.run.judge import Judge
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT
from tools.benchmarks.mutants import operators, schemata
from tools.benchmarks.mutants.mutant import ROOT, read_table
from tools.benchmarks.mutants.trial import KILLED, SURVIVED, killed, trial

OUTPUT = ROOT / "out" / "mutants"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="tools.benchmarks.mutants", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--only", default="", metavar="PATTERN", help="in 'GROUP: NAME'")
    parser.add_argument("--resume", action="store_true", help="leave out what has been tried")
    parser.add_argument("--seed", type=int, help="try mutants of the operators, not of the table")
    parser.add_argument("--share", type=float, default=0.1, help="of the operators' mutants")
    options = parser.parse_args(arguments)
    if not 0.0 < options.share <= 1.0:
        parser.error(f"--share must be above 0 and at most 1; got {options.share:g}")
    seeded = options.seed is not None
    table = operators.made(options.seed, options.share) if seeded else read_table()
    chosen = [each for each in table if re.search(options.only, f"{each.group}: {each.name}")]
    file = OUTPUT / "mutants.json"
    trials: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    if options.resume:
        chosen = [each for each in chosen if trials.get(each.name, {}).get("digest") != each.digest]
    in_one_program = schemata.trials(chosen) if seeded else {}
    with closing(Judge(DEFAULT)) as judge:
        for mutant in tqdm(chosen, disable=None):
            check = in_one_program.get(mutant.name, schemata.UNWRITTEN)
            undetected = check in (SURVIVED, schemata.UNWRITTEN)
            found = trial(mutant, judge) if undetected else killed("gl", [check], "")
            trials[mutant.name] = {"digest": mutant.digest} | found
            write_text(file, json.dumps(trials, indent=1, sort_keys=True) + "\n")
    # Print the number of mutants by group and verdict, then all unexpected verdicts.
    verdicts = {each.name: trials[each.name]["verdict"] for each in chosen}
    counts = Counter((each.group, verdicts[each.name]) for each in chosen)
    unexpected = [each for each in chosen if (verdicts[each.name] == KILLED) == each.survives]
    for (group, verdict), count in counts.items():
        print(f"{group}: {count} {verdict}")
    for each in unexpected:
        print(f"{each.name}: {verdicts[each.name]} ({each.reason})")
    return int(bool(unexpected))


if __name__ == "__main__":
    sys.exit(main())
