# SPDX-License-Identifier: Apache-2.0
"""Values for each point of a run: images with a pixel for each, and OSL statements that read them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.io.images import write_image

LEAST_SIZE = 4  # Blender renders no smaller picture.
TYPES = {
    "color3": "color",
    "vector3": "vector",
    "boolean": "int",
    "integer": "int",
}  # by MaterialX's
WIDTHS = {"color": 3, "vector": 3, "normal": 3, "vector2": 2}
# The row of a point, from its place in the picture.
ROW = """#define MXEON_AT(x, y) ((int) floor({size} * (y)) * {size} + (int) floor({size} * (x)))
#define MXEON_ROW MXEON_AT({place})
"""
READ = 'texture("{image}", {place}, 0.0, 0.0, 0.0, 0.0, "interp", "closest")'


@dataclass(frozen=True)
class Column:
    """Values of one variable.

    Attributes
    ----------
    kind : str
        OSL's type.
    values : array_like
        One for each point, or one for all.
    """

    kind: str
    values: ArrayLike

    @property
    def rows(self) -> NDArray[np.float32]:
        """The values, (N or 1, components)."""
        return np.asarray(self.values, np.float32).reshape(-1, WIDTHS.get(self.kind, 1))

    @property
    def directed(self) -> bool:
        """Whether the values are directions, which turn with the frame of the surface."""
        return self.kind in ("normal", "vector")


def side(count: int) -> int:
    """Pixels on a side of the square picture that has so many points."""
    return max(LEAST_SIZE, math.isqrt(count - 1) + 1)


def row(count: int, place: str) -> str:
    """OSL that defines MXEON_ROW, the row of a point of so many, by its place in an image."""
    return ROW.format(size=side(count), place=place)


def statements(
    columns: Mapping[str, Column], folder: Path, count: int, place: str
) -> Iterator[str]:
    """OSL declarations of variables that have a value for each point; their images are written.

    Each float of a variable is exact: an image of float32, read without a filter.

    Parameters
    ----------
    columns : mapping of str to Column
        Variables by name.
    folder : Path
        Of the images.
    count : int
        Points.
    place : str
        OSL expressions of the two coordinates at which a point reads its pixel.
    """

    def read(name: str, rows: NDArray[np.float32]) -> str:
        return READ.format(image=_image(folder, name, rows).as_posix(), place=place)

    for name, column in columns.items():
        # One row for each point: write them, and read them where the shader runs.
        rows = np.broadcast_to(column.rows, (count, column.rows.shape[1]))
        # A vector2 and an int are made of floats, as textures have neither.
        if column.kind == "vector2":
            for axis, part in zip("xy", rows.T, strict=True):
                yield f"float {name}_{axis} = {read(f'{name}_{axis}', part)};"
            yield f"vector2 {name} = vector2({name}_x, {name}_y);"
        elif column.kind == "int":
            yield f"float {name}_float = {read(name, rows)};"
            yield f"int {name} = (int) {name}_float;"
        # A normal is read as a vector.
        else:
            kind = "vector" if column.kind == "normal" else column.kind
            yield f"{kind} {name} = {read(name, rows)};"


def _image(folder: Path, name: str, rows: NDArray[np.float32]) -> Path:
    """Image of the rows of a variable, one pixel for each."""
    size, image = side(len(rows)), folder / f"{name}.exr"
    channels = rows.size // len(rows)
    pixels = np.zeros((size * size, channels), np.float32)
    pixels[: len(rows)] = rows.reshape(-1, channels)
    write_image(image, pixels.reshape(size, size, channels), {})
    return image
