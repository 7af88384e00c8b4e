# SPDX-License-Identifier: Apache-2.0
"""Probes of the diffuse lobe of surface shaders, whose other lobes cannot be switched off."""

from dataclasses import replace
from typing import ClassVar, cast

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.diffuse import DiffuseLobe
from mxeon.conformance.probes.pictures import PICTURE_INPUTS, PICTURE_SIZE, Mask, PictureProbe
from mxeon.conformance.samples.batch import LOBE_RIM, Array, Batch, Values
from mxeon.shaders.document.values import Plain
from mxeon.shaders.generation import Shader


class DiffuseLobeProbe(PictureProbe):
    """The diffuse lobe of a surface shader, told apart from what lies over it.

    A black lobe leaves the other lobes, and a white one at roughness 0, which is Lambert in every
    model, shows how much of the light reaches the lobe and comes back.
    """

    shown: ClassVar[str] = kinds.LOBE
    size: ClassVar[int] = PICTURE_SIZE // 4  # the shaders are long

    subject: DiffuseLobe

    def _mask(self, wo: Array, wi: Array) -> Mask:
        """Mask of the pairs far from the rim, where an error in position is divided twice."""
        mask: Mask = np.minimum(wo[:, 2], wi[:, 2]) >= LOBE_RIM
        return mask

    def _picture(self, batch: Batch) -> Array:
        picture = super()._picture
        others = picture(batch.altered(color=(0.0, 0.0, 0.0)))
        lambert = picture(batch.altered(color=(1.0, 1.0, 1.0), roughness=0.0)) - others
        return (picture(batch) - others) / lambert * batch.wi[:, 2:]

    def _shader(self, inputs: Values) -> Shader:
        """One shader for all inputs: long as it is, it is compiled once."""
        shader = super()._shader(PICTURE_INPUTS[0])
        values = {self.subject.color: inputs["color"], self.subject.roughness: inputs["roughness"]}
        ports = (
            replace(port, value=cast(Plain, values.get(port.path.rsplit("/", 1)[-1], port.value)))
            for port in shader.inputs
        )
        return replace(shader, inputs=tuple(ports))
