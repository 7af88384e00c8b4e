# SPDX-License-Identifier: Apache-2.0
"""Pictures as files: linear EXR, sRGB PNG, and the difference of two pictures."""

from pathlib import Path

import numpy as np

from mxeon.errors import InputError
from mxeon.io.files import write_image

# What a pixel that is not a finite number looks like, in code values.
NOT_FINITE = (255, 0, 255)


def srgb_encoded(image):
    """Eight-bit sRGB code values of a linear picture.

    Parameters
    ----------
    image : array_like, shape (..., 3)
        Linear, with the Rec. 709 primaries.

    Returns
    -------
    ndarray of uint8, shape (..., 3)
        Clipped to [0, 1] before encoding; magenta where a channel is not finite.

    References
    ----------
    IEC 61966-2-1, the encoding of sRGB.

    Examples
    --------
    >>> srgb_encoded([0.0, 0.18, 1.0]).tolist()
    [0, 118, 255]
    """
    # Single precision, 2^16 steps for each of the codes, takes a third of the time.
    image = np.asarray(image, dtype=np.float32)
    finite = np.isfinite(image).all(axis=-1, keepdims=True)
    linear = np.clip(np.where(finite, image, 0.0), 0.0, 1.0)
    curve = 1.055 * linear ** np.float32(1.0 / 2.4) - 0.055
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, curve)
    codes = np.rint(255.0 * encoded).astype(np.uint8)
    return np.where(finite, codes, np.array(NOT_FINITE, dtype=np.uint8))


def difference(image, reference):
    """Largest absolute difference over the channels of each pixel.

    Parameters
    ----------
    image, reference : array_like, shape (..., 3)

    Returns
    -------
    ndarray, shape (...), float64
        In the unit of the pictures; not finite where one of them is not.

    Examples
    --------
    >>> difference([[1.0, 0.5, 0.0]], [[1.0, 0.25, 0.125]]).tolist()
    [0.25]
    """
    image, reference = np.asarray(image, np.float64), np.asarray(reference, np.float64)
    with np.errstate(invalid="ignore"):  # inf - inf
        return np.abs(image - reference).max(axis=-1)


def difference_scale(difference_map):
    """Full scale for showing a difference: the next of 1, 2, 5, 10, ... above nearly all of it.

    Parameters
    ----------
    difference_map : array_like
        Non-negative; zeros and what is not finite are left out.

    Returns
    -------
    float
        At least the 99th percentile, so that a few pixels at a rim or a terminator do not
        darken the rest; at least 1e-9, so that equal pictures have a scale too.

    Examples
    --------
    >>> difference_scale([0.0, 0.003, 0.0031, float("nan")])
    0.005
    """
    difference_map = np.asarray(difference_map)
    shown = difference_map[np.isfinite(difference_map) & (difference_map > 0.0)]
    nearly_all = max(np.quantile(shown, 0.99) if shown.size else 0.0, 1e-9)
    decade = int(np.floor(np.log10(nearly_all)))
    # Read as decimals, so that the bounds are the printed numbers and not products of them.
    steps = [float(f"{digit}e{decade}") for digit in (1, 2, 5, 10)]
    return next((step for step in steps if nearly_all <= step), steps[-1])


def write_picture(path, image, metadata):
    """Writes a linear picture as what the ending of `path` says; see `write_exr`, `write_png`.

    Raises
    ------
    ValueError
        If the ending is neither .exr nor .png.
    OSError
        If the file cannot be written.
    """
    writers = {".exr": write_exr, ".png": write_png}
    ending = Path(path).suffix.lower()
    if ending not in writers:
        raise InputError(f"output must end in {' or '.join(writers)}; got {str(path)!r}")
    writers[ending](path, image, metadata)


def write_exr(path, image, metadata):
    """Writes a linear picture as a 32-bit float EXR with the Rec. 709 primaries.

    Parameters
    ----------
    path : path-like
        Ends in .exr; replaced whole.
    image : array_like, shape (height, width, 3)
    metadata : mapping of str to str
        Kept in the file under "mxeon:" and the key.

    Raises
    ------
    OSError
        If the file cannot be written; says why.
    """
    pixels = np.ascontiguousarray(image, dtype=np.float32)
    write_image(path, pixels, _attributes("lin_rec709_scene", metadata))


def write_png(path, image, metadata):
    """Writes a linear picture as an eight-bit sRGB PNG; parameters as in `write_exr`."""
    write_image(path, srgb_encoded(image), _attributes("srgb_rec709_scene", metadata))


def _attributes(space, metadata):
    named = {f"mxeon:{key}": str(value) for key, value in metadata.items()}
    return {"oiio:ColorSpace": space, "Software": "mxeon"} | named
