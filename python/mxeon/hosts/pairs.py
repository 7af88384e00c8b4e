# SPDX-License-Identifier: Apache-2.0
"""Renderers whose pictures show a pair of directions in each pixel, and so evaluate any pairs."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import InputError
from mxeon.hosts import base
from mxeon.hosts.base import Array, Inputs
from mxeon.hosts.pair_frames import LEAST_SINE, perpendicular, visible
from mxeon.shaders.generation import Shader

PATHS = 1 << 12  # pixels of a picture with a sky, each of the host's own number of paths
DIRECT, TRANSMITTED, EMITTED = "direct", "transmission", "emission"  # branches of `evaluate`
LAMP, SKY, DARK = "lamp", "sky", ""  # lights of a scene
BASE = "    {output} = layer({output}, uniform_edf(color(1)));\n"  # what shines through a layer


class PairHost(base.Host):
    """A renderer that compiles OSL and shows pairs of directions."""

    target = "osl"
    language = "osl"

    def evaluate(
        self,
        shader: Shader,
        wo: Array,
        wi: Array,
        inputs: Inputs,
        branch: str,
        *,
        output: str = "response",
        irradiance: Array | None = None,
    ) -> Array:
        """Values that a renderer gives to the closures of a shader; see `mxeon.hosts.base.Host`.

        The throughput is what is seen of a white emission below. The environment is sampled, so that it
        has noise; what comes through the surface is part of it. InputError if a pair in the light of a
        point is not `mxeon.hosts.pair_frames.visible`.
        """
        through = output == "throughput"
        if irradiance is not None or (branch == TRANSMITTED and not through):
            raise self._unsupported("uneven environment, and none below alone", "gl")
        if branch == DIRECT and output == "response":
            if not visible(wo, wi).all():
                raise InputError(
                    f"{self.name}: the sine of each pair must be at least {LEAST_SINE}"
                )
            return self._pixels(shader, wo, wi, inputs, "", LAMP)
        # What does not depend on the light: each view has one across it, and a sky several pixels.
        sky = not through and branch != EMITTED
        repeats = max(1, PATHS // len(wo)) if sky else 1
        rows = np.repeat(np.arange(len(wo)), repeats)
        spread = {
            name: np.asarray(each)[rows] if np.shape(each)[:1] == (len(wo),) else each
            for name, each in inputs.items()
        }
        last, across = BASE if through else "", perpendicular(wo)[rows]
        pixels = self._pixels(shader, wo[rows], across, spread, last, SKY if sky else DARK)
        return np.asarray(pixels.reshape(len(wo), repeats, 3).mean(axis=1))

    @abstractmethod
    def _pixels(
        self, shader: Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
    ) -> NDArray[np.float64]:
        """What pairs look like, (N, 3), where the OSL `last`, a pattern of its `output`, ends the shader.

        `light` is LAMP, of irradiance 1 on what faces it, SKY, a uniform radiance 1, or DARK.
        """
