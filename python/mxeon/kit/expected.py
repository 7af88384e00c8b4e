# SPDX-License-Identifier: Apache-2.0
"""What a model says a picture of the kit shows, and how far a right renderer may be from it."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mxeon.models.quadrature import albedo_dir_quadrature
from mxeon.shaders.scene import VIEW, local_directions, sphere

# Smallest cosine of either direction that is judged: nearer to rim and terminator a pixel's place
# is uncertain. With 64 pixels or more, all of a pixel above it lies on the sphere.
CUT = 0.2

# Cosines at which an albedo is integrated. Between them, 1/128 apart, it is read linearly: its
# second derivative is below 2 there, the error below 2e-5.
COSINES = np.linspace(CUT / 2.0, 1.0, 117)
INTERPOLATION = 2e-5
QUADRATURE_NODES = 16  # reaches 1e-9 on the models

# The nodes of Gauss's rule of two points, in halves of a pixel: exact for cubics.
GAUSS = 1.0 / np.sqrt(3.0)

# A half has 11 bits: relative rounding 2^-11 at most; its smallest step is 2^-24.
HALF_ROUNDING = 2.0**-11
HALF_STEP = 2.0**-24


@dataclass(frozen=True)
class Expected:
    """A picture's judged pixels.

    Attributes
    ----------
    value : ndarray, shape (N, 3)
        Mean over each pixel.
    slack : ndarray, shape (N, 3)
        Sum of what the value may change through the pixel's centre in place of its mean, through
        the depth of the mesh, and through rounding to half.
    """

    value: np.ndarray
    slack: np.ndarray


@lru_cache(maxsize=16)
def judged(scene):
    """Where both cosines are at least CUT, a mask of the picture."""
    points = sphere(scene.size)
    lit = points.normal[..., 2] >= CUT
    if scene.light is not None:
        lit &= points.normal @ np.array(scene.light) >= CUT
    return lit & points.mask


def expected(row, shot, depth):
    """What the model of a row of `mxeon.models.table` gives for a shot.

    Parameters
    ----------
    row : mxeon.models.table.Model
    shot : mxeon.kit.shots.Shot
    depth : float
        How far the surface may lie below the unit sphere.

    Returns
    -------
    Expected
    """
    place = sphere(shot.scene.size).normal[judged(shot.scene)][:, :2]
    value = pixel_means(row, shot)
    centre = _values(row, shot, place)
    # A point of a triangle has the normal of its direction: that of a point further out.
    mesh = _values(row, shot, place / (1.0 - depth))
    slack = np.abs(value - centre) + np.abs(mesh - centre) + HALF_ROUNDING * value + HALF_STEP
    return Expected(value, slack + (INTERPOLATION if shot.scene.light is None else 0.0))


def pixel_means(row, shot):
    """Means over the judged pixels, (N, 3)."""
    place = sphere(shot.scene.size).normal[judged(shot.scene)][:, :2]
    step = GAUSS / shot.scene.size
    offsets = [(x, y) for x in (-step, step) for y in (-step, step)]
    return np.mean([_values(row, shot, place + offset) for offset in offsets], axis=0)


def _values(row, shot, place):
    """Values at points of the picture, (N, 3)."""
    x, y = place.T
    normal = np.stack([x, y, np.sqrt(1.0 - x * x - y * y)], axis=-1)
    if shot.scene.light is None:
        return shot.scene.environment * _albedo(row, shot.material, normal[:, 2])
    wo = local_directions(normal, VIEW)
    wi = local_directions(normal, shot.scene.light)
    return np.pi * row.brdf(wo, wi, shot.material.color, *_parameter(row, shot)) * wi[:, 2:]


def _parameter(row, shot):
    return [shot.material.roughness] if row.parameter else []


def _albedo(row, material, mu):
    table = _albedo_table(row, material)
    return np.stack([np.interp(mu, COSINES, channel) for channel in table.T], axis=-1)


@lru_cache(maxsize=64)
def _albedo_table(row, material):
    """Directional albedo at COSINES, (N, 3): in closed form, else by quadrature."""
    parameter = [material.roughness] if row.parameter else []
    if row.albedo_dir:
        return row.albedo_dir(COSINES, material.color, *parameter)
    return albedo_dir_quadrature(
        row.brdf, COSINES, material.color, *parameter, nodes=QUADRATURE_NODES
    )
