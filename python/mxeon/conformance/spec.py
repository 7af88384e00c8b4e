# SPDX-License-Identifier: Apache-2.0
"""What a node is judged by: its inputs and their ranges, its models, its errors and the samples it needs.

A family of nodes is one file under `specs`. How an engine evaluates it is a backend's business.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Flag, auto
from functools import lru_cache, partial
from typing import ClassVar, Generic, NamedTuple, TypedDict, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance import samples
from mxeon.conformance.samples import Array, Batch, Candidate, Counts, Values, directions, generator
from mxeon.conformance.tolerance import ROUNDING, Compared, Term, Tolerance
from mxeon.hosts.base import Host
from mxeon.hosts.calls import NORMAL, TANGENT
from mxeon.models.nodes.node import Node as NodeRow
from mxeon.shaders.nodes import (
    FRAME_INPUTS,
    SURFACE,
    Node,
    document_text,
    input_types,
    lobe_text,
    network_text,
)

COMPONENTS = {"float": (), "vector2": (2,), "vector3": (3,), "color3": (3,)}  # shape by type
CHANGED_COLOR = (0.9, 0.1, 0.6)
F = TypeVar("F")  # a function of a row


@dataclass(frozen=True)
class Input:
    """An input of a node, by name or path."""

    name: str
    type: str = "float"  # in MaterialX
    low: ArrayLike = 0.0  # ends of the range of random values, of all components or of each
    high: ArrayLike = 1.0
    edges: tuple[float, ...] = ()  # what half of the special values are; () for none
    # Another value than the default, which must have an effect; None where it has none by itself.
    change: ArrayLike | None = None
    needs: Values = field(default_factory=dict, hash=False)  # inputs with which the change shows
    # Whether random values are uniform in their logarithm; else a tenth is on either end.
    logarithmic: bool = False
    often: float | None = None  # every other random value, of an input that is rarely set
    equal: bool = False  # both components are the same in every other random value
    # Values in the two materials that stand for a node in pictures; () for the default.
    materials: tuple[ArrayLike, ...] = ()
    variable: str = ""  # that a host sets instead, where the default is a variable
    default: ArrayLike = 1.0  # in a document that has to set it
    beyond: tuple[float, ...] = ()  # values outside the range that hosts pass, too
    ends: tuple[float, float] = (-np.inf, np.inf)  # beyond which the node takes the nearest value


def color(name: str, *materials: ArrayLike, edges: tuple[float, ...] = (0.0, 1e-3, 1.0)) -> Input:
    return Input(name, "color3", 0.0, 1.0, edges, CHANGED_COLOR, materials=materials)


def materials(*inputs: Input) -> tuple[Values, ...]:
    """Two materials that stand for a node in pictures."""
    return tuple(
        {each.name: each.materials[which] for each in inputs if len(each.materials) > which}
        for which in (0, 1)
    )


def draw(
    rng: np.random.Generator, count: int, inputs: Sequence[Input], edged: bool = False
) -> dict[str, Array]:
    """Random values of inputs in their ranges, by name; half of them on an edge if `edged`."""
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
    """The inputs of a batch with a row for each pair."""
    count = len(batch.wo)
    return {
        name: np.broadcast_to(values, (count, *np.shape(values)[-1:]))
        if np.shape(values)[:1] != (count,)
        else values
        for name, values in batch.inputs.items()
    }


class Ability(Flag):
    """What a backend can do, and a node or a check needs."""

    # Nodes whose values it has: rough diffuse ones, a renderer's own, and lobes of pbrlib.
    DIFFUSE = auto()
    BELOW = auto()  # a diffuse lobe below others
    OWN = auto()
    LOBE = auto()
    HAIR = auto()
    SUBSURFACE = auto()
    FILM = auto()
    TRANSMISSION = auto()
    COMBINATION = auto()
    MATERIAL = auto()  # a surface shader with all of its lobes
    SCATTERS = DIFFUSE | BELOW | OWN | LOBE | MATERIAL
    EMISSION = auto()
    SURFACE = auto()  # one that emits
    MEDIUM = auto()
    IMPLEMENTATION = auto()  # of nodes without values
    OUTPUT = auto()
    # For checks: pairs at the edges of the domain, too; how light is found, summed or let through.
    FRAME = auto()  # the whole main under what a client binds
    PAIRS = auto()
    LIGHT = auto()


NO_ABILITY = Ability(0)


class EngineError(NamedTuple):
    """A term by a function that engines have themselves, measured on each."""

    words: str
    measure: Callable[[Host], float]
    factor: float = 1.0


@lru_cache(maxsize=64)
def _measured(error: EngineError, host: Host) -> float:
    return error.factor * error.measure(host)


USUAL = Counts()
ZERO = Candidate("zero", lambda batch: np.zeros((len(batch.wo), 3)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Spec(ABC):
    """A node in one mode."""

    requires: ClassVar[Ability]
    coarse: ClassVar[int] = 1  # by which its pictures are smaller
    rim: ClassVar[float] = samples.RIM  # least cosines that are judged in a picture

    title: str  # in reports; unique
    node: str  # category
    model: str = ""  # name of the model that it has to be; "" for none
    inputs: tuple[Input, ...] = ()  # all but those that select the mode
    errors: Mapping[str, Tolerance] = field(default_factory=dict)  # of a right shader, by quantity
    # Errors outside the usual range of an input: by quantity, input and value.
    outside_errors: Mapping[tuple[str, str, float], Tolerance] = field(default_factory=dict)
    libraries: tuple[str, ...] = ()  # with which it is judged; () for all
    closure: bool = True  # whether eonlib leaves it to a renderer's own closures, in OSL
    counts: Counts = USUAL
    # Inputs that an evaluation sets unless a batch does.
    fixed: Values = field(default_factory=dict)
    # What is evaluated for a value: a branch, an output, and the factor of what a host returns.
    evaluated: tuple[str, str, float] = ("direct", "response", np.pi)
    flat: bool = False  # whether its values have no peak
    # Slope of values or albedos by the angle from a view along the normal, which no cosine near 1 tells.
    along: float = 0.0
    optional: bool = False  # whether a target may lack the node, so that it is not run there
    # What functions of an engine's own, measured there, add to the error of a quantity.
    engines: Mapping[str, tuple[EngineError, ...]] = field(default_factory=dict)
    # What MaterialX's fit of prefiltered light adds to the error of a quantity.
    prefiltered_fits: Mapping[str, tuple[Term, ...]] = field(default_factory=dict)

    @abstractmethod
    def document(self, inputs: Values | None = None) -> str:
        """MaterialX text of a material of this node alone, with these inputs."""

    @property
    def side(self) -> float:
        """-1 where it scatters light from below the horizon, else 1."""
        return 1.0

    @property
    def materials(self) -> tuple[Values, ...]:
        """The materials that stand for the node in pictures."""
        return materials(*self.inputs)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the inputs that must have an effect."""
        return tuple(each.name for each in self.inputs)

    @property
    def changes(self) -> Mapping[str, samples.Changes]:
        """For each input: inputs without and with a change of it alone."""
        return {
            each.name: (each.needs, {**each.needs, each.variable or each.name: each.change})
            for each in self.inputs
            if each.change is not None and each.name in self.names
        }

    def within(self, library: str) -> "Spec":
        """The spec where the document is that of a library: most do not depend on it."""
        return self

    def engine(self, quantity: str, host: Host) -> tuple[Term, ...]:
        """What functions of an engine's own add to the error of a quantity."""
        found = ((_measured(each, host), each.words) for each in self.engines.get(quantity, ()))
        return tuple(Term(error, words) for error, words in found if error)


