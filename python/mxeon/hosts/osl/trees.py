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

Array: TypeAlias = NDArray[np.float64]
Argument: TypeAlias = "Array | str | ClosureTree | None"  # None is the closure without light

DEEPEST = 200  # maximum nesting of closures
LONGEST = 1 << 20  # maximum characters of an expanded label
LABEL = re.compile(r"@-?\d+")
NUMBER = re.compile(r"(?<=[<| ])-?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|nan|inf)(?=[>| ])")
TOKEN = re.compile(r"(\w+)<|(#(?: #)*)|'([^'<>|]*)'|([|>])")


@dataclass(frozen=True)
class ClosureTree:
    """A closure, or an operation on closures, at some points."""

    name: str  # key of CLOSURES or OPERATIONS
    parts: tuple[ClosureTree | None, ...] = ()  # operands of an operation
    # Values by name, (N,) or (N, 3); an operation has only `factor`.
    arguments: Mapping[str, Array | str] = field(default_factory=dict)


@dataclass(frozen=True)
class TreeRows:
    """Rows of the points whose closures have the same shape, and their tree."""

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
