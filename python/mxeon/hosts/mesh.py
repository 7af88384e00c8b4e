# SPDX-License-Identifier: Apache-2.0
"""Exact visible points of a mesh from an .obj or .glb file. The `render` extra is required.

Embree traces the rays of the picture. The y axis of a file points up. The mesh stands in the place
of the shader ball and is scaled to the ball's size.
"""

import os
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import InputError, NotRun, install
from mxeon.io.images import Floats
from mxeon.shaders.scene import VisiblePoints
from mxeon.shaders.shader_ball import GROUND, NEAR, OBJECT

SIZE = 1.9  # diagonal of the box around a mesh, in a frame of width 2
OFFSET = 1e-4  # distance of a ray's origin from the surface that the ray leaves


@lru_cache(maxsize=2)
def mesh(file: str) -> Any:
    """The triangles of a file in the picture's frame, as a `trimesh.Trimesh`.

    Raises InputError for a file without triangles, and NotRun if the packages are not installed.
    """
    if not os.path.isfile(file):
        raise InputError(f"geometry must be a readable file; got {file!r}")
    try:
        import embreex  # noqa: F401, trimesh's own rays are too slow
        import trimesh
    except ImportError as error:
        raise NotRun(f"{file}: {error}; {install('render')}") from None
    try:
        loaded = trimesh.load_mesh(file, process=False)
    except Exception as error:  # trimesh passes on any exception of a reader
        raise InputError(f"{file}: must be a mesh; {type(error).__name__}: {error}") from None
    if not len(loaded.faces) or not np.isfinite(loaded.vertices).all():
        raise InputError(f"{file}: must have triangles at finite points")
    normals = np.array(loaded.vertex_normals)
    low, high = loaded.bounds
    scale = SIZE / max(float(np.linalg.norm(high - low)), 1e-30)
    base = np.array([(low + high)[0] / 2.0, low[1], (low + high)[2] / 2.0])
    upright = (loaded.vertices - base) * scale + [0.0, GROUND, 0.0]
    return trimesh.Trimesh(
        upright @ OBJECT,
        loaded.faces,
        vertex_normals=normals @ OBJECT,
        visual=loaded.visual,
        process=False,
    )


def mesh_points_at(file: str, x: Floats, y: Floats) -> VisiblePoints:
    """Points of a mesh at positions in the frame. Normals are interpolated and face the viewer."""
    shape = mesh(file)  # raises NotRun without trimesh
    from trimesh.triangles import points_to_barycentric

    position = np.stack([x, y, np.full_like(x, -NEAR)], axis=-1)
    starts = np.stack([x, y, np.full_like(x, NEAR)], axis=-1).reshape(-1, 3)
    down = np.broadcast_to([0.0, 0.0, -1.0], starts.shape)
    triangle, ray, hit = shape.ray.intersects_id(
        starts, down, multiple_hits=False, return_locations=True
    )
    corners = shape.faces[triangle]
    places = shape.vertices[corners]
    sides = places[:, 1:] - places[:, :1]
    share = points_to_barycentric(places, hit)

    def between(values: Any) -> NDArray[np.float64]:
        return np.asarray(np.einsum("nk,nka->na", share, np.asarray(values)[corners]))

    normal, texcoord = np.zeros_like(position), np.zeros(x.shape + (2,))
    tangent = np.zeros_like(position)
    normal[..., 2], tangent[..., 0] = 1.0, 1.0
    unit = between(shape.vertex_normals)
    unit *= np.where(unit[:, 2:] < 0.0, -1.0, 1.0)
    found = np.zeros(x.size, dtype=bool)
    found[ray] = True
    position.reshape(-1, 3)[ray] = hit
    normal.reshape(-1, 3)[ray] = _unit(unit)
    uv = getattr(shape.visual, "uv", None)
    if uv is None:  # use longitude and latitude about the center of the box
        out = (hit - shape.bounds.mean(axis=0)) @ OBJECT.T
        u = 0.5 + np.arctan2(out[:, 0], out[:, 2]) / (2.0 * np.pi)
        v = 0.5 + np.arctan2(out[:, 1], np.hypot(out[:, 0], out[:, 2])) / np.pi
        texcoord.reshape(-1, 2)[ray] = np.stack([u, v], axis=-1)
        east = np.stack([out[:, 2], np.zeros(len(out)), -out[:, 0]], axis=-1) @ OBJECT
    else:
        texcoord.reshape(-1, 2)[ray] = between(uv)
        (du0, dv0), (du1, dv1) = np.moveaxis(uv[corners][:, 1:] - uv[corners][:, :1], 0, -1)
        mirrored = np.where(du0 * dv1 < du1 * dv0, -1.0, 1.0)
        east = (dv1 * sides[:, 0].T - dv0 * sides[:, 1].T).T * mirrored[:, None]
    tangent.reshape(-1, 3)[ray] = _unit(east)
    return VisiblePoints(found.reshape(x.shape), position, normal, texcoord, tangent)


def _unit(vectors: Floats) -> Floats:
    length: Floats = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.maximum(length, 1e-30)


def mesh_blocks(file: str, points: Floats, towards: Floats) -> NDArray[np.bool_]:
    """Whether a mesh blocks each direction from each point, (points, directions).

    Points and directions are in the frame of the shader ball's foot.
    """
    starts = np.repeat((points + OFFSET * np.array([0.0, 1.0, 0.0])) @ OBJECT, len(towards), axis=0)
    blocked = mesh(file).ray.intersects_any(starts, np.tile(towards @ OBJECT, (len(points), 1)))
    return np.asarray(blocked).reshape(len(points), len(towards))
