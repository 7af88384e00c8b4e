# SPDX-License-Identifier: Apache-2.0
"""Subsurface scattering: on a plane it is Lambert; on a sphere the profile spreads light."""

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance import samples, spec, tolerance
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Candidate, Counts, Values
from mxeon.conformance.specs.lobes import COLOR, FLAT_ERRORS, NORMAL, WEIGHT, PbrSpec, named_mode
from mxeon.models.media import FAR, blur_to
from mxeon.models.nodes.lobes import SUBSURFACE_NODE, circle_blur
from mxeon.shaders.scene import BACK, SIDE, VIEW, Scene, local_directions, sphere

LEAST_COSINE = 1e-6  # MaterialX's M_FLOAT_EPS
COSINES = np.linspace(-1.0, 1.0, 129)
SCENES = tuple(replace(scene, size=32) for scene in (SIDE, BACK))  # scenes of a unit sphere
LEAST_HEIGHT = 0.3  # least z of normals: near the rim, neighboring pixels are far apart
MATERIALS: tuple[Values, ...] = (  # light spreads everywhere, or almost nowhere
    {"color": (0.9, 0.6, 0.3), "radius": (0.5, 0.2, 0.05), "anisotropy": -0.5},
    {"color": (0.4, 0.7, 1.0), "radius": (0.02, 0.1, 1.0), "anisotropy": 0.5},
    *(dict[str, ArrayLike](color=(1, 1, 1), radius=each, anisotropy=0.0) for each in np.eye(3)),
)
# Wrong radii, and wrong lengths of the far exponential (3 is right), that a diagnosis tries.
EVEN = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0)
FARTHER = (1.0, 1.5, 2.0, 2.5, 4.0, 5.0, 6.0, 9.0, 12.0)

# The largest error, 9.3e-3, is on the light's axis, where a whole circle becomes lit at once.
RINGS = tolerance.given(0.01, Quantity.DIFFERENCE, "six circles instead of the profile's integral")
MEAN_OF_CIRCLES = "twice the mean over a sphere of the errors of six circles"
RINGS_MEAN = tolerance.given(0.003, Quantity.MEAN, MEAN_OF_CIRCLES, tolerance.mean_error)


class SubsurfaceSpec(PbrSpec):
    """The node on a plane, where radius and anisotropy have no effect, and on a sphere."""

    requires = spec.Ability.LOBE | spec.Ability.SUBSURFACE
    curved = True

    @property
    def others(self) -> tuple[Candidate, ...]:
        """Other candidates for a diagnosis: zero, and MaterialX's implementation."""
        return spec.ZERO, Candidate("MaterialX's blur along a circle of radius 100", _blurred)

    def spheres(self, counts: Counts) -> tuple[Batch, ...]:
        return tuple(_points(scene, inputs) for scene in SCENES for inputs in MATERIALS)


def _blurred(batch: Batch) -> Array:
    """MaterialX's result on a plane, which also has light below the horizon and in shadow.

    Light is 0 where a cosine rounds above 1, since the arc cosine is then NaN.
    """
    mu = batch.wi[:, 2]
    shadow = 1.0 - np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
    lit = 1.0 - shadow * np.clip(mu, LEAST_COSINE, 1.0)[:, np.newaxis]
    inputs = spec.broadcast_inputs(batch)
    light = np.where(mu[:, np.newaxis] > 1.0, 0.0, circle_blur(mu, inputs["radius"]))
    return np.asarray(batch.strength * inputs["color"] * light * lit)


SUBSURFACE = SubsurfaceSpec(
    **named_mode(SUBSURFACE_NODE),
    row=SUBSURFACE_NODE,
    inputs=(WEIGHT, COLOR, spec.Input("radius", "color3", high=2.0), NORMAL),
    errors={**FLAT_ERRORS, "sphere": RINGS, "sphere_mean": RINGS_MEAN},
    flat=True,
)


def spread(batch: Batch, far: float = FAR, **changes: ArrayLike) -> Array:
    """Light on a unit sphere by the profile for l / (1 - g), (N, 3); `changes` replace inputs."""
    inputs = batch.altered(**changes).inputs
    reach = inputs["radius"] / (1.0 - inputs["anisotropy"])
    light = [np.interp(batch.wi[:, 2], COSINES, _profile(each, far)) for each in reach.tolist()]
    return np.asarray(inputs["color"] * np.stack(light, axis=-1))


@lru_cache(maxsize=128)
def _profile(reach: float, far: float) -> Array:
    """The blurred cosine at COSINES. Linear interpolation between them has an error of 2e-4."""
    return blur_to(COSINES, np.array(max(reach, 1e-9)), far)  # reach 0 has only a limit


def _around(batch: Batch) -> Array:
    """Light on a unit sphere by MaterialX's blur, (N, 3)."""
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
        for each in EVEN
    ),
    *(
        Candidate(f"a far exponential of {each:g} mean free paths instead of {FAR:g}",
                  partial(spread, far=each))
        for each in FARTHER
    ),
)
# fmt: on


def _points(scene: Scene, inputs: Values) -> Batch:
    """All points of a sphere that are away from its rim, including shadowed points."""
    normal = sphere(scene.size).normal[inner(scene.size)]
    wo, wi = (local_directions(normal, each) for each in (VIEW, scene.light or VIEW))
    return Batch(wo, wi, samples.arrays(inputs), scene)


def inner(size: int) -> NDArray[np.bool_]:
    """Mask of a picture's points away from the rim of the sphere."""
    points = sphere(size)
    mask: NDArray[np.bool_] = points.mask & (points.normal[..., 2] > LEAST_HEIGHT)
    return mask
