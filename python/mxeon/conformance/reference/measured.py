# SPDX-License-Identifier: Apache-2.0
"""Array of a document's nodes as the host that is judged computes them.

Patterns are not what the reference knows: where it has no function for a node, the value that comes
from it is drawn by the host, as an output of a document of its own, and the reference goes on from
there.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

import MaterialX as mx
import numpy as np

from mxeon.conformance.samples import Array
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts.base import Host
from mxeon.shaders.document.drawn_values import (
    NAME,
    Elements,
    emission_document,
    value_document,
)
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene

# Types that a generator draws as a color, and their components.
DRAWN = {"float": 1, "integer": 1, "vector2": 2, "color3": 3, "vector3": 3}
PATTERNS = (*DRAWN, "boolean", "color4", "vector4")  # of which a generator draws three components
TARGETS = ("glsl", "essl", "vulkan", "wgsl")  # whose shaders of an output draw its value
# Array of a node, by its type and the name of its output.
Measure: TypeAlias = Callable[[Elements, str, str], Array]


class HostValues:
    """Array of a shader's nodes at the pixels of a picture, as a host draws them; NotRun if it cannot."""

    def __init__(self, host: Host, shader: Shader, library: str, policy: Policy) -> None:
        self._host, self._shader = host, shader
        self.library, self._policy = library, policy
        self._pictures: dict[tuple[str, ...], Array] = {}

    def __call__(self, size: int, elements: Elements, kind: str, output: str = "") -> Array:
        """Array of a node in a picture, (size, size, components)."""
        key = (*(each.getNamePath() for each in elements), output, str(size))
        make = partial(value_document, self._shader.document, elements, kind, output)
        return self._drawn(key, make, elements[-1].getNamePath(), size)[..., : DRAWN[kind]]

    def emitted(self, size: int, output: mx.Output) -> Array:
        """Picture of a surface that emits the color of an output, (size, size, 3)."""
        make = partial(emission_document, self._shader.document, output)
        return self._drawn((output.getNamePath(), str(size)), make, output.getNamePath(), size)

    def _drawn(
        self,
        key: tuple[str, ...],
        make: Callable[[], tuple[mx.Document, str]],
        name: str,
        size: int,
    ) -> Array:
        """Picture of the element of a document to be made, on which no light falls; kept by a key."""
        if key in self._pictures:
            return self._pictures[key]
        if self._host.target not in TARGETS:
            raise NotRun(f"{self._host.name}: the value of {name!r} cannot be drawn here")
        document, path = make()
        try:
            [shader] = self._host.compile(document, path, library=self.library, policy=self._policy)
        except DocumentError as error:
            raise NotRun(f"reference: the value of {name!r} cannot be drawn; {error}") from None
        image = self._host.picture(shader, Scene(NAME, size=size))
        return self._pictures.setdefault(key, np.asarray(image, np.float64))
