# SPDX-License-Identifier: Apache-2.0
"""Files that appear whole or not at all."""

import os
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path):
    """A path beside `path` to write to, moved onto it when the block ends without an error.

    Parameters
    ----------
    path : path-like
        Its folder is made if need be. A file already there is replaced whole.

    Yields
    ------
    Path
        In the same folder and with the same suffix, which image writers go by.

    Raises
    ------
    OSError
        If the folder or the file cannot be written; nothing half-written stays behind.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        yield beside
        os.replace(beside, path)
    except OSError as error:
        if error.errno:  # what the system says names the file beside it, or of a full disk, none
            error.filename = str(path)
        raise
    finally:
        beside.unlink(missing_ok=True)


def write_text(path, text):
    """Writes `text` to `path` in UTF-8, replacing it whole; see `replacing`.

    A lone surrogate, which a file name can bring in and UTF-8 cannot hold, becomes "?".
    """
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8", errors="replace")
