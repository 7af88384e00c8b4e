# SPDX-License-Identifier: Apache-2.0
"""Runs `mxeon check` on wrong libraries: writes docs/mutants.json, and the page from it.

    python -m tools.benchmarks.mutants [--only PATTERN] [--resume] [--output DIR]
    python -m tools.benchmarks.mutants --page           the page alone, from the JSON that is there

Exit status: 0, or 1 if a mutant survives that is not listed so, or one that is does not.
"""

import argparse
import json
import re
import sys
import tempfile
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from tqdm import tqdm

from mxeon.conformance.run.judge import Judge
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT
from tools.benchmarks.mutants import page
from tools.benchmarks.mutants.mutant import Mutant, read_table
from tools.benchmarks.mutants.quick import Quick
from tools.benchmarks.mutants.trial import KILLED, trial

DOCS = Path(__file__).resolve().parents[3] / "docs"


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the mutants that are asked for; the exit status."""
    parser = argparse.ArgumentParser(
        prog="tools.benchmarks.mutants", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--only", default="", metavar="PATTERN", help="in 'GROUP: NAME'")
    parser.add_argument("--resume", action="store_true", help="leave out what has been tried")
    parser.add_argument("--all", action="store_true", help="go on after the first failure")
    parser.add_argument("--output", type=Path, default=DOCS, help="folder of JSON and page")
    parser.add_argument("--page", action="store_true", help="make the page alone")
    options = parser.parse_args(arguments)
    table, file = read_table(), options.output / "mutants.json"
    trials = _read(file)
    if not options.page:
        chosen = [each for each in table if re.search(options.only, f"{each.group}: {each.name}")]
        if options.resume:
            chosen = [each for each in chosen if not _tried(each, trials)]
        _try_all(chosen, trials, file, options.all)
    page.write(options.output / "mutants.md", table, trials)
    wrong = [each for each in table if each.name in trials and _is_wrong(each, trials[each.name])]
    for each in wrong:
        verdict = trials[each.name]["verdict"]
        print(f"tools.benchmarks.mutants: {each.group}: {each.name}: {verdict}", file=sys.stderr)
    return 1 if wrong else 0


def _try_all(mutants: Sequence[Mutant], trials: dict[str, Any], file: Path, every: bool) -> None:
    """Try mutants, and keep each result as soon as it is there."""
    with closing(Judge(DEFAULT)) as judge, closing(Quick()) as quick:
        for mutant in tqdm(mutants):
            found = trial(mutant, judge, quick, every)
            trials[mutant.name] = {"digest": mutant.digest} | summary(found)
            write_text(file, json.dumps(trials, indent=1, sort_keys=True) + "\n")


def summary(found: dict[str, Any]) -> dict[str, Any]:
    """The checks that failed, and the explanation of the clearest failure."""
    if found["verdict"] != KILLED:
        return found
    failures = found.get("failures", [])
    clearest = failures[0] if failures else {"diagnosis": found["refusal"]}
    words = (clearest.get("excess"), clearest["diagnosis"])
    return {
        "verdict": KILLED,
        "host": found["host"],
        "checks": list(dict.fromkeys(each["check"] for each in failures)) or ["refused"],
        "explanation": _placeless("; ".join(filter(None, words))),
    }


def _placeless(words: str) -> str:
    """`words` with files by their names alone: the folder of a trial is gone with it."""
    return re.sub(rf"{re.escape(tempfile.gettempdir())}/\S*/", "", words)


def _read(file: Path) -> dict[str, Any]:
    trials: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    return trials


def _tried(mutant: Mutant, trials: dict[str, Any]) -> bool:
    return trials.get(mutant.name, {}).get("digest") == mutant.digest


def _is_wrong(mutant: Mutant, found: dict[str, Any]) -> bool:
    """Whether a mutant survived, or one that is listed as a survivor did not."""
    return (found["verdict"] == KILLED) == mutant.survives


if __name__ == "__main__":
    sys.exit(main())
