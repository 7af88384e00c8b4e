# SPDX-License-Identifier: Apache-2.0
"""Functions of batches that keep what they computed: a check, its control, other checks and libraries ask again.

Batches are the same whose numbers are: to read them takes less time than to compute their values.
"""

from collections.abc import Callable, Hashable
from functools import lru_cache

from mxeon.conformance.nodes.subject import LobeSubject, ValuedSubject
from mxeon.conformance.recent import Recent, contents
from mxeon.conformance.samples.batch import Array, Batch, Candidate

LARGEST = 1 << 14  # pairs of a batch whose values are kept
KEPT = 32  # batches whose values are kept, of up to 400 kB each
EVALUATIONS = 16  # batches of a probe whose values are kept, of up to 3.5 megabytes each
KEPT_SUBJECTS = 2  # whose expected values are kept: that of a probe, and another that it asks


class Remembered:
    """A function of batches whose values of a few of them are kept, and cannot be written."""

    def __init__(self, function: Callable[[Batch], Array]) -> None:
        self._function = function
        self._known = Recent[Array](KEPT)

    def __call__(self, batch: Batch) -> Array:
        if len(batch.wo) > LARGEST:
            return self._function(batch)
        key = batch.scene, *_parts(batch)
        return self._known.value(key, lambda: _read_only(self._function(batch)))


class Evaluations:
    """Cache of the values that a host has for batches; read-only; the least recently used are dropped."""

    def __init__(self) -> None:
        self._known = Recent[Array](EVALUATIONS)

    def values(
        self, batch: Batch, rest: tuple[object, ...], evaluate: Callable[[], Array]
    ) -> Array:
        key = *_parts(batch), *map(contents, rest)
        return self._known.value(key, lambda: _read_only(evaluate()))


@lru_cache(maxsize=KEPT_SUBJECTS)
def expected_of(subject: ValuedSubject) -> Remembered:
    """Values expected of a subject, which are the same whatever the library."""
    return Remembered(subject.expected)


@lru_cache(maxsize=KEPT_SUBJECTS)
def albedo_of(subject: LobeSubject) -> Remembered:
    """Albedos expected of a subject, likewise."""
    return Remembered(subject.albedo)


def remembered(candidate: Candidate) -> Candidate:
    """A candidate that several comparisons may ask for the same values."""
    return Candidate(candidate.title, Remembered(candidate.values), candidate.permitted)


def _parts(batch: Batch) -> tuple[Hashable, ...]:
    """What tells a batch from others, but for its scene."""
    inputs = tuple((name, contents(values)) for name, values in batch.inputs.items())
    return contents(batch.wo), contents(batch.wi), contents(batch.frame), inputs


def _read_only(values: Array) -> Array:
    """The array, which cannot be written any more."""
    values.setflags(write=False)
    return values
