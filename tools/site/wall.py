# SPDX-License-Identifier: Apache-2.0
"""Writes wall.md, a page with pictures of materials in all renderers.

python -m tools.site.wall REPORT...    REPORT is a folder written by `mxeon check --report`
"""

import re
import sys
from collections import defaultdict
from functools import cached_property
from html import escape
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mxeon.conformance import words
from mxeon.conformance.results import (
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    Difference,
    Kind,
    Picture,
    Result,
)
from mxeon.conformance.results.known_issues import RENDERER_NODES
from mxeon.hosts import host_row, register
from mxeon.io.images import read_image
from mxeon.io.srgb import srgb_encoded
from mxeon.report.diff import read_results
from mxeon.shaders.scene import BACK, FURNACE, SIDE
from mxeon.survey import ROWS
from tools.site import DOCS, brief

PAGE = DOCS / "wall.md"
TILES = DOCS / "images" / "wall"
SIZE, QUALITY = 192, 85  # width of a tile in pixels, and WebP quality
LIGHTS = SIDE.name, BACK.name  # every renderer has these scenes
BLACK = 1e-3  # a picture with a smaller mean counts as black
EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
OTHER_MODELS = re.compile(
    "fon|qon|LAMBERT|shorter|compensation false|eon_diffuse|standard_surface|UsdPreview", re.I
)
NOT_JUDGED = "not judged"
Names = tuple[str, str, str, str, str]  # document, element, scene, host and library of a picture

HEAD = """<!-- Made by `python -m tools.site.wall`. -->
# A wall of renderers

Materials as each renderer draws them, in the same light and from the same place, next to the float64 reference. Each
material is shown in light from the side or from behind, whichever makes more renderers differ visibly; glass, which both
leave black, in a white environment, which few renderers have here.

Tiles are sorted by their largest difference in percent of white, or of the reference where that is brighter: *+* is too
bright. Then comes the share of the object that differs visibly. Renderers with the same figures share one picture, those
that differ by less than 0.1 % (*none*) that of the reference. Failed tiles are red. Below stands the cause: the lobes whose
defects [the ledger](upstream/README.md) lists, or the input without which a renderer's own material is closest to the
reference. *Not judged* means that the difference is no error of the renderer's code: it has closures of its own, or says
that it ignores an input. Renderers for the browser approximate OpenPBR on purpose: a failed tile says how far, not that
there is a bug. One is known: Babylon.js [squares the roughness of anisotropic lobes
twice](upstream/babylon_anisotropic_roughness.md).

    mxeon check MATERIAL.mtlx --host gl --host storm --host cycles --host three --report out

"""
ROUGH = f"""## A rough diffuse surface

EON with color (0.8, 0.4, 0.1) and roughness 1, {words.LIGHTS[BACK.name]}. Renderers whose materials are not read from documents
are here with their own nodes; [Renderers compared](the_field.md) has their models. Nodes in red fail the check `value`: for
some inputs they do not have the model that they claim.

"""


class Tile(NamedTuple):
    host: str
    variant: str  # library or node; "" for a renderer's own nodes
    scene: str
    image: NDArray[np.floating]
    difference: Difference
    cause: str  # HTML
    verdict: str  # also the CSS class of the figure

    @property
    def largest(self) -> float:
        return abs(self.difference.largest)

    @property
    def caption(self) -> str:
        return "<br>".join(each for each in (escape(brief(self.difference)), self.cause) if each)


def title(tiles: list[Tile]) -> str:
    """Names of hosts grouped by variant, such as "gl, storm: stock; cycles: eonlib"."""
    hosts: dict[str, list[str]] = defaultdict(list)
    for each in tiles:
        hosts[each.variant].append(each.host)
    return "; ".join(
        f"{', '.join(sorted(set(names)))}: {variant}".removesuffix(": ")
        for variant, names in hosts.items()
    )


