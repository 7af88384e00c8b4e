# SPDX-License-Identifier: Apache-2.0
"""The error output of libraries in other languages, which Python's own streams do not see."""

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

ERROR = 2  # file descriptor


@contextmanager
def lines_left_out(words: str) -> Iterator[None]:
    """Context in which lines with these words are kept off the process's error output.

    The other lines appear when it ends. A process without an error output has none to keep.

    Parameters
    ----------
    words : str
    """
    if sys.stderr is None:
        yield
        return
    # Let a file take the place of the error output.
    sys.stderr.flush()
    output = os.dup(ERROR)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), ERROR)
        try:
            yield
        finally:
            # Restore it, and write what is left.
            os.dup2(output, ERROR)
            os.close(output)
            file.seek(0)
            rest = [line for line in file if words.encode() not in line]
            os.write(ERROR, b"".join(rest))
