# SPDX-License-Identifier: Apache-2.0
"""Base class of subjects that are a row of `mxeon.models.nodes`."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.samples.batch import Array, Batch, Candidate, Changes, Values, float32
from mxeon.conformance.samples.edge_cases import with_edges
from mxeon.models.nodes.node import Function, Variant

COMPONENTS = {"float": (), "vector2": (2,), "vector3": (3,), "color3": (3,)}  # shape by type
CHANGED_COLOR = (0.9, 0.1, 0.6)


@dataclass(frozen=True)
class Port:
    """An input of a node."""

    name: str  # name or path of the input
    kind: str = "float"  # type in MaterialX
    low: ArrayLike = 0.0  # ends of the range of random values, of all components or of each
    high: ArrayLike = 1.0
    edges: tuple[float, ...] = ()  # what half of the special values are; () for none
    # Another value than the default, which must show; None where it shows nothing by itself.
    change: ArrayLike | None = None
    # Other inputs with which the change shows.
    needs: Values = field(default_factory=dict, hash=False)
    # Whether random values are uniform in their logarithm; others have a tenth on either end.
    logarithmic: bool = False
    # What every other random value is: the usual one of an input that is rarely set.
    often: float | None = None
    equal: bool = False  # whether both components are the same in every other random value
    # Values in the two materials that stand for a node in pictures; () for the default.
    materials: tuple[ArrayLike, ...] = ()
    # The variable that a host sets in its place, of an input whose default is one.
    variable: str = ""
    default: ArrayLike = 1.0  # value in a document that has to set it


def color(name: str, *materials: ArrayLike, edges: tuple[float, ...] = (0.0, 1e-3, 1.0)) -> Port:
    return Port(name, "color3", 0.0, 1.0, edges, CHANGED_COLOR, materials=materials)


def draw(rng: np.random.Generator, count: int, ports: Iterable[Port]) -> dict[str, Array]:
    """Random values of ports in their ranges, float32 numbers, by name."""
    return {port.name: _drawn(rng, count, port) for port in ports}


def _drawn(rng: np.random.Generator, count: int, port: Port) -> Array:
    low, high = np.asarray(port.low, np.float64), np.asarray(port.high, np.float64)
    share = rng.random((count, *COMPONENTS[port.kind]))
    if port.logarithmic:
        values = low * (high / low) ** share
    else:
        values = low + (high - low) * np.clip(1.25 * share - 0.125, 0.0, 1.0)
    if port.often is not None:
        values[::2] = port.often
    if port.equal:
        values[::2] = values[::2, :1]
    return float32(values)


def draw_edges(rng: np.random.Generator, count: int, ports: Iterable[Port]) -> dict[str, Array]:
    """Random values of ports, of which half lie on an edge where the port has some."""
    ports = tuple(ports)
    values = draw(rng, count, ports)
    edged = {
        port.name: with_edges(rng, values[port.name], port.edges) for port in ports if port.edges
    }
    return values | edged


def changes(ports: Iterable[Port]) -> dict[str, Changes]:
    """For each port with a change: inputs without and with it alone."""
    return {
        port.name: (port.needs, {**port.needs, port.variable or port.name: port.change})
        for port in ports
        if port.change is not None
    }


def materials(ports: Iterable[Port]) -> tuple[Mapping[str, ArrayLike], ...]:
    return tuple(
        {port.name: port.materials[which] for port in ports if len(port.materials) > which}
        for which in (0, 1)
    )


F = TypeVar("F")  # a function of a row
ZERO = Candidate("zero", lambda batch: np.zeros((len(batch.wo), 3)))


class NodeRow(Protocol[Function]):
    """A row of `mxeon.models.nodes`; see `mxeon.models.nodes.node.Node`."""

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def category(self) -> str: ...
    @property
    def value(self) -> Function: ...
    @property
    def variants(self) -> tuple[Variant[Function], ...]: ...


class RowSubject(Generic[F]):
    """A row, judged with any library: its ports tell what is drawn, its functions what is right."""

    row: NodeRow[F]

    libraries: ClassVar[tuple[str, ...]] = ()

    @property
    def closure(self) -> bool:
        return True

    @property
    def node(self) -> str:
        return self.row.category

    @property
    def model(self) -> str:
        return self.row.name

    @property
    def ports(self) -> tuple[Port, ...]:
        """Its inputs, but those that select a mode."""
        raise NotImplementedError

    @property
    def drawn(self) -> tuple[Port, ...]:
        """Those that its functions read."""
        return self.ports

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(port.name for port in self.ports)

    @property
    def changes(self) -> Mapping[str, Changes]:
        return changes(self.ports)

    @property
    def materials(self) -> tuple[Values, ...]:
        return materials(self.drawn)

    def with_flag(self, inputs: Values) -> Values:
        return inputs

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw(rng, count, self.drawn)

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw_edges(rng, count, self.drawn)

    def values(self, function: F, batch: Batch) -> Array:
        """What a host shows of a function of the row's kind, (N, 3)."""
        raise NotImplementedError

    def expected(self, batch: Batch) -> Array:
        return self.values(self.row.value, batch)

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """The row's own function, its variants, and others."""
        own = Candidate(self.row.title, self.expected)
        variants = (
            Candidate(each.title, partial(self.values, each.value), each.permitted)
            for each in self.row.variants
            if each.value
        )
        return (own, *variants, *self.others)

    @property
    def others(self) -> tuple[Candidate, ...]:
        """What any node may be in place of its model."""
        return (ZERO,)


def broadcast_inputs(batch: Batch) -> dict[str, Array]:
    """The inputs with a row for each pair."""
    count = len(batch.wo)
    return {
        name: np.broadcast_to(values, (count, *np.shape(values)[-1:]))
        if np.shape(values)[:1] != (count,)
        else values
        for name, values in batch.inputs.items()
    }
