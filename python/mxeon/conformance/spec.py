# SPDX-License-Identifier: Apache-2.0
"""A spec defines input ranges, models, errors and samples for the checks of a node.

Each file in the folder `specs` describes a family of nodes. Backends define how an engine
evaluates a spec.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Flag, auto
from functools import lru_cache, partial
from typing import ClassVar, Generic, NamedTuple, TypedDict, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance import samples
from mxeon.conformance.samples import Array, Batch, Candidate, Counts, Values, directions, generator
from mxeon.conformance.tolerance import ROUNDING, Compared, Term, Tolerance
from mxeon.hosts import base, calls
from mxeon.models.nodes.node import Node as NodeRow
from mxeon.shaders import nodes

COMPONENTS = {"float": (), "vector2": (2,), "vector3": (3,), "color3": (3,)}  # array shape by type
CHANGED_COLOR = (0.9, 0.1, 0.6)
F = TypeVar("F")  # type of the functions in a row of the models' table


@dataclass(frozen=True)
class Input:
    name: str  # name of the input, or path of a port in a graph
    type: str = "float"  # MaterialX type
    low: ArrayLike = 0.0  # lower end of the range of random values, or one end per component
    high: ArrayLike = 1.0  # upper end of the range of random values, or one end per component
    edges: tuple[float, ...] = ()  # values that half of the special samples have
    # Value that must change the result, or None for inputs without a visible effect.
    change: ArrayLike | None = None
    needs: Values = field(default_factory=dict, hash=False)  # inputs that make the change visible
    # Whether random values are log-uniform. If not, a tenth of the values is at each end of the
    # range.
    logarithmic: bool = False
    often: float | None = None  # value in half of the samples, if documents rarely set the input
    equal: bool = False  # whether the two components are equal in half of the samples
    # Values of the input in two materials that represent a node in pictures; () for the default.
    materials: tuple[ArrayLike, ...] = ()
    variable: str = ""  # shader variable from which the default value is read; "" for none
    default: ArrayLike = 1.0  # value that a document sets if a value is required
    beyond: tuple[float, ...] = ()  # values outside of [low, high] that checks also use
    ends: tuple[float, float] = (-np.inf, np.inf)  # range to which the node clamps the input


def color(name: str, *materials: ArrayLike, edges: tuple[float, ...] = (0.0, 1e-3, 1.0)) -> Input:
    return Input(name, "color3", 0.0, 1.0, edges, CHANGED_COLOR, materials=materials)


def materials(*inputs: Input) -> tuple[Values, ...]:
    """The inputs of two materials that represent a node in pictures."""
    return tuple(
        {each.name: each.materials[which] for each in inputs if len(each.materials) > which}
        for which in (0, 1)
    )


def draw(
    rng: samples.Rng, count: int, inputs: Sequence[Input], edged: bool = False
) -> dict[str, Array]:
    """Random values of inputs, by name. If `edged`, half of the values are the input's edges."""
    drawn = {}
    for each in inputs:
        low, high = np.asarray(each.low, np.float64), np.asarray(each.high, np.float64)
        share = rng.random((count, *COMPONENTS[each.type]))
        if each.logarithmic:
            values = low * (high / low) ** share
        else:
            values = low + (high - low) * np.clip(1.25 * share - 0.125, 0.0, 1.0)
        if each.often is not None:
            values[::2] = each.often
        if each.equal:
            values[::2] = values[::2, :1]
        drawn[each.name] = samples.float32(values)
    for each in inputs:
        if edged and each.edges:
            drawn[each.name] = samples.with_edges(rng, drawn[each.name], each.edges)
    return drawn


def broadcast_inputs(batch: Batch) -> dict[str, Array]:
    """The inputs of a batch. Constant inputs are repeated for each pair of directions."""
    count, inputs = len(batch.wo), dict(batch.inputs)
    for name, values in inputs.items():
        if np.shape(values)[:1] != (count,):
            inputs[name] = np.broadcast_to(values, (count, *np.shape(values)[-1:]))
    return inputs


