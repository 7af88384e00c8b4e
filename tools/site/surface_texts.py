# SPDX-License-Identifier: Apache-2.0
"""Writes the tables of surfaces.md, which compare surface shaders with their specifications.

`python -m tools.site.surface_texts` checks each sentence of the specifications on all HOSTS with
the installed MaterialX, and on gl with all VERSIONS, in ten minutes.
"""

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Any, TypeAlias

import numpy as np

import mxeon
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, Kind, Result
from mxeon.conformance.specs.surface_texts import GLTF, OPENPBR, SENTENCES, STANDARD, USD, Text
from mxeon.io.files import write_text
from mxeon.shaders.library import TESTED, load_library
from tests.support.wheels import run, wheel
from tools.site import DOCS, with_block
from tools.site.ledger import figure

PAGE = DOCS / "surfaces.md"
HOSTS = ("gl", "vulkan", "webgl")
VERSIONS = (*TESTED[:-1], "main")  # all versions except the installed version
Verdicts: TypeAlias = dict[str, dict[str, str]]
WORDS = {PASSED: "yes", DIFFERS: "left open", FAILED: "**no**", NOT_RUN: "not run"}
DEFAULTS_HEAD = "| text | parameter | its default | the node's |\n|---|---|---|---|\n"
HEAD = "| section | the text | verdict: what is there instead; largest error |\n|---|---|---|\n"
NAMES = tuple(name for name, _ in groupby(SENTENCES, lambda spec: spec.node))
OPTIONS = [word for name in NAMES for word in ("--node", name)]

TRANSPORT = "the renderer computes light inside the object; path tracers only receive the medium"
# Statements that no check covers. A row has specification, section, statement and reason.
# fmt: off
NOT_JUDGED = (
    (OPENPBR, "Subsurface", "radius, scale, anisotropy and the inversion of the albedo", TRANSPORT),
    (OPENPBR, "Translucent base", "extinction and scattering from color, depth and scatter", TRANSPORT),
    (OPENPBR, "Translucent base", "dispersion by an Abbe number", "no node of the graph reads the inputs"),
    (OPENPBR, "Opacity", "geometry_opacity blends with what is behind", "the check `alpha` of `surface` judges it"),
    (OPENPBR, "Emission", "nits", "the renderer converts them"),
    (OPENPBR, "Thin-walled mode", "multiple reflections in a sheet of glass", "environment lookups have one direction of transmission"),
    (STANDARD, "Transparency", "opacity by color", "the check `alpha` of `surface` judges its luminance"),
    (STANDARD, "Specular transmission", "depth, scatter, dispersion", "no node of the graph reads the inputs"),
    (STANDARD, "Specular transmission", "an index of 1 and no film on thin walls", "environment lookups do not show the index"),
    (STANDARD, "Subsurface scattering", "radius and anisotropy", "the text defines no model"),
    (GLTF, "3.9", "occlusion, normal and alpha modes", "clients apply textures and coverage; no node reads `occlusion`"),
    (GLTF, "KHR_materials_volume", "thickness and attenuation", "no connected node of the graph reads the inputs"),
    (GLTF, "KHR_materials_dispersion", "dispersion", "no node of the graph reads the input"),
    (USD, "Preview Surface", "displacement, occlusion", "no node of the graph reads the inputs"),
    (USD, "Preview Surface", "parts below opacityThreshold are not rendered", "the check `alpha` of `surface` judges it"),
)
# fmt: on


def rows(
    text: Text, results: Mapping[str, Mapping[str, Result]], verdicts: Verdicts
) -> Iterator[str]:
    """Table rows of a specification, with the verdict of gl and all other verdicts that differ."""
    for spec in (each for each in SENTENCES if each.text is text):
        places: dict[str, list[str]] = defaultdict(list)
        for place, verdict in verdicts[spec.title].items():
            places[WORDS[verdict]].append(place)
        usual = WORDS[verdicts[spec.title]["gl"]]
        others = [f"{', '.join(places[word])}: {word}" for word in places if word != usual]
        worst = max(results[spec.title].values(), key=lambda each: each.error or 0.0)
        cell = "; ".join([usual, *others]) + actual_form(worst)
        yield f"| {spec.section} | {spec.claim} | {cell} |\n"
    for unjudged, section, claim, reason in NOT_JUDGED:
        if unjudged is text:
            yield f"| {section} | {claim} | not judged: {reason} |\n"


def actual_form(result: Result) -> str:
    """The formula and the error of a shader that does not pass, or "" if the shader passes."""
    if result.verdict == PASSED:
        return ""
    cause = result.diagnosis.first
    form = cause.key if cause.kind is Kind.MODEL else "no known form"
    return f": {form}; {figure(result)}"


def defaults(text: Text) -> Iterator[str]:
    """Table rows for defaults that differ between a node's definition and the specification."""
    [definition, *_] = load_library("stock").getMatchingNodeDefs(text.node)
    for name, default in text.model.DEFAULTS.items():
        value = definition.getActiveInput(name).getValue()
        if value is None:
            continue
        values = np.ravel(tuple(value) if hasattr(value, "asTuple") else value).astype(float)
        if not np.allclose(values, np.ravel(default)):
            cells = (", ".join(f"{x:.3g}" for x in np.ravel(each)) for each in (default, values))
            yield f"| {text.name} | `{name}` | {' | '.join(cells)} |\n"


def judged_with(version: str, *options: str) -> list[dict[str, Any]]:
    done = run(wheel(version), "check", "--host", "gl", "--workers", "0", "--json", *options)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"MaterialX {version}: {done.stderr}")
    return list(json.loads(done.stdout)["results"])


def judged() -> tuple[dict[str, dict[str, Result]], Verdicts]:
    """Results for each subject and host, and verdicts for each subject and each host or version."""
    results: dict[str, dict[str, Result]] = defaultdict(dict)
    verdicts: Verdicts = defaultdict(dict)
    for host in HOSTS:
        for each in mxeon.check(None, [host], ["eonlib"], nodes=NAMES).results:
            if each.check == "specification":
                results[each.subject][host] = each
                verdicts[each.subject][host] = each.verdict
    for version in VERSIONS:
        for record in judged_with(version, *OPTIONS):
            if record["check"] == "specification":
                verdicts[record["subject"]][version] = record["verdict"]
    return results, verdicts


if __name__ == "__main__":
    (results, verdicts), page = judged(), PAGE.read_text(encoding="utf-8")
    texts = [text for text, _ in groupby(SENTENCES, lambda spec: spec.text)]
    for text in texts:
        page = with_block(page, text.name, "\n" + HEAD + "".join(rows(text, results, verdicts)))
    table = "".join(row for text in texts for row in defaults(text))
    write_text(PAGE, with_block(page, "defaults", f"\n{DEFAULTS_HEAD}{table}"))
