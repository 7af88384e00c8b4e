# SPDX-License-Identifier: Apache-2.0
"""Read only regular files, and write files atomically."""

import errno
import hashlib
import os
import stat
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from secrets import token_hex
from typing import TypeAlias

from mxeon.errors import InputError

AnyPath = str | os.PathLike[str]
BINARY: int = getattr(os, "O_BINARY", 0)  # this flag stops Windows from writing "\r\n" for "\n"
Names: TypeAlias = AnyPath | Iterable[AnyPath]  # one or more names or paths
TEMPORARY = ".mxeon-"  # prefix of incomplete files and folders


def one_name(parameter: str, value: object) -> str:
    """A name or path as text. Raises InputError for any other value, such as a list."""
    name = os.fspath(value) if isinstance(value, str | os.PathLike) else value
    if not isinstance(name, str):
        raise InputError(f"{parameter} must be one name or path; got {value!r}")
    return name


def names_of(parameter: str, value: object, least: int = 1) -> tuple[str, ...]:
    """Convert one or more names or paths to strings.

    >>> names_of("hosts", "gl"), names_of("files", [Path("a.mtlx"), "b.mtlx"])
    (('gl',), ('a.mtlx', 'b.mtlx'))
    """
    if isinstance(value, str | bytes | os.PathLike):
        return (one_name(parameter, value),)
    rule = f"{parameter} must be a name or path, or several"
    if not isinstance(value, Iterable):
        raise InputError(f"{rule}; got {value!r}")
    names = tuple(one_name(f"each of {parameter}", each) for each in value)
    if len(names) < least:
        raise InputError(f"{rule}; got none")
    return names


def below(folder: AnyPath, name: AnyPath) -> Path:
    """Path of a file in a user's folder. Raises InputError for links, which may lead elsewhere."""
    path = Path(folder)
    for part in Path(name).parts:
        path /= part
        if path.is_symlink():
            raise InputError(f"{path}: must not be a link, which leads to another file; remove it")
    return path


def check_output(
    output: AnyPath,
    inputs: Iterable[AnyPath] = (),
    endings: Sequence[str] = (),
    replaced: Sequence[str] = (),
    apart: bool = False,
) -> None:
    """Raise InputError or OSError unless an output can be written without replacing an input.

    Files are compared by device and inode, so that links and other spellings of a name are
    recognized. `inputs` is only iterated if the output exists. If there are patterns in `replaced`,
    the output is a folder in which matching files will be replaced. If `apart` is true, no input
    may be in that folder.
    """
    place = Path(output)
    if not os.fspath(output):
        raise InputError("output must have a name; got ''")
    if not replaced:
        if endings and place.suffix.lower() not in endings:
            raise InputError(f"output must end in {' or '.join(endings)}; got {str(output)!r}")
        if place.exists() and not place.is_file():  # replacing a device would destroy it
            raise OSError(errno.EINVAL, "not a regular file", str(output))
        home, targets = Path(os.path.realpath(place)).parent, [place]
    else:
        home = Path(os.path.realpath(place))
        targets = [file for pattern in replaced for file in place.glob(pattern)]
    while not os.path.lexists(home):
        home = home.parent
    if not home.is_dir():
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(home))
    if not os.access(home, os.W_OK | os.X_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(home))
    existing, folder = {*map(_identity, targets)} - {None}, _identity(place) if apart else None
    parent = cache(_identity)
    for file in inputs if existing or folder else ():
        if _identity(file) in existing:
            raise InputError(f"output must not replace an input file; {output} is {file}")
        paths = (Path(os.path.abspath(file)), Path(os.path.realpath(file)))
        if folder and any(folder == parent(each) for path in paths for each in path.parents):
            rule = "must be a folder without input files"
            raise InputError(f"{output}: {rule}; it holds {file}: name another folder")


def _identity(path: AnyPath) -> tuple[int, int] | None:
    """Device and inode of a file or folder, or None for a path that does not exist."""
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino


@contextmanager
def replacing(path: AnyPath) -> Iterator[Path]:
    """Yield a new empty file, which replaces `path` if the block succeeds and is deleted otherwise.

    The file is in the folder of `path`, which is created if needed. Links are followed, so `below`
    must check names that the user did not write. The new file has the suffix of `path`, from which
    image writers infer the format.
    """
    path = Path(os.path.realpath(path)) if os.path.islink(path) else Path(path)
    if not path.name:
        raise OSError(errno.EINVAL, "not the name of a file", str(path))
    if path.exists() and not path.is_file():  # replacing a device would destroy it
        raise OSError(errno.EINVAL, "not a regular file", str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    # The name is unpredictable, so no other program can have created a file or link with that name.
    temporary = path.with_name(f"{TEMPORARY}{token_hex(8)}{path.suffix}")
    with naming(path):
        os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            yield temporary
            with temporary.open("r+b") as file:  # Windows can flush only writable files
                os.fsync(file.fileno())  # some file systems report a full disk only in fsync
            os.replace(temporary, path)
        finally:
            with suppress(OSError):  # the first error is reported
                temporary.unlink(missing_ok=True)


@contextmanager
def naming(path: AnyPath) -> Iterator[None]:
    """System errors of the block name `path` instead of, for example, a temporary file."""
    try:
        yield
    except OSError as error:
        if error.errno:
            error.filename, error.filename2 = str(path), None
        raise


def write_text(path: AnyPath, text: str) -> None:
    """Write `text` to `path` in UTF-8. An existing file is replaced atomically.

    Lone surrogates, which file names can contain but UTF-8 cannot, are replaced by "?".
    """
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", errors="replace", newline="\n")


def sync(folder: AnyPath) -> None:
    """Flush a folder's list of files to disk, except on Windows, which cannot open folders."""
    if sys.platform == "win32":
        return
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)


def regular(path: AnyPath, flags: int) -> int:
    """Open a regular file and return its descriptor: `open(path, opener=regular)`.

    Pipes and devices are refused, because a device may have no end and a pipe without a writer
    blocks.
    """
    file = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))  # Windows has no O_NONBLOCK
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise OSError(errno.EINVAL, "not a regular file", os.fspath(path))
    return file


def digest(path: AnyPath) -> str:
    """SHA-256 of a regular file as hexadecimal digits, or "" for a file that cannot be read."""
    with suppress(OSError), open(path, "rb", opener=regular) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
    return ""
