# SPDX-License-Identifier: Apache-2.0
"""Spec of subsurface scattering, which equals Lambert on a plane and spreads light on a sphere."""

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance import samples, spec, tolerance
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Candidate, Counts, Values
from mxeon.conformance.specs.lobes import COLOR, FLAT_ERRORS, NORMAL, WEIGHT, PbrSpec, mode_of
from mxeon.models.media import FAR, blur_to
from mxeon.models.nodes.lobes import SUBSURFACE_NODE, circle_blur
from mxeon.shaders.scene import BACK, SIDE, VIEW, Scene, local_directions, sphere

LEAST_COSINE = 1e-6  # MaterialX's M_FLOAT_EPS
COSINES = np.linspace(-1.0, 1.0, 129)
SCENES = tuple(replace(scene, size=32) for scene in (SIDE, BACK))  # scenes of a unit sphere
LEAST_HEIGHT = 0.3  # smallest z of normals, which excludes pixels near the rim
# Materials in which light spreads over the sphere, and materials in which light hardly spreads.
MATERIALS: tuple[Values, ...] = (
    {"color": (0.9, 0.6, 0.3), "radius": (0.5, 0.2, 0.05), "anisotropy": -0.5},
    {"color": (0.4, 0.7, 1.0), "radius": (0.02, 0.1, 1.0), "anisotropy": 0.5},
    *(dict[str, ArrayLike](color=(1, 1, 1), radius=each, anisotropy=0.0) for each in np.eye(3)),
)

# A sum over six circles approximates the integral of the profile up to an error of 9.3e-3.
RINGS = tolerance.single(0.01, Quantity.DIFFERENCE, "six circles instead of the profile's integral")
MEAN_OF_CIRCLES = "twice the mean error of six circles over a sphere"
RINGS_MEAN = tolerance.single(0.003, Quantity.MEAN, MEAN_OF_CIRCLES, tolerance.mean_error)


class SubsurfaceSpec(PbrSpec):
    """Subsurface scattering on a plane, where radius and anisotropy have no effect."""

    requires = spec.Ability.LOBE | spec.Ability.SUBSURFACE
    curved = True

    @property
    def others(self) -> tuple[Candidate, ...]:
        return spec.ZERO, Candidate("MaterialX's blur along a circle of radius 100", _blurred)

    def spheres(self, counts: Counts) -> tuple[Batch, ...]:
        return tuple(_points(scene, inputs) for scene in SCENES for inputs in MATERIALS)


def _blurred(batch: Batch) -> Array:
    """Values that MaterialX's implementation computes on a plane, (N, 3).

    MaterialX adds light below the horizon and in shadow. For a cosine above 1, the arc cosine is
    NaN, and the light is 0.
    """
    mu = batch.wi[:, 2]
    shadow = 1.0 - np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
    lit = 1.0 - shadow * np.clip(mu, LEAST_COSINE, 1.0)[:, np.newaxis]
    inputs = spec.broadcast_inputs(batch)
    light = np.where(mu[:, np.newaxis] > 1.0, 0.0, circle_blur(mu, inputs["radius"]))
    return np.asarray(batch.strength * inputs["color"] * light * lit)


SUBSURFACE = SubsurfaceSpec(
    **mode_of(SUBSURFACE_NODE),
    inputs=(WEIGHT, COLOR, spec.Input("radius", "color3", high=2.0), NORMAL),
    errors={**FLAT_ERRORS, "sphere": RINGS, "sphere_mean": RINGS_MEAN},
    flat=True,
)


def spread(batch: Batch, far: float = FAR, **changes: ArrayLike) -> Array:
    """Diffused light on a unit sphere, (N, 3), after `changes` of the batch's inputs."""
    inputs = batch.altered(**changes).inputs
    reach = inputs["radius"] / (1.0 - inputs["anisotropy"])
    light = [np.interp(batch.wi[:, 2], COSINES, _profile(each, far)) for each in reach.tolist()]
    return np.asarray(inputs["color"] * np.stack(light, axis=-1))


@lru_cache(maxsize=128)
def _profile(reach: float, far: float) -> Array:
    """Diffused light at COSINES. Linear interpolation between COSINES has an error of 2e-4."""
    return blur_to(COSINES, np.array(max(reach, 1e-9)), far)


def _around(batch: Batch) -> Array:
    """Light that MaterialX's implementation computes on a unit sphere, (N, 3)."""
    mu = np.clip(batch.wi[:, 2], -1.0, 1.0)
    radius = np.broadcast_to(batch.inputs["radius"], batch.wi.shape)
    return np.asarray(batch.inputs["color"] * circle_blur(mu, radius, body=1.0))


# fmt: off
ON_SPHERES = (
    Candidate("the diffusion profile over the sphere", spread),
    Candidate("Lambert, whatever the radius",
              lambda batch: np.asarray(batch.inputs["color"] * np.maximum(batch.wi[:, 2:], 0.0))),
    Candidate("the profile, whatever the anisotropy", partial(spread, anisotropy=0.0)),
    Candidate("the profile, whatever the sign of the anisotropy",
              lambda batch: spread(batch, anisotropy=abs(batch.inputs["anisotropy"]))),
    Candidate("the profile, whatever an anisotropy below 0",
              lambda batch: spread(batch, anisotropy=np.maximum(batch.inputs["anisotropy"], 0.0))),
    Candidate("the profile, with red and blue of the radius exchanged",
              lambda batch: spread(batch, radius=batch.inputs["radius"][..., ::-1])),
    Candidate("MaterialX's blur along a circle of radius 1", _around),
    *(
        Candidate(f"the profile of a mean free path of {each:g}, whatever the radius",
                  partial(spread, radius=(each, each, each)))
        for each in (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0)
    ),
    *(
        Candidate(f"a far exponential of {each:g} mean free paths instead of {FAR:g}",
                  partial(spread, far=each))
        for each in (1.0, 1.5, 2.0, 2.5, 4.0, 5.0, 6.0, 9.0, 12.0)
    ),
)
# fmt: on


def _points(scene: Scene, inputs: Values) -> Batch:
    normal = sphere(scene.size).normal[inner(scene.size)]
    wo, wi = (local_directions(normal, each) for each in (VIEW, scene.light or VIEW))
    return Batch(wo, wi, samples.arrays(inputs), scene)


def inner(size: int) -> NDArray[np.bool_]:
    """Mask of the pixels that show the sphere away from its rim, (size, size)."""
    points = sphere(size)
    return np.asarray(points.mask & (points.normal[..., 2] > LEAST_HEIGHT), bool)
