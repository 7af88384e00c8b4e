# SPDX-License-Identifier: Apache-2.0
"""Text of a document: decoded, converted to strict XML, and checked before MaterialX reads it.

MaterialX accepts more than XML allows: `<` and `&` in attributes, `--` in comments, a declaration
after blank lines. Here it becomes strict XML once, so that the checked text is also the text that is read.
MaterialX keeps what it reads in memory and follows every include at once, so size, depth and
number are counted here, by a parser that keeps nothing.
"""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from mxeon.errors import STEERING, DocumentError
from mxeon.io.files import AnyPath
from mxeon.shaders.document.policy import Policy

LONGEST_DECLARATION = 65_536  # characters
DECLARED = re.compile(r"\s*<\?xml\s[^>]*?\sencoding\s*=\s*[\"']([^\"']*)[\"']")

PIECE = re.compile(
    r"<!--.*?(?:-->|\Z)"
    r"|<!\[CDATA\[.*?(?:\]\]>|\Z)"
    r"|<\?.*?(?:\?>|\Z)"
    r"|<[^!?<>\"'](?:[^\"'<>]|\"[^\"]*\"|'[^']*')*+>",
    re.DOTALL,
)
QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'")
AMPERSAND = re.compile(r"&(?!(?:lt|gt|amp|quot|apos|#[0-9]+|#x[0-9a-fA-F]+);)")


def decode(data: bytes, location: str) -> str:
    """Text of a document: UTF-8, or ASCII regardless of its declaration."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise DocumentError(
            f"{location}: must be a MaterialX document in UTF-8; {error.reason} at byte {error.start}"
        ) from None
    declared = DECLARED.match(text[:LONGEST_DECLARATION])
    if declared and declared[1].lower() not in ("utf-8", "utf8") and not text.isascii():
        raise DocumentError(f"{location}: must be in UTF-8; got encoding {declared[1]!r}")
    return text


def strict(text: str) -> str:
    """A document's text as XML without comments and declaration; line numbers are preserved."""
    return PIECE.sub(_strict_piece, text)


def _strict_piece(piece: re.Match[str]) -> str:
    text = piece[0]
    if (text.startswith("<!--") and text.endswith("-->")) or re.match(r"<\?xml\s", text):
        return "\n" * text.count("\n")
    if text.startswith(("<!", "<?")):
        return text
    if "&" not in text and "<" not in text[1:]:
        return text
    return QUOTED.sub(lambda value: AMPERSAND.sub("&amp;", value[0]).replace("<", "&lt;"), text)


LONGEST_NAME = 128  # characters; file names contain three names and may have 255


class XmlChecker:
    """Checks the text of a document and everything it includes, with common limits."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self._size = self._elements = self._attributes = self._depth = 0
        self._location = ""

    def read(self, file: AnyPath) -> bytes:
        """Content of a file, at most one byte more than the limit."""
        try:
            with Path(file).open("rb") as stream:
                size = min(self._policy.size - self._size, os.fstat(stream.fileno()).st_size)
                return stream.read(size + 1)
        except OSError as error:
            raise DocumentError(f"{file}: must be readable; {error.strerror}") from None

    def check_size(self, data: bytes, location: str) -> None:
        """Raise DocumentError if a document makes the total size exceed the limit."""
        self._location = location
        self._size += len(data)
        self._limit("size", self._size, "bytes, with all that it includes")

    def check(self, text: str, location: str) -> list[str]:
        """Check the text of a document; the faults of elements that MaterialX ignores."""
        self._location, self._depth = location, 0
        self._names: list[set[str]] = [set()]  # names of siblings at each level
        self._ignored: list[str] = []
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._refuse_type
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
            usd = location.lower().endswith((".usd", ".usda", ".usdc", ".usdz"))
            remedy = (
                "; a renderer that reads USD is checked by its images: mxeon kit export"
                if usd
                else ""
            )
            self._refuse(f"must be a MaterialX document; XML parse error: {error}{remedy}")
        return self._ignored

    def _start(self, category: str, attributes: Mapping[str, str]) -> None:
        self._depth += 1
        self._elements += 1
        self._limit("depth", self._depth, "elements within each other")
        self._attributes += len(attributes)
        self._limit("elements", self._elements, "elements, with all that it includes")
        self._limit("attributes", self._attributes, "attributes, with all that it includes")
        for key, value in attributes.items():
            if len(value) > self._policy.length:
                self._limit("length", len(value), f"characters in {key!r} of {category!r}")
            if STEERING.search(value):
                rule = f"must have no control characters in {key!r}"
                self._refuse(f"{category} {rule}; got {value!r}")
        if len(name := attributes.get("name", "")) > LONGEST_NAME:
            rule = f"must have a name of at most {LONGEST_NAME} characters"
            self._refuse(f"{category} {rule}; got {name}")
        if name in self._names[-1]:
            rule = "must have another name than its siblings; MaterialX ignores it"
            self._ignored.append(f"{self._location}: {category} {name!r} {rule}")
        self._names[-1] |= {name} - {""}
        self._names.append(set())

    def _end(self, _: str) -> None:
        self._depth -= 1
        self._names.pop()

    def _refuse_type(self, name: str, *_: object) -> None:
        self._refuse(f"must have no document type, which may define entities; got DOCTYPE {name}")

    def _limit(self, name: str, value: int, unit: str) -> None:
        self._policy.check_limit(name, value, f"{self._location}: must have", unit)

    def _refuse(self, reason: str) -> NoReturn:
        raise DocumentError(f"{self._location}: {reason}")
