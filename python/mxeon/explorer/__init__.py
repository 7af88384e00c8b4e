# SPDX-License-Identifier: Apache-2.0
"""The explorer: a self-contained page that draws, compares and probes materials in a browser.

The TypeScript program in `explorer/` is built into `explorer.html` in this folder.
"""

import json
from collections.abc import Iterable
from dataclasses import asdict, replace
from importlib.resources import files
from typing import Any

import MaterialX as mx

import mxeon
from mxeon.explorer.data import PageData, ShaderSource
from mxeon.explorer.documents import MEANT, document_sources, sky_of
from mxeon.explorer.references import pairs, views
from mxeon.explorer.sources import measured_models, model_sources, node_sources
from mxeon.shaders.functions import source

__all__ = ["document_sources", "page", "page_data", "sky_of"]

TEXTS, PARAGRAPH = ("pixel", "paths", "document"), "\n\n"  # fields whose paragraphs are shared
MARK = "%DATA%"  # the template's placeholder for the data
# Escape characters that have a meaning in HTML and could end the script element.
ESCAPES = str.maketrans({sign: f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029"})


def page_data(documents: Iterable[tuple[ShaderSource, ...]] = (), pages: str = "") -> PageData:
    """The data of a page. `documents` has the `document_sources` of each document.

    `pages` is the address of the pages in docs/upstream, with {} in place of a page's name, or "".
    """
    added = (
        replace(each, id=f"document/{position}/{each.id}")
        for position, group in enumerate(documents)
        for each in group
    )
    shaders = [*node_sources(), *added]
    for index, each in enumerate(shaders):
        if nodes := [node for node, models in MEANT.items() if models == each.meant]:
            shaders[index] = replace(each, actual=measured_models(each.library, nodes[0]))
    return PageData(
        mxeon.__version__,
        mx.getVersionString(),
        source("glsl"),
        (*shaders, *model_sources()),
        pairs(),
        views(),
        pages,
    )


def page(data: PageData) -> str:
    """The page with its data, as self-contained HTML.

    The text of documents is stored as escaped JSON, without characters that have a meaning in HTML.

        >>> "</b>" in page(PageData("1", "1", "</b>", ()))
        False
    """
    template = files("mxeon.explorer").joinpath("explorer.html").read_text(encoding="utf-8")
    fields = _with_texts(asdict(data))
    text = json.dumps(fields, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    before, _, after = template.partition(MARK)
    return before + text.translate(ESCAPES) + after


def _with_texts(fields: dict[str, Any]) -> dict[str, Any]:
    """Store each paragraph, reference and image once. `explorer/src/texts.ts` restores fields."""
    places: dict[str, int] = {}
    references: list[object] = []
    images: dict[tuple[int, int, str], int] = {}
    for each in fields["sources"]:
        if (reference := each.get("reference")) is not None:
            if reference not in references:
                references.append(reference)
            each["reference"] = references.index(reference)
        for port in each.get("inputs", ()):
            if image := port["image"]:
                key = image["width"], image["height"], image["rgba"]
                port["image"] = images.setdefault(key, len(images))
        for name in filter(each.__contains__, TEXTS):
            parts = each[name].split(PARAGRAPH)
            each[name] = [places.setdefault(part, len(places)) for part in parts]
    tables = {"texts": list(places), "references": references}
    whole = [{"width": wide, "height": high, "rgba": rgba} for wide, high, rgba in images]
    return fields | tables | {"images": whole}
