# SPDX-License-Identifier: Apache-2.0
"""Files opened by a name that somebody else chose."""

import errno
import os
import stat


def regular(path, flags):
    """Descriptor of a regular file: `open(path, opener=regular)`.

    A pipe or a device may have no end, and a pipe that nobody writes to blocks who opens it.

    Parameters
    ----------
    path : path-like
    flags : int
        As of `os.open`.

    Returns
    -------
    int

    Raises
    ------
    OSError
        If the file is of another kind, or cannot be opened.
    """
    file = os.open(path, flags | os.O_NONBLOCK)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise OSError(errno.EINVAL, "not a regular file", os.fspath(path))
    return file


def assert_regular(path):
    """Raise OSError unless a path names a regular file that can be read; for what opens by name."""
    os.close(regular(path, os.O_RDONLY))
