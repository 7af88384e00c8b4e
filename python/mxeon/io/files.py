# SPDX-License-Identifier: Apache-2.0
"""Files: regular ones alone are read, and those that are written appear whole or not at all."""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex

from mxeon.errors import InputError

AnyPath = str | os.PathLike[str]
TEMPORARY = ".mxeon-"  # begins the names of files and folders that are not whole yet


def below(folder: AnyPath, name: AnyPath) -> Path:
    """Path of the file `name` in a folder that the user named, unless a link would lead out of it.

    The folder itself may be a link.
    """
    path = Path(folder)
    for part in Path(name).parts:
        path /= part
        if path.is_symlink():
            raise InputError(f"{path}: must not be a link, which leads to another file; remove it")
    return path


@contextmanager
def replacing(path: AnyPath) -> Iterator[Path]:
    """New empty file beside `path` to write to, moved onto it when the block ends without an error.

    Its folder is created if need be. A link is followed: see `below` for names that the user did not
    write. The new file has the same suffix, from which image writers take the format. After an error,
    nothing half-written stays behind.
    """
    path = Path(os.path.realpath(path)) if os.path.islink(path) else Path(path)
    if not path.name:
        raise OSError(errno.EINVAL, "not the name of a file", str(path))
    if path.exists() and not path.is_file():  # a device that is replaced is gone
        raise OSError(errno.EINVAL, "not a regular file", str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    # Nobody can guess the name, and no link or other writer has it.
    beside = path.with_name(f"{TEMPORARY}{token_hex(8)}{path.suffix}")
    with naming(path):
        os.close(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            yield beside
            with beside.open("rb") as file:
                os.fsync(file.fileno())  # some file systems report a full disk only here
            os.replace(beside, path)
        finally:
            with suppress(OSError):  # of a folder that cannot be written: the first error says so
                beside.unlink(missing_ok=True)


@contextmanager
def naming(path: AnyPath) -> Iterator[None]:
    """Let the system's errors name `path`: they name a temporary file, or none on a full disk."""
    try:
        yield
    except OSError as error:
        if error.errno:
            error.filename, error.filename2 = str(path), None
        raise


def write_text(path: AnyPath, text: str) -> None:
    """Write `text` to `path` in UTF-8, replacing it whole; see `replacing`.

    A lone surrogate, which a file name can bring in and UTF-8 cannot hold, becomes "?".
    """
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8", errors="replace")


def regular(path: AnyPath, flags: int) -> int:
    """Descriptor of a regular file: `open(path, opener=regular)`.

    A pipe or a device may have no end, and opening a pipe without a writer blocks.
    """
    file = os.open(path, flags | os.O_NONBLOCK)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise OSError(errno.EINVAL, "not a regular file", os.fspath(path))
    return file


def assert_regular(path: AnyPath) -> None:
    """Raise OSError unless a path names a readable regular file; for libraries that open by name."""
    os.close(regular(path, os.O_RDONLY))
