# SPDX-License-Identifier: Apache-2.0
"""The pictures that a renderer put into the kit, read back, and what makes a file useless."""

import csv
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from mxeon.scene import sphere

COLUMNS = ["row", "column", "red", "green", "blue"]
LEVELS = 255  # steps of an eight-bit value
FLOATS = ("half", "float", "double")
# A smooth shading has as many values as pixels; eight bits leave far fewer than one in four.
DISTINCT = 4


class Missing(ValueError):
    """A picture that is not there."""


class Unusable(ValueError):
    """A picture that cannot be judged; names the file, the rule and what was found."""


def read_render(folder, shot):
    """The picture of a shot.

    Parameters
    ----------
    folder : path-like
        Where the renderer's files lie.
    shot : mxeon.kit.shots.Shot

    Returns
    -------
    ndarray, shape (size, size, 3), float64
        Linear; 0 off the sphere.

    Raises
    ------
    Missing
        If there is no file of that name.
    Unusable
        If the file is none of EXR and CSV, has another size, fewer than three channels, eight bits
        (also in a float file), or a pixel on the sphere that is missing or not finite.
    """
    found = sorted(Path(folder).glob(f"{shot.name}.*"))
    if not found:
        raise Missing(f"{shot.name}.exr: must be in {folder}; got no such file")
    file, size = found[0], shot.scene.size
    if len(found) > 1:
        raise Unusable(f"{shot.name}: must be one file; got {', '.join(f.name for f in found)}")
    image = _read_csv(file, size) if file.suffix == ".csv" else _read_image(file, size)
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


def _read_image(file, size):
    image = oiio.ImageInput.open(str(file))
    if image is None:
        raise Unusable(f"{file.name}: must be an EXR or CSV file; {oiio.geterror()}")
    spec, pixels = image.spec(), image.read_image(oiio.FLOAT)
    image.close()
    if (spec.width, spec.height) != (size, size):
        raise Unusable(
            f"{file.name}: must be {size} x {size} pixels; got {spec.width} x {spec.height}"
        )
    if str(spec.format) not in FLOATS:
        raise Unusable(f"{file.name}: must hold half or float numbers; got {spec.format}")
    if pixels is None or spec.nchannels < 3:
        raise Unusable(f"{file.name}: must hold red, green and blue; got {spec.nchannels} channels")
    return pixels[..., :3].astype(np.float64)


def _read_csv(file, size):
    with file.open(newline="", encoding="utf-8") as stream:
        header, *rows = csv.reader(stream)
    if header != COLUMNS:
        raise Unusable(f"{file.name}: must begin with {','.join(COLUMNS)}; got {','.join(header)}")
    image = np.full((size, size, 3), np.nan)
    for number, row in enumerate(rows, start=2):
        try:
            y, x, *values = int(row[0]), int(row[1]), *map(float, row[2:])
            image[range(size)[y], range(size)[x]] = values
        except (ValueError, IndexError):
            raise Unusable(
                f"{file.name}: line {number} must hold the row and column of a picture of {size} x "
                f"{size} pixels, and three numbers; got {','.join(row)}"
            ) from None
    return image


def _check_depth(file, values):
    """Refuse eight-bit values: few distinct ones, and all of them multiples of 1 / 255."""
    distinct = len(np.unique(values))
    steps = values * LEVELS
    whole = np.abs(steps - np.rint(steps)).max() < 0.02 * (1.0 + np.abs(values).max())
    if 2 < distinct < len(values) / DISTINCT and whole:
        raise Unusable(
            f"{file.name}: must hold numbers that were never rounded to eight bits; got multiples "
            "of 1/255"
        )
