# SPDX-License-Identifier: Apache-2.0
"""Caches of values by batch: a check, its control, other checks and libraries ask for the same ones.

Batches are equal if their numbers are: reading them takes less time than computing their values.
"""

from collections.abc import Callable, Hashable
from functools import lru_cache

from mxeon.conformance.cache import Recent, contents
from mxeon.conformance.samples import Array, Batch, Candidate
from mxeon.conformance.spec import LobeSpec, ValueSpec

LARGEST = 1 << 14  # pairs of a batch whose values are kept
KEPT = 32  # batches whose values are kept, of up to 400 kB each
EVALUATIONS = 16  # batches whose values of a host are kept, of up to 3.5 megabytes each
KEPT_SPECS = 2  # whose expected values are kept: that of a case, and another that it asks


class Remembered:
    """A function of batches that caches a few of its values, which are read-only."""

    def __init__(self, function: Callable[[Batch], Array]) -> None:
        self._function = function
        self._known = Recent[Array](KEPT)

    def __call__(self, batch: Batch) -> Array:
        if len(batch.wo) > LARGEST:
            return self._function(batch)
        key = batch.scene, *_parts(batch)
        return self._known.value(key, lambda: _read_only(self._function(batch)))


class Evaluations:
    """A cache of the values that a host returns for batches; they are read-only."""

    def __init__(self) -> None:
        self._known = Recent[Array](EVALUATIONS)

    def values(
        self, batch: Batch, rest: tuple[object, ...], evaluate: Callable[[], Array]
    ) -> Array:
        key = *_parts(batch), *map(contents, rest)
        return self._known.value(key, lambda: _read_only(evaluate()))


@lru_cache(maxsize=KEPT_SPECS)
def value_of(spec: ValueSpec) -> Remembered:
    return Remembered(spec.value)


@lru_cache(maxsize=KEPT_SPECS)
def albedo_of(spec: LobeSpec) -> Remembered:
    return Remembered(spec.albedo)


@lru_cache(maxsize=KEPT_SPECS)
def albedo_candidates(spec: LobeSpec) -> tuple[Candidate, ...]:
    """The candidates of a spec's albedo, whose values several comparisons ask for."""
    return tuple(
        Candidate(each.title, Remembered(each.values), each.permitted)
        for each in spec.albedo_candidates
    )


def _parts(batch: Batch) -> tuple[Hashable, ...]:
    """A key for a batch, but for its scene."""
    inputs = tuple((name, contents(values)) for name, values in batch.inputs.items())
    return contents(batch.wo), contents(batch.wi), contents(batch.frame), inputs


def _read_only(values: Array) -> Array:
    values.setflags(write=False)
    return values