class Ability(Flag):
    """Abilities of a backend that nodes and checks may require."""

    # Abilities that nodes require.
    DIFFUSE = auto()  # rough diffuse nodes
    BELOW = auto()  # diffuse lobes below the other lobes of a surface shader
    OWN = auto()  # nodes that a renderer defines
    LOBE = auto()  # BSDF nodes of MaterialX's pbrlib
    HAIR = auto()
    SUBSURFACE = auto()
    FILM = auto()
    TRANSMISSION = auto()
    COMBINATION = auto()  # nodes that add, mix, multiply or layer lobes
    MATERIAL = auto()  # surface shaders with all lobes
    SCATTERS = DIFFUSE | BELOW | OWN | LOBE | MATERIAL
    EMISSION = auto()
    SURFACE = auto()  # emitting surfaces
    MEDIUM = auto()
    IMPLEMENTATION = auto()  # nodes for which only the existence of an implementation is checked
    OUTPUT = auto()  # nodes whose outputs are numbers or colors
    # Abilities that checks require.
    CLIENT = auto()  # run the shader's complete main() function with a client's bindings
    PAIRS = auto()  # evaluate pairs at the edges of the domain
    LIGHT = auto()  # compute the lighting of a shader


NO_ABILITY = Ability(0)


class EngineError(NamedTuple):
    """An error of an engine's built-in function, measured on each engine."""

    words: str
    measure: Callable[[base.Host], float]
    factor: float = 1.0  # factor by which the node amplifies the error


@lru_cache(maxsize=64)
def _measured(error: EngineError, host: base.Host) -> float:
    return error.factor * error.measure(host)


