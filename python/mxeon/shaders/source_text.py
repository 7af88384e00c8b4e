# SPDX-License-Identifier: Apache-2.0
"""Files of shader source: their bytes, their text, and the files that they include."""

from mxeon.errors import InputError
from mxeon.io.files import AnyPath, regular

INCLUDE = "#include"  # as MaterialX seeks it, for every target


def read_source(path: AnyPath, limit: int) -> bytes:
    """Content of a regular file; of one that is longer than the limit, one byte more.

    Raises
    ------
    InputError
        If it cannot be read, or is of another kind.
    """
    try:
        with open(path, "rb", opener=regular) as file:
            return file.read(limit + 1)
    except OSError as error:
        raise InputError(f"{path}: must be readable; {error.strerror}") from None


def decode_source(data: bytes, path: AnyPath) -> str:
    """Text of a file, with the ends of its lines as they are.

    Raises
    ------
    InputError
        If it is not in UTF-8; names the file.
    """
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: must be text in UTF-8; byte {error.start} is not") from None


def included(line: str) -> str:
    """File that a line of source includes for MaterialX, or "": what its outer quotes hold.

    Examples
    --------
    >>> included('#include "lib/mx_math.glsl"')
    'lib/mx_math.glsl'
    """
    return line[line.index('"') + 1 : line.rindex('"')] if INCLUDE in line and '"' in line else ""
