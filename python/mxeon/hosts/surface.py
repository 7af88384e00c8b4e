# SPDX-License-Identifier: Apache-2.0
"""Functions of generated surface shaders: what they compute before they call their BSDFs."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

# A function that fills in a surface shader, and its statements before those of the lights. Slang
# hands the vertex data on as the first parameter.
FUNCTION = re.compile(
    r"^void \w+\(([^)]*)out surfaceshader \w+\)\n\{\n(.*?)^ *surfaceshader \w+ = ",
    re.MULTILINE | re.DOTALL,
)
# A property of the surface in world space, which an evaluation sets.
GEOMETRY = re.compile(r"^ *\w+ (geomprop_\w+) = [^;]*;\n", re.MULTILINE)
KINDS = {
    "float": "float",
    "int": "integer",
    "bool": "boolean",
    "vec2": "vector2",
    "vec3": "vector3",
    "float2": "vector2",
    "float3": "vector3",
}


@dataclass(frozen=True)
class Prelude:
    """What a surface shader computes of its inputs."""

    statements: str
    inputs: dict[str, str]  # types of what they read: parameters, and properties of the surface


@lru_cache(maxsize=16)  # the checks of a node share its shader
def prelude(text: str, end: int) -> Prelude | None:
    """What is computed before the first BSDF, at `end`; None outside a surface shader's function."""
    *_, function = [None, *FUNCTION.finditer(text, 0, end)]
    if function is None or "\n}\n" in text[function.end() : end]:
        return None
    parameters = (each.split() for each in function[1].split(",") if each.strip())
    inputs = {name: KINDS[kind] for kind, name in parameters if kind in KINDS}
    properties = dict.fromkeys(GEOMETRY.findall(function[2]), "vector3")
    return Prelude(GEOMETRY.sub("", function[2]), inputs | properties)
