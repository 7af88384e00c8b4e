# SPDX-License-Identifier: Apache-2.0
"""The page that compares renderers, which is one HTML file. The `report` extra is required."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import TypeAlias

import numpy as np
from markupsafe import Markup

import mxeon
from mxeon.conformance.results import Result, report_files
from mxeon.io.files import check_output, replacing
from mxeon.io.images import difference, difference_scale, read_image
from mxeon.io.srgb import srgb_encoded
from mxeon.report.formats import share, vector
from mxeon.report.pieces import difference_gradient, difference_pixels, generate_page, picture_uri
from mxeon.survey.field import CHECKS, Entry, by_harm

# Heading and meaning of each column.
HEADINGS = {
    "direct": ("Direct light", "worst error of π f cos θ over all pairs of directions"),
    "surroundings": ("Environment", "worst error of the albedo in a uniform environment"),
    "energy": ("White furnace", "what a white surface loses or gains"),
    "color": ("Color", "error of the albedo at mixed reflectance"),
    "black": ("Black", "what a black surface scatters"),
    "back": ("Back-lit", "worst error of the pictures in light from behind"),
}
SCENES = {"side": "light from the side", "back": "light from behind"}
# Row number, entry, image, difference map, scale of the difference map, and largest difference.
Frame: TypeAlias = tuple[int, Entry, str, str, float, float]
INPUTS = ("color", "roughness", "wo", "wi", "measured", "expected")


def write_field(entries: Sequence[Entry], file: str | PathLike[str]) -> Path:
    """Write the page that compares renderers, and return its path; see `render`."""
    read = (each for entry in entries for each in report_files(entry.report))
    check_output(file, read, [".html"])
    with replacing(Path(file)) as temporary, open(temporary, "w", encoding="utf-8") as page:
        page.writelines(render(entries))
    return Path(file)


def frames(entries: Sequence[Entry], scene: str) -> Iterator[Frame]:
    """Images and difference maps of a scene's portraits. Small errors are dark in maps."""
    for row, entry in enumerate(entries):
        portrait = entry.portraits.get(scene)
        if portrait is None:
            continue
        image, model = read_image(portrait.image), read_image(portrait.reference)
        differences = np.abs(difference(image, model))
        scale = max(difference_scale(differences), entry.cells["direct"].tolerance or 0.0)
        picture, errors = srgb_encoded(image), difference_pixels(differences, scale)
        yield row, entry, picture_uri(picture), picture_uri(errors), scale, portrait.difference


def render(
    entries: Sequence[Entry],
    pages: str = "",
    note: str = "",
    frames: Callable[[Sequence[Entry], str], Iterator[Frame]] = frames,
) -> Iterator[str]:
    """Generate the page in pieces, so that pictures are read one by one.

    `pages` is the address of the pages about defects, with `{}` for the name of a page, or "" for
    no links. `note` is text that follows the counts. `frames` returns the portraits of the first
    entry in each row. The HTML loads no files, works without JavaScript, and escapes the text of
    reports.
    """
    counts = Counter(entry.verdict for entry in entries)
    rows = by_harm(entries)
    return generate_page(
        "mxeon.survey",
        "field",
        {"breakable": breakable},
        version=mxeon.__version__,
        entries=entries,
        rows=rows,
        columns={column: HEADINGS[column] for column in CHECKS},
        claims=sorted({entry.claimed for entry in entries}),
        verdicts=tuple(counts),
        counts=counts,
        scenes=SCENES,
        frames=lambda scene: frames([row[0] for row in rows], scene),
        where=where,
        order=order,
        address=pages.format,
        linked=bool(pages),
        note=note,
        gradient=Markup(difference_gradient()),
    )


def order(cell: Result | None) -> float:
    """Sort key of a cell, the error divided by the tolerance. Checks that did not run come last."""
    ratio = math.inf if cell is None or cell.error is None else share(cell)
    return ratio if math.isfinite(ratio) else 1e30


def breakable(name: str) -> Markup:
    """A name as HTML, with possible line breaks after underscores."""
    return Markup("_<wbr>").join(name.split("_"))


def where(cell: Result) -> dict[str, str]:
    """The inputs and values at the worst point, as text."""
    return {name: vector(cell.worst[name]) for name in INPUTS if name in cell.worst}
