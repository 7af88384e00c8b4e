# SPDX-License-Identifier: Apache-2.0
"""The base classes of all hosts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import InputError, NotRun, Unsupported
from mxeon.hosts.textures import check_images
from mxeon.shaders import scene
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.methods import UNCHOSEN, Methods
from mxeon.shaders.scene import CLIENT, Client, Paths, Scene

if TYPE_CHECKING:
    import MaterialX as mx

    from mxeon.io.files import AnyPath
    from mxeon.shaders.generation import Shader

Array: TypeAlias = NDArray[Any]  # float32 or float64, whichever the caller or engine uses
Inputs: TypeAlias = Mapping[str, ArrayLike]  # a node's inputs: constants, or one value per pair

TABLE = "u_albedoTable"

# Generated shaders turn a direction by this matrix before they look up the environment, so the
# middle of a latitude-longitude map faces the viewer.
TURN = np.reshape(scene.TURN, (4, 4))


class RendererWarning(UserWarning):
    """A warning that a renderer prints, which may explain its picture."""


class LobeWarning(UserWarning):
    """The host cannot render the material's lobes below the surface correctly."""

    def __init__(self, element: str, reason: str) -> None:
        super().__init__(f"{element}: {reason}")


@dataclass(frozen=True)
class Identity:
    name: str
    version: str
    device: str


class Engine(ABC):
    """A program that executes shaders, or renders its own materials; a context manager."""

    name: str
    draws_images: ClassVar[bool] = False  # whether pictures may have an image as their environment
    # Methods of a shader for which no others are chosen; UNCHOSEN if methods do not apply.
    default: ClassVar[Methods] = UNCHOSEN
    methods: Methods = UNCHOSEN  # methods chosen for all shaders

    @property
    def active(self) -> Methods:
        """The chosen methods, completed by the default ones."""
        return self.methods.over(self.default)

    def choose(self, methods: Methods) -> None:
        """Use these methods, or raise NotRun."""
        if methods != UNCHOSEN:
            raise NotRun(f"{self.name}: its methods cannot be chosen; got {methods}")

    @abstractmethod
    def identity(self) -> Identity: ...

    def close(self) -> None:  # noqa: B027, a host may have nothing to release
        """Release the host's resources."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def refuse_paths(self, scene: Scene) -> None:
        """Raise InputError if a scene sets samples or bounces."""
        if scene.paths != Paths():
            raise InputError(
                f"{self.name}: samples and bounces can be set for cycles and --integrator path only"
            )

    def refuse_shape(self, scene: Scene) -> None:
        """Raise InputError unless a scene shows a sphere."""
        if scene.shape != "sphere":
            raise InputError(
                f"{self.name}: shape must be sphere; got {scene.shape}, which gl and webgl draw"
            )


class Query(NamedTuple):
    shader: Shader
    wo: Array
    wi: Array
    inputs: Inputs
    branch: str
    output: str
    irradiance: Array | None
    client: Client = CLIENT


class Host(Engine):
    """An engine that executes generated shaders; hosts override the methods that they support.

    Unsupported methods raise `Unsupported`; shaders that the compiler refuses raise `ShaderError`.
    Results are in the order of the request, as linear radiance or 1/sr.
    """

    target: ClassVar[str]
    profile: ClassVar[str | None] = None
    language: ClassVar[str] = "glsl"
    reads_images: ClassVar[bool] = False  # whether evaluations read a document's images
    fixed: ClassVar[bool] = False  # whether its methods cannot be changed

    def compile(
        self,
        document: AnyPath | mx.Document,
        element: str | None = None,
        *,
        library: str = "eonlib",
        methods: Methods = UNCHOSEN,
        policy: Policy = DEFAULT,
        client: Collection[str] = (),
    ) -> tuple[Shader, ...]:
        """Shaders of a document for this host; arguments and errors as for `mxeon.generate`.

        `methods` override those chosen for the host. Images that are too large in total are
        refused; see `mxeon.hosts.textures.check_images`.
        """
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
            client=client,
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
        self.methods = UNCHOSEN if self.fixed else methods

    def table(self, shader: Shader) -> dict[str, Array]:
        """Texels of a shader's albedo table, by sampler; the sampler clamps and interpolates."""
        return {TABLE: self._tables(shader.table)} if shader.table else {}

    @cached_property
    def _tables(self) -> Callable[[str], Array]:
        return lru_cache(maxsize=2)(self._drawn_table)

    def _drawn_table(self, text: str) -> Array:
        """Texels of a table of albedos, row 0 at an alpha of 0."""
        raise NotRun(f"{self.name}: albedo table: this host binds none")

    def picture(self, shader: Shader, scene: Scene) -> Array:
        """Picture of the unit sphere with a shader on it: linear, row 0 at the top, 0 off the sphere.

        Raises NotRun if the host fails or cannot render a scene; InputError for unsupported paths.
        """
        raise self._unsupported("pictures of a sphere", "gl")

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        """Reasons why the host cannot render a shader correctly."""
        return ()

    def unread(self, shader: Shader) -> str:
        """Description of parts of a shader's document that the host ignores, or ""."""
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
        client: Client = CLIENT,
    ) -> Array:
        """Values of a shader's BSDF for pairs of directions, shape (N, 3).

        - `wo`, `wi`: (N, 3). Unit vectors in world space. The surface has the normal +z.
        - `inputs`: Node inputs by name, (N, ...) or constant, and "occlusion", 1 by default. The
          default normal is that of the surface.
        - `branch`: "direct", "environment", "transmission" or "emission"; or "graph": the color of
          the uniform EDF, independent of the directions; or "lit": pi times the sum over up to two
          lights plus an environment in one pixel, given by the inputs of `mxeon.hosts.calls.LIT`.
        - `output`: "response", f cos(theta_i) in 1/sr or the directional albedo times the
          irradiance; "throughput", the share of the light from below that passes the BSDF; or
          "radiance", emitted by the EDF towards `wo`, in any branch.
        - `irradiance`: (rows, columns, 3). Irradiance over pi of the environment for every normal,
          as a latitude-longitude map with row 0 upwards (+y) and its middle towards +z, also used
          for lookups of radiance. None for a uniform environment of radiance 1.
        - `client`: How the environment is turned and scaled, and whether refraction is two-sided.

        Raises ValueError if the shader calls no BSDF, or branch or output is unknown.
        """
        return self._values(Query(shader, wo, wi, inputs, branch, output, irradiance, client))

    def _values(self, query: Query) -> Array:
        raise self._unsupported("values for pairs of directions", "gl")

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a function defined in a text, shape (N, 3); a float fills all three columns.

        - `source`: Functions in the host's language, without includes.
        - `*arguments`: (N, 3) for a vector or color, (N,) for a float, rounded to float32; a
          constant may have one row.

        Raises ValueError if there is no such function.
        """
        raise self._unsupported("calls of a shader function", "gl")

    def call(self, function: str, *arguments: ArrayLike) -> Array:
        """Values of a shader function of eonlib; see `execute`."""
        from mxeon.shaders import functions

        return self.execute(functions.source(self.language), function, *arguments)

    def _unsupported(self, verb: str, other: str) -> Unsupported:
        return Unsupported(f"{self.name}: this host has no {verb}; use {other}")
