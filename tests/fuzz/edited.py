# SPDX-License-Identifier: Apache-2.0
"""Files that mxeon wrote, with one value or some bytes changed: of a run, and of a kit."""

import contextlib
import io
import json
import random
import tempfile
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np

from mxeon.io.images import write_exr
from mxeon.kit.export import DESCRIPTION, export_kit
from mxeon.kit.submitted import COLUMNS
from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import OUT, Case
from tests.fuzz.words import VALUES

JOURNAL, RESULTS, PICTURE = "run/journal/items.jsonl", "run/results.json", "kit/renders/true_side"
ODD = (None, True, -1, 1.5, 10**9, 10**400, "x", [], {}, [None], {"a": None}, float("nan"))
ODD += (*VALUES[:20], "\ud83d", "\x1b[31m", VALUES[-6])
READERS = (
    ("report", "diff", "run", "run"),
    ("report", "diff", "results.json", "run"),
    ("report", "field", "run", "--output", f"{OUT}/field.html"),
)
SIZE = 64


@cache
def originals():
    """Texts of the journal and the results of a run that needs no engine, by their names."""
    from mxeon.cli import main

    document = str(examples_folder() / "plaster.mtlx")
    with tempfile.TemporaryDirectory(prefix="mxeon-fuzz-") as folder, contextlib.chdir(folder):
        with contextlib.redirect_stdout(io.StringIO()):
            main(["check", document, "--host", "msl", "--workers", "0", "--report", "run"])
        return {name: Path(name).read_text(encoding="utf-8") for name in (JOURNAL, RESULTS)}


@cache
def kit():
    """The description of a kit, and a picture, as bytes."""
    with tempfile.TemporaryDirectory(prefix="mxeon-fuzz-") as folder:
        export_kit(folder, SIZE)
        write_exr(path := Path(folder, "a.exr"), np.full((SIZE, SIZE, 3), 0.18), {})
        return Path(folder, DESCRIPTION).read_bytes(), path.read_bytes()


def edits(text):
    """Places in JSON and what is put there: a value at the end of a path of keys, or a character."""
    yield from product(paths(json.loads(text)), ODD)
    yield from product(range(0, len(text), 97), ["\x00"])


def edited(text, place, value):
    """JSON with one of its edits, as bytes."""
    if isinstance(place, int):
        text = text[:place] + value + text[place + 1 :]
    else:
        record = part = json.loads(text)
        for key in place[:-1]:
            part = part[key]
        part[place[-1]] = value
        text = json.dumps(record)
    return text.encode(errors="replace")


def paths(part, path=()):
    """Keys that lead to each value of a record."""
    pairs = part.items() if isinstance(part, dict) else enumerate(part)
    for key, value in pairs:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from paths(value, (*path, key))


def journal_rows():
    """Numbers of lines, and their edits."""
    for number, line in enumerate(originals()[JOURNAL].splitlines()):
        yield from product([number], edits(line))


def to_journal(_, row):
    """The report of an edited journal."""
    number, edit = row
    lines = [line.encode() for line in originals()[JOURNAL].splitlines()]
    lines[number] = edited(lines[number].decode(), *edit)
    return Case(f"line {row}", ((JOURNAL, b"\n".join(lines) + b"\n"),), ("report", "make", "run"))


def result_rows():
    """Edits of the results, and commands that read them."""
    return product(edits(originals()[RESULTS]), READERS)


def to_results(_, row):
    """What a command makes of edited results."""
    edit, command = row
    return Case(f"{row}", ((RESULTS, edited(originals()[RESULTS], *edit)),), command)


def kit_rows():
    """Which file of a kit is changed, where, and into what."""
    yield from product(["value"], edits(kit()[0].decode()))
    yield from product(["bytes"], range(300))
    yield from product(["cell"], product(range(5), map(str, ODD)))


def to_kit(_, row):
    """A kit with one file changed: its description, a picture, or a table in place of one."""
    kind, change = row
    description, picture = kit()
    file = f"{PICTURE}.exr", picture
    if kind == "value":
        description = edited(description.decode(), *change)
    elif kind == "bytes":
        file = file[0], _damaged(picture, change)
    else:
        cells = ["1", "1", "0.5", "0.5", "0.5"]
        cells[change[0]] = change[1]
        text = f"{','.join(COLUMNS)}\n{','.join(cells)}\n"
        file = f"{PICTURE}.csv", text.encode(errors="surrogatepass")
    return Case(f"{row}", ((f"kit/{DESCRIPTION}", description), file), ("kit", "check", "kit"))


def _damaged(data, seed):
    """Bytes of which twenty of the header are others, or of which the end is cut."""
    rng = random.Random(seed)
    if seed % 5 == 0:
        return data[: rng.randrange(len(data))]
    changed = bytearray(data)
    for _ in range(20):
        changed[rng.randrange(8, 400)] = rng.randrange(256)
    return bytes(changed)
