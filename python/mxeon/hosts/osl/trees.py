# SPDX-License-Identifier: Apache-2.0
"""Printed labels of closures as trees: rows that only differ in numbers share one tree of arrays."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.osl.carriers import CLOSURES, MIX, MULTIPLE, OPERATIONS
from mxeon.hosts.osl.points import Column

Array: TypeAlias = NDArray[np.float64]
Argument: TypeAlias = "Array | str | ClosureTree | None"  # None is the closure without light

DEEPEST = 200  # closures inside each other
LONGEST = 1 << 20  # characters of a label with all that it names
LABEL = re.compile(r"@-?\d+")
NUMBER = re.compile(r"(?<=[<| ])-?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|nan|inf)(?=[>| ])")
TOKEN = re.compile(r"(\w+)<|(#(?: #)*)|'([^'<>|]*)'|([|>])")


@dataclass(frozen=True)
class ClosureTree:
    """A closure, or an operation on closures, at some points."""

    name: str  # in CLOSURES or in OPERATIONS
    parts: tuple[ClosureTree | None, ...] = ()  # what an operation combines
    # By name, (N,) or (N, 3); of an operation its `factor` alone.
    arguments: Mapping[str, Array | str] = field(default_factory=dict)


@dataclass(frozen=True)
class TreeRows:
    """The points, by number, at which a shader makes closures of one shape."""

    rows: NDArray[np.intp]
    tree: ClosureTree | None


def whole_label(texts: Mapping[str, str], root: str) -> str:
    """Text of a label, with every label in it replaced by its own text."""
    text = texts[root]
    for _ in range(DEEPEST):
        text, labels = LABEL.subn(lambda match: texts[match[0]], text)
        if not labels:
            return text
        if len(text) > LONGEST:
            break
    raise NotRun(f"osl: closures must be less than {DEEPEST} deep and {LONGEST} characters long")


def read_trees(labels: Sequence[str]) -> tuple[TreeRows, ...]:
    """Trees of labels, one per shape; ShaderError for closures that OSL does not document."""
    shapes: dict[str, list[int]] = {}
    numbers = []
    for row, label in enumerate(labels):
        shapes.setdefault(NUMBER.sub("#", label), []).append(row)
        numbers.append(NUMBER.findall(label))
    return tuple(
        # Nine digits are a float32.
        TreeRows(np.array(rows), _tree(shape, np.array([numbers[row] for row in rows], np.float32)))
        for shape, rows in shapes.items()
    )


def with_roots(tree: ClosureTree | None) -> ClosureTree | None:
    """A tree whose Zeltner sheens have the root of their roughness, a float32 as the closure takes it."""
    if tree is None:
        return None
    arguments = dict(tree.arguments)
    mode = arguments.get("mode")
    if tree.name == "sheen_bsdf" and isinstance(mode, np.ndarray):
        rough = np.asarray(arguments["roughness"], np.float64)
        root = np.sqrt(rough).astype(np.float32).astype(np.float64)
        arguments["roughness"] = np.where(mode == 0.0, rough, root)
    return ClosureTree(tree.name, tuple(map(with_roots, tree.parts)), arguments)


def _tree(shape: str, numbers: Array) -> ClosureTree | None:
    """Tree of a label with placeholders for the numbers, which differ from point to point."""
    numbers = numbers.astype(np.float64)
    columns = iter(range(numbers.shape[1])) if numbers.size else count()
    stack: list[tuple[str, list[Argument]]] = [("", [])]
    expected = "closure"
    position = 0
    while position < len(shape):
        token = TOKEN.match(shape, position)
        if token is None:
            raise ShaderError(_unreadable(shape[position:]))
        name, values, text, mark = token.groups()
        position = token.end()
        if name:
            stack.append((name, []))
            expected = "closure"
        elif values:
            rows = numbers[:, [next(columns) for _ in range(values.count("#"))]]
            stack[-1][1].append(rows[:, 0] if rows.shape[1] == 1 else rows)
            expected = ""
        elif text is not None:
            stack[-1][1].append(text)
            expected = ""
        # An argument that is empty is the closure without light.
        elif (
            mark
            and expected
            and not (mark == ">" and not stack[-1][1] and stack[-1][0] in CLOSURES)
        ):
            stack[-1][1].append(None)
        if mark == "|":
            expected = "closure"
        if mark == ">":
            name, arguments = stack.pop()
            stack[-1][1].append(_closure(name, arguments))
            expected = ""
    [root] = stack[0][1] or [None]
    assert root is None or isinstance(root, ClosureTree)
    return root


def _closure(name: str, values: Iterable[Argument]) -> ClosureTree:
    """ClosureTree or operation with its arguments by name."""
    # An operation and what it combines.
    values = list(values)
    if name in OPERATIONS:
        factor = [each for each in values if isinstance(each, np.ndarray)]
        parts = tuple(each for each in values if each is None or isinstance(each, ClosureTree))
        assert bool(factor) == (name in (MIX, MULTIPLE))
        return ClosureTree(name, parts, {"factor": factor[0]} if factor else {})
    if name not in CLOSURES:
        raise ShaderError(_unreadable(name))
    # A closure: its arguments in their order, then pairs of keywords and values.
    signature = CLOSURES[name]
    plain = [each for each in values if isinstance(each, (np.ndarray, str))]
    arguments = dict(zip(signature.arguments, plain, strict=False))
    pairs = plain[len(signature.arguments) :]
    for keyword, value in zip(pairs[::2], pairs[1::2], strict=True):
        assert isinstance(keyword, str)
        if keyword not in (*signature.keywords, "label"):
            known = ", ".join((*signature.keywords, "label"))
            raise ShaderError(f"osl: keyword of {name} must be one of {known}; got {keyword!r}")
        arguments[keyword] = value
    return ClosureTree(name, (), arguments)


def _unreadable(text: str) -> str:
    return f"osl: closure must be one of {', '.join(CLOSURES)}; got {text[:60]!r}"


VIEWED = re.compile(r"\bI\b")  # a text that reads the view
MOST = 1 << 16  # points of a shader


class KeptTrees:
    """A cache of the closures that one shader makes, by the values of all variables of a point.

    Light does not change which closures a shader makes, and most texts do not read the view either. So a
    check of other lights, or of some of the points of another check, runs nothing.
    """

    def __init__(self) -> None:
        self._trees: dict[str, ClosureTree | None] = {}  # one of each shape
        self._counts: dict[str, int] = {}  # of their points
        self._places: dict[bytes, tuple[str, int]] = {}  # shape of a point's tree, and row in it

    def missing(self, keys: Sequence[bytes]) -> NDArray[np.intp]:
        """Rows of the points that are not cached, one of each kind; a full cache is emptied first."""
        if len(self._places) > MOST:
            for each in (self._trees, self._counts, self._places):
                each.clear()
        rows = {key: row for row, key in enumerate(keys) if key not in self._places}
        return np.array([*rows.values()], np.intp)

    def add(self, keys: Sequence[bytes], found: Sequence[TreeRows]) -> None:
        for each in found:
            shape = _shape(each.tree)
            first = self._counts.get(shape, 0)
            known = self._trees.get(shape)
            self._trees[shape] = each.tree if known is None else _joined(known, each.tree)
            self._counts[shape] = first + len(each.rows)
            self._places |= {keys[row]: (shape, first + n) for n, row in enumerate(each.rows)}

    def of(self, keys: Sequence[bytes]) -> tuple[TreeRows, ...]:
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
    """What the closures of each point depend on: the values of all variables, and the view if it is read."""
    read = [*columns.values(), *([view] if VIEWED.search(text) else [])]
    values = [np.broadcast_to(each.rows, (count, each.rows.shape[1])) for each in read]
    return [row.tobytes() for row in np.concatenate(values, axis=1)]


def _shape(tree: ClosureTree | None) -> str:
    """What trees must have in common to be merged: everything but their numbers."""
    if tree is None:
        return ""
    arguments = (f"{k}={v}" if isinstance(v, str) else k for k, v in tree.arguments.items())
    return f"{tree.name}<{'|'.join(map(_shape, tree.parts))};{'|'.join(arguments)}>"


def _some(tree: ClosureTree | None, rows: NDArray[np.intp]) -> ClosureTree | None:
    if tree is None:
        return None
    arguments = {k: v if isinstance(v, str) else v[rows] for k, v in tree.arguments.items()}
    return ClosureTree(tree.name, tuple(_some(part, rows) for part in tree.parts), arguments)


def _joined(first: ClosureTree | None, second: ClosureTree | None) -> ClosureTree | None:
    if first is None or second is None:
        return None
    arguments = {
        k: v if isinstance(v, str) else np.concatenate([v, second.arguments[k]])
        for k, v in first.arguments.items()
    }
    parts = map(_joined, first.parts, second.parts)
    return ClosureTree(first.name, tuple(parts), arguments)
