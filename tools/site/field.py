# SPDX-License-Identifier: Apache-2.0
"""Makes the site's page that compares renderers.

`python -m tools.site.field` measures the available hosts. `python -m tools.site.field DIR` reads
reports from a folder instead. Stored measurements of other hosts are kept.
"""

import base64
import io
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mxeon import check, report
from mxeon.conformance.results import NOT_RUN, Diagnosis
from mxeon.conformance.results.records import make_converter
from mxeon.conformance.specs.diffuse import DIFFUSE as DIFFUSE_SPECS
from mxeon.conformance.specs.diffuse import SURFACE_LOBES
from mxeon.hosts import host_rows
from mxeon.io.files import write_text
from mxeon.report.pieces import picture_uri
from mxeon.shaders.library import examples_folder
from mxeon.survey.field import Entry, by_harm, read_field
from mxeon.survey.field_page import INPUTS, SCENES, Frame, frames, render

DATA = Path(__file__).with_name("field.json")
PICTURES = DATA.with_suffix(".webp")  # portraits and difference maps, ACROSS per row
SIZE, ACROSS = 96, 8
PAGES = "upstream/{}.html"  # path of a ledger page, relative to the built field.html
EXAMPLE = examples_folder() / "clay.mtlx"
DIFFUSE = tuple(dict.fromkeys(row.node for row in (*DIFFUSE_SPECS, *SURFACE_LOBES)))
LIBRARIES = ("eonlib", "stock")
TIMEOUT = 600.0


@dataclass(frozen=True)
class Row:
    """A row of the page without the pictures.

    - `entry`: The entry with the largest error among entries with the same cause of failure.
    - `same`: Library and node of each other entry with the same cause.
    - `frames`: By scene, the scale of the difference map and the largest difference.
    """

    entry: Entry
    same: tuple[tuple[str, str], ...]
    frames: dict[str, tuple[float, float]]


def read() -> tuple[list[Row], Iterator[NDArray[np.uint8]]]:
    """The stored rows, and two pictures for each row and scene: portrait and difference map."""
    rows = make_converter().structure(json.loads(DATA.read_text(encoding="utf-8")), list[Row])
    lines = np.asarray(Image.open(PICTURES)).reshape(-1, SIZE, ACROSS, SIZE, 3)
    return rows, iter(lines.swapaxes(1, 2).reshape(-1, SIZE, SIZE, 3))


def text() -> str:
    """HTML of the page, with links to the site's ledger pages."""
    rows, pictures = read()
    uris = map(picture_uri, pictures)
    stored = {
        (row.entry.host, row.entry.library, row.entry.node, scene): (
            next(uris),
            next(uris),
            *numbers,
        )
        for row in rows
        for scene, numbers in row.frames.items()
    }

    def stored_frames(entries: Sequence[Entry], scene: str) -> Iterator[Frame]:
        for row, entry in enumerate(entries):
            if frame := stored.get((entry.host, entry.library, entry.node, scene)):
                yield row, entry, *frame

    entries = [
        replace(row.entry, library=library, node=node)
        for row in rows
        for library, node in ((row.entry.library, row.entry.node), *row.same)
    ]
    hosts = {each.host for each in entries}
    absent = " ".join(
        f"{row.name} was not measured{f': it needs {row.needs}' if row.needs else ''}."
        for row in host_rows()
        if row.name not in hosts
    )
    return "".join(render(entries, PAGES, absent, stored_frames))


def keep(folder: str) -> None:
    """Replace the stored rows of all hosts that have reports in a folder."""
    groups = by_harm(read_field([folder]))
    measured = {group[0].host for group in groups if group[0].verdict != NOT_RUN}
    old, old_pictures = read()
    rows, pictures = [], []
    for row in old:
        images = [next(old_pictures) for _ in range(2 * len(row.frames))]
        if row.entry.host not in measured:
            rows.append(row)
            pictures += images
    for group in (group for group in groups if group[0].host in measured):
        numbers = {}
        for scene in SCENES:
            for _, _, *uris, scale, largest in frames(group[:1], scene):
                numbers[scene] = (scale, largest)
                pictures += map(pixels, uris)
        same = tuple((each.library, each.node) for each in group[1:])
        rows.append(Row(essential(group[0]), same, numbers))
    write(rows, pictures)


def write(rows: list[Row], pictures: list[NDArray[np.uint8]]) -> None:
    records = make_converter().unstructure(rows)
    for cell in (cell for record in records for cell in record["entry"]["cells"].values()):
        for key in [key for key, value in cell.items() if value in (None, "", [], {})]:
            del cell[key]  # a reader uses the default value for a missing key
    write_text(DATA, "[\n" + ",\n".join(map(json.dumps, records)) + "\n]\n")
    blank = np.zeros((-len(pictures) % ACROSS, SIZE, SIZE, 3), np.uint8)
    lines = np.concatenate([pictures, blank]).reshape(-1, ACROSS, SIZE, SIZE, 3)
    tiles = Image.fromarray(lines.swapaxes(1, 2).reshape(-1, ACROSS * SIZE, 3))
    tiles.save(PICTURES, lossless=True, quality=100, method=6)


def pixels(uri: str) -> NDArray[np.uint8]:
    data = base64.b64decode(uri.partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))


def essential(entry: Entry) -> Entry:
    """A copy of an entry with only the fields that the page shows."""
    cells = {
        column: replace(
            cell,
            claim=column,
            quantity=None,
            derivation="",
            worst={name: cell.worst[name] for name in INPUTS if name in cell.worst},
            errors=(),
            samples="",
            diagnosis=Diagnosis(cell.diagnosis.causes[:1]),
            difference=None,
            control=None,
            measured=(),
            seconds=None,
        )
        for column, cell in entry.cells.items()
    }
    return replace(entry, cells=cells, portraits={}, report=Path())


def main(folder: str = "") -> None:
    if folder:
        keep(folder)
        return
    options: dict[str, Any] = {"workers": 1, "timeout": TIMEOUT}
    with TemporaryDirectory(prefix="mxeon-field-") as new:
        for row in (row for row in host_rows() if not row.needs):
            nodes = DIFFUSE if row.target else ("common",)
            run = check([EXAMPLE], [row.name], LIBRARIES, nodes=nodes, **options)
            if any(e.host == row.name and e.verdict != NOT_RUN for e in run.results):
                report.write(run, Path(new, row.name))
            print(row.name, run.sentence, flush=True)
        keep(new)


if __name__ == "__main__":
    main(*sys.argv[1:])
