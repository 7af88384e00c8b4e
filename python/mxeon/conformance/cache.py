# SPDX-License-Identifier: Apache-2.0
"""Small LRU caches of values by the numbers that they depend on."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

import numpy as np

T = TypeVar("T")


class Recent(Generic[T]):
    """An LRU cache of at most so many values."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._values: OrderedDict[Hashable, T] = OrderedDict()

    def value(self, key: Hashable, compute: Callable[[], T]) -> T:
        if key not in self._values:
            self._values[key] = compute()
        self._values.move_to_end(key)
        if len(self._values) > self._most:
            self._values.popitem(last=False)
        return self._values[key]


def contents(value: object) -> Hashable:
    """A key for an array, a number, a string or None: of an array type, shape and a hash of 64 bits."""
    if value is None or isinstance(value, (str, bool)):
        return value
    array = np.asarray(value)
    return array.dtype.str, array.shape, hash(array.tobytes())
