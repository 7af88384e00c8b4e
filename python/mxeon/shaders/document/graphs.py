# SPDX-License-Identifier: Apache-2.0
"""Directed graphs as mappings from each key to its parts, walked without recursion."""

from collections.abc import Callable, Hashable, Iterable, Mapping
from graphlib import TopologicalSorter
from typing import TypeVar

Key = TypeVar("Key", bound=Hashable)
Graph = Mapping[Key, Iterable[Key]]


def reachable(
    roots: Iterable[Key], parts: Callable[[Key], Iterable[Key] | None]
) -> dict[Key, tuple[Key, ...]]:
    """Graph of all keys that the roots lead to.

    Parameters
    ----------
    roots : iterable of hashable
    parts : callable
        Parts of a key; None where it has none.

    Examples
    --------
    >>> reachable("a", {"a": "bc", "b": "c", "d": "a"}.get)
    {'a': ('b', 'c'), 'c': (), 'b': ('c',)}
    """
    graph: dict[Key, tuple[Key, ...]] = {}
    waiting = list(roots)
    while waiting:
        key = waiting.pop()
        if key not in graph:
            graph[key] = tuple(parts(key) or ())
            waiting += graph[key]
    return graph


def parts_first(graph: Graph[Key]) -> tuple[Key, ...]:
    """Keys of a graph, each after its parts.

    Raises
    ------
    graphlib.CycleError
        If a key leads back to itself; its second argument holds the cycle.
    """
    return tuple(TopologicalSorter(graph).static_order())


def heights(graph: Graph[Key], order: Iterable[Key]) -> dict[Key, int]:
    """Number of keys on the longest path from each key to one without parts, both included.

    Parameters
    ----------
    graph : mapping of key to keys
    order : iterable of key
        As `parts_first` returns it.
    """
    height: dict[Key, int] = {}
    for key in order:
        height[key] = 1 + max((height[part] for part in graph[key]), default=0)
    return height
