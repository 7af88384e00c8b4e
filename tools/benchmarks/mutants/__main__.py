# SPDX-License-Identifier: Apache-2.0
"""Runs `mxeon check` on mutants of eonlib, and writes which check detects each to out/mutants.

    python -m tools.benchmarks.mutants [--only PATTERN] [--resume]    the rows of the table
    python -m tools.benchmarks.mutants --seed N [--share 0.1]         some of the operators' mutants

Exit status: 0, or 1 if other mutants survive than those listed.
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
from tools.benchmarks.mutants.mutant import ROOT, Mutant, read_table
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
    seed, share = options.seed, options.share
    table = read_table() if seed is None else operators.made(seed, share)
    chosen = [each for each in table if re.search(options.only, f"{each.group}: {each.name}")]
    file = OUTPUT / "mutants.json"
    trials: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    if options.resume:
        chosen = [each for each in chosen if trials.get(each.name, {}).get("digest") != each.digest]
    together = {} if seed is None else schemata.trials(chosen)
    with closing(Judge(DEFAULT)) as judge:
        for mutant in tqdm(chosen, disable=None):
            check = together.get(mutant.name, schemata.UNWRITTEN)
            alone = check in (SURVIVED, schemata.UNWRITTEN)
            found = trial(mutant, judge) if alone else killed("gl", [check], "")
            trials[mutant.name] = {"digest": mutant.digest} | found
            write_text(file, json.dumps(trials, indent=1, sort_keys=True) + "\n")
    print(*lines(chosen, trials), sep="\n")
    return int(any((trials[m.name]["verdict"] == KILLED) == m.survives for m in chosen))


def lines(mutants: Sequence[Mutant], trials: dict[str, Any]) -> list[str]:
    """Lines to print: number of mutants by group and verdict, then each unexpected verdict."""
    counts = Counter((each.group, trials[each.name]["verdict"]) for each in mutants)
    wrong = [
        f"{each.name}: {trials[each.name]['verdict']} ({each.reason})"
        for each in mutants
        if (trials[each.name]["verdict"] == KILLED) == each.survives
    ]
    return [*(f"{group}: {count} {verdict}" for (group, verdict), count in counts.items()), *wrong]


if __name__ == "__main__":
    sys.exit(main())
