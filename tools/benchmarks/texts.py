# SPDX-License-Identifier: Apache-2.0
"""Characters of generated shaders, eonlib / stock: with comments, without, and of each file of eonlib."""

import re

from mxeon.shaders.library import source_folder
from tools.benchmarks.instructions import sources
from tools.benchmarks.materials import BARE, DIFFUSE, OTHERS, TEXTS
from tools.benchmarks.rounds import Group, figure, ratio

DETAILED = "dielectric_bsdf"  # whose text is taken apart by file
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
INCLUDE = re.compile(r"^#include .*\n", re.MULTILINE)


def code(text: str) -> str:
    """A text without comments and blank ends of lines."""
    return re.sub(r"\s*\n", "\n", COMMENT.sub("", text))


def parts(text: str) -> dict[str, str]:
    """Texts of eonlib's files that a generated shader has, by name."""
    files = sorted((source_folder("eonlib") / "genglsl").rglob("*.glsl"))
    found = {each.name: INCLUDE.sub("", each.read_text(encoding="utf-8")) for each in files}
    return {name: part for name, part in found.items() if code(part).strip() in code(text)}


def measure(nodes=(*DIFFUSE, *BARE, *OTHERS)):
    """The `Group` of nodes."""
    figures = []
    for node in nodes:
        own, stock = (stages["pixel"] for stages in sources(node).values())
        lengths = [[len(code(own))], [len(code(stock))]]
        figures += [
            ratio(f"{node}, eonlib / stock", [len(own)], [len(stock)], TEXTS.get(node)),
            ratio(f"{node}, without comments, eonlib / stock", *lengths),
        ]
        for name, part in parts(own).items() if node == DETAILED else ():
            figures += [
                figure(f"{node}, {name}, code", "characters", [len(code(part))]),
                figure(f"{node}, {name}, comments", "characters", [len(part) - len(code(part))]),
            ]
    return Group("texts", "Characters of generated fragment shaders", tuple(figures))
