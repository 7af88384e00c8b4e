# SPDX-License-Identifier: Apache-2.0
"""What a check asks of a host: values and albedos of one node over batches of pairs.

A host that evaluates gets free pairs, a host that only makes pictures gets the points of a sphere;
both answer in the same form, so a check is written once.
"""

import warnings
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from mxeon.conformance.checks.batch import (
    FEW,
    LOBE_RIM,
    PAIRS,
    RIM,
    SEED,
    Batch,
    directions,
    random_inputs,
)
from mxeon.conformance.checks.nodes import Subject, Surface
from mxeon.models import table as reference
from mxeon.shaders.generation import ApproximationWarning
from mxeon.shaders.hosts import front_lit_only, host_row
from mxeon.shaders.plane import plane_pairs
from mxeon.shaders.scene import BACK, FRONT, FURNACE, SIDE, VIEW, Scene, local_directions, sphere

# Colors and roughnesses of the pictures that stand for a node on hosts that only make pictures.
PICTURE_INPUTS = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5},
)
PICTURE_SIZE = 128


@dataclass(frozen=True)
class PairProbe:
    """A node on a host that evaluates any pairs."""

    kind = "pairs"

    host: object
    subject: Subject
    library: str

    @cached_property
    def _shader(self):
        return self.host.compile(self.subject.document(), library=self.library)[0]

    @cached_property
    def batches(self):
        """One batch of PAIRS random pairs; a quarter of each direction grazes the surface."""
        rng = np.random.default_rng(SEED)
        wo, wi = directions(rng, PAIRS), directions(rng, PAIRS)
        return (Batch(wo, wi, random_inputs(rng, PAIRS, reference.model(self.subject.model))),)

    @cached_property
    def few(self):
        """FEW of them."""
        return tuple(batch.first(FEW) for batch in self.batches)

    @property
    def cosines(self):
        """Directions for the environment branch, which takes no heed of `wi`."""
        return self.few

    def direct(self, batch):
        """pi f cos(theta_i), (N, 3)."""
        return np.pi * self._evaluate(batch, "direct")

    def albedo(self, batch):
        """What the environment branch makes of a uniform surrounding of radiance 1, (N, 3)."""
        return self._evaluate(batch, "environment")

    def call(self, function, *arguments):
        """A function of the shader twins."""
        return self.host.call(function, *arguments)

    def _evaluate(self, batch, branch):
        inputs = self.subject.with_flag(batch.inputs)
        values = self.host.evaluate(self._shader, batch.wo, batch.wi, inputs, branch)
        return values.astype(np.float64)


@dataclass(frozen=True)
class PictureProbe:
    """A node on a host that makes pictures: the lit points of a sphere are its pairs."""

    kind = "pictures"
    lit = (SIDE, FRONT, BACK)
    size = PICTURE_SIZE

    host: object
    subject: Subject | Surface
    library: str

    @cached_property
    def batches(self):
        """The lit points away from rim and terminator, for each light and PICTURE_INPUTS."""
        batches = (
            self._batch(replace(scene, size=self.size), inputs)
            for scene in self.lit
            for inputs in PICTURE_INPUTS
        )
        return tuple(batch for batch in batches if len(batch.wo))

    @property
    def few(self):
        """The same: they are few."""
        return self.batches

    @cached_property
    def cosines(self):
        """The points in a white surrounding."""
        scene = replace(FURNACE, size=self.size)
        return tuple(self._batch(scene, inputs) for inputs in PICTURE_INPUTS)

    def direct(self, batch):
        """pi f cos(theta_i), (N, 3)."""
        return self._picture(batch)

    albedo = direct

    def call(self, function, *arguments):
        """A function of the shader twins."""
        return self.host.call(function, *arguments)

    def _batch(self, scene, inputs):
        wo, wi, chosen = self._points(scene)
        return Batch(wo[chosen], wi[chosen], inputs, scene)

    def _points(self, scene):
        """Directions at the points of a picture, and which points are judged."""
        wo, wi, chosen = picture_pairs(scene)
        return wo, wi, chosen & self._judged(wo, wi)

    def _judged(self, wo, wi):
        """Pairs to judge: those for which the host has a closure that can be the model."""
        if not front_lit_only(self.host.name, self.subject.model):
            return np.ones(len(wo), dtype=bool)
        return wo[:, 0] * wi[:, 0] + wo[:, 1] * wi[:, 1] >= 0.0

    def _picture(self, batch):
        values = self._shown(self._shader(batch.inputs), batch.scene)
        return values[self._points(batch.scene)[2]].astype(np.float64)

    def _shader(self, inputs):
        return _compiled(self.host, self.subject.document(inputs), self.library)

    def _shown(self, shader, scene):
        """What the host shows at all points."""
        return self.host.picture(shader, scene)[sphere(scene.size).mask]


