# SPDX-License-Identifier: Apache-2.0
"""Small LRU caches of values, keyed by the numbers that they depend on.

Checks, controls and libraries share many values. Batches are compared by hashing their numbers,
which takes less time than computing their values.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

import numpy as np

from mxeon.conformance.samples import Array, Batch

LARGEST = 1 << 14  # maximum pairs of a cached batch
KEPT = 32  # maximum cached batches, up to 400 kB each
EVALUATIONS = 16  # maximum cached batches of a host's values, up to 3.5 megabytes each
T = TypeVar("T")


class Recent(Generic[T]):
    """An LRU cache of a limited number of values; arrays are read-only."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._values: OrderedDict[Hashable, T] = OrderedDict()

    def value(self, key: Hashable, compute: Callable[[], T]) -> T:
        if key not in self._values:
            found = self._values[key] = compute()
            if isinstance(found, np.ndarray):
                found.setflags(write=False)
        self._values.move_to_end(key)
        if len(self._values) > self._most:
            self._values.popitem(last=False)
        return self._values[key]


def contents(value: object) -> Hashable:
    """A key for an array (type, shape and a 64-bit hash), a number, a string or None."""
    if value is None or isinstance(value, (str, bool)):
        return value
    array = np.asarray(value)
    return array.dtype.str, array.shape, hash(array.tobytes())


class Remembered:
    """A function of batches that caches a few of its values."""

    def __init__(self, function: Callable[[Batch], Array]) -> None:
        self._function = function
        self._known = Recent[Array](KEPT)

    def __call__(self, batch: Batch) -> Array:
        if len(batch.wo) > LARGEST:
            return self._function(batch)
        key = batch.scene, *parts(batch)
        return self._known.value(key, lambda: self._function(batch))


def parts(batch: Batch) -> tuple[Hashable, ...]:
    """A key for a batch, without its scene."""
    inputs = tuple((name, contents(values)) for name, values in batch.inputs.items())
    return contents(batch.wo), contents(batch.wi), contents(batch.frame), inputs
