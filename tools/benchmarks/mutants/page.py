# SPDX-License-Identifier: Apache-2.0
"""docs/mutants.md from the JSON."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from mxeon.io.files import write_text
from tools.benchmarks.mutants.mutant import Mutant

LENGTH = 160  # characters of a change that are shown
CHEAP = ("gl", "text", "tests")  # in the place of a host, what needs no other renderer


def write(file: Path, mutants: Sequence[Mutant], trials: Mapping[str, Any]) -> None:
    """Write the page of the mutants that were tried."""
    environment = Environment(
        loader=PackageLoader("tools.benchmarks.mutants", "."),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"cell": cell, "code": code}
    rows = [(mutant, trials[mutant.name]) for mutant in mutants if mutant.name in trials]
    template = environment.get_template("mutants.md.jinja")
    untried = [
        mutant for mutant in mutants if trials.get(mutant.name, {}).get("digest") != mutant.digest
    ]
    parts = {name: counted_by(rows, name) for name in ("group", "file")}
    write_text(
        file,
        template.render(
            rows=rows, parts=parts, groups=parts["group"], change=change, untried=untried
        ),
    )


def counted_by(rows: Sequence[tuple[Mutant, Any]], name: str) -> list[dict[str, Any]]:
    """Counts of each value of an attribute of mutants: of each implementation, or of each file."""
    titles = dict.fromkeys(getattr(mutant, name) for mutant, _ in rows)
    return [
        {"title": title} | counts([row for row in rows if getattr(row[0], name) == title])
        for title in titles
    ]


def counts(rows: Sequence[tuple[Mutant, Any]]) -> dict[str, int]:
    """Numbers of mutants but controls: those that count, killed, on gl or by text, equivalent."""
    rows = [row for row in rows if not row[0].control]
    wrong = [trial for mutant, trial in rows if not mutant.equivalent]
    killed = [trial for trial in wrong if trial["verdict"] == "killed"]
    return {
        "total": len(wrong),
        "killed": len(killed),
        "cheap": sum(trial["host"] in CHEAP for trial in killed),
        "equivalent": len(rows) - len(wrong),
    }


def change(mutant: Mutant) -> tuple[str, str]:
    """Old and new text; of long ones, without the words that both begin and end with."""
    old, new = mutant.old, mutant.new
    if len(old) + len(new) <= LENGTH:
        return old, new
    start = end = 0
    while start < min(len(old), len(new)) and old[start] == new[start]:
        start += 1
    while end < min(len(old), len(new)) - start and old[-1 - end] == new[-1 - end]:
        end += 1
    start, end = _word_start(old, start), _word_start(old[::-1], end)
    return old[start : len(old) - end], new[start : len(new) - end]


def _word_start(text: str, place: int) -> int:
    """The place of a change, moved back to a space."""
    while place and not text[place - 1].isspace():
        place -= 1
    return place


def cell(text: str) -> str:
    """Text for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")


def code(text: str) -> str:
    """Code for a cell of a table, cut where it is long."""
    line = " ".join(text.split())
    if not line:
        return "nothing"
    line = line if len(line) <= LENGTH else f"{line[: LENGTH - 4]} ..."
    return f"`{line}`".replace("|", "\\|")