DEFAULT_COUNTS = Counts()
ZERO = Candidate("zero", lambda batch: np.zeros((len(batch.wo), 3)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Spec(ABC):
    """A node in one mode, with the data that checks need."""

    requires: ClassVar[Ability]
    coarse: ClassVar[int] = 1  # divisor of the width of pictures
    rim: ClassVar[float] = samples.RIM  # smallest cosine judged in pictures

    title: str  # unique title for reports
    node: str  # category of the node
    model: str = ""  # name of the expected model; "" for none
    inputs: tuple[Input, ...] = ()  # inputs, except inputs that select the mode
    errors: Mapping[str, Tolerance] = field(default_factory=dict)  # tolerances by quantity
    # Tolerances outside the usual ranges of inputs. A key has a quantity, an input and a value.
    outside_errors: Mapping[tuple[str, str, float], Tolerance] = field(default_factory=dict)
    libraries: tuple[str, ...] = ()  # libraries that the spec applies to, or () for all libraries
    claim: str = ""  # claim of all checks of the node, or "" for each check's own claim
    closure: bool = True  # whether eonlib's OSL uses a renderer's closure for the node
    counts: Counts = DEFAULT_COUNTS
    fixed: Values = field(default_factory=dict)  # values of inputs that a batch does not set
    # The kind of light, the output, and the factor that scales the host's values.
    evaluated: tuple[str, str, float] = ("direct", "response", np.pi)
    flat: bool = False  # whether values have no sharp peak
    # Slope of the values per radian near the normal, where rounded cosines do not resolve angles.
    along: float = 0.0
    optional: bool = False  # whether checks are skipped if a target lacks the node
    # For each quantity, errors of an engine's built-in functions, measured on the engine.
    engines: Mapping[str, tuple[EngineError, ...]] = field(default_factory=dict)
    # For each quantity, additional errors of MaterialX's fit for prefiltered light.
    prefiltered_fits: Mapping[str, tuple[Term, ...]] = field(default_factory=dict)

    @abstractmethod
    def document(self, inputs: Values | None = None) -> str:
        """MaterialX document with a material that consists of this node with the given inputs."""

    @property
    def side(self) -> float:
        """-1 for a node that scatters light from below the horizon, otherwise 1."""
        return 1.0

    @property
    def materials(self) -> tuple[Values, ...]:
        return materials(*self.inputs)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the inputs that must have an effect."""
        return tuple(each.name for each in self.inputs)

    @property
    def changes(self) -> Mapping[str, samples.Changes]:
        """For each input, all inputs before and after a change of that input."""
        return {
            each.name: (each.needs, {**each.needs, each.variable or each.name: each.change})
            for each in self.inputs
            if each.change is not None and each.name in self.names
        }

    def within(self, library: str) -> "Spec":
        """The spec adapted to a library. By default, nothing changes."""
        return self

    def engine(self, quantity: str, host: base.Host) -> tuple[Term, ...]:
        """Error terms of a quantity that are due to an engine's built-in functions."""
        terms = (Term(_measured(each, host), each.words) for each in self.engines.get(quantity, ()))
        return tuple(term for term in terms if term.value)


class ValueSpec(Spec):
    """A node with reference values, which are scattered light, emitted light or an output."""

    @abstractmethod
    def value(self, batch: Batch) -> Array:
        """Values of a correct shader, (N, 3): pi f |cos(theta_i)|, radiance, or a node's output."""

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the values. The first function is the node's own model."""
        return ()

    @property
    def all_candidates(self) -> tuple[Candidate, ...]:
        """The `value_candidates`, and functions that only explain samples outside of `batches`."""
        return self.value_candidates

    @abstractmethod
    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """All samples, with one batch for each kind of samples."""

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """A subset of the samples, for negative controls and expensive checks."""
        return tuple(batch.first(counts.few) for batch in batches)

    def rescaled(self, compared: Compared) -> Compared:
        """The comparison, rescaled to a unit in which errors are uniform."""
        return compared


class LobeSpec(ValueSpec):
    """A node that scatters light."""

    curved: ClassVar[bool] = False  # whether values depend on the surface's curvature
    # States that the check `states` skips, and kinds of states of which only the first is checked.
    plain: ClassVar[tuple[str, ...]] = ()

    @property
    def mode(self) -> Values:
        return self.fixed

    @property
    def types(self) -> dict[str, str]:
        return {**nodes.input_types(self.node), **{each.name: each.type for each in self.inputs}}

    def two_lobes(self) -> str:
        """MaterialX document with the sum of two lobes of the node, each in a separate frame."""
        axes = dict.fromkeys(nodes.FRAME_INPUTS, calls.TANGENT) | {"normal": calls.NORMAL}
        frame = {name: axes[name] for name in axes if name in nodes.input_types(self.node)}
        modes = {"first": self.mode, "second": {**self.mode, **frame}}
        lobes = (nodes.lobe_text(self.node, mode, name, self.types) for name, mode in modes.items())
        total = nodes.network_text({"lobe": nodes.Node("add", "BSDF", ("first", "second"))})
        return nodes.document_text("".join(lobes) + total + nodes.SURFACE)

    @abstractmethod
    def albedo(self, batch: Batch) -> Array:
        """Directional albedo of a correct shader, (N, 3)."""

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the albedo. The first function is the node's own model."""
        return ()

    @abstractmethod
    def random_inputs(self, rng: samples.Rng, count: int, edged: bool = False) -> dict[str, Array]:
        """Random values of the inputs. If `edged`, half of the values are the input's edges."""

    @abstractmethod
    def edges(self, counts: Counts) -> Batch:
        """Pairs and inputs at the edges of the domain."""

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs, special pairs, and pairs outside the models' domain."""
        rng, count = generator(), counts.pairs
        pairs = directions(rng, count), directions(rng, count)
        return (
            self._batch(rng, pairs),
            self._batch(rng, samples.special_directions(rng), edged=True),
            self._batch(rng, samples.outside_directions(rng)),
        )

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """A subset of the random pairs, and all special pairs."""
        return batches[0].first(counts.few), batches[1]

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Views for environment light, which does not depend on `wi`."""
        return (*self.few(batches, counts), batches[-1])

    def turned(self, counts: Counts) -> Batch:
        """Pairs with individual frames, in which half of the normals face away from the viewer.

        A tangent leans out of the surface by a slope of up to LEAN, as the tangents of a mesh do
        under a normal map.
        """
        rng = generator()
        frames = samples.turned_frames(rng, samples.FRAMES)
        count = len(frames)
        wo, wi = samples.turned_directions(rng, count), samples.turned_directions(rng, count)
        facing = np.where(np.arange(count) % 2, 1.0, -1.0)[:, np.newaxis]
        normal = facing * samples.float32(frames[:, :, 2])
        lean = samples.LEAN * np.linspace(-1.0, 1.0, count)[:, np.newaxis]
        tangent = frames[:, :, 0] + lean * frames[:, :, 2]
        axes = {"normal": normal, "tangent": samples.float32(tangent)}
        inputs = {**self.random_inputs(rng, count), **axes}
        return Batch(wo, wi * [1.0, 1.0, self.side], inputs, frame=frames)

    def _batch(self, rng: samples.Rng, pairs: tuple[Array, Array], edged: bool = False) -> Batch:
        """Pairs with random inputs, weights and occlusions, and with light from the node's side."""
        wo, wi = pairs
        inputs, count = self.random_inputs(rng, len(wo), edged), len(wo)
        for name, edges in (("weight", samples.WEIGHTS), ("occlusion", samples.OCCLUSIONS)):
            is_one = rng.random(count) < 0.5
            inputs[name] = np.where(is_one, 1.0, samples.with_edges(rng, rng.random(count), edges))
        return Batch(wo, wi * [1.0, 1.0, self.side], inputs)


class Names(TypedDict):
    """Fields of a spec that are copied from a row of the models' table."""

    title: str
    node: str
    model: str


def named(row: NodeRow[object], title: str = "") -> Names:
    return {"title": title or row.category, "node": row.category, "model": row.name}


@dataclass(frozen=True, eq=False, kw_only=True)
class RowSpec(ValueSpec, Generic[F]):
    """A node whose values are computed by functions in a row of the models' table."""

    row: NodeRow[F]

    @property
    def drawn(self) -> tuple[Input, ...]:
        """The inputs of the functions in the row of the models' table."""
        inputs = {each.name: each for each in self.inputs}
        return tuple(inputs[name] for name in self.row.inputs)

    @abstractmethod
    def values(self, function: F, batch: Batch) -> Array:
        """Values of a function in the row of the models' table, (N, 3)."""

    def value(self, batch: Batch) -> Array:
        return self.values(self.row.value, batch)

    def random_inputs(self, rng: samples.Rng, count: int) -> dict[str, Array]:
        return draw(rng, count, self.drawn)

    @property
    def others(self) -> tuple[Candidate, ...]:
        """Functions that may explain the values but are not in the row of the models' table."""
        return ()

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the values: the model, variants of the model, and `others`."""
        variants = (
            Candidate(
                each.title, partial(self.values, each.value), each.permitted, each.anisotropic
            )
            for each in self.row.variants
            if each.value
        )
        return (Candidate(self.row.title, self.value), *variants, *self.others)


def ports(inputs: Sequence[Input], values: Values | None) -> list[tuple[str, str, Array]]:
    """Path, type and value of each input. Inputs that `values` lacks have the default value."""
    values = {each.name: each.default for each in inputs} | dict(values or {})
    return [
        (each.name, each.type, np.broadcast_to(values[each.name], COMPONENTS[each.type]))
        for each in inputs
    ]


ARGUMENTS = 1 << 14  # number of arguments for measuring an engine's function


@dataclass(frozen=True)
class EngineFunction:
    """A built-in shader function, whose error is measured on each engine."""

    name: str  # last part of the name of a GLSL function that returns the expression
    expression: str  # GLSL expression in x, or in x and y
    exact: Callable[..., Array]

    def errors(self, host: base.Host, *arguments: Array) -> Array:
        """Errors of a host's values for float32 arguments, (N,)."""
        function = f"mxeon_{self.name}"
        parameters = ", ".join(f"float {name}" for name in "xy"[: len(arguments)])
        text = f"float {function}({parameters})\n{{\n    return {self.expression};\n}}\n"
        values = host.execute(text, function, *arguments)[:, 0]
        return np.abs(values - self.exact(*arguments))

    def error(
        self, arguments: Callable[[], Sequence[Array]], allowed: float = 1.0
    ) -> Callable[[base.Host], float]:
        """The excess of an error over `allowed` float32 roundings, as a function of the host."""
        least = allowed * ROUNDING
        return lambda host: max(float(self.errors(host, *arguments()).max()) - least, 0.0)


POWER = EngineFunction("power", "pow(x, y)", np.power)
EXPONENTIAL = EngineFunction("exponential", "exp(-x)", lambda x: np.exp(-x))
LOGARITHM = EngineFunction("logarithm", "log(x)", np.log)
WAVE = EngineFunction("wave", "max(cos(x), sin(x))", lambda x: np.maximum(np.cos(x), np.sin(x)))
TURN = EngineFunction(
    "turn",
    "max(abs(cos(6.28318530718 * x)), abs(sin(6.28318530718 * x)))",
    lambda x: np.maximum(np.abs(np.cos(2.0 * np.pi * x)), np.abs(np.sin(2.0 * np.pi * x))),
)
