# SPDX-License-Identifier: Apache-2.0
"""Kits with one file changed: a value of the description, bytes of a picture, a cell of a table."""

import json
import random
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from mxeon.io.images import write_exr
from mxeon.kit.export import DESCRIPTION, export_kit
from mxeon.kit.submitted import COLUMNS
from tests.fuzz.cases import Case
from tests.fuzz.journals import ODD, paths, planted
from tests.fuzz.words import VALUES

SIZE = 64
PICTURE = "renders/true_side"
CHECK = ("kit", "check", "kit")


@cache
def original():
    """The description of a kit, and a picture, as bytes."""
    with tempfile.TemporaryDirectory(prefix="mxeon-fuzz-") as folder:
        export_kit(folder, SIZE)
        path = Path(folder, "a.exr")
        write_exr(path, np.full((SIZE, SIZE, 3), 0.18), {})
        return Path(folder, DESCRIPTION).read_bytes(), path.read_bytes()


def rows():
    """What is changed, where, and into what."""
    for path in paths(json.loads(original()[0])):
        for value in (*ODD, *VALUES[:6]):
            yield "value", path, value
    for number in range(300):
        yield "bytes", number, None
    for place in range(5):
        for value in (*ODD, *VALUES):
            yield "cell", place, str(value)


def to_case(_, row):
    """The case of a row."""
    kind, place, value = row
    description, picture = original()
    file = f"kit/{PICTURE}.exr", picture
    if kind == "value":
        changed = planted(json.loads(description), place, value)
        description = json.dumps(changed).encode()
    elif kind == "bytes":
        file = file[0], _damaged(picture, place)
    else:
        cells = ["1", "1", "0.5", "0.5", "0.5"]
        cells[place] = value
        text = f"{','.join(COLUMNS)}\n{','.join(cells)}\n"
        file = f"kit/{PICTURE}.csv", text.encode(errors="surrogatepass")
    return Case(f"{kind} {place} {value!r}", ((f"kit/{DESCRIPTION}", description), file), CHECK)


def _damaged(data, seed):
    """Bytes of which twenty of the header are others, or of which the end is cut."""
    rng = random.Random(seed)
    if seed % 5 == 0:
        return data[: rng.randrange(len(data))]
    changed = bytearray(data)
    for _ in range(20):
        changed[rng.randrange(8, 400)] = rng.randrange(256)
    return bytes(changed)
