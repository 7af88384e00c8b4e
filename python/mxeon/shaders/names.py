# SPDX-License-Identifier: Apache-2.0
"""Names of generated shaders: identifiers in every language of a target."""

import re
from collections.abc import Iterable

import MaterialX as mx

# Words that OSL or MDL does not take as the name of a shader.
RESERVED = frozenset(
    [
        "and",
        "auto",
        "bool",
        "break",
        "bsdf",
        "bsdf_measurement",
        "case",
        "cast",
        "char",
        "class",
        "closure",
        "color",
        "const",
        "continue",
        "default",
        "delete",
        "displacement",
        "do",
        "double",
        "edf",
        "else",
        "emit",
        "enum",
        "export",
        "extern",
        "false",
        "float",
        "float2",
        "float3",
        "float4",
        "for",
        "friend",
        "goto",
        "hair_bsdf",
        "if",
        "illuminance",
        "illuminate",
        "import",
        "in",
        "inline",
        "int",
        "int2",
        "int3",
        "int4",
        "intensity_mode",
        "let",
        "light_profile",
        "long",
        "material",
        "matrix",
        "mdl",
        "module",
        "mutable",
        "new",
        "normal",
        "not",
        "operator",
        "or",
        "output",
        "package",
        "point",
        "private",
        "protected",
        "public",
        "return",
        "shader",
        "short",
        "signed",
        "sizeof",
        "static",
        "string",
        "struct",
        "surface",
        "switch",
        "template",
        "texture_2d",
        "this",
        "throw",
        "true",
        "try",
        "typedef",
        "typename",
        "uniform",
        "union",
        "unsigned",
        "using",
        "varying",
        "vdf",
        "vector",
        "virtual",
        "void",
        "volatile",
        "volume",
        "while",
    ]
)


def shader_names(elements: Iterable[mx.TypedElement]) -> dict[str, str]:
    """Names of the shaders of renderable elements, by name path; no two are alike."""
    names: dict[str, str] = {}
    last: dict[str, str] = {}  # name by stem, before which all are in use
    used: set[str] = set()
    for element in elements:
        # Make a word of the path.
        stem = re.sub(r"\W", "_", element.getNamePath(), flags=re.ASCII)
        if stem[0].isdigit() or stem in RESERVED:
            stem = f"shader_{stem}"
        # Number it until it is new.
        name = last.get(stem, stem)
        while name in used:
            name = mx.incrementName(name)
        names[element.getNamePath()] = last[stem] = name
        used.add(name)
    return names
