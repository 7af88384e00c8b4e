# SPDX-License-Identifier: Apache-2.0
"""Small LRU caches. The key of a cached value consists of the numbers that determine the value.

Checks, negative controls and libraries share many values. Batches are compared by a hash of their
numbers, because hashing takes less time than evaluating a model or a shader.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

import numpy as np

from mxeon.conformance.samples import Array, Batch

LARGEST = 1 << 14  # maximum number of pairs in a batch whose values are cached
KEPT = 32  # maximum number of cached batches of a function, up to 400 kB each
EVALUATIONS = 16  # maximum number of cached batches of a host's values, up to 3.5 MB each
T = TypeVar("T")


class Recent(Generic[T]):
    """An LRU cache of up to `size` values. Cached arrays are read-only."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._values: OrderedDict[Hashable, T] = OrderedDict()

    def value(self, key: Hashable, compute: Callable[[], T]) -> T:
        if key not in self._values:
            value = self._values[key] = compute()
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
        self._values.move_to_end(key)
        if len(self._values) > self._size:
            self._values.popitem(last=False)
        return self._values[key]


def contents(value: object) -> Hashable:
    """A key for an array (type, shape and a 64-bit hash), a number, a string or None."""
    if value is None or isinstance(value, (str, bool)):
        return value
    array = np.asarray(value)
    return array.dtype.str, array.shape, hash(array.tobytes())


def remembered(function: Callable[[Batch], Array]) -> Callable[[Batch], Array]:
    """The given function, with a cache for the values of small batches."""
    cache = Recent[Array](KEPT)

    def cached(batch: Batch) -> Array:
        if len(batch.wo) > LARGEST:
            return function(batch)
        return cache.value((batch.scene, *parts(batch)), lambda: function(batch))

    return cached


def parts(batch: Batch) -> tuple[Hashable, ...]:
    """A key for the directions, frames and inputs of a batch."""
    inputs = tuple((name, contents(values)) for name, values in batch.inputs.items())
    return contents(batch.wo), contents(batch.wi), contents(batch.frame), inputs
