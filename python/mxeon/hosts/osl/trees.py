# SPDX-License-Identifier: Apache-2.0
"""Printed closures as trees. Closures that differ only in numbers share a tree of arrays."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.osl.carriers import CLOSURES, OPERATIONS

Array: TypeAlias = NDArray[np.float64]

DEEPEST = 200  # maximum nesting of closures
LONGEST = 1 << 20  # maximum number of characters in an expanded label
LABEL = re.compile(r"@-?\d+")
NUMBER = re.compile(r"(?<=[\[,])-?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|nan|inf)(?=[\],])")
PLACEHOLDER = re.compile(r"(?<=[\[,])#")  # matches a # that stands for a number


@dataclass(frozen=True)
class ClosureTree:
    """A closure, or an operation on closures, at some points."""

    name: str  # key of CLOSURES or OPERATIONS
    parts: tuple[ClosureTree | None, ...] = ()  # operands of an operation
    # Values of arguments by name, (N,) or (N, 3). The only argument of an operation is `factor`.
    arguments: Mapping[str, Array | str] = field(default_factory=dict)


@dataclass(frozen=True)
class TreeRows:
    """A tree of closures, and the rows of the points that share the tree."""

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
    """One tree per structure of labels. Raises ShaderError for an undocumented closure."""
    shapes: dict[str, list[int]] = {}
    numbers = []
    for row, label in enumerate(labels):
        shapes.setdefault(NUMBER.sub("#", label), []).append(row)
        numbers.append(NUMBER.findall(label))
    trees = []
    for shape, rows in shapes.items():
        # Numbers have nine digits, which determine a float32.
        values = np.array([numbers[row] for row in rows], np.float32).astype(np.float64)
        columns = count()
        text = PLACEHOLDER.sub(lambda _: str(next(columns)), shape)  # noqa: B023, used at once
        try:
            trees.append(TreeRows(np.array(rows), _tree(json.loads(text), values)))
        except json.JSONDecodeError as error:
            rule = f"osl: closure must be one of {', '.join(CLOSURES)}"
            raise ShaderError(f"{rule}; got {text[error.pos :][:60]!r}") from None
    return tuple(trees)


def _tree(label: Any, numbers: Array) -> ClosureTree | None:
    """Tree of a label. Each number in the label is the index of a column of `numbers`."""
    if label is None:
        return None
    name, *values = label
    if name in OPERATIONS:
        parts = [each for each in values if each is None or _is_closure(each)]
        factors = [numbers[:, each] for each in values if each not in parts]
        operands = tuple(_tree(each, numbers) for each in parts)
        return ClosureTree(name, operands, {"factor": factors[0]} if factors else {})
    # Pairs of keywords and values follow the positional arguments of a closure.
    signature, known = CLOSURES[name], (*CLOSURES[name].keywords, "label")
    positional = len(signature.arguments)
    keywords = values[positional::2]
    for keyword in keywords:
        if keyword not in known:
            rule = f"keyword of {name} must be one of {', '.join(known)}"
            raise ShaderError(f"osl: {rule}; got {keyword!r}")
    values = values[:positional] + values[positional + 1 :: 2]
    arguments = {
        argument: value if isinstance(value, str) else numbers[:, value]
        for argument, value in zip((*signature.arguments, *keywords), values, strict=True)
    }
    return ClosureTree(name, (), arguments)


def _is_closure(label: Any) -> bool:
    return isinstance(label, list) and isinstance(label[0], str)
