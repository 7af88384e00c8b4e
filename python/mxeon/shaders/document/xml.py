# SPDX-License-Identifier: Apache-2.0
"""Checks of a document's text before MaterialX reads it.

MaterialX keeps what it reads in memory and follows every include at once, so size, depth and
number are counted here, by a parser that keeps nothing.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from mxeon.errors import STEERING, DocumentError
from mxeon.io.files import AnyPath
from mxeon.shaders.document.policy import Policy

LONGEST_NAME = 128  # characters; a file's name may have 255 and has three names in it


class XmlChecker:
    """Checks of the text of a document and of all that it includes, which counts as one.

    Parameters
    ----------
    policy : Policy
    """

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self._size = self._elements = self._attributes = self._depth = 0
        self._location = ""

    def read(self, file: AnyPath) -> bytes:
        """Content of a file; of one that is too long, one byte more than the limit.

        Raises
        ------
        DocumentError
            If it cannot be read.
        """
        try:
            with Path(file).open("rb") as stream:
                size = min(self._policy.size - self._size, os.fstat(stream.fileno()).st_size)
                return stream.read(size + 1)
        except OSError as error:
            raise DocumentError(f"{file}: must be readable; {error.strerror}") from None

    def check_size(self, data: bytes, location: str) -> None:
        """Raise DocumentError if a document makes all that was read longer than the limit."""
        self._location = location
        self._size += len(data)
        self._limit("size", self._size, "bytes, with all that it includes")

    def check(self, text: str, location: str) -> None:
        """Check the text of a document.

        Raises
        ------
        DocumentError
            If it is not XML, has a document type or control characters, or exceeds a limit.
        """
        self._location, self._depth = location, 0
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._refuse_type
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
            self._refuse(f"must be a MaterialX document; XML parse error: {error}")

    def _start(self, category: str, attributes: Mapping[str, str]) -> None:
        # Limit depth and numbers.
        self._depth += 1
        self._elements += 1
        self._limit("depth", self._depth, "elements within each other")
        self._attributes += len(attributes)
        self._limit("elements", self._elements, "elements, with all that it includes")
        self._limit("attributes", self._attributes, "attributes, with all that it includes")
        # Limit the attributes, and refuse control characters.
        for key, value in attributes.items():
            if len(value) > self._policy.length:
                self._limit("length", len(value), f"characters in {key!r} of {category!r}")
            if STEERING.search(value):
                rule = f"must have no control characters in {key!r}"
                self._refuse(f"{category} {rule}; got {value!r}")
        # Limit the name.
        if len(name := attributes.get("name", "")) > LONGEST_NAME:
            rule = f"must have a name of at most {LONGEST_NAME} characters"
            self._refuse(f"{category} {rule}; got {name}")

    def _end(self, _: str) -> None:
        self._depth -= 1

    def _refuse_type(self, name: str, *_: object) -> None:
        self._refuse(f"must have no document type, which may define entities; got DOCTYPE {name}")

    def _limit(self, name: str, value: int, unit: str) -> None:
        self._policy.check_limit(name, value, f"{self._location}: must have", unit)

    def _refuse(self, reason: str) -> NoReturn:
        raise DocumentError(f"{self._location}: {reason}")
