# SPDX-License-Identifier: Apache-2.0
"""What a document's text is judged by before MaterialX reads it.

MaterialX keeps what it reads in memory and follows every include at once, so size, depth and
number are counted here, by a parser that keeps nothing.
"""

import os
from pathlib import Path
from xml.parsers import expat

from mxeon.errors import STEERING, DocumentError

LONGEST_NAME = 128  # characters; a file's name may have 255 and has three names in it


class Screening:
    """Counts over a document and all that it includes, held against the limits.

    Parameters
    ----------
    policy : Policy
    """

    def __init__(self, policy):
        self._permissions = policy
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
                size = min(self._permissions.size - self._size, os.fstat(opened.fileno()).st_size)
                return opened.read(size + 1)
        except OSError as error:
            raise DocumentError(f"{file}: must be readable; {error.strerror}") from None

    def measure(self, data, place):
        """Raise DocumentError if a document, as bytes, makes all that was read too long."""
        self._place = place
        self._size += len(data)
        self._limit("size", self._size, "bytes, with all that it includes")

    def judge(self, text, place):
        """Raise DocumentError unless a document's text may be read.

        Raises
        ------
        DocumentError
            If it is no XML, has a document type or control characters, or breaks a limit.
        """
        self._place, self._depth = place, 0
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._refuse_type
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
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


def check_limit(policy, name, value, rule, what):
    """Nothing, if a value is within the limit of that name; the rule says what must have what.

    Raises
    ------
    DocumentError
        Otherwise; names the option that raises the limit.
    """
    limit = getattr(policy, name)
    if value > limit:
        raise DocumentError(
            f"{rule} at most {limit} {what}; got {value}: raise it with --max{name.capitalize()}"
        )
