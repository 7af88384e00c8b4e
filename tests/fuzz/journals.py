# SPDX-License-Identifier: Apache-2.0
"""Journals of a real run, edited: each case is the report of one whose text was changed."""

import contextlib
import io
import json
import tempfile
from functools import cache
from pathlib import Path

from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import Case
from tests.fuzz.words import VALUES

NAME = "run/journal/items.jsonl"
ODD = (None, True, -1, 1.5, 10**9, 10**400, "x", [], {}, [None], {"a": None}, float("nan"))


@cache
def original():
    """Text of the journal of a run that needs no engine."""
    from mxeon.cli import main

    with tempfile.TemporaryDirectory(prefix="mxeon-fuzz-") as folder, contextlib.chdir(folder):
        document = str(examples_folder() / "plaster.mtlx")
        with contextlib.redirect_stdout(io.StringIO()):
            main(["check", document, "--host", "msl", "--workers", "0", "--report", "run"])
        return Path(NAME).read_text(encoding="utf-8")


def rows():
    """Line, place in it, and what is put there: a value for one of JSON's, or a byte."""
    lines = original().splitlines()
    for number, line in enumerate(lines):
        for path in paths(json.loads(line)):
            for value in (*ODD, *VALUES[:20]):
                yield number, path, value
        for place in range(0, len(line), 97):
            yield number, place, "\x00"


def to_case(_, row):
    """The case of a row: the report is made of the edited journal."""
    number, path, value = row
    lines = original().splitlines()
    if isinstance(path, int):
        lines[number] = lines[number][:path] + value + lines[number][path + 1 :]
    else:
        lines[number] = json.dumps(planted(json.loads(lines[number]), path, value))
    text = "\n".join(lines) + "\n"
    name = f"line {number}, {path}: {value!r}"
    return Case(name, ((NAME, text.encode(errors="replace")),), ("report", "make", "run"))


def planted(record, path, value):
    """A record in which a value stands at the end of a path of keys."""
    *parents, last = path
    part = record
    for key in parents:
        part = part[key]
    part[last] = value
    return record


def paths(part, path=()):
    """Keys that lead to each value of a record."""
    pairs = part.items() if isinstance(part, dict) else enumerate(part)
    for key, value in pairs:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from paths(value, (*path, key))
