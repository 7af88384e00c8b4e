# SPDX-License-Identifier: Apache-2.0
"""Judge the documents of MaterialX's repository, and write `documents.md`: the verdict on each, and its cause.

In a folder with the `resources` of a checkout of MaterialX:

    python -m tools.site.documents run FOLDER DIR     # mxeon check resources --report DIR, with its time
    python -m tools.site.documents page PAGE DIR ...  # the page, from the report of a run, and of runs of some documents again

An interrupted run is continued; its time is that of the part that ran last.
"""

import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from mxeon.conformance.results import PASSED, Run
from mxeon.conformance.run import read_run
from mxeon.conformance.run.documents import (
    DocumentVerdict,
    causes,
    document_verdicts,
)
from mxeon.io.files import write_text
from tools.benchmarks.rounds import machine

TIMES = "times.json"  # beside a report
COMMAND = ("check", "resources", "--path", ".", "--path", "resources", "--allowCode")
TEXT = """\
# MaterialX's documents

Do MaterialX's own example documents render correctly? mxeon checks all documents in `resources` of MaterialX's
repository, including its TestSuite and Examples, on gl with eonlib. {referenced} of {count} have a reference picture of
each material. Every pixel is compared with the NumPy models in float64, in two distant lights and in white surroundings;
if each pixel has a material of its own, every eighth row and column is. mxeon does not check patterns: if the reference
cannot compute the input of a lobe, it takes the values from the host, pixel by pixel. Large images that the copy of the
repository lacked may have been replaced by others of the same name.

`mxeon check FOLDER` does the same for any folder, on any host. The page is made by

    python -m tools.site.documents run FOLDER DIR
    python -m tools.site.documents page docs/documents.md DIR ...
"""


def judge(folder: str, report: str) -> int:
    """Run the check of a folder, and keep its time beside the report; the exit status."""
    resume = ["--resume"] if Path(report, "journal").is_dir() else []
    before = machine()
    start = time.monotonic()
    words = [*COMMAND, "--report", os.path.abspath(report), *resume]
    done = subprocess.run([sys.executable, "-P", "-m", "mxeon", *words], cwd=folder)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    times = {
        "minutes": (time.monotonic() - start) / 60.0,
        "processor minutes": (used.ru_utime + used.ru_stime) / 60.0,
    }
    write_text(Path(report, TIMES), json.dumps({**times, **before}))
    return done.returncode


def lines(
    verdicts: Sequence[DocumentVerdict], times: Mapping[str, object], tasks: int, again: int = 0
) -> Iterator[str]:
    """Lines of the page."""
    documents = {each.document for each in verdicts}
    lacking = {each.document for each in verdicts if not each.referenced}
    yield TEXT.format(referenced=len(documents) - len(lacking), count=len(documents))
    yield "## Causes\n"
    yield "| documents | verdict | cause |\n|---|---|---|"
    for (verdict, cause), names in causes(verdicts).items():
        yield f"| {len(names)} | {verdict} | {_cell(cause)} |"
    if times:
        numbers = dict(times)
        wall, used = (float(str(numbers.pop(f"{key}minutes"))) for key in ("", "processor "))
        yield (
            f"\nThe run, with {tasks} checks and pictures, took {wall:.0f} minutes and {used:.1f} minutes of "
            "processor time." + (f" {again} documents were judged again since." if again else "")
        )
        yield "\nMeasured on: " + ", ".join(f"{k} {v}" for k, v in numbers.items()) + "."
    yield "\n## Documents that do not pass\n"
    yield "| document | verdict | cause |\n|---|---|---|"
    for each in sorted(verdicts, key=lambda each: each.document):
        if each.verdict != PASSED:
            name = each.document.removeprefix("resources/")
            yield f"| {' | '.join(map(_cell, (name, each.verdict, each.cause)))} |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def merged(runs: Sequence[Run]) -> tuple[DocumentVerdict, ...]:
    """Verdicts of runs, the last one on each document."""
    verdicts: dict[str, list[DocumentVerdict]] = {}
    for run in runs:
        again = document_verdicts(run)
        verdicts |= {each.document: [] for each in again}
        for each in again:
            verdicts[each.document].append(each)
    return tuple(each for same in verdicts.values() for each in same)


def write_page(page: str, *reports: str) -> None:
    """Write the page of reports, whose time is that of the first."""
    times = Path(reports[0], TIMES)
    known = json.loads(times.read_text()) if times.is_file() else {}
    runs = [read_run(each) for each in reports]
    again = len({each.document for each in merged(runs[1:])})
    text = lines(merged(runs), known, len(runs[0].results), again)
    write_text(Path(page), "\n".join([*text, ""]))


if __name__ == "__main__":
    verb, *words = sys.argv[1:]
    sys.exit(judge(*words) if verb == "run" else write_page(*words))
