# SPDX-License-Identifier: Apache-2.0
"""Evaluates a single expression in MDL or MSL in float64.

No code is executed. A few substitutions turn the expression into Python, `ast` parses the Python
text, and a walk over a few kinds of syntax nodes computes the value. Statements, loops, attributes
and subscripts are refused, so the work is linear in the length of the expression. A number is an
array of shape (N, 1), and a color or a vector is an array of shape (N, 3). Integers stay integers.
"""

import ast
import keyword
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun, ShaderError
from mxeon.shaders.closure_calls import COMMENT

Array = NDArray[Any]  # float64, int64 or bool
LONGEST = 10_000  # characters; the libraries' expressions have up to 700
# Matches text that only Python accepts: Python's keywords and operators, `=` for named arguments,
# and comments.
FOREIGN = re.compile(
    rf"\b(?:{'|'.join(keyword.kwlist)})\b|\*\*|[#@%\\'`\[\]{{}}]|(?<![<>=!])=(?!=)|[^\x20-\x7e]"
)
PYTHON = (
    (r"::", "__"),
    (r"(?<=[(,]) *(\w+) *:", r"\1="),  # a named argument
    (r"\?", " if "),  # `a ? b : c` becomes `a if b else c`, where `a` is the condition
    (r":", " else "),
    (r"!(?!=)", "~"),
    (r"\b((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)f\b", r"\1"),
)


def _divided(left: Array, right: Array) -> Array:
    whole = left.dtype.kind == right.dtype.kind == "i"
    return np.trunc(left / right).astype(np.int64) if whole else left / right


def _triple(*values: Array) -> Array:
    """A color or vector from a number, a color or three numbers."""
    if len(values) not in (1, 3):
        raise TypeError(f"a color takes one number or three; got {len(values)}")
    return np.concatenate(np.broadcast_arrays(*values), axis=1) * np.ones((1, 3))


OPERATORS: Mapping[type[ast.AST], Callable[[Any, Any], Any]] = {
    **{ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: _divided},
    **{ast.Lt: operator.lt, ast.Gt: operator.gt, ast.LtE: operator.le, ast.GtE: operator.ge},
    **{ast.Eq: operator.eq, ast.NotEq: operator.ne},
}
KNOWN: Mapping[str, Any] = {
    **{"true": np.array([[1]]), "false": np.array([[0]]), "math__PI": np.array([[np.pi]])},
    **dict.fromkeys(("color", "float3"), _triple),
}


def evaluate(text: str, names: Mapping[str, Any]) -> Any:
    """Value of an expression with the variables and functions in `names` and KNOWN.

    Raises ShaderError for invalid expressions, and NotRun for unsupported expressions.
    """
    text = " ".join(COMMENT.sub(" ", text).split())
    if len(text) > LONGEST:
        raise NotRun(f"an expression must have at most {LONGEST} characters; got {len(text)}")
    if foreign := FOREIGN.search(text):
        raise NotRun(f"{foreign[0]!r} in an expression is not supported")
    for pattern, replacement in PYTHON:
        text = re.sub(pattern, replacement, text)
    known = {**KNOWN, **{name.replace("::", "__"): value for name, value in names.items()}}
    try:
        with np.errstate(all="ignore"):
            return _value(ast.parse(text.strip(), mode="eval").body, known)
    except (RecursionError, MemoryError):
        raise NotRun("an expression must be nested less deeply") from None
    except (SyntaxError, AttributeError, OverflowError, TypeError, ValueError) as error:
        raise ShaderError(f"the expression of the lobe is wrong: {error.args[0]}") from None


def _value(node: ast.expr, names: Mapping[str, Any]) -> Any:
    match node:
        case ast.Constant(value=str(value)):
            return value
        case ast.Constant(value=int(value) | float(value)):
            return np.array([[value]], np.int64 if isinstance(value, int) else np.float64)
        case ast.Name(id=name):
            if name not in names:
                raise ShaderError(f"{_spelled(name)} is not defined")
            return names[name]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return 0 - _value(operand, names)
        case ast.UnaryOp(op=ast.Invert(), operand=operand):
            return _value(operand, names) == 0
        case (
            ast.BinOp(left=left, op=operation, right=right)
            | ast.Compare(left=left, ops=[operation], comparators=[right])
        ) if type(operation) in OPERATORS:
            return OPERATORS[type(operation)](_value(left, names), _value(right, names))
        case ast.IfExp(body=condition, test=yes, orelse=no):
            truth = _value(condition, names) != 0
            chosen = _value(yes, names), _value(no, names)
            return (
                chosen[not truth.all()] if truth.all() == truth.any() else np.where(truth, *chosen)
            )
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=keywords):
            function = _function(name, names)
            positional = [_value(each, names) for each in arguments]
            return function(*positional, **{str(k.arg): _value(k.value, names) for k in keywords})
    raise NotRun(f"{type(node).__name__} in an expression is not supported")


def _function(name: str, names: Mapping[str, Any]) -> Callable[..., Any]:
    if callable(names.get(name)):
        return names[name]  # type: ignore[no-any-return]
    if name.rpartition("__")[0] not in ("", "df"):
        raise NotRun(f"function {_spelled(name)} is not supported")
    known = ", ".join(_spelled(each) for each in names if callable(names[each]))
    raise ShaderError(f"function {_spelled(name)} is unknown; known are {known}")


def _spelled(name: str) -> str:
    return name.replace("__", "::")
