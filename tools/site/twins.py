# SPDX-License-Identifier: Apache-2.0
"""Generates the OSL files that are translated from GLSL: `python -m tools.site.twins`."""

import re
from pathlib import Path

from tools.site import ROOT

STEMS = (
    "lib/eon",
    "lib/ggx_albedo",
    "lib/conty_kulla_albedo",
    "lib/hair_parameters",
    "sampling/oren_nayar_family",
    "sampling/ltc_sampling",
    "sampling/eon_sampling",
)
HEADER = "// Generated from genglsl/{stem}.glsl by `python -m tools.site.twins`; edit that file.\n"


def osl_text(stem: str) -> str:
    """OSL translation of a GLSL file.

    A vec3 becomes a vector in samplers and in declarations of wo, wi or wh. Any other vec3 becomes
    a color.
    """
    text = (ROOT / "genglsl" / f"{stem}.glsl").read_text(encoding="utf-8")
    text = re.sub(r"\bvec3(?= w[oih]\b)", "vector", text)
    triple = "vector" if stem.endswith("_sampling") else "color"
    words = {"vec3": triple, "out": "output", "glsl": "osl"}
    text = re.sub(r"\b(vec3|out|glsl)\b", lambda word: words[word[0]], text)
    license_line, rest = text.split("\n", 1)
    return f"{license_line}\n{HEADER.format(stem=stem)}{rest}"


def path(stem: str) -> Path:
    return ROOT / "genosl" / f"{stem}.osl"


if __name__ == "__main__":
    for each in STEMS:
        path(each).write_text(osl_text(each), encoding="utf-8")
