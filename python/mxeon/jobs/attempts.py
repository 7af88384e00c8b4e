# SPDX-License-Identifier: Apache-2.0
"""Attempts at items that wait for a worker, those of one group for the same one."""

import os
from collections import deque
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Attempt:
    """An attempt at an item, whose worker prints to the file `log`."""

    index: int
    item: object
    group: Hashable = None
    number: int = 1
    log: str = ""

    def logged(self, folder: str) -> "Attempt":
        """The same attempt with a file in a folder."""
        return replace(self, log=os.path.join(folder, f"{self.index}-{self.number}.txt"))


def by_group(groups: Sequence[Hashable]) -> list[int]:
    """Positions of items by their groups, those of one group after each other, in the order of the first.

    >>> by_group(["a", "b", "a"])
    [0, 2, 1]
    """
    first: dict[Hashable, int] = {}
    for position, group in enumerate(groups):
        first.setdefault(group, position)
    return sorted(range(len(groups)), key=lambda position: first[groups[position]])


class Queue:
    """Attempts that wait, by group.

    What the items of a group have in common is then done by one worker once. A worker begins a group
    that no other works on, in the order in which they came, and helps with the longest where there is
    none.
    """

    def __init__(self, attempts: Sequence[Attempt]) -> None:
        self._groups: dict[Hashable, deque[Attempt]] = {}
        self._current: dict[int, Hashable] = {}  # group of each worker
        for attempt in attempts:
            self.put(attempt)

    def put(self, attempt: Attempt) -> None:
        """Let an attempt wait."""
        self._groups.setdefault(attempt.group, deque()).append(attempt)

    def take(self, worker: int) -> Attempt:
        """The next attempt for a worker; there has to be one."""
        if self._current.get(worker) not in self._groups or worker not in self._current:
            others = {group for each, group in self._current.items() if each != worker}
            free = (group for group in self._groups if group not in others)
            longest = max(self._groups, key=lambda group: len(self._groups[group]))
            self._current[worker] = next(free, longest)
        group = self._current[worker]
        attempt = self._groups[group].popleft()
        if not self._groups[group]:
            del self._groups[group]
        return attempt

    def __len__(self) -> int:
        return sum(map(len, self._groups.values()))

    def __iter__(self) -> Iterator[Attempt]:
        for group in self._groups.values():
            yield from group
