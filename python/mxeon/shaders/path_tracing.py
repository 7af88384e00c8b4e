# SPDX-License-Identifier: Apache-2.0
"""Turns generated shaders into text that path tracers include, for the profile "path".

The material's code is unchanged, but the inputs and outputs of the pixel stage become variables.
docs/path_tracing.md describes the interface.
"""

import re
from collections.abc import Mapping

import MaterialX as mx
import numpy as np

from mxeon.errors import InterfaceError
from mxeon.shaders.document.values import property_defaults
from mxeon.shaders.library import source_folder

# Expressions that replace outputs of a vertex stage. The path tracer's structure Point is `p`, and
# object space is the same as world space.
PLACES = {
    "position": "p.position",
    "normal": "p.normal",
    "tangent": "p.tangent",
    "bitangent": "cross(p.normal, p.tangent)",
    "texcoord": "p.texcoord",
}
PROPERTY = "i_geomprop_"
MEMBER = re.compile(r"^ *(?:flat )?(?:in )?(\w+) (\w+)(?: : \w+)?;$", re.MULTILINE)
LAYOUT = r"^(?:layout \(location = \d+\) )?"
HEADS = re.compile(r"^#version.*\n|^#pragma shader_stage.*\n", re.MULTILINE)
# Patterns and replacements that turn the stage's inputs, output and main function into variables
# and a function for a path tracer.
GLSL = (
    (LAYOUT + r"in VertexData\n", "struct VertexData\n"),
    (LAYOUT + r"(?:flat )?in (\w+ \w+;\n)", r"\1"),
    (LAYOUT + r"out vec4 (\w+);\n", r"vec4 \1;\n#define path_out \1\n"),
    (r"^void main\(\)\n", "void path_material()\n"),
    (r"^ *discard;\n", ""),
)
SLANG = (
    (r"^static VertexData vd;\n", r"\g<0>static float4 path_out;\n"),
    (
        r'^\[shader\("fragment"\)\]\nfloat4 fragmentMain\(VertexData _vd\) : SV_Target\n',
        "void path_material()\n",
    ),
    (r"^    vd = _vd;\n|^ *discard;\n", ""),
    (r"^    return (\w+);\n}\s*\Z", r"    path_out = \1;\n}\n"),
)
WORDS = {"vec2": "float2", "vec3": "float3", "vec4": "float4", "uvec4": "uint4"}  # types in Slang
GLOBAL = re.compile(r"^(?=(?:int|bool|float|vec\d) path_\w+;)", re.MULTILINE)


def path_text(text: str, target: str, element: mx.TypedElement, library: str) -> str:
    """A material's pixel stage, to be included after a path tracer's #version and declarations.

    Raise InterfaceError if the material mixes surfaces, because a path can follow only one surface,
    or if a BSDF has code that is not for path tracers, because the BSDF would be black.
    """
    if "mx_mix_surfaceshader(" in text:
        raise InterfaceError(
            "path: the material must have one surface; it mixes several: mix their closures instead"
        )
    for each in element.getDocument().getImplementations():
        function, node = each.getFunction(), each.getNodeDef()
        called = f" {function}(closureData," in text and not function.startswith("path_")
        if called and node and node.getType() == "BSDF":
            name = node.getNodeString()
            raise InterfaceError(
                f"path: the BSDF {name} must be a graph of MaterialX's BSDFs; its code has no sampler"
            )
    text = HEADS.sub("", text)
    slang = target == "slang"
    for old, new in SLANG if slang else GLSL:
        text = re.sub(old, new, text, flags=re.MULTILINE)
    declared = re.search(r"^(?:#define|static float4) path_out.*\n", text, re.MULTILINE)
    assert declared
    has_block = "struct VertexData" in text
    block = text[text.index("struct VertexData") if has_block else 0 : declared.start()]
    prefix = "vd." if has_block else ""
    defaults = property_defaults(element.getDocument())
    places = [
        f"    {prefix}{name} = {value};\n"
        for kind, name in MEMBER.findall(block)
        if (value := _at_point(kind, name, defaults))
    ]
    head, random, tail = (
        own_text(name, library, slang) for name in ("head", "random", "interface")
    )
    names = (
        f"#define u_viewPosition ({prefix}positionWorld + path_wo)\n"
        f"#define material_is_thin_walled {thin_walled(element)}\n"
    )
    place = f"\nvoid path_place(Point p)\n{{\n{''.join(places)}}}\n\n"
    return text[: declared.end()] + head + names + text[declared.end() :] + place + random + tail


def _at_point(kind: str, name: str, defaults: Mapping[str, tuple[float, ...]]) -> str:
    """Expression at a Point for an output of the vertex stage, or "" for other variables.

    Vertex colors are white. A pair of numbers is the texture coordinates, as USD's `st`, and other
    geometric properties have the default of their node.
    """
    if name.startswith(PROPERTY):
        if kind in ("vec2", "float2"):
            return PLACES["texcoord"]
        numbers = defaults.get(name.removeprefix(PROPERTY), (0.0,))
        return f"{kind}({', '.join(str(np.float32(each)) for each in numbers)})"
    if name.startswith("color_"):
        return f"{kind}(1.0)"
    return PLACES.get(re.split("[^a-z]", name, maxsplit=1)[0], "")


def own_text(name: str, library: str, slang: bool) -> str:
    """Text of a file of the interface for path tracers, in GLSL or Slang."""
    text = (source_folder(library) / "genglsl" / "path" / f"{name}.glsl").read_text(
        encoding="utf-8"
    )
    if slang:
        text = re.sub(
            r"\b\w+", lambda word: WORDS.get(word[0], word[0]), GLOBAL.sub("static ", text)
        )
    return text


def thin_walled(element: mx.TypedElement) -> str:
    """Whether a surface is thin-walled, as "true" or "false". Computed values count as false."""
    shaders = mx.getShaderNodes(element) if element.getType() == "material" else [element]
    nodes = [each for each in shaders if isinstance(each, mx.Node)]
    names = ("thin_walled", "geometry_thin_walled")
    return str(any(each.getInputValue(name) for each in nodes for name in names)).lower()
