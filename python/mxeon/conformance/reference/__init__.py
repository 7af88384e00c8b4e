# SPDX-License-Identifier: Apache-2.0
"""The NumPy models in float64 as a host, which is the reference for all other hosts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import islice

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.reference.graph import DRAWN, Graph
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

SCENES = 4  # number of scenes whose points are cached, enough for the pictures of a run

# Size of pattern pictures, and maximum number drawn to find a wrong pattern.
PATTERN_SIZE, PATTERNS_DRAWN = 32, 16
OTHER = 0.01  # smallest reported difference of a pattern, above errors of filters and powers
LATTICE = 32  # number of judged rows and columns in a picture that exceeds MOST
MOST = 2000  # maximum judged pixels whose material varies; an integral takes a millisecond

PATTERNS = (*DRAWN, "boolean", "color4", "vector4")  # generators draw at most three components
TARGETS = ("glsl", "essl", "vulkan", "wgsl")  # targets whose shaders can draw a node's value


class HostValues:
    """Values of a shader's nodes at a picture's pixels, drawn by a host; NotRun if it cannot.

    The reference has no functions for most pattern nodes. In their place, the judged host draws
    the node's value as the output of a separate document, and the reference continues with this
    value.
    """

    def __init__(self, host: base.Host, shader: Shader, library: str, policy: Policy) -> None:
        self._host, self._shader = host, shader
        self.library, self._policy = library, policy
        self._pictures: dict[tuple[str, ...], Array] = {}

    def __call__(self, size: int, elements: Elements, kind: str, output: str = "") -> Array:
        """Values of a node in an unlit picture, (size, size, components).

        The picture shows an output as a surface that emits the output's color.
        """
        shown, document = elements[-1], self._shader.document
        name = shown.getNamePath()
        key = (*(each.getNamePath() for each in elements), output, str(size))
        if key not in self._pictures:
            if self._host.target not in TARGETS:
                raise NotRun(f"{self._host.name}: the value of {name!r} cannot be drawn here")
            if shown.isA(mx.Output):
                document, path = emission_document(document, shown)
            else:
                document, path = drawn_values.value_document(document, elements, kind, output)
            try:
                make = partial(self._host.compile, library=self.library, policy=self._policy)
                [shader] = make(document, path)
            except DocumentError as error:
                raise NotRun(f"reference: the value of {name!r} cannot be drawn; {error}") from None
            image = self._host.picture(shader, Scene(NAME, size=size))
            self._pictures[key] = np.asarray(image, np.float64)
        return self._pictures[key][..., : DRAWN[kind]]


@dataclass(frozen=True, eq=False)
class ExpectedPicture:
    """The picture that a correct host would render."""

    image: NDArray[np.float64]
    # Mask of computed pixels; all other pixels copy a neighbor.
    judged: NDArray[np.bool_]
    measured: tuple[str, ...]  # node inputs whose values come from the host
    lobes: tuple[ShownLobe, ...] = ()  # lobes with a nonzero weight


class Reference(base.Host):
    """A host with the models of `mxeon.models.table` and the nodes of `mxeon.models.nodes`."""

    name, target = "reference", "glsl"

    def identity(self) -> base.Identity:
        return base.Identity(self.name, f"NumPy {np.__version__}", "CPU, float64")

    def picture(self, shader: Shader, scene: Scene) -> NDArray[np.float64]:
        """Picture of the sphere with the shader's document; see `mxeon.hosts.base.Host`.

        Raise NotRun if the material has lobes that the models do not cover, or the light is an
        image; ValueError if the scene asks for paths.
        """
        self.refuse_paths(scene)
        self.refuse_shape(scene)
        return self.expected(shader, scene).image

    def expected(
        self, shader: Shader, scene: Scene, values: HostValues | None = None, stride: int = 1
    ) -> ExpectedPicture:
        """The expected picture of a host; `values` measures some inputs of lobes on that host.

        Only every `stride`-th row and column is computed; with `values`, the stride grows if there
        are too many materials. Raise NotRun as `picture` does.
        """
        mask = sphere(scene.size).mask
        chosen = mask & _lattice(scene.size, stride)
        points = _shown(scene, stride, MOST if values and stride == 1 else np.inf)
        if shader.methods.searched:
            points = replace(points, searched=True)

        def measure(elements: Elements, kind: str, output: str) -> NDArray[np.float64]:
            assert values
            return values(scene.size, elements, kind, output)[chosen]

        image = np.zeros((*mask.shape, 3))
        try:
            graph = Graph(shader.document, points, measure=measure if values else None)
            image[chosen] = graph.element(shader.element)
            if points.wi is None and TRANSMISSION in inner_lobes(shader):
                dark = replace(points, behind=True)
                behind = Graph(shader.document, dark, measure=measure if values else None)
                image[chosen] += behind.element(shader.element)
        except ManyMaterialsError:
            return self.expected(shader, scene, values, -(-scene.size // LATTICE))
        except NotRun:
            shown = shader.document.getDescendant(shader.element)
            if values is None or not shown.isA(mx.Output) or shown.getType() in LIT:
                raise
            # The host draws patterns as the color of an emitting surface; other types are black.
            if shown.getType() in PATTERNS:
                image = values(scene.size, [shown], "color3")
            return ExpectedPicture(image, mask, (shown.getName(),))
        middle = (np.arange(scene.size) // stride * stride + stride // 2).clip(max=scene.size - 1)
        image = image[np.ix_(middle, middle)]
        return ExpectedPicture(image, chosen, tuple(graph.measured), tuple(graph.lobes))

    def other_node(self, shader: Shader, values: HostValues) -> tuple[str, ...]:
        """Category and name of the first pattern node that a host evaluates differently, or ()."""
        scene = Scene(NAME, VIEW, size=PATTERN_SIZE)
        mask = sphere(scene.size).mask

        def drawn(elements: Elements, kind: str, output: str) -> NDArray[np.float64]:
            return values(scene.size, elements, kind, output)[mask]

        nodes = Graph(shader.document, _shown(scene, 1, np.inf), measure=drawn)
        try:
            for elements, right in islice(nodes.patterns(shader.element), PATTERNS_DRAWN):
                own = drawn(elements, elements[-1].getType(), "")
                if np.abs(own - right).max() > OTHER * max(1.0, np.abs(right).max()):
                    return elements[-1].getCategory(), elements[-1].getName()
        except NotRun:  # patterns that cannot be drawn are not compared
            pass
        return ()

    def _values(self, query: base.Query) -> NDArray[np.float64]:
        """Values of the document's lobes; see `mxeon.hosts.base.Host.evaluate`.

        The branch "opacity" is "transmission" by MaterialX's method "opacity". Raise NotRun unless
        the query is for the response to a light or a uniform environment, transmission included.
        """
        shader, wo, wi, inputs, branch, output, irradiance, _ = query
        branches = ("direct", "environment", "transmission", "opacity")
        if output != "response" or irradiance is not None or branch not in branches:
            known = "the response to a light or a uniform environment"
            raise NotRun(f"reference: only {known} is known")
        normal, tangent = (np.broadcast_to(axis, wo.shape) for axis in ((0, 0, 1.0), (1.0, 0, 0)))
        points = ShadingPoints(wo, wi if branch == "direct" else None, 1.0, normal, tangent)
        opaque = branch == "opacity"
        points = replace(points, behind=opaque or branch == "transmission", opacity=opaque)
        values = Graph(shader.document, points, inputs, emits=False).element(shader.element)
        return np.array(np.broadcast_to(values, wo.shape), np.float64)


def _lattice(size: int, stride: int) -> NDArray[np.bool_]:
    """Pixels in the middle of squares of `stride` rows and columns."""
    chosen = np.arange(size) % stride == stride // 2
    return np.asarray(np.logical_and.outer(chosen, chosen), np.bool_)


@lru_cache(maxsize=2 * SCENES)
def _shown(scene: Scene, stride: int, most: float) -> ShadingPoints:
    """The points and the light of a picture.

    Raise NotRun if the light is an image.
    """
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


# Any target works here, because the reference evaluates the shader's document.
ROW = Row("reference", target=Reference.target, start=lambda name: Reference())
