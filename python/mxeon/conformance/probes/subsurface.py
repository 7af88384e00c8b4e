# SPDX-License-Identifier: Apache-2.0
"""Probe of subsurface scattering: on a plane, and on a sphere, over which its profile spreads light."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes.subsurface import SubsurfaceSubject
from mxeon.conformance.probes.bsdf import BsdfProbe
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch, Candidate, Values
from mxeon.conformance.samples.measurement import Case
from mxeon.models.media.subsurface import FAR, blur_to
from mxeon.models.nodes.subsurface import circle_blur
from mxeon.shaders.scene import BACK, SIDE, VIEW, Scene, local_directions, sphere

COSINES = np.linspace(-1.0, 1.0, 129)
SCENES = tuple(replace(scene, size=32) for scene in (SIDE, BACK))  # of a sphere of radius 1
LEAST_HEIGHT = 0.3  # of its normals; next to the rim a pixel's point is far from the next one's
MATERIALS: tuple[Values, ...] = (  # from one whose light is everywhere to one like a plane
    {"color": (0.9, 0.6, 0.3), "radius": (0.5, 0.2, 0.05), "anisotropy": 0.0},
    {"color": (0.4, 0.7, 1.0), "radius": (0.02, 0.1, 1.0), "anisotropy": 0.5},
)


# What may stand in the place of the radius, and of the far exponential's length, which is 3.
EVEN = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0)
FARTHER = (1.0, 1.5, 2.0, 2.5, 4.0, 5.0, 6.0, 9.0, 12.0)


class SubsurfaceProbe(BsdfProbe):
    """The node on a plane, and on a sphere, whose points are a batch with a scene."""

    subject: SubsurfaceSubject

    @cached_property
    def turned(self) -> Batch:
        """Pairs in frames of their own, which no light leaves elsewhere: such a surface is not flat."""
        return super().turned.altered(radius=(0.0, 0.0, 0.0))

    @cached_property
    def spheres(self) -> tuple[Batch, ...]:
        return tuple(_points(scene, inputs) for scene in SCENES for inputs in MATERIALS)

    def direct(self, batch: Batch) -> Array:
        if batch.scene is None:
            return super().direct(batch)
        document = self.subject.document(batch.inputs)
        [shader] = self.host.compile(document, library=self.library)
        picture = self.host.picture(shader, batch.scene)
        return picture[_inner(batch.scene.size)].astype(np.float64)


def sphere_cases(probe: Probe) -> Iterator[Case]:
    """Points of a sphere, with the light that the profile spreads over it."""
    return (Case(batch, probe.direct(batch), _spread(batch)) for batch in probe.spheres)


def _spread(batch: Batch, far: float = FAR) -> Array:
    """Light on a unit sphere by the profile of l / (1 - g), (N, 3)."""
    reach = np.array(batch.inputs["radius"]) / (1.0 - batch.inputs["anisotropy"])
    return _light(batch, reach.tolist(), far)


def _even(batch: Batch, reach: float) -> Array:
    """Light on a unit sphere by one mean free path l / (1 - g), whatever the radius, (N, 3)."""
    return _light(batch, [reach / (1.0 - batch.inputs["anisotropy"])] * 3)


def _light(batch: Batch, reaches: Sequence[float], far: float = FAR) -> Array:
    """Light on a unit sphere by the profiles of a mean free path for each channel, (N, 3)."""
    mu = batch.wi[:, 2]
    light = [np.interp(mu, COSINES, _profile(each, far)) for each in reaches]
    return np.asarray(batch.inputs["color"] * np.stack(light, axis=-1))


@lru_cache(maxsize=128)
def _profile(reach: float, far: float) -> Array:
    """The blurred cosine at COSINES: between them it is straight within 2e-4."""
    return blur_to(COSINES, np.array(reach), far)


def _around(batch: Batch) -> Array:
    """Light on a unit sphere as MaterialX blurs it."""
    mu = np.clip(batch.wi[:, 2], -1.0, 1.0)
    radius = np.broadcast_to(batch.inputs["radius"], batch.wi.shape)
    return np.asarray(batch.inputs["color"] * circle_blur(mu, radius, body=1.0))


ON_SPHERES = (
    Candidate("the diffusion profile over the sphere", _spread),
    Candidate(
        "Lambert, whatever the radius",
        lambda batch: np.asarray(batch.inputs["color"] * np.maximum(batch.wi[:, 2:], 0.0)),
    ),
    Candidate(
        "the profile, whatever the anisotropy",
        lambda batch: _light(batch, list(batch.inputs["radius"])),
    ),
    Candidate("MaterialX's blur along a circle of radius 1", _around),
    *(
        Candidate(
            f"the profile of a mean free path of {each:g}, whatever the radius",
            partial(_even, reach=each),
        )
        for each in EVEN
    ),
    *(
        Candidate(
            f"a far exponential of {each:g} mean free paths instead of {FAR:g}",
            partial(_spread, far=each),
        )
        for each in FARTHER
    ),
)


def _points(scene: Scene, inputs: Values) -> Batch:
    """Points of a sphere away from its rim, those in the shadow among them."""
    normal = sphere(scene.size).normal[_inner(scene.size)]
    wo, wi = (local_directions(normal, each) for each in (VIEW, scene.light or VIEW))
    return Batch(wo, wi, inputs, scene)


def _inner(size: int) -> NDArray[np.bool_]:
    """Mask of a picture's points away from the rim of the sphere."""
    points = sphere(size)
    mask: NDArray[np.bool_] = points.mask & (points.normal[..., 2] > LEAST_HEIGHT)
    return mask
