# SPDX-License-Identifier: Apache-2.0
"""Antialiased pictures for presentation, with a floor on which the shader ball casts a shadow.

A host's picture has one sample at the center of each pixel. Pixels that differ from a neighbor are
redrawn with 16 samples. The floor is Lambertian paper that bends up into a wall behind the ball.
A mesh, or the ball with its foot but without its grooves, blocks light that falls on the floor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.base import Array, Host
from mxeon.hosts.mesh import mesh_blocks
from mxeon.hosts.path_tracer import PathTracerHost
from mxeon.hosts.points import MARGIN, visible, visible_at
from mxeon.hosts.raster import FragmentHost
from mxeon.hosts.textures import RADIANCE_SIZE, latlong_directions, read_latlong, reduced
from mxeon.io.images import Floats
from mxeon.io.srgb import pbr_neutral
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene, VisiblePoints, pixel_centers
from mxeon.shaders.shader_ball import CENTER, FOOT_HEIGHT, FOOT_RADIUS, GROUND, OBJECT, RADIUS

Mask = NDArray[np.bool_]

SIDE = 4  # rows and columns of samples in a redrawn pixel
BLOCKS = 64, 256  # columns and rows of redrawn pixels in one frame
# Two neighboring pixels are redrawn if display values differ by more than the first number, or if
# the cosine of the angle between normals is less than the second number.
SMOOTH = 0.06, 0.98

DIRECTIONS = 64  # number of directions in the environment for each of the 16 samples
GRID = 96  # rows and columns of the grid of floor points between which radiance is interpolated
DRAWN = 512  # number of light directions for the floor
PAPER = 0.5  # reflectance of the floor
EDGE = FOOT_RADIUS + 0.01
BEND = -1.0, -4.5  # z in the foot's frame where the bend begins, and where the paper is vertical


def still(host: Host, shader: Shader, scene: Scene) -> Array:
    """Antialiased linear picture of a shape with a shader on a floor, (size, size, 3)."""
    image = host.picture(shader, scene)
    mask = visible(scene.size, scene.shape).mask
    covered = mask.astype(np.float32)
    if isinstance(host, FragmentHost):
        # Pictures of a path tracer are antialiased already, but the coverage of pixels is unknown.
        traced = isinstance(host, PathTracerHost)
        for rows, columns in jagged(np.zeros_like(image) if traced else image, mask, scene):
            draw = None if traced else partial(host.shade, shader, scene, directions=DIRECTIONS)
            drawn, covered[rows, columns] = samples(draw, scene, rows, columns)
            if not traced:
                image[rows, columns] = drawn
    if scene.shape != "sphere" and scene.environment is not None:
        image += (1.0 - covered[..., None]) * floor(scene)
    return image


def jagged(image: Array, mask: Mask, scene: Scene) -> Iterator[tuple[Array, Array]]:
    """Yield batches of pixels that differ from a neighbor, as (rows, columns)."""
    display, normal = pbr_neutral(image), visible(scene.size, scene.shape).normal
    differing = mask.copy()  # pixels at the frame's edge may be partly covered
    differing[1:-1, 1:-1] = False
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        first = slice(0, -down or None), slice(max(-right, 0), -max(right, 0) or None)
        second = slice(down, None), slice(max(right, 0), min(right, 0) or None)
        edge: Mask = np.abs(display[first] - display[second]).max(axis=-1) > SMOOTH[0]
        edge |= (normal[first] * normal[second]).sum(axis=-1) < SMOOTH[1]
        edge &= mask[first] | mask[second]
        differing[first] |= edge
        differing[second] |= edge
    rows, columns = np.nonzero(differing)
    for start in range(0, len(rows), batch := BLOCKS[0] * BLOCKS[1]):
        yield rows[start : start + batch], columns[start : start + batch]


def samples(
    draw: Callable[[VisiblePoints], Array] | None, scene: Scene, rows: Array, columns: Array
) -> tuple[Array, Array]:
    """Weighted means over the samples of pixels, and the fraction of samples on the shape.

    Samples off the shape are 0. A sample whose largest channel is m has the weight 1 / (1 + m),
    because equal weights would leave bright edges jagged on a display.
    """
    wide = BLOCKS[0]
    number = np.minimum(np.arange(-(-len(rows) // wide) * wide), len(rows) - 1).reshape(-1, wide)
    block = number.repeat(SIDE, axis=0).repeat(SIDE, axis=1)
    within = (np.indices(block.shape) % SIDE + 0.5) / SIDE
    y = 1.0 - 2.0 * (rows[block] + within[0]) / scene.size
    x = 2.0 * (columns[block] + within[1]) / scene.size - 1.0
    seen = visible_at(np.pad(x, MARGIN, "edge"), np.pad(y, MARGIN, "edge"), scene.shape)
    mask = seen.mask[MARGIN:-MARGIN, MARGIN:-MARGIN, None]
    drawn = np.where(mask, draw(seen) if draw else 0.0, np.float32(0.0))
    weight = mask / (1.0 + drawn.max(axis=-1, keepdims=True))
    with np.errstate(invalid="ignore"):  # a shader may return infinity
        sums = weight * drawn, weight, mask.astype(np.float32)
    color, total, share = (
        each.reshape(-1, SIDE, wide, SIDE, each.shape[-1])
        .mean(axis=(1, 3))
        .reshape(-1, each.shape[-1])
        for each in sums
    )
    color *= share / np.maximum(total, 1e-30)
    return color[: len(rows)], share[: len(rows), 0]


def floor(scene: Scene) -> Array:
    """Radiance of the floor in the pixels of a picture, (size, size, 3)."""
    x, y = (each.reshape(-1, 1) for each in pixel_centers(GRID))
    depth = (GROUND - OBJECT[1, 1] * y) / OBJECT[1, 2]
    points = np.hstack([x, y, depth]) @ OBJECT.T
    bend = np.clip((points[:, 2] - BEND[0]) / (BEND[1] - BEND[0]), 0.0, 1.0)
    bend = 0.5 * np.pi * bend**2 * (3.0 - 2.0 * bend)
    if is_ball := scene.shape == "ball":  # extend the floor's values under the foot
        around = np.hypot(points[:, 0], points[:, 2])[:, None]
        points[:, ::2] *= np.maximum(EDGE / np.maximum(around, 1e-9), 1.0)
    normal = np.stack([0.0 * bend, np.cos(bend), np.sin(bend)], axis=-1)
    towards, power = lights(scene)
    cosine = np.maximum(normal @ towards.T, 0.0)
    dark = blocked(points, towards) if is_ball else mesh_blocks(scene.shape, points, towards)
    radiance = PAPER / np.pi * (cosine * ~dark) @ power
    coarse = radiance.reshape(GRID, GRID, 3)
    centers, fine = (np.arange(GRID) + 0.5) / GRID, (np.arange(scene.size) + 0.5) / scene.size
    for axis in (0, 1):
        coarse = np.apply_along_axis(lambda row: np.interp(fine, centers, row), axis, coarse)
    return coarse.astype(np.float32)


def lights(scene: Scene) -> tuple[Floats, Floats]:
    """Directions that represent an environment, and each direction's radiance times solid angle.

    Directions are in the frame of the shader ball's foot. The shape of each array is (DRAWN, 3).
    """
    sky = reduced(read_latlong(scene.environment))
    if sky.shape[:2] == (1, 1):
        sky = np.broadcast_to(sky, (RADIANCE_SIZE, 2 * RADIANCE_SIZE, 3))
    directions, area = latlong_directions(*sky.shape[:2])
    power = sky.reshape(-1, 3) * (area * 2.0 * np.pi / area.sum() * 2.0)[:, None]
    share = np.cumsum(power.mean(axis=-1) + 1e-9)
    drawn = np.searchsorted(share, (np.arange(DRAWN) + 0.5) / DRAWN * share[-1])
    mean = power[drawn].mean(axis=-1, keepdims=True)
    return directions[drawn] @ OBJECT.T, power[drawn] / np.maximum(mean, 1e-30) * share[-1] / DRAWN


def blocked(points: Floats, towards: Floats) -> Mask:
    """Whether the ball or the foot blocks each direction from each point of the floor."""
    out = CENTER - points
    along = out @ towards.T
    ball = (along > 0.0) & ((out**2).sum(axis=-1)[:, None] - along**2 < RADIUS**2)
    # Below the top of the foot, a ray covers a horizontal segment. The segment begins at `start` and
    # extends by the vector `reach`.
    start = points[:, ::2]
    reach = towards[:, ::2] * 2.0 * FOOT_HEIGHT / np.maximum(towards[:, 1:2], 1e-6)
    squared, product = (reach**2).sum(axis=-1), start @ reach.T
    # Position on the segment, from 0 to 1, of the point nearest to the foot's axis.
    nearest = np.clip(-product / np.maximum(squared, 1e-12), 0.0, 1.0)
    distance = (start**2).sum(axis=-1)[:, None] + 2.0 * nearest * product + nearest**2 * squared
    foot = (distance < FOOT_RADIUS**2) & (towards[:, 1] > 0.0)
    blocks: Mask = ball | foot
    return blocks
