# SPDX-License-Identifier: Apache-2.0
"""Read and write images (linear EXR, sRGB PNG), and compute the difference of two images."""

from __future__ import annotations

import errno
import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import ImageError, printable
from mxeon.io.files import AnyPath, check_output, regular, replacing
from mxeon.io.srgb import Codes, srgb_encoded

if TYPE_CHECKING:
    import OpenImageIO as oiio

Floats = NDArray[np.float64]
Pixels = NDArray[np.float32]

PICTURES = (".exr", ".png")  # file name suffixes that `write_picture` supports
LARGEST = 2**28  # largest number of values in an image, such as 8192 x 8192 RGBA, 1 GiB
PNG_END = b"IEND\xaeB`\x82"  # the last chunk of a PNG file
# Run-length encoding takes 0.6 of the time of zip, and produces an eighth more bytes.
FAST_EXR: dict[str, str | int] = {"oiio:ColorSpace": "lin_rec709_scene", "compression": "rle"}
# Without a filter (libpng's value 8), writing takes a tenth of the time, and a file has a quarter
# more bytes.
FAST_PNG: dict[str, str | int] = {
    "oiio:ColorSpace": "srgb_rec709_scene",
    "png:compressionLevel": 1,
    "png:filter": 8,
}
NO_THREADS = {"threads": 1, "exr_threads": -1}  # disables threads of OpenImageIO and OpenEXR
INCOMPLETE = "the file is incomplete; the disk may be full"


class ImageWarning(UserWarning):
    """An image is readable, but is damaged or contains values that are not numbers."""


def difference(image: ArrayLike, reference: ArrayLike) -> Floats:
    """Largest difference in the channels of each pixel, relative if the reference exceeds 1.

    The difference is infinite if a value of the pixel is not finite.

    >>> difference([[1.0, 0.5, 9.0]], [[1.0, 0.25, 10.0]]).tolist()
    [0.25]
    """
    with np.errstate(invalid="ignore"):  # inf - inf is invalid
        change: Floats = np.subtract(image, reference, dtype=np.float64)
        change /= np.maximum(1.0, np.abs(reference))
    change[~np.isfinite(change)] = np.inf

    def larger(a: Floats, b: Floats) -> Floats:
        return np.where(np.abs(a) >= np.abs(b), a, b)

    # Channels are reduced one by one, because NumPy's maximum over a short axis takes five times as
    # long.
    return reduce(larger, np.moveaxis(change, -1, 0))


def difference_scale(difference_map: ArrayLike) -> float:
    """Full scale for a plot of differences: the least of 1, 2, 5, 10, ... above almost all values.

    The scale is above the 99th percentile, so that a few pixels at a rim do not darken all other
    pixels. The scale is at least 1e-9, also for equal images. Non-finite values are ignored.

        >>> difference_scale([0.0, 0.003, 0.0031, float("nan")])
        0.005
    """
    difference_map = np.asarray(difference_map)
    positive = difference_map[np.isfinite(difference_map) & (difference_map > 0.0)]
    percentile = max(np.quantile(positive, 0.99) if positive.size else 0.0, 1e-9)
    decade = int(np.floor(np.log10(percentile)))
    # Steps are parsed from text, because products with powers of ten have rounding errors.
    steps = [float(f"{digit}e{decade}") for digit in (1, 2, 5, 10)]
    return next((step for step in steps if percentile <= step), steps[-1])


def read_image(path: AnyPath) -> Pixels:
    """Read the pixels of an image file, with row 0 at the top, without a color transformation.

    Raises ImageError for more than LARGEST values, which even a small file can contain. Issues an
    ImageWarning if OpenImageIO reports an error, for example for a truncated JPEG.
    """
    import OpenImageIO as oiio

    file = open_image(path)
    values = file.spec().image_pixels() * file.spec().nchannels
    if values > LARGEST:
        raise ImageError(f"{path}: must be an image of at most {LARGEST} values; got {values}")
    pixels: Pixels | None = file.read_image(oiio.FLOAT)
    reason = words(file.geterror)
    if pixels is None:
        raise ImageError(f"{path}: must be an image that OpenImageIO reads", reason)
    if reason:
        warnings.warn(ImageWarning(f"{path}: is damaged; {reason}"), stacklevel=2)
    return pixels


