# SPDX-License-Identifier: Apache-2.0
"""What a document's text is judged by before MaterialX reads it.

MaterialX keeps what it reads in memory and follows every include at once, so size, depth and
number are counted here, by a parser that keeps nothing.
"""

import re
from pathlib import Path
from textwrap import shorten
from xml.parsers import expat

LONGEST = 1000  # characters of a message, which may quote the document
# Controls, changes of the direction of writing, and halves of characters.
STEERING = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
LONGEST_NAME = 128  # characters; a file's name may have 255 and has three names in it


class DocumentError(ValueError):
    """A document that no shader can be made from; names the place, the rule and the value."""

    def __init__(self, message):
        super().__init__(one_line(message))


def printable(text):
    """Text with U+FFFD for characters that steer a terminal or fit in no encoding."""
    return STEERING.sub("\ufffd", text)


def one_line(text):
    """A message as one line that steers nothing and is not too long to read."""
    return shorten(printable(str(text)), LONGEST)


class Screening:
    """Counts over a document and all that it includes, held against the limits.

    Parameters
    ----------
    permissions : Permissions
    """

    def __init__(self, permissions):
        self._permissions = permissions
        self._size = self._elements = self._attributes = self._depth = 0
        self._place = ""

    def read(self, file):
        """Text of a file, as bytes; of a file that is too long, no more than shows it.

        Raises
        ------
        DocumentError
            If it cannot be read.
        """
        try:
            with Path(file).open("rb") as opened:
                return opened.read(self._permissions.size - self._size + 1)
        except OSError as error:
            raise DocumentError(f"{file}: must be readable; {error.strerror}") from None

    def judge(self, text, place):
        """Nothing, if a document's text, as bytes, may be read.

        Raises
        ------
        DocumentError
            If it is no XML in UTF-8, has a document type or control characters, or breaks a limit.
        """
        self._place, self._depth = place, 0
        self._size += len(text)
        self._limit("size", self._size, "bytes, with all that it includes")
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._refuse_type
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        try:
            text.decode("utf-8")
            parser.Parse(text, True)
        except (expat.ExpatError, UnicodeDecodeError) as error:
            self._refuse(f"must be a MaterialX document; XML parse error: {error}")

    def _start(self, name, attributes):
        self._depth += 1
        self._elements += 1
        self._limit("depth", self._depth, "elements within each other")
        self._attributes += len(attributes)
        self._limit("elements", self._elements, "elements, with all that it includes")
        self._limit("attributes", self._attributes, "attributes, with all that it includes")
        for key, value in attributes.items():
            self._limit("length", len(value), f"characters in {key!r} of {name!r}")
            if STEERING.search(value):
                self._refuse(f"{name} must have no control characters in {key!r}; got {value!r}")
        if len(called := attributes.get("name", "")) > LONGEST_NAME:
            rule = f"must have a name of at most {LONGEST_NAME} characters"
            self._refuse(f"{name} {rule}; got {called}")

    def _end(self, _):
        self._depth -= 1

    def _refuse_type(self, name, *_):
        self._refuse(f"must have no document type, which may define entities; got DOCTYPE {name}")

    def _limit(self, name, value, what):
        check_limit(self._permissions, name, value, f"{self._place}: must have", what)

    def _refuse(self, reason):
        raise DocumentError(f"{self._place}: {reason}")


def check_limit(permissions, name, value, rule, what):
    """Nothing, if a value is within the limit of that name; the rule says what must have what.

    Raises
    ------
    DocumentError
        Otherwise; names the option that raises the limit.
    """
    limit = getattr(permissions, name)
    if value > limit:
        raise DocumentError(
            f"{rule} at most {limit} {what}; got {value}: raise it with --max{name.capitalize()}"
        )

