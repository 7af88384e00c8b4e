# SPDX-License-Identifier: Apache-2.0
"""Expected values of a picture, and the largest deviations that a correct renderer may have."""

from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import numpy as np
from numpy.typing import NDArray

from mxeon.kit.views import Material, View
from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.table import Model
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

# Least cosine of view and light at judged pixels. Pixels near the rim and the terminator are not
# judged, because values there depend on the position within a pixel. In pictures of 64 pixels or
# more, all judged pixels are entirely on the sphere.
CUT = 0.2
# Relative rounding of half floats, which have 11 bits, and the smallest step between half floats.
HALF_ROUNDING, HALF_STEP = 2.0**-11, 2.0**-24

# Albedos are integrated at COSINES, which are 1/128 apart, and interpolated linearly. The second
# derivative of the albedo is below 2, so the error is below 2e-5.
COSINES = np.linspace(CUT / 2.0, 1.0, 117)
INTERPOLATION = 2e-5
QUADRATURE_NODES = 16  # albedos of the models have an error of 1e-9

# Nodes of the two-point Gauss rule, which is exact for cubics, in units of half a pixel.
GAUSS = 1.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class Expected:
    value: np.ndarray  # (N, 3), mean value over each pixel
    slack: np.ndarray  # (N, 3), deviation due to pixel centers, mesh depth and half floats


@lru_cache(maxsize=16)
def judged(scene: Scene) -> NDArray[np.bool_]:
    """Mask of the pixels at which the cosines of view and light are at least CUT."""
    points = sphere(scene.size)
    lit = points.normal[..., 2] >= CUT
    if scene.light is not None:
        lit &= points.normal @ np.array(scene.light) >= CUT
    return np.asarray(lit & points.mask)


def expected(row: Model, view: View, depth: float) -> Expected:
    """Expected values of a view if the surface is at most `depth` below the unit sphere."""
    place = _centers(view)
    value = pixel_means(row, view)
    center = _values(row, view, place)
    # The normal at a point of the mesh is the sphere's normal at a point farther from the axis.
    mesh = _values(row, view, place / (1.0 - depth))
    slack = np.abs(value - center) + np.abs(mesh - center) + HALF_ROUNDING * value + HALF_STEP
    return Expected(value, slack + (INTERPOLATION if view.scene.light is None else 0.0))


def pixel_means(row: Model, view: View) -> NDArray[np.float64]:
    step = GAUSS / view.scene.size
    offsets = [(x, y) for x in (-step, step) for y in (-step, step)]
    values = [_values(row, view, _centers(view) + offset) for offset in offsets]
    return np.asarray(np.mean(values, axis=0))


def _centers(view: View) -> NDArray[np.float64]:
    """Centers of the judged pixels in the plane of the picture, (N, 2)."""
    return sphere(view.scene.size).normal[judged(view.scene)][:, :2]


def _values(row: Model, view: View, place: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y = place.T
    normal = np.stack([x, y, np.sqrt(1.0 - x * x - y * y)], axis=-1)
    if view.scene.light is None:
        table = _albedo_table(row, view.material)
        albedo = [np.interp(normal[:, 2], COSINES, channel) for channel in table.T]
        return cast(float, view.scene.environment) * np.stack(albedo, axis=-1)
    wo = local_directions(normal, VIEW)
    wi = local_directions(normal, view.scene.light)
    parameter = [view.material.roughness] if row.parameter else []
    return np.pi * row.brdf(wo, wi, view.material.color, *parameter) * wi[:, 2:]


@lru_cache(maxsize=64)
def _albedo_table(row: Model, material: Material) -> NDArray[np.float64]:
    """Directional albedo at COSINES, (N, 3), in closed form if known, otherwise by quadrature."""
    parameter = [material.roughness] if row.parameter else []
    if row.albedo_dir:
        return row.albedo_dir(COSINES, material.color, *parameter)
    return albedo_dir_quadrature(
        row.brdf, COSINES, material.color, *parameter, nodes=QUADRATURE_NODES
    )
