# SPDX-License-Identifier: Apache-2.0
"""A host that evaluates, made of one that only tells closures.

So what is asked of generated GLSL is asked of generated OSL by the same probes.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.reference.closures import GRAPH, Views, column, radiance
from mxeon.hosts.base import Array, Host, Identity, Inputs
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.generation import Shader

if TYPE_CHECKING:
    import MaterialX as mx

    from mxeon.io.files import AnyPath


class Evaluated(Host):
    """A host that tells closures, with their values by the models."""

    def __init__(self, host: Host) -> None:
        self.name, self._host = host.name, host
        self.target, self.profile, self.language = host.target, host.profile, host.language  # type: ignore[misc]

    def identity(self) -> Identity:
        """That of the host."""
        return self._host.identity()

    def compile(
        self,
        document: AnyPath | mx.Document,
        element: str | None = None,
        *,
        library: str = "eonlib",
        policy: Policy = DEFAULT,
    ) -> tuple[Shader, ...]:
        """Shaders of a document; see `mxeon.hosts.base.Host`."""
        return self._host.compile(document, element, library=library, policy=policy)

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a function; see `mxeon.hosts.base.Host`."""
        return self._host.execute(source, function, *arguments)

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
        """Values of the closures of a shader; see `mxeon.hosts.base.Host`.

        Raise Unsupported if the environment is not uniform: closures look none up.
        """
        if irradiance is not None:
            raise self._unsupported("uneven environment", "gl")
        values = np.zeros((len(wo), 3))
        occlusion = np.broadcast_to(column(inputs.get("occlusion", 1.0)), (len(wo), 1))
        for points in self._host.trees(shader, wo, inputs):
            rows = points.rows
            if output == "radiance" or branch == GRAPH:
                values[rows] = radiance(points.tree)
                continue
            view, light = (np.asarray(each, np.float64)[rows] for each in (wo, wi))
            views = Views(view, light, occlusion[rows], branch)
            bsdf = views.bsdf(points.tree, output == "throughput")
            values[rows] = bsdf.throughput if output == "throughput" else bsdf.value
        return values


@lru_cache(maxsize=4)
def evaluated(host: Host) -> Evaluated:
    return host if isinstance(host, Evaluated) else Evaluated(host)
