# SPDX-License-Identifier: Apache-2.0
"""Renders the materials in `examples/` with stock MaterialX and eonlib, and writes gallery.md.

python -m tools.site.gallery
"""

import json
from contextlib import suppress
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import OpenImageIO as oiio
from PIL import Image, ImageDraw, ImageFont

import mxeon
from mxeon.conformance import words
from mxeon.conformance.results import VISIBLE
from mxeon.errors import DocumentError
from mxeon.hosts import open_host
from mxeon.hosts.points import visible
from mxeon.hosts.still import still
from mxeon.io.images import difference, difference_scale
from mxeon.io.srgb import pbr_neutral, srgb_encoded
from mxeon.report.pieces import difference_pixels
from mxeon.shaders.scene import BACK, FURNACE, STUDIO
from tools.site import DOCS, brief

PAGE = DOCS / "gallery.md"
EXAMPLES = DOCS.parent / "examples"
PICTURES = DOCS / "images" / "gallery"
# File with the largest differences of stock MaterialX from the reference, and their descriptions.
DIFFERENCES = PICTURES / "differences.json"
SIZE = 512  # width and height of a picture in pixels
INSET, EDGE = 112, 8  # width of the inset and distance from the edges, in pixels
QUALITY = 85  # WebP quality
ROWS = 96  # height of the studio's latitude-longitude map in pixels
# A soft box has an azimuth relative to the viewer, an elevation, a half width and a half height in
# degrees, and an RGB radiance.
BOXES = (
    ((-48.0, 42.0), (22.0, 15.0), (7.0, 6.8, 6.4)),
    ((66.0, 22.0), (5.0, 34.0), (8.0, 8.3, 9.0)),
    ((-118.0, 20.0), (8.0, 36.0), (9.0, 8.6, 8.0)),
    ((150.0, 30.0), (20.0, 12.0), (5.0, 5.2, 5.6)),
)
SOFT = 2.5  # width in degrees of the soft edge of a box
BACKGROUND = 30  # sRGB value from 0 to 255
TITANIUM = DOCS / "images" / "titanium.mtlx"  # material of the README's picture

HEAD = """<!-- Made by `python -m tools.site.gallery`. -->
# Gallery

The materials in `examples/` on a shader ball in a studio, rendered on the `gl` host: stock MaterialX and eonlib, the
largest difference first. The inset shows the pictures' difference, from black to the share in its label. Furnace documents
show a sphere in a white environment, where it vanishes if no energy is lost or gained. The ball reflects itself only in
the [path-traced pictures](#path-traced).

Below each pair is what `mxeon check` reports for stock: the largest difference from the reference, in percent of white or
of the reference where that is brighter (*+*: too bright), and the share of the sphere on which it is visible; in light from
behind, unless another light is named. To draw a picture yourself:

    mxeon render examples/roughness_wedge.mtlx --element wedge_eon_100 --output wedge_eon_100.png
    mxeon render examples/layered_white_furnace.mtlx --element white_dielectric --scene furnace --output white.png

"""

TRACED = """
## Path traced

Three of [MaterialX's examples](https://github.com/AcademySoftwareFoundation/MaterialX/tree/main/resources/Materials/Examples)
on the [path-traced](path_tracing.md) shader ball in the studio, with shadows and reflections of itself, at the default of
64 paths a pixel and denoised:

![open_pbr_velvet](images/gallery/traced_open_pbr_velvet.webp)

![standard_surface_carpaint](images/gallery/traced_standard_surface_carpaint.webp)

![standard_surface_glass](images/gallery/traced_standard_surface_glass.webp)

    mxeon render standard_surface_glass.mtlx --integrator path --output glass.png
"""


def studio():
    """Latitude-longitude map of radiance in a studio with floor, ceiling and soft boxes."""
    polar = (np.arange(ROWS)[:, None] + 0.5) / ROWS * np.pi
    azimuth = ((np.arange(2 * ROWS) + 0.5) / ROWS - 1.0) * np.pi
    up = np.broadcast_to(np.cos(polar), (ROWS, 2 * ROWS))[..., None]
    elevation, azimuth = 90.0 - np.degrees(polar), np.degrees(azimuth)
    wall = 0.06 + 0.16 * np.exp(-np.abs(up) * 4.0)
    radiance = np.where(
        up > 0.0, wall * [0.95, 1.0, 1.08], 0.2 * (1.0 + 0.6 * up) * [1.0, 0.98, 0.95]
    )
    for (center, middle), (width, height), light in BOXES:
        distance = np.abs((azimuth - center + 180.0) % 360.0 - 180.0)
        inside = np.minimum(width - distance, height - np.abs(elevation - middle)) / SOFT
        radiance += light / (1.0 + np.exp(-4.0 * np.clip(inside, -9.0, 9.0)))[..., None]
    return radiance.astype(np.float32)