def cause_of(result: Result) -> str:
    """HTML with the wrong lobes, the diagnosis, or the reason why the picture was not judged."""
    text = wrapped(escape(words.diagnosis(result.diagnosis)))
    if result.check == "finite":
        reason = text.partition(": the")[0].removeprefix(f"{result.host}: ")
        return f"<em>{NOT_JUDGED}</em>: {reason.partition(' for ')[0]}"
    if result.verdict != FAILED:
        return ""
    follows = [each for each in result.diagnosis.causes if each.kind is Kind.FOLLOWS]
    if names := dict.fromkeys(name for each in follows for name in each.names):
        return f'<a href="upstream/README.md">{wrapped(", ".join(names))}</a>'
    return text


def wrapped(text: str) -> str:
    """HTML in which lines may break after underscores."""
    return text.replace("_", "_<wbr>")


def pixels(path: Path) -> NDArray[np.floating]:
    return np.asarray(read_image(path))[..., :3]


def figure(
    image: NDArray[np.floating],
    name: str,
    alt: str,
    title: str,
    caption: str,
    verdict: str = "expected",
) -> str:
    """Save a picture as a tile, and return the HTML of a figure with the tile."""
    name = re.sub(r"[^\w-]+", "-", name)
    codes = Image.fromarray(srgb_encoded(image.astype(np.float32)))
    codes = codes.resize((SIZE, SIZE), Image.Resampling.LANCZOS)
    codes.save(TILES / f"{name}.webp", quality=QUALITY, method=6)
    return (
        f'<figure class="{verdict}"><img src="images/wall/{name}.webp" alt="{alt}">'
        f"<figcaption><b>{wrapped(escape(title))}</b><br>{caption}</figcaption></figure>\n"
    )


def figures(name: str, reference: NDArray[np.floating], tiles: list[Tile]) -> str:
    """HTML of the reference and of the sorted tiles. Hosts with equal captions share a tile."""
    groups: dict[tuple[str, str], list[Tile]] = defaultdict(list)
    for each in sorted(tiles, key=lambda each: each.largest):
        groups[each.caption, each.verdict].append(each)
    exact = groups.pop(("none", PASSED), [])
    caption = f"the same: {title(exact)}" if exact else "float64"
    text = figure(reference, name, "reference", "reference", caption)
    for (caption, verdict), group in groups.items():
        first = group[0]
        file = f"{name}-{first.host}-{first.variant}".rstrip("-")
        text += figure(first.image, file, first.host, title(group), caption, verdict)
    return f'<div class="wall">\n{text}</div>\n'


