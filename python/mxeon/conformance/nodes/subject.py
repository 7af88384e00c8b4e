# SPDX-License-Identifier: Apache-2.0
"""What is judged, as plans, probes and pages see it: a node in one mode, with its model."""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

import numpy as np

from mxeon.conformance.samples.batch import Array, Batch, Candidate, Changes, Values


class Subject(Protocol):
    """A node in one of its modes."""

    @property
    def title(self) -> str: ...  # name in reports, which no other subject has
    @property
    def node(self) -> str: ...  # category of the node
    # Name of the model that it has to be: checks list the models that they hold for.
    @property
    def model(self) -> str: ...
    @property
    def kind(self) -> str: ...  # kind of its probe on a host that evaluates pairs of directions
    @property
    def libraries(self) -> tuple[str, ...]: ...  # the libraries with which it is judged; () for all
    @property
    def closure(self) -> bool: ...  # whether eonlib leaves it to a renderer's own closures, in OSL

    def document(self, inputs: Values | None = None) -> str:
        """MaterialX text of a material that shows this node alone, with these inputs."""
        ...

    def __hash__(self) -> int:
        """Hash of what it consists of, by which its expected values are kept."""
        ...


@runtime_checkable
class ValuedSubject(Subject, Protocol):
    """A node that gives values: light that it scatters or emits, or an output."""

    @property
    def inputs(self) -> tuple[str, ...]: ...  # names of its inputs
    # For each input: inputs without and with a change of it alone, which must be seen.
    @property
    def changes(self) -> Mapping[str, Changes]: ...
    # Functions that may explain its values, its own model first.
    @property
    def value_candidates(self) -> tuple[Candidate, ...]: ...

    def expected(self, batch: Batch) -> Array:
        """Values that a right shader has, (N, 3)."""
        ...


@runtime_checkable
class LobeSubject(ValuedSubject, Protocol):
    """A node that scatters light."""

    # Inputs with which it scatters nothing; none where it always scatters some light.
    @property
    def black(self) -> Values: ...
    # Functions that may explain its directional albedo, its own model first.
    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]: ...

    def albedo(self, batch: Batch) -> Array:
        """Directional albedo that a right shader has, (N, 3)."""
        ...

    def sky(self, batch: Batch) -> Array:
        """Mean of the uneven sky that a right shader scatters, (N, 3)."""
        ...


class DrawnSubject(LobeSubject, Protocol):
    """A lobe whose inputs can be drawn at random, for pairs of directions."""

    def with_flag(self, inputs: Values) -> Values:
        """Inputs with those that select the subject's mode, unless they set them."""
        ...

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values of its inputs, float32 numbers."""
        ...

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values of which half lie on an edge of their range."""
        ...