def open_image(path: AnyPath) -> oiio.ImageInput:
    """Open an image file with OpenImageIO. Raises ImageError if the file cannot be opened."""
    import OpenImageIO as oiio

    try:
        os.close(regular(path, os.O_RDONLY))  # OpenImageIO would also open pipes
    except OSError as error:
        raise ImageError(f"{path}: must be an image file", error.strerror or "") from None
    file = oiio.ImageInput.open(str(path))
    if file is None:
        reason = words(oiio.geterror)
        raise ImageError(f"{path}: must be an image that OpenImageIO reads", reason)
    return file


def words(message: Callable[[], str]) -> str:
    """A message of OpenImageIO on one line. Bytes that are not UTF-8 are escaped.

    >>> words(lambda: b"channel \\xff is\\nmissing".decode())
    'channel \\\\xff is missing'
    """
    try:
        text = message()
    except UnicodeDecodeError as error:
        text = error.object.decode(errors="backslashreplace")
    return " ".join(text.split())


def write_image(path: AnyPath, pixels: Pixels | Codes, attributes: Mapping[str, str | int]) -> None:
    """Write pixels to an image file in the format that the suffix of `path` names.

    The last row is read back, because OpenImageIO's PNG writer does not report a full disk, nor do
    writers that leave the last bytes in a buffer of the C library.
    """
    import OpenImageIO as oiio

    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise OSError(errno.EILSEQ, "the name must be UTF-8", str(path)) from None
    kind = oiio.UINT8 if pixels.dtype == np.uint8 else oiio.FLOAT
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, kind)
    for name, value in attributes.items():
        spec.attribute(name, value)
    with replacing(path) as temporary:
        name, file = str(temporary), oiio.ImageOutput.create(str(temporary))
        if not (file and file.open(name, spec) and file.write_image(pixels) and file.close()):
            reason = words(file.geterror if file else oiio.geterror)
            raise OSError(errno.EIO, reason.replace(name, str(path)))
        if not _is_complete(temporary, pixels):
            raise OSError(errno.EIO, INCOMPLETE)


def _is_complete(path: Path, pixels: Pixels | Codes) -> bool:
    """Whether the last row of a written image file equals the last row of the pixels."""
    import OpenImageIO as oiio

    if path.suffix.lower() == ".png" and not path.read_bytes().endswith(PNG_END):
        return False  # libpng would print a message
    height, _, channels = pixels.shape
    file = oiio.ImageInput.open(str(path))
    last: NDArray[Any] | None = None
    if file:
        last = file.read_scanlines(height - 1, height, 0, 0, channels, oiio.UNKNOWN)
    words(oiio.geterror)  # clears an error that OpenImageIO prints when Python ends
    return last is not None and last.tobytes() == pixels[-1].tobytes()


@contextmanager
def without_threads() -> Iterator[None]:
    """Encode in the thread of the caller, for callers that write many images in parallel.

    In a small EXR file, it takes longer to pass a row to another thread than to compress the row.
    """
    import OpenImageIO as oiio

    before = {name: oiio.get_int_attribute(name) for name in NO_THREADS}
    try:
        for name, value in NO_THREADS.items():
            oiio.attribute(name, value)
        yield
    finally:
        for name, value in before.items():
            oiio.attribute(name, value)


def write_picture(path: AnyPath, image: ArrayLike, metadata: Mapping[str, object]) -> None:
    """Write a linear image as EXR or PNG, as the suffix of `path` says."""
    check_output(path, endings=PICTURES)
    write = write_exr if Path(path).suffix.lower() == ".exr" else write_png
    write(path, image, metadata)


def write_exr(path: AnyPath, image: ArrayLike, metadata: Mapping[str, object]) -> None:
    """Write a linear image as 32-bit float EXR with Rec. 709 primaries and metadata as text."""
    pixels = np.ascontiguousarray(image, dtype=np.float32)
    write_image(path, pixels, FAST_EXR | _texts(metadata))


def write_png(path: AnyPath, image: ArrayLike, metadata: Mapping[str, object]) -> None:
    """Write a linear image as an eight-bit sRGB PNG with metadata as text."""
    write_image(path, srgb_encoded(image), FAST_PNG | _texts(metadata))


def _texts(metadata: Mapping[str, object]) -> dict[str, str | int]:
    texts: dict[str, str | int] = {"Software": "mxeon"}
    return texts | {f"mxeon:{key}": printable(str(value)) for key, value in metadata.items()}
