# SPDX-License-Identifier: Apache-2.0
"""A convex polyhedron with known normals, for renderers that spread samples over a pixel.

If a pixel lies within a facet, all samples of the pixel have the same normal. The shape is convex,
so facets neither shadow nor light each other. Frame and camera are as in `mxeon.shaders.scene`.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

RINGS, SECTORS = 20, 40  # numbers of facets from pole to pole and around the axis
AXIS = (0.48, 0.6, 0.64)  # polar axis, tilted to vary the cosines of both view and light
MARGIN = 1.05  # relative size of the area around a pixel that must lie within one facet


class Polyhedron(NamedTuple):
    vertices: NDArray[np.float64]  # points of the unit sphere
    triangles: NDArray[np.int64]  # indices of vertices, counterclockwise seen from outside
    normals: NDArray[np.float64]  # outward unit normals of the facets, in float64
    offsets: NDArray[np.float64]  # distances of the facets' planes from the origin


class Points(NamedTuple):
    normal: NDArray[np.float64]
    mask: NDArray[np.bool_]  # whether a pixel lies within one facet


@lru_cache(maxsize=1)
def polyhedron() -> Polyhedron:
    """The polyhedron, whose vertices lie on a grid of polar angles around AXIS.

    Vertices are rounded to float32. The facets are triangles at the poles, and flat trapezoids.
    """
    polar, azimuth = np.linspace(0.0, np.pi, RINGS + 1), np.arange(SECTORS) * 2.0 * np.pi / SECTORS
    theta, phi = np.meshgrid(polar[1:-1], azimuth, indexing="ij")
    ring = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    local = np.concatenate([[[0.0, 0.0, 1.0]], ring.reshape(-1, 3), [[0.0, 0.0, -1.0]]])
    # Two axes perpendicular to AXIS complete a frame.
    axis = np.asarray(AXIS) / np.linalg.norm(AXIS)
    across = np.cross([0.0, 0.0, 1.0], axis)
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(axis, across), axis])
    vertices = (local @ frame).astype(np.float32).astype(np.float64)
    # Corners of the facets. At the poles, a ring is a single vertex.
    row, column = np.meshgrid(np.arange(RINGS + 1), np.arange(SECTORS), indexing="ij")
    index = np.clip(1 + (row - 1) * SECTORS + column, 0, 1 + (RINGS - 1) * SECTORS)
    after = np.roll(index, -1, axis=1)
    quads = np.stack([index[:-1], index[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    corners = vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = triangles[np.linalg.norm(areas, axis=1) > 0.0]
    one, two, three, four = (vertices[quads[:, index]] for index in range(4))
    normals = np.cross(three - one, four - two)  # also correct for triangles
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    offsets = (normals * (one + two + three + four)).sum(axis=1) / 4.0
    return Polyhedron(vertices, triangles, normals, offsets)


@lru_cache(maxsize=4)
def facet_points(size: int) -> Points:
    """Normals at the pixels of a picture, `size` pixels wide and high."""
    axis = (2.0 * np.arange(size) + 1.0) / size - 1.0
    x, y = np.meshgrid(axis, -axis)
    reach = MARGIN / size
    facets = [_facets(x + dx * reach, y + dy * reach) for dx in (-1.0, 1.0) for dy in (-1.0, 1.0)]
    mask = facets[0] >= 0
    for other in facets[1:]:
        mask &= other == facets[0]
    normal = polyhedron().normals[facets[0]]
    for array in (normal, mask):
        array.flags.writeable = False  # all callers share the cached arrays
    return Points(normal, mask)


def _facets(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int64]:
    """Index of the facet that each ray along -z hits first; -1 if the ray hits no facet."""
    _, _, normals, offsets = polyhedron()
    first, top = np.full(x.shape, -1), np.full(x.shape, np.inf)
    bottom = np.full(x.shape, -np.inf)
    for index, (nx, ny, nz) in enumerate(normals):
        if nz:  # the plane of the facet is not parallel to the rays
            height = (offsets[index] - nx * x - ny * y) / nz
            if nz > 0.0:
                first = np.where(height < top, index, first)
                top = np.minimum(top, height)
            else:
                bottom = np.maximum(bottom, height)
    return np.where(top > bottom, first, -1)
