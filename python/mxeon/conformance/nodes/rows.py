# SPDX-License-Identifier: Apache-2.0
"""Base class of subjects that are a row of `mxeon.models.nodes`."""

from collections.abc import Mapping
from functools import partial
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np

from mxeon.conformance.nodes.ports import Port, changes, draw, draw_edges, materials
from mxeon.conformance.samples.batch import Array, Batch, Candidate, Changes, Values
from mxeon.models.nodes.node import Function, Variant

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
        """Inputs of the two materials that stand for it in pictures."""
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
