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
Inputs: TypeAlias = Mapping[str, ArrayLike]  # input values of a node, constant or one per pair

TABLE = "u_albedoTable"

# Generated shaders rotate a direction by this matrix before looking up the environment. The matrix
# makes the middle of a latitude-longitude map face the viewer.
TURN = np.reshape(scene.TURN, (4, 4))


class RendererWarning(UserWarning):
    """A warning that a renderer prints and that may explain a wrong picture."""


class LobeWarning(UserWarning):
    """Warns that a host cannot correctly render a material's lobes below the surface."""

    def __init__(self, element: str, reason: str) -> None:
        super().__init__(f"{element}: {reason}")


@dataclass(frozen=True)
class Identity:
    name: str
    version: str
    device: str


class Engine(ABC):
    """A program that executes shaders or renders built-in materials; a context manager."""

    name: str
    draws_images: ClassVar[bool] = False  # whether an environment may be an image
    # Default methods of shader generation, or UNCHOSEN if the engine has no such methods.
    default: ClassVar[Methods] = UNCHOSEN
    methods: Methods = UNCHOSEN  # methods that are chosen for all shaders

    @property
    def active(self) -> Methods:
        """The chosen methods, completed by the default methods."""
        return self.methods.over(self.default)

    def choose(self, methods: Methods) -> None:
        """Use `methods` for all shaders, or raise NotRun."""
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
    """An engine that executes generated shaders. Subclasses override the supported methods.

    Unsupported methods raise `Unsupported`, and a shader that the compiler refuses raises
    `ShaderError`. Results are in the order of the request. Pictures are linear radiance.
    """

    target: ClassVar[str]
    profile: ClassVar[str | None] = None
    language: ClassVar[str] = "glsl"
    reads_images: ClassVar[bool] = False  # whether evaluations read a document's images
    fixed: ClassVar[bool] = False  # whether the methods of shader generation cannot be chosen

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
        """Shaders of a document for this host. Arguments and errors are as for `mxeon.generate`.

        `methods` override the methods that are chosen for the host. A document whose images are too
        large in total is refused; see `mxeon.hosts.textures.check_images`.
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
        """A shader's albedo table by sampler name. The sampler must clamp and interpolate."""
        return {TABLE: self._tables(shader.table)} if shader.table else {}

    @cached_property
    def _tables(self) -> Callable[[str], Array]:
        return lru_cache(maxsize=2)(self._drawn_table)

    def _drawn_table(self, text: str) -> Array:
        """Texels of a table of GGX albedos. Row 0 is for the smallest alpha."""
        raise NotRun(f"{self.name}: this host binds no albedo table")

    def picture(self, shader: Shader, scene: Scene) -> Array:
        """Linear picture of the unit sphere with a shader, row 0 at the top.

        Pixels off the sphere are 0. Raises NotRun if the host fails or cannot render the scene, and
        InputError if the host cannot set the scene's samples and bounces.
        """
        raise self._unsupported("pictures of a sphere", "gl")

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        """Reasons why the host cannot render a shader correctly."""
        return ()

    def unread(self, shader: Shader) -> str:
        """Description of the parts of a shader's document that the host ignores, or ""."""
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

        - `wo`, `wi`: Unit vectors in world space, (N, 3). The surface has the normal +z.
        - `inputs`: Values of node inputs by name, (N, ...) or constant. The input "occlusion" is 1
          by default, and "normal" is the surface's normal by default.
        - `branch`: "direct", "environment", "transmission", "emission", "graph" or "lit". The value
          of "graph" is the color of the uniform EDF. The value of "lit" is pi times the sum over up
          to two lights, plus the value of an environment; see `mxeon.hosts.calls.LIT` for the
          inputs of this branch.
        - `output`: The "response" is f cos(theta_i) in 1/sr. In the branch "environment", the
          response is the directional albedo times irradiance / pi. The "throughput" is the fraction
          of light from below that passes the BSDF. The "radiance" is emitted by the EDF.
        - `irradiance`: Irradiance of the environment divided by pi for every normal, (rows,
          columns, 3). This latitude-longitude map has row 0 at +y and its middle at +z, and is also
          used for lookups of radiance. None means a uniform environment of radiance 1.
        - `client`: Rotation and scale of the environment, and whether refraction is two-sided.

        Raises ValueError if the shader calls no BSDF, or if the branch or the output is unknown.
        """
        return self._values(Query(shader, wo, wi, inputs, branch, output, irradiance, client))

    def _values(self, query: Query) -> Array:
        raise self._unsupported("values for pairs of directions", "gl")

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of a function that a text defines, (N, 3). A float is repeated in all columns.

        - `source`: Text of functions in the host's language, without includes.
        - `*arguments`: Arrays (N, 3) for vectors or colors, and (N,) for floats, which are rounded
          to float32. A constant may have one row.

        Raises ValueError if the text has no such function.
        """
        raise self._unsupported("calls of a shader function", "gl")

    def call(self, function: str, *arguments: ArrayLike) -> Array:
        """Values of a shader function of eonlib; see `execute`."""
        from mxeon.shaders import functions

        return self.execute(functions.source(self.language), function, *arguments)

    def _unsupported(self, verb: str, other: str) -> Unsupported:
        return Unsupported(f"{self.name}: this host has no {verb}; use {other}")