class ValueSpec(Spec):
    """A node with values that have a reference: light that it scatters or emits, or an output."""

    @abstractmethod
    def value(self, batch: Batch) -> Array:
        """Values of a right shader, (N, 3): pi f |cos(theta_i)|, a radiance, or an output."""

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the values, its own model first."""
        return ()

    @property
    def all_candidates(self) -> tuple[Candidate, ...]:
        """The same, and those of samples that `batches` lacks."""
        return self.value_candidates

    @abstractmethod
    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """All samples."""

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Some of them, for controls and for what takes long."""
        return tuple(batch.first(counts.few) for batch in batches)

    def alike(self, compared: Compared) -> Compared:
        """Values in a unit in which their errors are alike."""
        return compared


class LobeSpec(ValueSpec):
    """A node that scatters light."""

    curved: ClassVar[bool] = False  # whether they depend on how the surface bends
    # Axes of `checks.states` of which it has the first state alone, and states that it lacks.
    plain: ClassVar[tuple[str, ...]] = ()

    @property
    def mode(self) -> Values:
        """Inputs that select the mode."""
        return self.fixed

    @property
    def types(self) -> dict[str, str]:
        """Types of its inputs."""
        return {**input_types(self.node), **{each.name: each.type for each in self.inputs}}

    def two_lobes(self) -> str:
        """MaterialX text of a material of two such lobes, `first` and `second`, which has a frame of its own."""
        own = [name for name in FRAME_INPUTS if name in input_types(self.node)]
        frame = {name: NORMAL if name == "normal" else TANGENT for name in own}
        modes = {"first": self.mode, "second": {**self.mode, **frame}}
        lobes = (lobe_text(self.node, mode, name, self.types) for name, mode in modes.items())
        total = network_text({"lobe": Node("add", "BSDF", ("first", "second"))})
        return document_text("".join(lobes) + total + SURFACE)

    @abstractmethod
    def albedo(self, batch: Batch) -> Array:
        """Directional albedo of a right shader, (N, 3)."""

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the albedo, its own model first."""
        return ()

    @abstractmethod
    def random_inputs(
        self, rng: np.random.Generator, count: int, edged: bool = False
    ) -> dict[str, Array]:
        """Random values of the inputs, half of them on an edge if `edged`."""

    @abstractmethod
    def edges(self, counts: Counts) -> Batch:
        """Pairs and inputs at the edges of the domain."""

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs, a quarter of each direction grazing; special ones; and outside ones."""
        rng, count = generator(), counts.pairs
        pairs = directions(rng, count), directions(rng, count)
        return (
            self._batch(rng, pairs),
            self._batch(rng, samples.special_directions(rng), edged=True),
            self._batch(rng, samples.outside_directions(rng)),
        )

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Few of the random pairs, and the special ones; none of them is outside."""
        return batches[0].first(counts.few), batches[1]

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Views for the environment branch, which does not depend on `wi`."""
        return (*self.few(batches, counts), batches[-1])

    def turned(self, counts: Counts) -> Batch:
        """Pairs in frames of their own.

        Half of the normals face away from the viewer. Tangents lean out of the surface by up to LEAN,
        as those of a geometry do where a picture turns the normal.
        """
        rng = generator()
        frames = samples.turned_frames(rng, samples.FRAMES)
        count = len(frames)
        wo, wi = samples.turned_directions(rng, count), samples.turned_directions(rng, count)
        facing = np.where(np.arange(count) % 2, 1.0, -1.0)[:, np.newaxis]
        normal = facing * samples.rounded(frames[:, :, 2].T)
        lean = samples.LEAN * np.linspace(-1.0, 1.0, count)[:, np.newaxis]
        tangent = frames[:, :, 0] + lean * frames[:, :, 2]
        axes = {"normal": normal, "tangent": samples.rounded(tangent.T)}
        inputs = {**self.random_inputs(rng, count), **axes}
        return Batch(wo, wi * [1.0, 1.0, self.side], inputs, frame=frames)

    def _batch(
        self, rng: np.random.Generator, pairs: tuple[Array, Array], edged: bool = False
    ) -> Batch:
        """Pairs with random inputs, weights and occlusions, lit from the side that it scatters."""
        wo, wi = pairs
        inputs, count = self.random_inputs(rng, len(wo), edged), len(wo)
        for name, edges in (("weight", samples.WEIGHTS), ("occlusion", samples.OCCLUSIONS)):
            whole = rng.random(count) < 0.5
            inputs[name] = np.where(whole, 1.0, samples.with_edges(rng, rng.random(count), edges))
        return Batch(wo, wi * [1.0, 1.0, self.side], inputs)


