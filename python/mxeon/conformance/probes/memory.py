# SPDX-License-Identifier: Apache-2.0
"""Functions of batches that keep what they computed: a check, its control, other checks and libraries ask again.

Batches are the same whose numbers are: to read them takes less time than to compute their values.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import lru_cache

import numpy as np

from mxeon.conformance.nodes.subject import LobeSubject, ValuedSubject
from mxeon.conformance.samples.batch import Array, Batch, Candidate

LARGEST = 1 << 14  # pairs of a batch whose values are kept
KEPT = 32  # batches whose values are kept, of up to 400 kB each
EVALUATIONS = 16  # batches of a probe whose values are kept, of up to 3.5 megabytes each
KEPT_SUBJECTS = 2  # whose expected values are kept: that of a probe, and another that it asks


class Remembered:
    """A function of batches whose values of a few of them are kept, and cannot be written.

    Parameters
    ----------
    function : callable (batch) -> ndarray, shape (N, 3)
    """

    def __init__(self, function: Callable[[Batch], Array]) -> None:
        self._function = function
        self._known = Known(KEPT)

    def __call__(self, batch: Batch) -> Array:
        """Its values of a batch."""
        if len(batch.wo) > LARGEST:
            return self._function(batch)
        return self._known.values((batch.scene, *_parts(batch)), lambda: self._function(batch))


class Evaluations:
    """Cache of the values that a host has for batches; read-only; the least recently used are dropped."""

    def __init__(self) -> None:
        self._known = Known(EVALUATIONS)

    def values(
        self, batch: Batch, rest: tuple[object, ...], evaluate: Callable[[], Array]
    ) -> Array:
        """Values of a batch, which are computed unless they are known.

        Parameters
        ----------
        batch : Batch
        rest : tuple
            What else the values depend on: arrays, numbers, strings, or None.
        evaluate : callable () -> ndarray, shape (N, 3)
        """
        return self._known.values((*_parts(batch), *map(_contents, rest)), evaluate)


class Known:
    """Values by what they depend on; so many of them, those that were asked for last."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._values: OrderedDict[Hashable, Array] = OrderedDict()

    def values(self, key: Hashable, compute: Callable[[], Array]) -> Array:
        """The values of a key, read-only, which are computed unless they are known."""
        if key not in self._values:
            self._values[key] = compute()
            self._values[key].setflags(write=False)
        # Forget what was not asked for longest.
        self._values.move_to_end(key)
        if len(self._values) > self._most:
            self._values.popitem(last=False)
        return self._values[key]


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
    inputs = tuple((name, _contents(values)) for name, values in batch.inputs.items())
    return _contents(batch.wo), _contents(batch.wi), _contents(batch.frame), inputs


def _contents(value: object) -> Hashable:
    """What tells an array, a word or None from others: of an array type, shape and a hash of 64 bits."""
    if value is None or isinstance(value, (str, bool)):
        return value
    array = np.asarray(value)
    return array.dtype.str, array.shape, hash(array.tobytes())
