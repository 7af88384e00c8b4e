# SPDX-License-Identifier: Apache-2.0
"""The base classes of all hosts: their verbs, and the error for verbs that a host lacks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import InputError, NotRun, Unsupported
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.methods import UNCHOSEN, Methods
from mxeon.shaders.scene import Paths, Scene

if TYPE_CHECKING:
    import MaterialX as mx

    from mxeon.hosts.osl.trees import TreeRows
    from mxeon.io.files import AnyPath
    from mxeon.shaders.generation import Shader

Array: TypeAlias = NDArray[Any]  # float32 or float64, whichever the caller or engine uses
Inputs: TypeAlias = Mapping[str, ArrayLike]  # of a node by name, for all pairs or for each

# Matrix by which shaders turn a direction before they look it up in an environment, as generated
# GLSL has it: the middle of a latitude-longitude map faces the viewer.
TURN = np.diag([-1.0, 1.0, -1.0, 1.0])


class RendererWarning(UserWarning):
    """A warning of the renderer itself, which may explain its picture."""


class LobeWarning(UserWarning):
    """A picture that cannot be right because its material has light below the surface."""

    def __init__(self, element: str, reason: str) -> None:
        super().__init__(f"{element}: {reason}")


@dataclass(frozen=True)
class Identity:
    """What executed: the host's name, its version and its device."""

    name: str
    version: str
    device: str