@dataclass(frozen=True)
class SurfaceProbe(PictureProbe):
    """The diffuse lobe of a surface shader, told apart from what lies over it.

    A black lobe leaves the other lobes, and a white one at roughness 0, which is Lambert in every
    model, shows how much of the light reaches the lobe and comes back.
    """

    kind = "lobes"
    size = PICTURE_SIZE // 4  # the shaders are long

    def _judged(self, wo, wi):
        """Pairs to judge: those far from the rim, where an error in place is divided twice."""
        return np.minimum(wo[:, 2], wi[:, 2]) >= LOBE_RIM

    def _picture(self, batch):
        picture = super()._picture
        others = picture(batch.altered(color=(0.0, 0.0, 0.0)))
        lambert = picture(batch.altered(color=(1.0, 1.0, 1.0), roughness=0.0)) - others
        return (picture(batch) - others) / lambert * batch.wi[:, 2:]

    def _shader(self, inputs):
        """One shader for all inputs: long as it is, it is compiled once."""
        shader = super()._shader(PICTURE_INPUTS[0])
        given = {self.subject.color: inputs["color"], self.subject.roughness: inputs["roughness"]}
        values = [given.get(each.path.rsplit("/", 1)[-1], each.value) for each in shader.inputs]
        changed = map(lambda each, value: replace(each, value=value), shader.inputs, values)
        return replace(shader, inputs=tuple(changed))


@dataclass(frozen=True)
class PlaneProbe(PictureProbe):
    """A node on a plane: every pixel is another direction of view."""

    kind = "planes"
    lit = tuple(
        Scene(f"plane{degrees}", light=(np.sin(polar), 0.0, np.cos(polar)))
        for degrees in (20, 75)
        for polar in [np.radians(degrees)]
    )

    def _points(self, scene):
        wo, wi = plane_pairs(scene)
        return wo, wi, np.ones(len(wo), dtype=bool)

    def _shown(self, shader, scene):
        return self.host.plane(shader, scene)


@dataclass(frozen=True)
class NativeProbe(PictureProbe):
    """A node that a renderer has of its own, on a sphere."""

    def _picture(self, batch):
        color, roughness = (batch.inputs[name] for name in ("color", "roughness"))
        image = self.host.node(self.subject.node, color, roughness, batch.scene)
        return image[sphere(batch.scene.size).mask][picture_pairs(batch.scene)[2]].astype(
            np.float64
        )


PROBES = {
    "pairs": PairProbe,
    "pictures": PictureProbe,
    "planes": PlaneProbe,
    "native": NativeProbe,
}


def probe_type(host):
    """The class of probe that asks the host of a name, or None where only text is checked."""
    return PROBES.get(host_row(host).probe)


@lru_cache(maxsize=8)  # a check makes many pictures of a few documents
def _compiled(host, text, library):
    with warnings.catch_warnings():  # what is approximated is not judged: see _judged
        warnings.simplefilter("ignore", ApproximationWarning)
        return host.compile(text, library=library)[0]


@lru_cache(maxsize=8)
def picture_pairs(scene):
    """Directions at the points of the sphere, and which points are judged.

    Returns
    -------
    wo, wi : ndarray, shape (N, 3)
        One row per pixel on the sphere; wi is wo where there is no distant light.
    chosen : ndarray of bool, shape (N,)
        Both cosines at least RIM.
    """
    points = sphere(scene.size)
    normal = points.normal[points.mask]
    wo = local_directions(normal, VIEW)
    wi = wo if scene.light is None else local_directions(normal, scene.light)
    return wo, wi, (wo[:, 2] >= RIM) & (wi[:, 2] >= RIM)