class Names(TypedDict):
    """What a spec takes from its row by name."""

    title: str
    node: str
    model: str


def named(row: NodeRow[object], title: str = "") -> Names:
    return {"title": title or row.category, "node": row.category, "model": row.name}


@dataclass(frozen=True, eq=False, kw_only=True)
class RowSpec(ValueSpec, Generic[F]):
    """A node whose functions are those of a row."""

    row: NodeRow[F]

    @property
    def drawn(self) -> tuple[Input, ...]:
        """The inputs that its functions read."""
        inputs = {each.name: each for each in self.inputs}
        return tuple(inputs[name] for name in self.row.inputs)

    @abstractmethod
    def values(self, function: F, batch: Batch) -> Array:
        """Values of a function of the row, (N, 3)."""

    def value(self, batch: Batch) -> Array:
        return self.values(self.row.value, batch)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw(rng, count, self.drawn)

    @property
    def others(self) -> tuple[Candidate, ...]:
        """What else may explain the values."""
        return ()

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """The functions of the row: its own and its variants; and others."""
        own = Candidate(self.row.title, self.value)
        variants = (
            Candidate(each.title, partial(self.values, each.value), each.permitted)
            for each in self.row.variants
            if each.value
        )
        return (own, *variants, *self.others)


def ports(inputs: Iterable[Input], values: Values | None) -> list[tuple[str, str, Array]]:
    """Paths and types of inputs, and their values or those of a document."""
    return [
        (each.name, each.type, np.broadcast_to(value, COMPONENTS[each.type]))
        for each in inputs
        for value in [(values or {}).get(each.name, each.default)]
    ]


