# SPDX-License-Identifier: Apache-2.0
"""What hosts share that run generated text of the GLSL family as the pixel stage of a frame."""

from __future__ import annotations

from abc import abstractmethod
from collections import OrderedDict
from collections.abc import Mapping
from functools import cached_property
from hashlib import blake2b

import numpy as np
from numpy.typing import ArrayLike

from mxeon.hosts import base, fragment, raster
from mxeon.hosts.base import Array, Inputs
from mxeon.shaders import functions
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene

KEPT = 32  # evaluations: a check, its control and its diagnosis ask for many again


class FragmentHost(base.Host):
    """A host whose engine draws frames: an evaluation has one pixel per element.

    It writes the pixel stage of an evaluation or of a call; its engine draws it.
    """

    @cached_property
    def _values(self) -> OrderedDict[bytes, Array]:
        """Values of evaluations by the digest of their text and their arguments, the last used last."""
        return OrderedDict()

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        """What takes the place of lobes below the surface; see `base.Host`."""
        return raster.approximations(shader)

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
        """Values of the shader's own BSDF function, read-only; see `base.Host`."""
        pixel, arguments = fragment.bsdf_evaluation(shader, wo, wi, inputs, branch, output)
        vertex = shader.stages["vertex"]
        # Draw what is not known.
        key = _digest(f"{vertex}{pixel}{raster.EVALUATION}", arguments, irradiance)
        if key not in self._values:
            self._values[key] = self._evaluate(vertex, pixel, arguments, irradiance)
            self._values[key].setflags(write=False)
        # Forget what was not asked for longest.
        self._values.move_to_end(key)
        if len(self._values) > KEPT:
            self._values.popitem(last=False)
        return self._values[key]

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a GLSL function; see `base.Host`."""
        parameters = functions.parameters(source, function)
        pixel, texels = fragment.function_evaluation(
            source, function, parameters, arguments, self.target
        )
        return self._evaluate(fragment.DIALECTS[self.target].vertex, pixel, texels)

    @abstractmethod
    def _evaluate(
        self,
        vertex: str,
        pixel: str,
        arguments: Mapping[str, Array],
        irradiance: Array | None = None,
    ) -> Array:
        """Values of a pixel stage, one pixel per element, as many as the longest argument has."""


def _digest(text: str, arguments: Mapping[str, Array], irradiance: Array | None) -> bytes:
    """What two evaluations have in common that are the same."""
    digest = blake2b(text.encode())
    for values in (*arguments.values(), *([] if irradiance is None else [irradiance])):
        digest.update(repr(values.shape).encode())
        digest.update(np.ascontiguousarray(values))
    return digest.digest()
