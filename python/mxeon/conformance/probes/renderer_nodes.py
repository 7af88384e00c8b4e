# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes that a renderer has of its own, by its pictures of a sphere."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.renderer_nodes import RendererNode
from mxeon.conformance.probes.pictures import PICTURE_SIZE, Mask, PictureProbe, scene_of
from mxeon.conformance.results import Claims
from mxeon.conformance.samples.batch import Array, Batch, Values
from mxeon.hosts.base import RendererHost
from mxeon.models import table as reference
from mxeon.shaders.scene import Scene, sphere

EXACT_INPUTS: tuple[Values, ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.02, 0.05, 0.1), "roughness": 1.0},
    {"color": (1.0, 0.8, 0.0), "roughness": 0.75},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5},
    {"color": (0.5, 0.2, 1.0), "roughness": 0.1},
)


class NativeProbe(PictureProbe):
    """A node that a renderer has of its own, on a sphere."""

    host: RendererHost  # type: ignore[assignment]  # in place of a host of generated shaders
    subject: RendererNode

    @property
    def claims(self) -> Claims:
        """Titles of the model that the node claims, and of the form of it that is judged."""
        claimed, *_ = self.subject.forms or (self.subject.model,)
        title, own = (reference.model(name).title for name in (claimed, self.subject.model))
        return {"claimed": title, "model": own}

    def _picture(self, batch: Batch) -> Array:
        scene, inputs = scene_of(batch), batch.inputs
        image = self.host.node(self.subject.node, inputs["color"], inputs["roughness"], scene)
        return image[self._seen(scene)][self.points(scene)[2]].astype(np.float64)

    def _seen(self, scene: Scene) -> Mask:
        """Mask of a picture's pixels that show the subject."""
        return sphere(scene.size).mask


class ExactProbe(NativeProbe):
    """A node of a renderer's own, on a sphere whose points and light have no error but rounding."""

    shown: ClassVar[str] = kinds.EXACT
    size: ClassVar[int] = PICTURE_SIZE // 2

    @property
    def _inputs(self) -> Sequence[Values]:
        """EXACT_INPUTS, from dark to white and from rough to smooth."""
        return EXACT_INPUTS

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """The first for each light."""
        return self.batches[:: len(EXACT_INPUTS)]

    def nearest_form(self) -> "ExactProbe":
        """The probe of the published form of the model that is nearest to what is measured."""
        if not self.subject.forms:
            return self
        batch = self.batches[0]
        values = self.direct(batch)
        errors = {
            form: float(np.abs(values - batch.expected(form)).max()) for form in self.subject.forms
        }
        nearest = min(errors, key=errors.__getitem__)
        return self.of(replace(self.subject, model=nearest))
