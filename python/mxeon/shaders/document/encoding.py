# SPDX-License-Identifier: Apache-2.0
"""Text of a document from its bytes, as MaterialX reads it, and as XML that any parser reads alike.

MaterialX takes more than XML allows: `<` and `&` in attributes, `--` in comments, a declaration
after blank lines. Here that becomes XML, once, so that the checked text is the text that is read.
"""

import codecs
import re

from mxeon.errors import DocumentError

# First bytes of a document and their encoding, in the order in which MaterialX compares.
STARTS = (
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (b"\0\0\0<", "utf-32-be"),
    (b"<\0\0\0", "utf-32-le"),
    (b"\0<", "utf-16-be"),
    (b"<\0", "utf-16-le"),
)
LONGEST_DECLARATION = 65_536  # bytes
DECLARED = re.compile(r"\s*<\?xml\s[^>]*?\sencoding\s*=\s*[\"']([^\"']*)[\"']")
DECODED = re.compile(r"utf-?(8|16|32)([bl]e|-[bl]e)?", re.IGNORECASE)
LATIN = ("iso-8859-1", "latin1")
ASCII = rb'<x a="+AGE-\x41~{.xn--a">'  # characters that some encodings read otherwise

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
    """Text of a document from its bytes, as MaterialX decodes it.

    Parameters
    ----------
    data : bytes
        In UTF-8, UTF-16, UTF-32 or ISO-8859-1, or ASCII under any name of an encoding that has it.
    location : str
        Name of the document in messages.

    Returns
    -------
    str

    Raises
    ------
    DocumentError
        If it is in another encoding.
    """
    # Tell the encoding from the first bytes.
    encoding = next((name for start, name in STARTS if data.startswith(start)), "utf-8")
    if data.startswith(b"<?xml"):
        declared = DECLARED.match(data[:LONGEST_DECLARATION].decode("latin-1"))
        if declared and declared[1].lower() in LATIN:
            encoding = "iso-8859-1"
    # Decode the text.
    try:
        text = data.decode(encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        raise DocumentError(
            f"{location}: must be a MaterialX document in {encoding.upper()}; {error.reason} at byte "
            f"{error.start}"
        ) from None
    # Refuse another encoding than the declared one.
    if declared := DECLARED.match(text[:LONGEST_DECLARATION]):
        _check_declared(declared[1], text, location)
    return text


def strict(text: str) -> str:
    """A document's text as XML without comments and declaration; its lines keep their numbers."""
    return PIECE.sub(_strict_piece, text)


def _check_declared(name: str, text: str, location: str) -> None:
    """Raise DocumentError if a text would differ in the encoding that it declares."""
    if DECODED.fullmatch(name) or name.lower() in LATIN:
        return
    try:
        same = text.isascii() and ASCII.decode(name) == ASCII.decode()
    except (LookupError, ValueError):  # unknown, no encoding of text, or not of this one
        same = False
    if not same:
        raise DocumentError(
            f"{location}: must be in an encoding that MaterialX reads, UTF-8, UTF-16, UTF-32 or "
            f"ISO-8859-1; got {name!r}"
        )


def _strict_piece(piece: re.Match[str]) -> str:
    text = piece[0]
    if (text.startswith("<!--") and text.endswith("-->")) or re.match(r"<\?xml\s", text):
        return "\n" * text.count("\n")
    if text.startswith(("<!", "<?")):
        return text
    if "&" not in text and "<" not in text[1:]:
        return text
    return QUOTED.sub(lambda value: AMPERSAND.sub("&amp;", value[0]).replace("<", "&lt;"), text)
