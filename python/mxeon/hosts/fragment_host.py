# SPDX-License-Identifier: Apache-2.0
"""What hosts share that run generated text of the GLSL family as the pixel stage of a frame."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping

from numpy.typing import ArrayLike

from mxeon.hosts import base, fragment, raster
from mxeon.hosts.base import Array, Inputs
from mxeon.shaders import functions
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene


class FragmentHost(base.Host):
    """A host whose engine draws frames: an evaluation has one pixel per element.

    It writes the pixel stage of an evaluation or of a call; its engine draws it.
    """

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
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
        pixel, arguments = fragment.bsdf_evaluation(shader, wo, wi, inputs, branch, output)
        return self._evaluate(shader.stages["vertex"], pixel, arguments, irradiance)

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
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
