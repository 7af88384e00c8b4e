# SPDX-License-Identifier: Apache-2.0
"""Write wall.md, materials in every renderer that was judged, from reports of `mxeon check`.

python -m tools.site.wall REPORT...    the tiles and wall.md, from folders that `mxeon check --report` wrote
"""

import sys
from collections import defaultdict
from html import escape
from pathlib import Path

import numpy as np
from PIL import Image

from mxeon.conformance import words
from mxeon.conformance.results import FAILED, PORTRAIT, Kind
from mxeon.io.images import read_image
from mxeon.io.srgb import srgb_encoded
from mxeon.report.diff import Report, ShownPicture, read_results
from tools.site import DOCS

PAGE = DOCS / "wall.md"
TILES = DOCS / "images" / "wall"
SIZE, QUALITY = 160, 85  # pixels, and WebP quality

HEAD = """<!-- Made by `python -m tools.site.wall`. -->
# A wall of renderers

Materials as each renderer draws them, in the same light and from the same place, next to the float64 reference. The
light is the one in which the worst renderer is most wrong. Tiles are sorted by their largest difference, which is given as
in `mxeon check`; below stand the lobes of the material that cause it, whose defects [the ledger](upstream/README.md) lists.
*Not judged*: subsurface scattering needs a curved surface, which only gl has here, and Storm reads no enumerated inputs.

    mxeon check MATERIAL.mtlx --host gl --host storm --report out

Renderers that evaluate their own materials instead of MaterialX's nodes are judged in
[Renderers compared](the_field.md).

"""


def largest(picture: ShownPicture) -> float:
    return abs(picture.difference.largest) if picture.difference else 0.0


def causes(report: Report, picture: ShownPicture) -> str:
    """The lobes that make a picture wrong, or else its diagnosis; "" for a right one."""
    subject, place = f"{picture.document}: {picture.element}", (picture.host, picture.library)
    own = [
        each
        for each in report.results
        if (each.check, each.subject, each.host, each.library) == ("picture", subject, *place)
        and each.verdict == FAILED
    ]
    found = [cause for each in own for cause in each.diagnosis.causes if cause.kind is Kind.FOLLOWS]
    if names := dict.fromkeys(name for cause in found for name in cause.names):
        return f'<a href="upstream/README.md">{", ".join(names)}</a>'
    return "; ".join(escape(words.diagnosis(each.diagnosis)) for each in own)


def tile(path: Path, name: str, title: str, caption: str) -> str:
    """Write a picture as a tile; returns its figure."""
    image = Image.fromarray(srgb_encoded(np.asarray(read_image(path))[..., :3]))
    image.resize((SIZE, SIZE), Image.Resampling.LANCZOS).save(
        TILES / f"{name}.webp", quality=QUALITY, method=6
    )
    return (
        f'<figure><img src="images/wall/{name}.webp" alt="{escape(title)}" width="{SIZE}">'
        f"<figcaption><b>{escape(title)}</b><br>{caption}</figcaption></figure>\n"
    )


def page(folders: list[Path]) -> str:
    """The wall as Markdown, the material with the largest difference first; later reports replace earlier ones."""
    hosts, found = {}, defaultdict(dict)
    for folder in folders:
        report = read_results(folder)
        hosts |= {each.name: f"{each.name}: {each.version}, {each.device}" for each in report.hosts}
        for each in report.pictures:
            if each.reference and each.document != PORTRAIT:
                place = each.host, each.library, each.scene
                found[each.document, each.element][place] = folder, report, each
    sections = {}
    for (document, element), places in found.items():
        pictures = list(places.values())
        _, _, worst = max(pictures, key=lambda each: largest(each[2]))
        lit = [each for each in pictures if each[2].scene == worst.scene]
        lit.sort(key=lambda each: largest(each[2]))
        name = f"{Path(document).stem}-{element}"
        folder, _, first = lit[0]
        text = [tile(folder / first.reference, name, "reference", "float64")]
        for folder, report, each in lit:
            title = f"{each.host}, {each.library}"
            apart = each.difference
            caption = escape(words.difference(apart)) if apart else "not judged"
            cause = causes(report, each)
            text.append(
                tile(
                    folder / each.exr,
                    f"{name}-{each.host}-{each.library}",
                    title,
                    f"{caption}<br>{cause}" if cause else caption,
                )
            )
        head = f"## {element}\n\n`{document}`, {words.LIGHTS[worst.scene]}\n\n"
        sections[head + f'<div class="wall">\n{"".join(text)}</div>\n'] = -largest(worst)
    measured = "".join(f"- {each}\n" for each in hosts.values())
    return (
        HEAD + "\n".join(sorted(sections, key=sections.__getitem__)) + f"\n## Hosts\n\n{measured}"
    )


if __name__ == "__main__":
    TILES.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(page([Path(each) for each in sys.argv[1:]]), encoding="utf-8")
