# SPDX-License-Identifier: Apache-2.0
"""Decodes the text of a document, and converts the text to strict XML.

MaterialX accepts texts that XML forbids: `<` and `&` in attributes, `--` in comments, and a
declaration after blank lines. Checks and MaterialX both read the converted text, so MaterialX reads
what was checked.
"""

import re

from mxeon.errors import DocumentError

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
    """Text of a document, which must be in UTF-8. An ASCII document may declare any encoding."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        reason = f"{error.reason} at byte {error.start}"
        if data.startswith((b"\xff\xfe", b"\xfe\xff")) and data[2:4] != b"\0\0":
            reason = "this is UTF-16"
        rule = "must be a MaterialX document in UTF-8"
        raise DocumentError(f"{location}: {rule}; {reason}: save it as UTF-8") from None
    declared = DECLARED.match(text[:LONGEST_DECLARATION])
    if declared and declared[1].lower() not in ("utf-8", "utf8") and not text.isascii():
        raise DocumentError(
            f"{location}: must be in UTF-8; got encoding {declared[1]!r}: save it as UTF-8"
        )
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