class Wall:
    """Pictures and results of all reports. Later reports replace earlier reports."""

    def __init__(self, folders: list[Path]) -> None:
        self.hosts: dict[str, str] = {}
        self.references: dict[tuple[str, str, str], Path] = {}  # keys: document, element and scene
        self.images: dict[Names, Path] = {}
        self.facets: dict[Names, Path] = {}  # references for hosts that draw shapes as polyhedra
        self.results: dict[tuple[str, str, str], Result] = {}  # keys: subject, host and library
        for folder in folders:
            report = read_results(folder)
            for host in report.hosts:
                self.hosts[host.name] = f"{host.name}: {host.version}, {host.device}"
            for each in report.pictures:
                view = each.document, each.element, each.scene
                names = (*view, each.host, each.library)
                self.images[names] = folder / each.exr
                if each.reference and host_row(each.host).way == "coarse facets":
                    self.facets[names] = folder / each.reference
                elif each.reference:
                    self.references.setdefault(view, folder / each.reference)
            for result in report.results:
                checks = ("picture", "finite") if ".mtlx" in result.subject else ("value",)
                if result.check in checks:
                    self.results[result.subject, result.host, result.library] = result

    def tile(self, names: Names, reference: NDArray[np.floating]) -> Tile:
        document, element, scene, host, library = names
        image = pixels(self.images[names])
        reference = pixels(self.facets[names]) if names in self.facets else reference
        found = Picture(document, element, host, library, scene, image, reference, {}).difference
        assert found is not None
        variant = "" if library == RENDERER_NODES else library
        if document == PORTRAIT:
            result = self.results.get((element, host, library))
            claim = f"claims {result.claimed}" if result and result.claimed else ""
            verdict = result.verdict if result else NOT_RUN
            return Tile(host, variant or element, scene, image, found, claim, verdict)
        judged = self.results[f"{document}: {element}", host, library]
        return Tile(host, variant, scene, image, found, cause_of(judged), judged.verdict)

    def section(self, material: tuple[str, str]) -> tuple[float, str]:
        """Largest difference of a material, and the section about the material on the page."""
        document, element = material
        references = {scene: pixels(self.references[(*material, scene)]) for scene in LIGHTS}
        if max(map(np.mean, references.values())) < BLACK:
            references = {FURNACE.name: pixels(self.references[(*material, FURNACE.name)])}
        tiles = [
            self.tile(each, references[each[2]])
            for each in self.images
            if each[:2] == material and each[2] in references
        ]

        def visibility(scene: str) -> tuple[int, float]:
            differences = [each.difference for each in tiles if each.scene == scene]
            return sum(e.is_visible for e in differences), max(e.visible for e in differences)

        scene = max(references, key=visibility)
        tiles = [each for each in tiles if each.scene == scene]
        text = f"## {element}\n\n`{document}`, {words.LIGHTS[scene]}\n\n"
        text += figures(f"{Path(document).stem}-{element}", references[scene], tiles)
        return max(each.largest for each in tiles), text

    def not_drawn(self) -> str:
        """Markdown list of materials that renderers do not draw, by renderer and reason."""
        elements: dict[tuple[str, str], list[str]] = defaultdict(list)
        for (subject, host, _), result in self.results.items():
            for document, element in self.materials:
                if subject in (f"{document}: {element}", document) and result.verdict == NOT_RUN:
                    reason = re.sub(r' on "[^"]*"', "", result.reason.removeprefix(f"{host}: "))
                    elements[host, reason.partition(". ")[0].rstrip(".")].append(element)
        return "".join(
            f"- {host} does not draw {', '.join(dict.fromkeys(names))}: {reason}.\n"
            for (host, reason), names in elements.items()
        )

    def rough(self) -> str:
        """Section about rough diffuse nodes. Equal pictures of a renderer appear only once."""
        reference = pixels(self.references[PORTRAIT, EON, BACK.name])
        tiles: dict[tuple[str, float], Tile] = {}
        for each in self.images:
            document, element, scene, host, _ = each
            if document == PORTRAIT and scene == BACK.name and not OTHER_MODELS.search(element):
                tile = self.tile(each, reference)
                tiles.setdefault((host, round(tile.largest, 3)), tile)
        return ROUGH + figures("rough", reference, list(tiles.values()))

    @cached_property
    def materials(self) -> list[tuple[str, str]]:
        """Materials with more than half as many hosts as the material with the most hosts."""
        hosts = defaultdict(set)
        for document, element, _, host, _ in self.images:
            if document != PORTRAIT:
                hosts[document, element].add(host)
        most = max(map(len, hosts.values()))
        return [material for material, names in hosts.items() if 2 * len(names) > most]

    def page(self) -> str:
        sections = [text for _, text in sorted(map(self.section, self.materials), reverse=True)]
        drawn = {host for *_, host, _ in self.images}
        measured = "".join(f"- {each}\n" for host, each in self.hosts.items() if host in drawn)
        return HEAD + "\n".join(
            [*sections, self.rough(), "## Not drawn, and versions\n", self.not_drawn(), measured]
        )


if __name__ == "__main__":
    register(*ROWS)
    wall = Wall([Path(each) for each in sys.argv[1:]])
    TILES.mkdir(parents=True, exist_ok=True)
    for old in TILES.glob("*.webp"):
        old.unlink()
    PAGE.write_text(wall.page(), encoding="utf-8")
