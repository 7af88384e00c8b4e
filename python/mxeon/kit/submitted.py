# SPDX-License-Identifier: Apache-2.0
"""Read the pictures that a user submits."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from mxeon.errors import ImageError
from mxeon.io.images import open_image, words
from mxeon.kit.views import View
from mxeon.shaders.scene import sphere

CHANNELS = "RGB"
LEVELS = 255  # largest eight-bit value
ROUNDED = LEVELS * 2.0**-12  # largest rounding of a half float below 1, in eight-bit steps
FLOATS = ("half", "float", "double")
# Smooth shading has about as many distinct values as pixels; eight bits leave less than a quarter.
DISTINCT = 4


class Missing(ValueError):
    """The picture's file does not exist."""


class Unusable(ValueError):
    """The picture cannot be judged; the message has the rule and the violation."""


def read_render(folder: str | PathLike[str], view: View) -> NDArray[np.float64]:
    """Read the picture of a view: linear float64, 0 off the sphere. Raises Missing or Unusable."""
    files = sorted(Path(folder).glob(f"{view.name}.*"))
    if not files:
        raise Missing(f"{view.name}.exr: must be in {folder}; got no such file")
    if len(files) > 1:
        raise Unusable(f"{view.name}: must be one file; got {', '.join(f.name for f in files)}")
    try:
        image = _read_image(files[0], view.scene.size)
        mask = sphere(view.scene.size).mask
        bad = ~np.isfinite(image).all(axis=-1) & mask
        if bad.any():
            row, column = np.argwhere(bad)[0]
            raise Unusable(
                f"pixels on the sphere must be finite numbers; got {image[row, column].tolist()} "
                f"at row {row}, column {column}, {bad.sum()} in all"
            )
        _check_depth(image[mask])
    except Unusable as error:
        raise Unusable(f"{files[0].name}: {error}") from None
    return np.where(mask[..., None], image, 0.0)


def _read_image(file: Path, size: int) -> NDArray[np.float64]:
    try:
        image = open_image(file)
    except ImageError as error:
        raise Unusable(f"must be an EXR file; {str(error).partition('; ')[2]}") from None
    spec = image.spec()
    if (spec.width, spec.height) != (size, size):
        raise Unusable(f"must be {size} x {size} pixels; got {spec.width} x {spec.height}")
    if (offset := (spec.x - spec.full_x, spec.y - spec.full_y)) != (0, 0):
        raise Unusable(f"must begin at the display window's corner; got {offset}")
    if str(spec.format) not in FLOATS:
        raise Unusable(f"must hold half or float numbers; got {spec.format}")
    try:
        channels = _channels(spec.channelnames)
    except UnicodeDecodeError:
        raise Unusable("must have names of channels in UTF-8") from None
    # Read only these channels: even a small file may have thousands.
    read = [image.read_image(0, 0, each, each + 1, oiio.FLOAT) for each in channels]
    pixels = [each for each in read if each is not None]
    reason = words(image.geterror)
    image.close()
    if reason or len(pixels) < len(read):
        raise Unusable(f"must be a whole image; {reason}")
    return np.concatenate(pixels, axis=-1, dtype=np.float64)


def _channels(names: Sequence[str]) -> list[int]:
    """Indices of red, green and blue: without a layer, or of the only layer with all three."""
    layers: dict[str, dict[str, int]] = {}
    for index, name in enumerate(names):
        layer, _, channel = name.rpartition(".")
        layers.setdefault(layer, {})[channel.upper()] = index
    whole = {layer: rgb for layer, rgb in layers.items() if rgb.keys() >= set(CHANNELS)}
    chosen = whole.get("") or (len(whole) == 1 and next(iter(whole.values())))
    if not chosen:
        raise Unusable(f"must hold one R, G and B; got channels {', '.join(names)}")
    return [chosen[channel] for channel in CHANNELS]


def _check_depth(values: NDArray[np.float64]) -> None:
    """Refuse eight-bit values: few distinct values, all multiples of 1 / 255 up to 1."""
    distinct = len(np.unique(values))
    steps = values * LEVELS
    whole = values.max() <= 1.0 and np.abs(steps - np.rint(steps)).max() <= ROUNDED
    if 2 < distinct < len(values) / DISTINCT and whole:
        rule = "must hold numbers that were never rounded to eight bits"
        raise Unusable(f"{rule}; got multiples of 1/255")
