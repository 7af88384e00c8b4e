# SPDX-License-Identifier: Apache-2.0
"""The sphere as a mesh in which every pixel is an exact point: a quad for each, with one normal.

It is for renderers that take a mesh and show the document themselves. A quad lies in the tangent plane
of its point and covers the pixel, so that the derivatives of positions are those of the sphere, and those
of texture coordinates have their directions. They are smaller, so that textures are read at their full
size, as from a point.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mxeon.shaders.scene import sphere

SPREAD = 1.0 / 64.0  # of the texture coordinates within a quad
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
STEEPEST = (
    0.05  # cosine with the view of a tangent plane: nearer to the rim it would leave the frame
)


def quads(size: int, place: tuple[float, float] = (0.0, 0.0)) -> dict[str, NDArray[np.float32]]:
    """The quads of a picture of `size` x `size` pixels, four vertices each, counterclockwise.

    A point lies at `place` in its pixel, in half widths from the middle. "position", "normal" and
    "texcoord", by the pixels of the sphere, row 0 at the top first.
    """
    points = sphere(size)
    normal = points.normal[points.mask][:, np.newaxis]
    # Corners of the pixel, raised into the tangent plane.
    offset = np.broadcast_to((CORNERS - place) / size, (len(normal), 4, 2))
    rise = -(normal[..., :2] * offset).sum(axis=-1) / np.maximum(normal[..., 2], STEEPEST)
    position = normal + np.concatenate([offset, rise[..., np.newaxis]], axis=-1)
    # Longitude and latitude of the point, and their changes towards the corners.
    x, y, z = np.moveaxis(normal, -1, 0)
    dx, dy, dz = SPREAD * np.moveaxis(position - normal, -1, 0)
    squared = x * x + z * z
    u = 0.5 + (np.arctan2(x, z) + (z * dx - x * dz) / squared) / (2.0 * np.pi)
    v = 0.5 + (np.arctan2(y, np.sqrt(squared)) + dy / np.sqrt(squared)) / np.pi
    columns = {
        "position": position,
        "normal": np.broadcast_to(normal, position.shape),
        "texcoord": np.stack([u, v], axis=-1),
    }
    return {
        name: values.reshape(-1, values.shape[-1]).astype(np.float32)
        for name, values in columns.items()
    }


def quad_file(folder: Path, size: int, place: tuple[float, float] = (0.0, 0.0)) -> Path:
    """File of the quads of a picture, written by the first request; parameters as those of `quads`."""
    path = folder / f"quads{size}{place}.npz"
    if not path.exists():
        np.savez(path, **quads(size, place))  # type: ignore[arg-type]  # NumPy takes it for an option
    return path
