# SPDX-License-Identifier: Apache-2.0
"""A host that renders with the NumPy models in float64, to compare other hosts with."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import islice

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.reference.graph import DRAWN, Graph, Measure
from mxeon.conformance.reference.nodes import ManyMaterialsError, ShadingPoints, ShownLobe
from mxeon.conformance.samples import Array
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts import Row, base
from mxeon.shaders.document import drawn_values
from mxeon.shaders.document.drawn_values import LIT, NAME, Elements, emission_document
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import Shader
from mxeon.shaders.inner_lobes import TRANSMISSION, inner_lobes
from mxeon.shaders.scene import VIEW, Scene, sphere, tangents

# Size of a picture that shows a pattern node, and maximum number of pattern nodes that are drawn to
# find a wrong node.
PATTERN_SIZE, PATTERNS_DRAWN = 32, 16
# Smallest reported error of a pattern node. Errors of texture filters and pow() are smaller.
PATTERN_ERROR = 0.01
LATTICE = 32  # number of judged rows and columns in a picture with more than MOST materials
MOST = 2000  # maximum number of integrals, each of which takes a millisecond

PATTERNS = (*DRAWN, "boolean", "color4", "vector4")  # shaders draw at most three components
TARGETS = ("glsl", "essl", "vulkan", "wgsl")  # targets whose shaders can draw a node's value


@dataclass(frozen=True, eq=False)
class HostValues:
    """Values of a shader's nodes at the pixels of a picture, drawn by the judged host.

    The reference has no functions for most pattern nodes. The judged host draws such a node's value
    as the output of a separate document, and the reference continues with the drawn value.
    """

    host: base.Host
    shader: Shader
    library: str
    policy: Policy
    pictures: dict[tuple[str, ...], Array] = field(default_factory=dict)

    def __call__(self, size: int, elements: Elements, kind: str, output: str = "") -> Array:
        """Values of the innermost of nested elements, (size, size, components).

        An output is drawn as a surface that emits the output's color. Raise NotRun if the host
        cannot draw the value.
        """
        element, document = elements[-1], self.shader.document
        name = element.getNamePath()
        key = (*(each.getNamePath() for each in elements), output, str(size))
        if key not in self.pictures:
            if self.host.target not in TARGETS:
                raise NotRun(f"{self.host.name}: the value of {name!r} cannot be drawn here")
            if element.isA(mx.Output):
                document, path = emission_document(document, element)
            else:
                document, path = drawn_values.value_document(document, elements, kind, output)
            try:
                [shader] = self.host.compile(
                    document, path, library=self.library, policy=self.policy
                )
            except DocumentError as error:
                raise NotRun(f"reference: the value of {name!r} cannot be drawn; {error}") from None
            image = self.host.picture(shader, Scene(NAME, size=size))
            self.pictures[key] = np.asarray(image, np.float64)
        return self.pictures[key][..., : DRAWN[kind]]

    def at(self, mask: NDArray[np.bool_]) -> Measure:
        """A function that draws values and selects pixels by a mask, (size, size)."""
        return lambda elements, kind, output: self(len(mask), elements, kind, output)[mask]


@dataclass(frozen=True, eq=False)
class ExpectedPicture:
    """The picture that a correct host would render."""

    image: NDArray[np.float64]
    judged: NDArray[np.bool_]  # mask of computed pixels, which the remaining pixels copy
    measured: tuple[str, ...]  # node inputs whose values the judged host has drawn
    lobes: tuple[ShownLobe, ...] = ()  # lobes with a nonzero weight


class Reference(base.Host):
    """A host that evaluates materials by the formulas of `mxeon.models`."""

    name, target = "reference", "glsl"

    def identity(self) -> base.Identity:
        return base.Identity(self.name, f"NumPy {np.__version__}", "CPU, float64")

    def picture(self, shader: Shader, scene: Scene) -> NDArray[np.float64]:
        """Picture of the sphere with the shader's material; see `mxeon.hosts.base.Host`.

        Raise NotRun if the models do not cover a lobe of the material, or if the light is an image.
        Raise ValueError if the scene asks for path tracing.
        """
        self.refuse_paths(scene)
        self.refuse_shape(scene)
        return self.expected(shader, scene).image

    def expected(
        self, shader: Shader, scene: Scene, values: HostValues | None = None, stride: int = 1
    ) -> ExpectedPicture:
        """The picture that is expected from the judged host.

        If the reference cannot compute an input of a lobe, `values` draws the input on the judged
        host. Only every `stride`-th row and column is computed. With `values`, the stride grows if
        there are too many different materials. Raise NotRun as `picture` does.
        """
        mask = sphere(scene.size).mask
        chosen = mask & _lattice(scene.size, stride)
        points = _points(scene, stride, MOST if values and stride == 1 else np.inf)
        if shader.methods.searched:
            points = replace(points, searched=True)

        measure = values.at(chosen) if values else None
        image = np.zeros((*mask.shape, 3))
        try:
            graph = Graph(shader.document, points, measure=measure)
            image[chosen] = graph.element(shader.element)
            if points.wi is None and TRANSMISSION in inner_lobes(shader):
                behind = replace(points, behind=True)
                passed = Graph(shader.document, behind, measure=measure)
                image[chosen] += passed.element(shader.element)
        except ManyMaterialsError:
            return self.expected(shader, scene, values, -(-scene.size // LATTICE))
        except NotRun:
            element = shader.document.getDescendant(shader.element)
            if values is None or not element.isA(mx.Output) or element.getType() in LIT:
                raise
            if element.getType() in PATTERNS:  # hosts draw other types as black
                image = values(scene.size, [element], "color3")
            return ExpectedPicture(image, mask, (element.getName(),))
        middle = (np.arange(scene.size) // stride * stride + stride // 2).clip(max=scene.size - 1)
        image = image[np.ix_(middle, middle)]
        return ExpectedPicture(image, chosen, tuple(graph.measured), tuple(graph.lobes))

    def other_node(self, shader: Shader, values: HostValues) -> tuple[str, ...]:
        """Category and name of the first pattern node with a wrong value on the host, or ()."""
        scene = Scene(NAME, VIEW, size=PATTERN_SIZE)
        measure = values.at(sphere(scene.size).mask)
        graph = Graph(shader.document, _points(scene, 1, np.inf), measure=measure)
        try:
            for elements, expected in islice(graph.patterns(shader.element), PATTERNS_DRAWN):
                found = measure(elements, elements[-1].getType(), "")
                scale = max(1.0, np.abs(expected).max())
                if np.abs(found - expected).max() > PATTERN_ERROR * scale:
                    return elements[-1].getCategory(), elements[-1].getName()
        except NotRun:  # the host cannot draw the pattern
            pass
        return ()

    def _values(self, query: base.Query) -> NDArray[np.float64]:
        """Values of the document's lobes; see `mxeon.hosts.base.Host.evaluate`.

        The branch "opacity" returns the light that passes if opacity replaces refraction. Raise
        NotRun for anything but the response to a light or a uniform environment.
        """
        shader, wo, wi, inputs, branch, output, irradiance, _ = query
        branches = ("direct", "environment", "transmission", "opacity")
        if output != "response" or irradiance is not None or branch not in branches:
            raise NotRun(
                "reference: only the response to a light or a uniform environment is known"
            )
        normal, tangent = (np.broadcast_to(axis, wo.shape) for axis in ((0, 0, 1.0), (1.0, 0, 0)))
        points = ShadingPoints(wo, wi if branch == "direct" else None, 1.0, normal, tangent)
        opaque = branch == "opacity"
        points = replace(points, behind=opaque or branch == "transmission", opacity=opaque)
        values = Graph(shader.document, points, inputs, emits=False).element(shader.element)
        return np.array(np.broadcast_to(values, wo.shape), np.float64)


def _lattice(size: int, stride: int) -> NDArray[np.bool_]:
    """Mask of the pixels in the middle of squares of `stride` rows and columns."""
    chosen = np.arange(size) % stride == stride // 2
    return np.asarray(np.logical_and.outer(chosen, chosen), np.bool_)


@lru_cache(maxsize=8)
def _points(scene: Scene, stride: int, most: float) -> ShadingPoints:
    """The points and the light of a picture. Raise NotRun if the light is an image."""
    points = sphere(scene.size)
    mask = points.mask & _lattice(scene.size, stride)
    normal, texcoord = points.normal[mask], points.texcoord[mask]
    if scene.light is not None:
        wi, strength = np.broadcast_to(scene.light, normal.shape), np.pi
    elif isinstance(scene.environment, float):
        wi, strength = None, scene.environment
    else:
        raise NotRun("reference: environment must be uniform; got an image")
    wo = np.broadcast_to(VIEW, normal.shape)
    return ShadingPoints(wo, wi, strength, normal, tangents(normal), texcoord, most, True)


ROW = Row("reference", target=Reference.target, start=lambda name: Reference())