class Engine(ABC):
    """A program that executes shaders, or renders its own materials; a context manager, which closes it."""

    name: str
    draws_images: ClassVar[bool] = False  # whether the environment of its pictures may be an image
    default: ClassVar[Methods] = UNCHOSEN  # its methods unless others are chosen, if it has any
    methods: Methods = UNCHOSEN  # chosen for all shaders

    @property
    def active(self) -> Methods:
        """The methods of its shaders."""
        return self.methods.over(self.default)

    def choose(self, methods: Methods) -> None:
        """Use the methods that a client chooses, or raise NotRun."""
        if methods != UNCHOSEN:
            raise NotRun(f"{self.name}: its methods cannot be chosen; got {methods}")

    @abstractmethod
    def identity(self) -> Identity:
        """Name, version and device, as the engine has them."""

    def close(self) -> None:  # noqa: B027, a host may hold nothing
        """Release what the host holds."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def refuse_paths(self, scene: Scene) -> None:
        """Raise InputError if a scene sets samples or bounces, which this host cannot change."""
        if scene.paths != Paths():
            raise InputError(
                f"{self.name}: samples and bounces can be set for cycles and --integrator path only"
            )

    def refuse_shape(self, scene: Scene) -> None:
        """Raise InputError if a scene shows anything but a sphere."""
        if scene.shape != "sphere":
            raise InputError(
                f"{self.name}: shape must be sphere; got {scene.shape}, which gl and webgl draw"
            )


class Query(NamedTuple):
    """The arguments of `Host.evaluate`."""

    shader: Shader
    wo: Array
    wi: Array
    inputs: Inputs
    branch: str
    output: str
    irradiance: Array | None


class Host(Engine):
    """An engine that executes generated shaders.

    A caller may rely on this: a verb that a host lacks raises `Unsupported`, here and nowhere else; a
    shader that the host's compiler refuses raises `ShaderError`; `compile` alone knows the target, the
    profile and the lights; pairs, rows and pixels come back in the order of the request, as linear
    radiance or 1/sr, and never silently from another shader. A host overrides the verbs that it has.
    """

    target: ClassVar[str]
    profile: ClassVar[str | None] = None
    language: ClassVar[str] = "glsl"
    reads_images: ClassVar[bool] = False  # whether its evaluations read a document's images
    default: ClassVar[Methods] = (
        UNCHOSEN  # its methods unless others are chosen; UNCHOSEN: it has none
    )
    fixed: ClassVar[bool] = False  # whether it has its own methods alone

    def compile(
        self,
        document: AnyPath | mx.Document,
        element: str | None = None,
        *,
        library: str = "eonlib",
        methods: Methods = UNCHOSEN,
        policy: Policy = DEFAULT,
    ) -> tuple[Shader, ...]:
        """Shaders of a document for this host; arguments and errors as for `mxeon.generate`.

        `methods` are those of these shaders where they differ from the host's.
        Images that are too large in total are refused, too; see `mxeon.hosts.textures.check_images`.
        """
        from mxeon.hosts.textures import check_images
        from mxeon.shaders.generation import generate

        shaders = generate(
            document,
            self.target,
            element,
            library=library,
            profile=self.profile,
            lights=True,
            methods=UNCHOSEN if self.fixed else methods.over(self.methods),
            policy=policy,
        )
        check_images(shaders, policy)
        return shaders

    def choose(self, methods: Methods) -> None:
        offered = dict(self.default.chosen())
        for name, value in methods.chosen():
            if self.default == UNCHOSEN:
                raise NotRun(f"{self.name}: {self.target} has no choice of {name}; got {value}")
            if self.fixed and offered.get(name) != value:
                only = offered.get(name, "MaterialX's default")
                raise NotRun(f"{self.name}: {name} is always {only}; got {value}")
        if methods.albedo == "table":
            raise NotRun(
                f"{self.name}: albedo table: clients draw the table themselves, mxeon does not"
            )
        self.methods = UNCHOSEN if self.fixed else methods

    def picture(self, shader: Shader, scene: Scene) -> Array:
        """Picture of the unit sphere with a shader on it: linear, row 0 at the top, 0 off the sphere.

        `NotRun` if the host cannot show the scene or fails; `InputError` for paths if it traces none.
        """
        raise self._unsupported("pictures of a sphere", "gl")

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        """Reasons, as text, why the `picture` of a shader cannot be right; empty if it can."""
        return ()

    def unread(self, shader: Shader) -> str:
        """The parts of a shader's document that the host does not read, as text; "" if it reads all."""
        return ""

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
        """Values of a shader's BSDF for pairs of directions, shape (N, 3).

        - `wo`, `wi`: (N, 3). Unit vectors in world space. The surface has the normal +z.
        - `inputs`: Node inputs by name, (N, ...) or constant, and "occlusion", 1 unless given. The
          node's normal is that of the surface unless given.
        - `branch`: "direct", "environment", "transmission" or "emission"; or "graph": the color of
          the uniform EDF, which the directions do not change; or "lit": pi times the sum over up to two
          lights plus an environment, in one pixel, as the inputs of `mxeon.hosts.calls.LIT` say.
        - `output`: "response", f cos(theta_i) in 1/sr or the directional albedo times the
          irradiance; "throughput", the share of the light from below that passes the BSDF; or
          "radiance", what the EDF emits towards `wo`, in any branch.
        - `irradiance`: (rows, columns, 3). Irradiance over pi of the environment for every normal,
          as a latitude-longitude map with row 0 upwards (+y) and its middle towards +z; lookups of
          radiance find it too. None for a uniform environment of radiance 1.

        Raises ValueError if the shader calls no BSDF, or branch or output is unknown.
        """
        return self._values(Query(shader, wo, wi, inputs, branch, output, irradiance))

    def _values(self, query: Query) -> Array:
        raise self._unsupported("values for pairs of directions", "gl")

    def trees(self, shader: Shader, wo: Array, inputs: Inputs) -> tuple[TreeRows, ...]:
        """Trees of the closures that an OSL shader makes, with their arguments and weights.

        `wo`, shape (N, 3), and `inputs` are those of `evaluate`. Points whose closures differ in numbers
        alone share one tree. `ShaderError` also for a closure that OSL does not document.
        """
        raise self._unsupported("trees of closures", "osl")

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a function defined in a text, shape (N, 3); a float fills all three columns.

        - `source`: Functions in the host's language, without includes.
        - `*arguments`: (N, 3) for a vector or color, (N,) for a float, taken as float32; what is the
          same for all N may have one row.

        Raises ValueError if there is no such function.
        """
        raise self._unsupported("calls of a shader function", "gl")

    def call(self, function: str, *arguments: ArrayLike) -> Array:
        """Values of a shader function of eonlib; see `execute`."""
        from mxeon.shaders import functions

        return self.execute(functions.source(self.language), function, *arguments)

    def _unsupported(self, verb: str, other: str) -> Unsupported:
        return Unsupported(f"{self.name}: this host has no {verb}; use {other}")
