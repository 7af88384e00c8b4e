# SPDX-License-Identifier: Apache-2.0
"""Closures of points that are kept, since the checks of a node ask for many of them again.

Light does not change which closures a shader makes, and most texts do not read the view either. So a check
of other lights, or of some of the points of another check, runs nothing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.osl.points import Column
from mxeon.hosts.osl.trees import ClosureTree, TreeRows

VIEWED = re.compile(r"\bI\b")  # a text that reads the view
MOST = 1 << 16  # points of a shader


class KeptTrees:
    """Closures that one shader makes, by the values of all variables of a point."""

    def __init__(self) -> None:
        self._trees: dict[str, ClosureTree | None] = {}  # one of each shape
        self._counts: dict[str, int] = {}  # of their points
        self._places: dict[bytes, tuple[str, int]] = {}  # shape of a point's tree, and row in it

    def missing(self, keys: Sequence[bytes]) -> NDArray[np.intp]:
        """Rows of the points that are not kept, one of each kind; too many are forgotten first."""
        if len(self._places) > MOST:
            for each in (self._trees, self._counts, self._places):
                each.clear()
        rows = {key: row for row, key in enumerate(keys) if key not in self._places}
        return np.array([*rows.values()], np.intp)

    def add(self, keys: Sequence[bytes], found: Sequence[TreeRows]) -> None:
        """Keep the closures of points, each beside the others of its shape."""
        for each in found:
            shape = _shape(each.tree)
            first = self._counts.get(shape, 0)
            known = self._trees.get(shape)
            self._trees[shape] = each.tree if known is None else _joined(known, each.tree)
            self._counts[shape] = first + len(each.rows)
            self._places |= {keys[row]: (shape, first + n) for n, row in enumerate(each.rows)}

    def of(self, keys: Sequence[bytes]) -> tuple[TreeRows, ...]:
        """Closures of points that are kept."""
        rows: dict[str, list[tuple[int, int]]] = {}
        for row, key in enumerate(keys):
            shape, place = self._places[key]
            rows.setdefault(shape, []).append((row, place))
        return tuple(
            TreeRows(places[:, 0], _some(self._trees[shape], places[:, 1]))
            for shape, found in rows.items()
            for places in [np.array(found, np.intp)]
        )


def keys_of(text: str, columns: Mapping[str, Column], view: Column, count: int) -> list[bytes]:
    """What the closures of each point depend on: the values of all variables, of which the view may be one."""
    read = [*columns.values(), *([view] if VIEWED.search(text) else [])]
    values = [np.broadcast_to(each.rows, (count, each.rows.shape[1])) for each in read]
    return [row.tobytes() for row in np.concatenate(values, axis=1)]


def _shape(tree: ClosureTree | None) -> str:
    """What trees must have in common to be one: all but their numbers."""
    if tree is None:
        return ""
    arguments = (f"{k}={v}" if isinstance(v, str) else k for k, v in tree.arguments.items())
    return f"{tree.name}<{'|'.join(map(_shape, tree.parts))};{'|'.join(arguments)}>"


def _some(tree: ClosureTree | None, rows: NDArray[np.intp]) -> ClosureTree | None:
    """A tree at some of its points."""
    if tree is None:
        return None
    arguments = {k: v if isinstance(v, str) else v[rows] for k, v in tree.arguments.items()}
    return ClosureTree(tree.name, tuple(_some(part, rows) for part in tree.parts), arguments)


def _joined(first: ClosureTree | None, second: ClosureTree | None) -> ClosureTree | None:
    """A tree at the points of two of one shape."""
    if first is None or second is None:
        return None
    arguments = {
        k: v if isinstance(v, str) else np.concatenate([v, second.arguments[k]])
        for k, v in first.arguments.items()
    }
    parts = map(_joined, first.parts, second.parts)
    return ClosureTree(first.name, tuple(parts), arguments)
