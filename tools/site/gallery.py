# SPDX-License-Identifier: Apache-2.0
"""Render the materials of `examples/` with stock and with eonlib, and write the gallery page.

python -m tools.site.gallery           the pictures, their differences, and gallery.md
python -m tools.site.gallery --page    gallery.md alone
"""

import json
import sys
from contextlib import suppress
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
from PIL import Image

from mxeon.errors import DocumentError
from mxeon.hosts import open_host
from mxeon.hosts.points import visible
from mxeon.io.images import write_exr
from mxeon.io.srgb import srgb_encoded
from mxeon.shaders.scene import FURNACE, STUDIO
from tools.site import DOCS

PAGE = DOCS / "gallery.md"
EXAMPLES = DOCS.parent / "examples"
PICTURES = DOCS / "images" / "gallery"
DIFFERENCES = PICTURES / "differences.json"  # in sRGB codes, by material; null without stock
SIZE = 512  # pixels
QUALITY = 85  # of WebP
ROWS = 64  # of the studio's picture
BOXES = (  # soft boxes of the studio: towards them, half of their width in radian, radiance
    ((-1.0, 1.0, 0.6), 0.45, (5.0, 4.8, 4.4)),
    ((1.2, 0.4, -0.4), 0.35, (4.0, 4.2, 5.0)),
    ((0.3, 0.2, 1.0), 0.15, (1.0, 1.0, 1.0)),
)
BACKGROUND = 30  # sRGB code
SEEN = 3  # sRGB codes: the least difference that an eye may find side by side
TITANIUM = DOCS / "images" / "titanium.mtlx"  # of the README

HEAD = """<!-- Made by `python -m tools.site.gallery`. -->
# Gallery

The materials in `examples/` on a shader ball in a studio, rendered on the `gl` host: stock MaterialX on the left,
eonlib on the right, the largest difference first. Furnace documents show a sphere in a white environment, where
it vanishes if no energy is lost or gained. Nothing casts a shadow here.

"""

TRACED = """
## Path traced

Three of [MaterialX's examples](https://github.com/AcademySoftwareFoundation/MaterialX/tree/main/resources/Materials/Examples):
the rasterizer's picture on the left, [paths of light](path_tracing.md) on the right, with the ball's
shadows and reflections of itself.

![carpaint](images/gallery/traced_carpaint.webp)

*standard_surface_carpaint: 32 paths a pixel, 9.9 % noise.*

![glass](images/gallery/traced_glass.webp)

*standard_surface_glass: 40 paths a pixel, 12 % noise.*

![velvet](images/gallery/traced_velvet.webp)

*open_pbr_velvet: 32 paths a pixel, 9 % noise.*

    mxeon render standard_surface_glass.mtlx --integrator path --size 192 --samples 40 --output glass.png
"""


def studio():
    """Radiance of a studio, a latitude-longitude picture: a floor, a ceiling and soft boxes."""
    polar = (np.arange(ROWS)[:, None] + 0.5) / ROWS * np.pi
    azimuth = ((np.arange(2 * ROWS) + 0.5) / ROWS - 1.0) * np.pi
    up = np.broadcast_to(np.cos(polar), (ROWS, 2 * ROWS))
    ring = np.sin(polar)
    towards = np.stack([ring * np.sin(azimuth), up, ring * np.cos(azimuth)], axis=-1)
    ceiling, floor = (
        0.35 + up[..., None] * [0.2, 0.28, 0.4],
        0.12 + (1.0 + up[..., None]) * [0.1, 0.08, 0.06],
    )
    radiance = np.where(up[..., None] > 0.0, ceiling, floor)
    for direction, width, light in BOXES:
        inside = towards @ direction / np.linalg.norm(direction) - np.cos(width)
        radiance += light / (1.0 + np.exp(-40.0 * inside[..., None]))
    return radiance.astype(np.float32)


def materials(document):
    """Names of the materials in a document, in its order."""
    return [each.get("name") for each in ElementTree.parse(document).iter("surfacematerial")]


def pictures(host, document):
    """A document's materials, each with its sRGB codes with stock, where that can generate it, and eonlib."""
    shaders, scene = [], replace(FURNACE if "furnace" in document.stem else STUDIO, size=SIZE)
    for library in ("stock", "eonlib"):
        with suppress(DocumentError):
            shaders.append(host.compile(document, library=library))
    mask = visible(SIZE, scene.shape).mask[..., None]
    for pair in zip(*shaders, strict=True):
        images = [srgb_encoded(host.picture(each, scene)) for each in pair]
        yield pair[0].element, [np.where(mask, each, np.uint8(BACKGROUND)) for each in images]


def render():
    """Write the pictures, the difference of each material, and the README's picture of two balls.

    The difference is that in sRGB codes which one pixel in a hundred exceeds.
    """
    PICTURES.mkdir(parents=True, exist_ok=True)
    write_exr(STUDIO.environment, studio(), {})
    differences = {}

    def save(path, codes):
        Image.fromarray(np.hstack(codes)).save(path, quality=QUALITY, method=6)

    with open_host("gl") as host:
        for document in sorted(EXAMPLES.glob("*.mtlx")):
            for name, codes in pictures(host, document):
                save(PICTURES / f"{name}.webp", codes)
                apart = np.ptp(np.array(codes, int), axis=0).max(axis=-1)
                differences[name] = float(np.percentile(apart, 99)) if len(codes) > 1 else None
        [(_, balls)] = pictures(host, TITANIUM)
    save(TITANIUM.with_suffix(".webp"), balls)
    DIFFERENCES.write_text(json.dumps(differences, indent=1) + "\n", encoding="utf-8")


def words(difference):
    """What to look for, by the difference of the pictures."""
    if difference is None:
        return "stock MaterialX cannot generate its nodes"
    if difference < SEEN:
        return "no visible difference"
    return f"1 % of the pixels differ by {difference:.0f} of 255 sRGB codes or more"


def page():
    """The gallery as Markdown: documents and their materials, those with the largest difference first."""
    differences = json.loads(DIFFERENCES.read_text(encoding="utf-8"))
    named = {
        document: sorted(materials(document), key=lambda name: -(differences[name] or 0.0))
        for document in sorted(EXAMPLES.glob("*.mtlx"))
    }
    sections = []
    for document, names in sorted(
        named.items(), key=lambda each: -(differences[each[1][0]] or 0.0)
    ):
        description = document.read_text(encoding="utf-8").splitlines()[2]
        shown = "\n\n".join(
            f"![{name}](images/gallery/{name}.webp)\n\n*{name}: {words(differences[name])}.*"
            for name in names
        )
        scene = "--scene furnace " if "furnace" in document.stem else ""
        command = f"mxeon render examples/{document.name} --element {names[0]} {scene}--output {names[0]}.png"
        sections.append(
            f"## {document.stem}\n\n{description.removeprefix('<!-- ').removesuffix(' -->')}\n\n"
            f"{shown}\n\n    {command}\n"
        )
    return HEAD + "\n".join(sections) + TRACED


if __name__ == "__main__":
    if "--page" not in sys.argv:
        render()
    PAGE.write_text(page(), encoding="utf-8")
