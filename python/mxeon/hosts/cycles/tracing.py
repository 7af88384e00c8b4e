# SPDX-License-Identifier: Apache-2.0
"""How Cycles samples a picture: its paths, and the sphere that they meet.

A point cloud is an exact sphere, and nothing goes through it: Cycles finds no exit for a path inside.
So a material with lobes below its surface is shown on a mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

from mxeon.shaders.inner_lobes import SUBSURFACE
from mxeon.shaders.scene import Scene

# Samples of a pixel: 1 is enough under a distant light.
ENVIRONMENT_SAMPLES = 256
INNER_SAMPLES = 64
# A random walk below the surface counts as one bounce, and on a convex body no second one follows.
# Light that a body refracts is reflected inside. Under a uniform sky a sphere of dielectric_bsdf is as
# bright with 6 bounces as with 16 in every digit of float32; with 2 it is darker by 1e-3.
SURFACE_BOUNCES, REFRACTED_BOUNCES = 1, 8


class SceneParts(TypedDict):
    """Parts of a scene that the worker needs; see `request`."""

    size: int
    samples: int
    bounces: int
    radius: float
    light: tuple[float, float, float] | None
    environment: float | Path | None
    body: str


FEWEST_SAMPLES = 16  # below the surface, less is noise rather than a picture


def request(scene: Scene, lobes: Sequence[str]) -> SceneParts:
    """Parts of a scene that the worker needs, for a material with such lobes below its surface."""
    samples = ENVIRONMENT_SAMPLES if scene.environment is not None else 1
    return {
        "size": scene.size,
        "samples": scene.paths.samples or (max(samples, INNER_SAMPLES) if lobes else samples),
        "bounces": scene.paths.bounces or _bounces(lobes),
        "radius": 1.0,
        "light": scene.light,
        "environment": scene.environment,
        "body": "mesh" if lobes else "points",
    }


def approximations(scene: Scene, lobes: Sequence[str]) -> tuple[str, ...]:
    """Why a picture of such lobes cannot be right: paths that are too few or too short."""
    if not lobes:
        return ()
    asked, reasons = request(scene, lobes), []
    if asked["samples"] < FEWEST_SAMPLES:
        reasons.append(
            f"{' and '.join(lobes)}: needs at least {FEWEST_SAMPLES} samples of a pixel; with "
            f"{asked['samples']} the picture is noise"
        )
    if asked["bounces"] < _bounces(lobes):
        reasons.append(
            f"{' and '.join(lobes)}: needs {_bounces(lobes)} bounces; with {asked['bounces']} the "
            "light of longer paths is missing"
        )
    return tuple(reasons)


def _bounces(lobes: Sequence[str]) -> int:
    return SURFACE_BOUNCES if set(lobes) <= {SUBSURFACE} else REFRACTED_BOUNCES
