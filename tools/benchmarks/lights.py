# SPDX-License-Identifier: Apache-2.0
"""Lights on a ball, seen from +z with y upwards, and the points of the ball that are seen.

A light is a set of directions with solid angles and radiances, which serve as its quadrature, and a
density by which a renderer would sample it. The sun's radiance has the irradiance of a clear day, five
times that of the sky.
"""

from dataclasses import dataclass

import numpy as np

from mxeon.shaders.scene import local_directions

STEPS = 64
SUN = np.cos(np.radians(0.2666))  # cosine of the angle of its rim
LAMP = np.cos(np.radians(10.0))
BAND = np.sin(np.radians(10.0))
PANE = np.tan(np.radians(15.0))  # half of the window's side at distance 1
TOWARDS_SUN = np.array([0.5, np.sqrt(0.5), 0.5])
TOWARDS_WINDOW = np.array([-0.8, 0.0, 0.6])
FRONT = np.array([0.0, 0.0, 1.0])
UP = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Light:
    """Radiance from directions, (N, 3), each with its solid angle; `pdf` samples it, 1/sr."""

    title: str
    wi: np.ndarray
    solid_angle: np.ndarray
    radiance: np.ndarray
    pdf: np.ndarray


def frame(axis):
    """Three axes in columns, the last one `axis`."""
    helper = UP if abs(axis[1]) < 0.9 else FRONT
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), axis], axis=1)


def zone(axis, low, high, steps=STEPS):
    """Directions whose cosine with an axis lies between two, and their equal solid angles."""
    cosine = low + (high - low) * (np.arange(steps) + 0.5) / steps
    azimuth = 2.0 * np.pi * (np.arange(2 * steps) + 0.5) / (2 * steps)
    cosine, azimuth = (grid.ravel() for grid in np.meshgrid(cosine, azimuth, indexing="ij"))
    sine = np.sqrt(1.0 - cosine**2)
    local = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=-1)
    return local @ frame(axis).T, np.full(len(local), 2.0 * np.pi * (high - low) / len(local))


def _even(title, axis, low, high):
    """A zone of radiance 1, sampled evenly."""
    wi, solid_angle = zone(axis, low, high)
    one = np.ones(len(wi))
    return Light(title, wi, solid_angle, one, one / (2.0 * np.pi * (high - low)))


def _overcast():
    """The overcast sky of the CIE, (1 + 2 y) / 3, sampled in proportion to it."""
    wi, solid_angle = zone(UP, 0.0, 1.0)
    rising = 1.0 + 2.0 * wi[:, 1]
    return Light("overcast sky", wi, solid_angle, rising / 3.0, rising / (4.0 * np.pi))


def _clear():
    """An even sky and the sun, each sampled by half of the samples."""
    sky, sky_angle = zone(UP, 0.0, 1.0)
    sun, sun_angle = zone(TOWARDS_SUN, SUN, 1.0, steps=4)
    radiance = 5.0 * np.pi / sun_angle.sum()
    density = 0.5 / (2.0 * np.pi), 0.5 / (2.0 * np.pi) + 0.5 / sun_angle.sum()
    return Light(
        "clear sky with sun",
        np.concatenate([sky, sun]),
        np.concatenate([sky_angle, sun_angle]),
        np.repeat([1.0, 1.0 + radiance], [len(sky), len(sun)]),
        np.repeat(density, [len(sky), len(sun)]),
    )


def _window():
    """A square of 30 degrees on the left, sampled evenly over its area."""
    side = PANE * (2.0 * (np.arange(STEPS) + 0.5) / STEPS - 1.0)
    x, y = (grid.ravel() for grid in np.meshgrid(side, side))
    distance = np.sqrt(1.0 + x * x + y * y)
    wi = np.stack([x, y, np.ones_like(x)], axis=-1) / distance[:, np.newaxis]
    area = (2.0 * PANE) ** 2
    density = distance**3 / area
    one = np.ones(len(wi))
    return Light("window", wi @ frame(TOWARDS_WINDOW).T, one / (density * len(wi)), one, density)


LIGHTS = (
    _even("uniform", UP, -1.0, 1.0),
    _overcast(),
    _clear(),
    _even("half space", np.array([1.0, 0.0, 0.0]), 0.0, 1.0),
    _window(),
    _even("horizon band", UP, 0.0, BAND),
    _even("retro lamp", FRONT, LAMP, 1.0),
)


def points(rings=10, spokes=20):
    """Normals of the ball at points that lie evenly in its picture."""
    radius = np.sqrt((np.arange(rings) + 0.5) / rings)
    azimuth = 2.0 * np.pi * (np.arange(spokes) + 0.5) / spokes
    radius, azimuth = (grid.ravel() for grid in np.meshgrid(radius, azimuth, indexing="ij"))
    z = np.sqrt(1.0 - radius**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def local(normal, directions):
    """Directions in the frame of one normal, (N, 3)."""
    axes = np.stack([local_directions(normal[np.newaxis], tuple(e))[0] for e in np.eye(3)], axis=1)
    return directions @ axes.T
