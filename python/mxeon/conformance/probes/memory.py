# SPDX-License-Identifier: Apache-2.0
"""Functions of batches that keep what they computed: a check, its control and other checks ask for the same."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from hashlib import blake2b

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.samples.batch import Array, Batch

LARGEST = 1 << 14  # pairs of a batch that is kept
KEPT = 32  # batches, of half a megabyte each
NUMBERS = 16  # of an input that is compared by its values and not as an array
EVALUATIONS = 16  # batches of a probe whose values are kept, of up to 3.5 megabytes each


class Remembered:
    """A function of batches whose values of a few of them are kept, and cannot be written.

    Batches are the same whose arrays are: `Batch.altered` keeps those that it does not change.

    Parameters
    ----------
    function : callable (batch) -> ndarray, shape (N, 3)
    """

    def __init__(self, function: Callable[[Batch], Array]) -> None:
        self._function = function
        # With the batches, whose arrays keep their identities as long as they exist.
        self._known: OrderedDict[Hashable, tuple[Batch, Array]] = OrderedDict()

    def __call__(self, batch: Batch) -> Array:
        """Its values of a batch."""
        if len(batch.wo) > LARGEST:
            return self._function(batch)
        # Compute what is not known.
        key = _key(batch)
        if key not in self._known:
            values = self._function(batch)
            values.setflags(write=False)
            self._known[key] = batch, values
        # Forget what was not asked for longest.
        self._known.move_to_end(key)
        if len(self._known) > KEPT:
            self._known.popitem(last=False)
        return self._known[key][1]


def _key(batch: Batch) -> Hashable:
    """What two batches have in common that are the same."""
    inputs = tuple((name, _identity(values)) for name, values in batch.inputs.items())
    return id(batch.wo), id(batch.wi), id(batch.frame), batch.scene, inputs


def _identity(values: ArrayLike) -> Hashable:
    """The numbers of a value of few, and the identity of an array of many."""
    array = np.asarray(values)
    return (array.shape, array.tobytes()) if array.size <= NUMBERS else id(values)


class Evaluations:
    """Cache of the values that a host has for batches; read-only; the least recently used are dropped.

    Batches with the same numbers are the same: to hash these takes less time than the host takes.
    """

    def __init__(self) -> None:
        self._known: OrderedDict[bytes, Array] = OrderedDict()

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
        key = _digest(batch.wo, batch.wi, batch.frame, *batch.inputs.items(), *rest)
        if key not in self._known:
            self._known[key] = evaluate()
            self._known[key].setflags(write=False)
        # Forget what was not asked for longest.
        self._known.move_to_end(key)
        if len(self._known) > EVALUATIONS:
            self._known.popitem(last=False)
        return self._known[key]


def _digest(*parts: object) -> bytes:
    """Digest of arrays, numbers, strings and None; a tuple is the name of a value, and the value."""
    digest = blake2b()
    for part in parts:
        name, value = part if isinstance(part, tuple) else ("", part)
        digest.update(repr(name).encode())
        if value is None or isinstance(value, (str, bool)):
            digest.update(repr(value).encode())
        else:
            array = np.ascontiguousarray(value)
            digest.update(f"{array.dtype} {array.shape}".encode())
            digest.update(array.data)
    return digest.digest()