ARGUMENTS = 1 << 14  # of a function that is measured


@dataclass(frozen=True)
class EngineFunction:
    """A function that engines have themselves."""

    name: str  # in GLSL, of x or of x and y
    expression: str
    exact: Callable[..., Array]  # the same in NumPy

    def errors(self, host: Host, *arguments: Array) -> Array:
        """Errors of a host's values of arguments that are float32 numbers, (N,)."""
        function = f"mxeon_{self.name}"
        parameters = ", ".join(f"float {name}" for name in "xy"[: len(arguments)])
        text = f"float {function}({parameters})\n{{\n    return {self.expression};\n}}\n"
        values = host.execute(text, function, *arguments)[:, 0]
        return np.abs(values - self.exact(*arguments))

    def error(
        self, arguments: Callable[[], Sequence[Array]], allowed: float = 1.0
    ) -> Callable[[Host], float]:
        """What measures a host's largest error of some arguments, beyond so many roundings of 1."""
        return lambda host: max(
            float(self.errors(host, *arguments()).max()) - allowed * ROUNDING, 0.0
        )


POWER = EngineFunction("power", "pow(x, y)", np.power)
EXPONENTIAL = EngineFunction("exponential", "exp(-x)", lambda x: np.exp(-x))
LOGARITHM = EngineFunction("logarithm", "log(x)", np.log)
WAVE = EngineFunction("wave", "max(cos(x), sin(x))", lambda x: np.maximum(np.cos(x), np.sin(x)))
TURN = EngineFunction(
    "turn",
    "max(abs(cos(6.28318530718 * x)), abs(sin(6.28318530718 * x)))",
    lambda x: np.maximum(np.abs(np.cos(2.0 * np.pi * x)), np.abs(np.sin(2.0 * np.pi * x))),
)
