# SPDX-License-Identifier: Apache-2.0
"""Checks the words of a document that generators may copy into shaders.

Generators copy the names, the text values and some attributes of a document unchanged, so anything
but a plain word would be code. `tests.fuzz.reach` finds these attributes for every target. All
other attributes, such as `doc`, `uiname` and the attributes of applications, may have any text.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator
from functools import cache

import MaterialX as mx

from mxeon.shaders.document.graphs import reachable
from mxeon.shaders.document.values import location

# Attributes that are names or become part of a name. A name consists of identifiers, with `:`
# between namespaces.
NAMES = frozenset(
    """
    defaultgeomprop function geomprop implname impltype index inherit interfacename namespace node
    nodedef nodegraph nodename output semantic space type unit unittype
    """.split()  # noqa: SIM905
)
# Text attributes of MaterialX. If a generator copies such an attribute, the copy is quoted.
TEXTS = frozenset(
    ["colorspace", "context", "file", "fileprefix", "geomprefix", "target", "value", "version"]
)
STRINGS = ("string", "stringarray", "geomname", "geomnamearray")
NUMBERS = frozenset(
    """
    float integer boolean color3 color4 vector2 vector3 vector4 matrix33 matrix44
    """.split()  # noqa: SIM905
)

NAME = re.compile(r"[\w:]*", re.ASCII)
WORD = re.compile(r"\w*", re.ASCII)
# STRING matches lists of words and paths; MEMBERS also matches the members of a structure.
STRING = re.compile(r"[\w .,:/+<>\[\]-]*", re.ASCII)
MEMBERS = re.compile(r"[\w .,:/+<>\[\]{};-]*", re.ASCII)
COMMENT = "//"  # the patterns already exclude other comments
ENDS_A_STRING = re.compile(r'["\\\x00-\x1f\x7f]')


Choices = Callable[[], Collection[str]]


def word_faults(document: mx.Document, elements: Iterable[mx.Element]) -> Iterator[str]:
    """A fault for each name or text value in a document that is not a plain word."""
    choices = cache(lambda: _choices(document))  # cached, because the whole library is searched
    for element in elements:
        for name in ("name", *element.getAttributeNames()):
            text = element.getName() if name == "name" else element.getAttribute(name)
            if text and (rule := _broken(element, name, text, choices)):
                yield f"{location(element)}: {name!r} must be {rule}; got {text!r}"


def _broken(element: mx.Element, name: str, text: str, choices: Choices) -> str:
    """The rule that an attribute breaks, or "". Numbers and file names are checked elsewhere."""
    if name == "value" and element.hasAttribute("type"):
        kind = element.getAttribute("type")
        if kind in NUMBERS or kind == "filename" or WORD.fullmatch(text):
            return ""
        if kind == "string" and element.getName() in choices():
            return "one word of letters, digits and _"
        if not (STRING if kind in STRINGS else MEMBERS).fullmatch(text) or COMMENT in text:
            return "words of letters, digits and .,:/+- without //"
    elif (name in NAMES or name == "name") and not NAME.fullmatch(text):
        return "a name of letters, digits, _ and :"
    elif name in TEXTS and ENDS_A_STRING.search(text):
        return "without quotes, backslashes and control characters"
    return ""


def _choices(document: mx.Document) -> Collection[str]:
    """Names of inputs whose text a generator writes unquoted, directly or through other inputs."""
    inputs = [
        each
        for tree in (document, document.getDataLibrary())
        for each in tree.traverseTree()
        if each.isA(mx.Input) and each.getType() == "string"
    ]
    sources: dict[str, list[str]] = defaultdict(list)
    for each in inputs:
        sources[each.getName()].append(each.getInterfaceName())
    enums = [each.getName() for each in inputs if each.hasAttribute("enum")]
    return reachable(["geomprop", *enums], sources.get)
