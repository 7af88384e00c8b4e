# SPDX-License-Identifier: Apache-2.0
"""Helpers for elements of a document: names for messages, Python values, and color spaces."""

import re
from collections.abc import Iterable, Iterator
from typing import TypeAlias, cast

import MaterialX as mx

TEXT = "document text"


def label(document: mx.Document) -> str:
    """The file that a document was read from, or the words "document text"."""
    return document.getSourceUri() or TEXT


def location(element: mx.Element) -> str:
    """Text that identifies an element in messages: document, category and name path."""
    return f'{label(element.getDocument())}: {element.getCategory()} "{element.getNamePath()}"'


# Syntax of numbers. MaterialX reads the longest numeric prefix of a word and ignores the rest.
FLOAT = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?\s*", re.ASCII | re.IGNORECASE)
INTEGER = re.compile(r"\s*[+-]?\d+\s*", re.ASCII)
SCALARS = {"float": FLOAT, "integer": INTEGER}
VECTORS = ("color3", "color4", "vector2", "vector3", "vector4", "matrix33", "matrix44")
ARRAYS = {"floatarray": FLOAT, "integerarray": INTEGER}
NUMERIC = (*SCALARS, *VECTORS, *ARRAYS)


Plain: TypeAlias = "bool | int | float | str | tuple[Plain, ...] | None"


def plain(value: object, document: mx.Document) -> Plain:
    """A MaterialX value of any type, or the data of such a value, as a plain Python value.

    A color, vector or array becomes a tuple of components. A matrix becomes a tuple of numbers, row
    by row, as in documents. A structure becomes a tuple of the members' plain values, in order.
    """
    if isinstance(value, mx.Value):
        if not hasattr(value, "getData"):  # Python only has the text of structures
            return _members(value.getValueString(), value.getTypeString(), document)
        value = value.getData()
    if isinstance(value, (mx.Matrix33, mx.Matrix44)):
        rows, columns = range(value.numRows()), range(value.numColumns())
        return tuple(value[row, column] for row in rows for column in columns)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return tuple(cast(Iterable[float], value))  # a color, a vector or an array


def property_defaults(document: mx.Document) -> dict[str, tuple[float, ...]]:
    """Defaults of the geometric properties that a document reads, by their names in shaders."""
    defaults: dict[str, tuple[float, ...]] = {}
    for node in document.traverseTree():
        if node.getCategory() == "geompropvalue" and (name := node.getInputValue("geomprop")):
            value = plain(node.getInputValue("default"), document)
            numbers = value if isinstance(value, tuple) else (value or 0.0,)
            defaults.setdefault(mx.createValidName(str(name)), cast(tuple[float, ...], numbers))
    return defaults


def members(kind: str, document: mx.Document) -> tuple[tuple[str, str], ...]:
    """Names and types of a structure's members; empty for other types."""
    definition = document.getTypeDef(kind)
    parts = definition.getMembers() if definition else ()
    return tuple((each.getName(), each.getType()) for each in parts)


def flat(
    name: str, kind: str, value: Plain, document: mx.Document
) -> Iterator[tuple[str, str, Plain]]:
    """Name, type and value of an input or of each member of a structure, except for text values."""
    if parts := members(kind, document):
        values = value if isinstance(value, tuple) else ()
        for (part, inner), member in zip(parts, values, strict=False):
            yield from flat(f"{name}.{part}", inner, member, document)
    elif value is not None and not isinstance(value, str):
        yield name, kind, value


def is_exact(text: str, kind: str) -> bool:
    """Whether MaterialX reads the whole text as a numeric value, not only a prefix."""
    if kind in SCALARS:
        return bool(SCALARS[kind].fullmatch(text))
    if kind in ARRAYS:
        return all(map(ARRAYS[kind].fullmatch, text.split(",")))
    return all(map(FLOAT.fullmatch, filter(None, re.split("[, ]", text))))


def _members(text: str, kind: str, document: mx.Document) -> tuple[Plain, ...]:
    parts = split(text[1:-1], ";")
    return tuple(
        _members(part, kind, document)
        if members(kind, document)
        else plain(mx.Value.createValueFromStrings(part, kind), document)
        for part, (_, kind) in zip(parts, members(kind, document), strict=False)
    )


def split(text: str, separator: str) -> list[str]:
    """Split a text at separators outside brackets, up to the first unmatched closing bracket.

    >>> split("a;b;{c;d}} e", ";")
    ['a', 'b', '{c;d}']
    """
    parts, depth = [""], 0
    for sign in text:
        depth += (sign in "([{") - (sign in ")]}")
        if depth < 0:
            break
        if sign == separator and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return parts


# Aliases of color spaces in MaterialX's DefaultColorManagementSystem.cpp.
LEGACY = {
    "gamma18": "g18_rec709",
    "gamma22": "g22_rec709",
    "gamma24": "rec709_display",
    "lin_ap1": "acescg",
}
# First version of MaterialX with the aliases of the Color Interop Forum.
INTEROP_VERSION = (1, 39, 4)
INTEROP = {
    "lin_ap1_scene": "acescg",
    "lin_rec709_scene": "lin_rec709",
    "lin_p3d65_scene": "lin_displayp3",
    "lin_adobergb_scene": "lin_adobergb",
    "srgb_rec709_scene": "srgb_texture",
    "g22_rec709_scene": "g22_rec709",
    "g18_rec709_scene": "g18_rec709",
    "g22_ap1_scene": "g22_ap1",
    "srgb_p3d65_scene": "srgb_displayp3",
    "g22_adobergb_scene": "adobergb",
}


def color_spaces(element: mx.Element) -> tuple[str, str] | None:
    """Color spaces of an element and of its document; None if values need no transform."""
    known = LEGACY | (INTEROP if mx.getVersionIntegers() >= INTEROP_VERSION else {})
    space, target = (
        known.get(name, name)
        for name in (element.getActiveColorSpace(), element.getDocument().getColorSpace())
    )
    return None if {"", "none"} & {space, target} or space == target else (space, target)
