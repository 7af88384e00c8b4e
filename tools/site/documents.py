# SPDX-License-Identifier: Apache-2.0
"""Judge the documents of MaterialX's repository, and write the tables of `docs/documents.md`: verdicts, and causes.

In a folder with the `resources` of a checkout of MaterialX:

    python -m tools.site.documents run FOLDER DIR  # mxeon check resources --report DIR, with its time
    python -m tools.site.documents page DIR ...  # the page, from the report of a run, and of runs of some documents again

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
from mxeon.conformance.run.plan import DocumentVerdict, causes, document_verdicts
from mxeon.io.files import write_text
from tools.benchmarks.rounds import machine
from tools.site import DOCS, with_block

PAGE = DOCS / "documents.md"
TIMES = "times.json"  # beside a report
COMMAND = ("check", "resources", "--path", ".", "--path", "resources", "--allowCode")


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


def tables(runs: Sequence[Run], times: Mapping[str, object]) -> Iterator[str]:
    """Lines of the page, of a run and of runs of some documents again, whose verdicts count."""
    latest: dict[str, list[DocumentVerdict]] = {}
    for run in runs:
        again: dict[str, list[DocumentVerdict]] = {}
        for each in document_verdicts(run):
            again.setdefault(each.document, []).append(each)
        latest |= again
    verdicts = [each for same in latest.values() for each in same]
    lacking = {each.document for each in verdicts if not each.referenced}
    yield f"{len(latest) - len(lacking)} of {len(latest)} documents have a reference picture of each material.\n"
    yield "## Causes\n"
    yield "| documents | verdict | cause |\n|---|---|---|"
    for (verdict, cause), names in causes(verdicts).items():
        yield f"| {len(names)} | {verdict} | {_cell(cause)} |"
    if times:
        numbers = dict(times)
        wall, used = (float(str(numbers.pop(f"{key}minutes"))) for key in ("", "processor "))
        repeated = len({each.document for run in runs[1:] for each in document_verdicts(run)})
        yield (
            f"\nThe run, with {len(runs[0].results)} checks and pictures, took {wall:.0f} minutes and {used:.1f} "
            "minutes of processor time."
            + (f" {repeated} documents were judged again since." * bool(repeated))
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


def write_page(*reports: str) -> None:
    """Write the tables of reports, whose time is that of the first."""
    times = Path(reports[0], TIMES)
    known = json.loads(times.read_text()) if times.is_file() else {}
    made = "\n".join([*tables([read_run(each) for each in reports], known), ""])
    write_text(PAGE, with_block(PAGE.read_text(encoding="utf-8"), "verdicts", made))


if __name__ == "__main__":
    verb, *words = sys.argv[1:]
    sys.exit(judge(*words) if verb == "run" else write_page(*words))
