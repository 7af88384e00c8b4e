# SPDX-License-Identifier: Apache-2.0
"""Printed labels of closures as trees; rows that differ only in numbers share a tree of arrays."""

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

DEEPEST = 200  # nesting of closures
LONGEST = 1 << 20  # characters of an expanded label
LABEL = re.compile(r"@-?\d+")
NUMBER = re.compile(r"(?<=[<| ])-?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|nan|inf)(?=[>| ])")
TOKEN = re.compile(r"(\w+)<|(#(?: #)*)|'([^'<>|]*)'|([|>])")


@dataclass(frozen=True)
class ClosureTree:
    """A closure, or an operation on closures, at some points."""

    name: str  # key of CLOSURES or OPERATIONS
    parts: tuple[ClosureTree | None, ...] = ()  # operands of an operation
    # By name, (N,) or (N, 3); an operation has only `factor`.
    arguments: Mapping[str, Array | str] = field(default_factory=dict)


@dataclass(frozen=True)
class TreeRows:
    """Numbers of the points with the same shape of closures, and their tree."""

    rows: NDArray[np.intp]
    tree: ClosureTree | None


def whole_label(texts: Mapping[str, str], root: str) -> str:
    """Text of a label, with nested labels replaced by their texts."""
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
        # Nine digits restore a float32.
        TreeRows(np.array(rows), _tree(shape, np.array([numbers[row] for row in rows], np.float32)))
        for shape, rows in shapes.items()
    )


def with_roots(tree: ClosureTree | None) -> ClosureTree | None:
    """A tree with the root of the roughness in Zeltner sheens, rounded to float32 like the closure's."""
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
        # An empty argument is the closure without light.
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
    values = list(values)
    if name in OPERATIONS:
        factor = [each for each in values if isinstance(each, np.ndarray)]
        parts = tuple(each for each in values if each is None or isinstance(each, ClosureTree))
        assert bool(factor) == (name in (MIX, MULTIPLE))
        return ClosureTree(name, parts, {"factor": factor[0]} if factor else {})
    if name not in CLOSURES:
        raise ShaderError(_unreadable(name))
    # The arguments of a closure come in order, then pairs of keywords and values.
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


VIEWED = re.compile(r"\bI\b")  # matches texts that read the view
MOST = 1 << 16  # cached points of a shader


class KeptTrees:
    """A cache of one shader's closures by the values of a point's variables.

    Closures do not depend on the light, and mostly not on the view. So checks of other lights, or of the same points,
    run nothing.
    """

    def __init__(self) -> None:
        self._trees: dict[str, ClosureTree | None] = {}  # keys: shapes
        self._counts: dict[str, int] = {}  # points by shape
        self._places: dict[bytes, tuple[str, int]] = {}  # shape of a point's tree, and its row

    def missing(self, keys: Sequence[bytes]) -> NDArray[np.intp]:
        """Rows of distinct points that are not cached; empties a full cache."""
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
    """Keys of each point: the values of all variables, and of the view if the text reads it."""
    read = [*columns.values(), *([view] if VIEWED.search(text) else [])]
    values = [np.broadcast_to(each.rows, (count, each.rows.shape[1])) for each in read]
    return [row.tobytes() for row in np.concatenate(values, axis=1)]


def _shape(tree: ClosureTree | None) -> str:
    """A tree without its numbers, as text; trees of one shape can be merged."""
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
