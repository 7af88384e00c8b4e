# SPDX-License-Identifier: Apache-2.0
"""Results of a real run, edited: what three commands make of a results.json that was changed."""

import contextlib
import io
import json
import tempfile
from functools import cache
from pathlib import Path

from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import OUT, Case
from tests.fuzz.journals import ODD, paths, planted
from tests.fuzz.words import VALUES

NAME = "run/results.json"
COMMANDS = (
    ("report", "diff", "run", "run"),
    ("report", "diff", "results.json", "run"),
    ("report", "field", "run", "--output", f"{OUT}/field.html"),
)


@cache
def original():
    """Text of the results of a run that needs no engine."""
    from mxeon.cli import main

    with tempfile.TemporaryDirectory(prefix="mxeon-fuzz-") as folder, contextlib.chdir(folder):
        document = str(examples_folder() / "plaster.mtlx")
        with contextlib.redirect_stdout(io.StringIO()):
            main(["check", document, "--host", "msl", "--workers", "0", "--report", "run"])
        return Path(NAME).read_text(encoding="utf-8")


def rows():
    """A command, a place in the results, and what is put there."""
    for path in paths(json.loads(original())):
        for value in (*ODD, *VALUES[:20], "\ud83d", "\x1b[31m", VALUES[-6]):
            for command in COMMANDS:
                yield command, path, value
    for place in range(0, len(original()), 97):
        for command in COMMANDS:
            yield command, place, "\x00"


def to_case(_, row):
    """The case of a row: the results are the run's but for one value, or one character."""
    command, path, value = row
    text = original()
    if isinstance(path, int):
        text = text[:path] + value + text[path + 1 :]
    else:
        text = json.dumps(planted(json.loads(text), path, value))
    name = f"{command[1]}, {path}: {value!r}"
    return Case(name, ((NAME, text.encode(errors="replace")),), command)
