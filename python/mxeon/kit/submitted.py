# SPDX-License-Identifier: Apache-2.0
"""Reading of the pictures that a renderer submitted."""

import csv
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from mxeon.errors import ImageError
from mxeon.io.files import regular
from mxeon.io.images import open_image, words
from mxeon.kit.views import View
from mxeon.shaders.scene import sphere

COLUMNS = ["row", "column", "red", "green", "blue"]
CHANNELS = "RGB"
LEVELS = 255  # steps of an eight-bit value
ROUNDED = LEVELS * 2.0**-12  # rounding of a half float up to 1, in steps
FLOATS = ("half", "float", "double")
# A smooth shading has as many values as pixels; eight bits leave far fewer than one in four.
DISTINCT = 4


class Missing(ValueError):
    """No file holds the picture."""


class Unusable(ValueError):
    """A file that cannot be judged; names the file, the rule and the violation."""


def read_render(folder: str | PathLike[str], view: View) -> NDArray[np.float64]:
    """The picture of a view: linear float64, 0 off the sphere; else Missing or Unusable."""
    files = sorted(Path(folder).glob(f"{view.name}.*"))
    if not files:
        raise Missing(f"{view.name}.exr: must be in {folder}; got no such file")
    file, size = files[0], view.scene.size
    if len(files) > 1:
        raise Unusable(f"{view.name}: must be one file; got {', '.join(f.name for f in files)}")
    image = _read_csv(file, size) if file.suffix.lower() == ".csv" else _read_image(file, size)
    mask = sphere(size).mask
    bad = ~np.isfinite(image).all(axis=-1) & mask
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise Unusable(
            f"{file.name}: pixels on the sphere must be finite numbers; got "
            f"{image[row, column].tolist()} at row {row}, column {column}, {bad.sum()} in all"
        )
    _check_depth(file, image[mask])
    return np.where(mask[..., None], image, 0.0)


def _read_image(file: Path, size: int) -> NDArray[np.float64]:
    try:
        image = open_image(file)
    except ImageError as error:
        reason = str(error).partition("; ")[2]
        raise Unusable(f"{file.name}: must be an EXR or CSV file; {reason}") from None
    spec = image.spec()
    if (spec.width, spec.height) != (size, size):
        raise Unusable(
            f"{file.name}: must be {size} x {size} pixels; got {spec.width} x {spec.height}"
        )
    if (offset := (spec.x - spec.full_x, spec.y - spec.full_y)) != (0, 0):
        raise Unusable(f"{file.name}: must begin at the display window's corner; got {offset}")
    if str(spec.format) not in FLOATS:
        raise Unusable(f"{file.name}: must hold half or float numbers; got {spec.format}")
    try:
        channels = _channels(file, spec.channelnames)
    except UnicodeDecodeError:
        raise Unusable(f"{file.name}: must have names of channels in UTF-8") from None
    # Read only these: a small file may have a thousand channels.
    read = [image.read_image(0, 0, each, each + 1, oiio.FLOAT) for each in channels]
    pixels = [each for each in read if each is not None]
    reason = words(image.geterror)
    image.close()
    if reason or len(pixels) < len(read):
        raise Unusable(f"{file.name}: must be a whole image; {reason}")
    return np.concatenate(pixels, axis=-1, dtype=np.float64)


def _channels(file: Path, names: Sequence[str]) -> list[int]:
    """Indices of red, green and blue: unlayered, or in the only layer that has all three."""
    layers: dict[str, dict[str, int]] = {}
    for index, name in enumerate(names):
        layer, _, channel = name.rpartition(".")
        layers.setdefault(layer, {})[channel.upper()] = index
    whole = {layer: rgb for layer, rgb in layers.items() if rgb.keys() >= set(CHANNELS)}
    chosen = whole.get("") or (len(whole) == 1 and next(iter(whole.values())))
    if not chosen:
        raise Unusable(f"{file.name}: must hold one R, G and B; got channels {', '.join(names)}")
    return [chosen[channel] for channel in CHANNELS]


def _read_csv(file: Path, size: int) -> NDArray[np.float64]:
    try:
        with open(file, newline="", encoding="utf-8-sig", opener=regular) as stream:
            return _table(file, csv.reader(stream), size)
    except (OSError, UnicodeError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise Unusable(f"{file.name}: must be CSV in UTF-8; {reason}") from None


def _table(file: Path, lines: Any, size: int) -> NDArray[np.float64]:
    header: list[str] = next(lines, [])
    if header != COLUMNS:
        raise Unusable(f"{file.name}: must begin with {','.join(COLUMNS)}; got {','.join(header)}")
    image, present = np.full((size, size, 3), np.nan), np.zeros((size, size), dtype=bool)
    for line in filter(None, lines):
        try:
            row, column, *values = int(line[0]), int(line[1]), *map(float, line[2:])
            fits = min(row, column) >= 0 and len(values) == 3 and not present[row, column]
        except (ValueError, IndexError):
            fits = False
        if not fits:
            raise Unusable(
                f"{file.name}: line {lines.line_num} must hold row and column of a pixel, of "
                f"{size} x {size}, that no line before it has, and three numbers; "
                f"got {','.join(line)}"
            )
        image[row, column], present[row, column] = values, True
    return image


def _check_depth(file: Path, values: NDArray[np.float64]) -> None:
    """Refuse eight-bit values: few distinct ones, all of them multiples of 1 / 255 up to 1."""
    distinct = len(np.unique(values))
    steps = values * LEVELS
    whole = values.max() <= 1.0 and np.abs(steps - np.rint(steps)).max() <= ROUNDED
    if 2 < distinct < len(values) / DISTINCT and whole:
        raise Unusable(
            f"{file.name}: must hold numbers that were never rounded to eight bits; got multiples "
            "of 1/255"
        )
