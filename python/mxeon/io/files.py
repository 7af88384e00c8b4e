# SPDX-License-Identifier: Apache-2.0
"""Files: regular ones alone are read; what is written appears whole or not at all."""

import errno
import os
import stat
from contextlib import contextmanager
from pathlib import Path

PNG_END = b"IEND\xaeB`\x82"  # its last chunk
PART = "not all of it is in the file; the disk may be full"


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
        with beside.open("rb") as file:
            os.fsync(file.fileno())  # some file systems tell only now that there is no room
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


def write_image(path, pixels, attributes):
    """Write pixels to an image file in the format that the ending of `path` names.

    Parameters
    ----------
    path : path-like
        Replaced whole; see `replacing`.
    pixels : ndarray of float32 or uint8, shape (height, width, channels)
        Contiguous, of a type that the format keeps as it is.
    attributes : mapping of str to str
        Kept in the file, by OpenImageIO's names.

    Raises
    ------
    OSError
        If the file cannot be written; says why.

    Notes
    -----
    The file is read again: OpenImageIO's PNG writer, and any whose last bytes wait in a buffer of
    the C library, report no full disk.
    """
    import OpenImageIO as oiio

    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise OSError(errno.EILSEQ, "the name must be UTF-8", str(path)) from None
    image = oiio.ImageBuf(pixels)
    for name, value in attributes.items():
        image.specmod().attribute(name, value)
    with replacing(path) as beside:
        if not image.write(str(beside)):
            raise OSError(errno.EIO, image.geterror().replace(str(beside), str(path)))
        if not _holds(beside, pixels):
            raise OSError(errno.EIO, PART)


def _holds(path, pixels):
    """Whether an image file holds these pixels."""
    import OpenImageIO as oiio

    if path.suffix.lower() == ".png" and not path.read_bytes().endswith(PNG_END):
        return False  # libpng would print that
    file = oiio.ImageInput.open(str(path))
    stored = file.read_image(oiio.UNKNOWN) if file else None
    oiio.geterror()  # else it is printed when Python ends
    return stored is not None and stored.tobytes() == pixels.tobytes()


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
