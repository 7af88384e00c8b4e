# SPDX-License-Identifier: Apache-2.0
"""The explorer: one self-contained page that draws, compares and probes materials in a browser.

Its program lies in `explorer/`, in TypeScript; what is built from it is `explorer.html` here.
"""

import json
from collections.abc import Iterable
from dataclasses import asdict, replace
from importlib.resources import files
from itertools import chain
from typing import Any

import MaterialX as mx

import mxeon
from mxeon.conformance.results import Result
from mxeon.explorer.data import PageData, ShaderSource
from mxeon.explorer.documents import MEANT, document_sources
from mxeon.explorer.references import pairs, views
from mxeon.explorer.sources import measured_models, model_sources, node_sources, run_sources, stills
from mxeon.shaders.functions import source

__all__ = ["document_sources", "page", "page_data"]

TEXTS, PARAGRAPH = ("pixel", "paths", "document"), "\n\n"  # fields in the table of texts
MARK = "%DATA%"  # in the template, replaced by the data
# Characters that could end the script element, or be read otherwise in HTML, as JSON writes them.
ESCAPES = str.maketrans({sign: f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029"})


def page_data(
    documents: Iterable[tuple[ShaderSource, ...]] = (),
    results: Iterable[Result] = (),
    pages: str = "",
) -> PageData:
    """The data of a page: what `document_sources` gives for each document, and results of a run.

    `pages` is the address of a page of `docs/upstream`, {} for its name; "" for none.
    """
    own = (
        replace(each, id=f"document/{position}/{each.id}")
        for position, group in enumerate(documents)
        for each in group
    )
    shaders = map(_diagnosed, chain(node_sources(), own))
    return PageData(
        mxeon.__version__,
        mx.getVersionString(),
        source("glsl"),
        tuple(chain(shaders, run_sources(results), model_sources())),
        stills(),
        pairs(),
        views(),
        pages,
    )


def _diagnosed(source: ShaderSource) -> ShaderSource:
    """A source with the models that its node is, where it is one of the diffuse nodes."""
    nodes = [node for node, models in MEANT.items() if models == source.meant]
    return replace(source, actual=measured_models(source.library, nodes[0])) if nodes else source


def page(data: PageData) -> str:
    """The page with its data, as one HTML text that loads nothing.

    Text of documents stands in it as JSON without any character that HTML knows.

        >>> "</b>" in page(PageData("1", "1", "</b>", ()))
        False
    """
    template = files("mxeon.explorer").joinpath("explorer.html").read_text(encoding="utf-8")
    fields = _with_texts(asdict(data))
    text = json.dumps(fields, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    before, _, after = template.partition(MARK)
    return before + text.translate(ESCAPES) + after


def _with_texts(fields: dict[str, Any]) -> dict[str, Any]:
    """The data with each paragraph, reference and image once; `explorer/src/texts.ts` undoes it.

    Shaders share nearly all of their functions, and materials of one file the whole document; both
    libraries share the reference and the images.
    """
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