def pictures(host, document):
    """Yield each material's name, the pictures with stock MaterialX and eonlib, and the difference.

    If stock MaterialX cannot generate the shaders, the only picture is with eonlib.
    """
    shaders, scene = [], replace(STUDIO, size=SIZE)
    if "furnace" in document.stem:
        scene = replace(FURNACE, size=2 * SIZE)
    for library in ("stock", "eonlib"):
        with suppress(DocumentError):
            shaders.append(host.compile(document, library=library))
    for pair in zip(*shaders, strict=True):
        images = [still(host, each, scene) for each in pair]
        if scene.name == STUDIO.name:
            codes = [Image.fromarray(srgb_encoded(pbr_neutral(each))) for each in images]
        else:
            codes = [sphere_picture(each) for each in images]
        yield pair[0].element, codes, np.abs(difference(images[0], images[-1]))


def sphere_picture(image):
    """A picture of a sphere, SIZE pixels wide including a margin of background."""
    mask = visible(len(image), "sphere").mask[..., None]
    codes = np.where(mask, srgb_encoded(image), np.uint8(BACKGROUND))
    inner = SIZE - SIZE // 8
    picture = Image.new("RGB", (SIZE, SIZE), (BACKGROUND,) * 3)
    reduced = Image.fromarray(codes).resize((inner, inner), Image.Resampling.BOX)
    picture.paste(reduced, (SIZE // 16, SIZE // 16))
    return picture


def label(image, place, text, size=22, anchor="ls"):
    style = {"font": ImageFont.load_default(size), "anchor": anchor, "stroke_fill": (0, 0, 0)}
    ImageDraw.Draw(image).text(place, text, fill="white", stroke_width=1, **style)


def save(path, pictures, difference_map):
    """Save pictures side by side, with an inset if the difference is visible."""
    image = Image.new("RGB", (SIZE * len(pictures), SIZE))
    for number, each in enumerate(pictures):
        image.paste(each, (number * SIZE, 0))
        if len(pictures) == 2:
            label(image, (number * SIZE + 14, SIZE - 14), ("stock", "eonlib")[number])
    if difference_map.max() > VISIBLE:
        scale = difference_scale(difference_map)
        left, top = image.width - INSET - EDGE, image.height - INSET - EDGE
        inset = Image.fromarray(difference_pixels(difference_map, scale))
        image.paste(inset.resize((INSET, INSET), Image.Resampling.LANCZOS), (left, top))
        text = f"difference, {100.0 * scale:.0f} %"
        label(image, (left + INSET // 2, top - 6), text, 14, "ms")
    image.save(path, quality=QUALITY, method=6)


def render():
    """Write the pictures of each material, and the README's picture of two balls."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    painted = oiio.ImageBuf(studio())
    painted.set_write_format("half")
    painted.write(str(STUDIO.environment))

    with open_host("gl") as host:
        for document in sorted(EXAMPLES.glob("*.mtlx")):
            for name, *images in pictures(host, document):
                save(PICTURES / f"{name}.webp", *images)
        [(_, *images)] = pictures(host, TITANIUM)
    save(TITANIUM.with_suffix(".webp"), *images)


def judge():
    """Write the differences that `mxeon check` finds between stock MaterialX and the reference."""
    found = {}
    for each in mxeon.check(sorted(EXAMPLES.glob("*.mtlx")), ["gl"], ["stock"]).results:
        if each.check == "picture" and (differs := each.difference):
            light = "" if differs.scene == BACK.name else f", {words.LIGHTS[differs.scene]}"
            description = f"{brief(differs)}{light}" if differs.is_visible else ""
            found[each.subject.partition(": ")[2]] = description, abs(differs.largest)
    DIFFERENCES.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def page():
    """Markdown of the gallery, sorted by decreasing difference."""
    found = json.loads(DIFFERENCES.read_text(encoding="utf-8"))
    equal = [name for name, (description, _) in found.items() if not description]
    sections = []
    for document in sorted(EXAMPLES.glob("*.mtlx")):
        materials = [
            each.get("name") for each in ElementTree.parse(document).iter("surfacematerial")
        ]
        rows = [
            (name, *found.get(name, ("stock cannot generate its nodes", 0.0)))
            for name in materials
            if name not in equal
        ]
        rows.sort(key=lambda row: -row[2])
        if rows:
            comment = document.read_text(encoding="utf-8").splitlines()[2]
            text = f"## {document.stem}\n\n{comment.removeprefix('<!-- ').removesuffix(' -->')}"
            for name, description, _ in rows:
                text += f"\n\n![{name}](images/gallery/{name}.webp)\n\n*{name}: {description}.*"
            sections.append((rows[0][2], f"{text}\n"))
    sections.sort(key=lambda section: -section[0])
    same = f"No visible difference: {', '.join(f'`{each}`' for each in sorted(equal))}.\n"
    return HEAD + "\n".join([*(text for _, text in sections), same]) + TRACED


if __name__ == "__main__":
    render()
    judge()
    PAGE.write_text(page(), encoding="utf-8")
