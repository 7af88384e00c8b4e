# SPDX-License-Identifier: Apache-2.0
"""Values of MDL's and OSL's arithmetic in float64, and sums of closures.

A number is a column (N, 1), a color or vector rows (N, 3); N rows are N materials at once. A closure
is a name with arguments; a sum of weighted closures is a tuple of them.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.text import syntax
from mxeon.conformance.text.syntax import Unreadable, expression, function_table, macros, statements
from mxeon.errors import NotRun

Array = NDArray[np.float64]
Value: TypeAlias = Any  # Array, str or Closures: the function that takes it knows which

TRIPLES = ("color", "vector", "normal", "vec3", "float3", "point")
SIGNS: Mapping[str, Callable[[Array, Array], Array]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "<": np.less,
    ">": np.greater,
    "<=": np.less_equal,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
    "&&": np.logical_and,
    "||": np.logical_or,
}
MATHEMATICS: Mapping[str, Callable[..., Array]] = {
    "abs": np.abs,
    "clamp": np.clip,
    "cos": np.cos,
    "dot": lambda a, b: np.sum(a * b, axis=1, keepdims=True),
    "max": np.maximum,
    "min": np.minimum,
    "mix": lambda a, b, t: a + (b - a) * t,
    "pow": np.power,
    "radians": np.radians,
    "sqrt": np.sqrt,
}
CONSTANTS = {"math::PI": np.pi, "M_PI": np.pi, "true": 1.0, "false": 0.0}


@dataclass(frozen=True)
class Closure:
    """A closure of a renderer, times a weight."""

    name: str
    weight: Array
    # By name, positions as "0", "1", ...; keywords of OSL as `"keyword"` with its quotes.
    arguments: Mapping[str, Value]


class Interpreter:
    """Evaluates expressions of a text."""

    def __init__(
        self,
        text: str,
        closures: Mapping[str, Callable[[Mapping[str, Value]], tuple[Closure, ...]]],
        variables: Mapping[str, Value] = MappingProxyType({}),
    ) -> None:
        self._text, self._functions, self._macros = text, function_table(text), macros(text)
        self._closures, self._globals = closures, variables

    def value(self, text: str, variables: Mapping[str, Value]) -> Value:
        """Value of the expression that a text is."""
        return self._evaluate(expression(text), variables)

    def call(self, name: str, arguments: list[Value]) -> Value:
        """Value of a function of the text: what it returns, or its one output."""
        if name not in self._functions:
            raise Unreadable(f"function {name} is not defined")
        function = self._functions[name]
        if len(arguments) > len(function.parameters):
            raise Unreadable(f"{name} takes {len(function.parameters)} arguments")
        return self._run(function, arguments)

    def _run(self, function: syntax.Function, arguments: list[Value]) -> Value:
        names = [name for _, name in function.parameters]
        outputs = [name for kind, name in function.parameters if kind.startswith("output ")]
        if len(arguments) != len(names) - len(outputs):
            raise Unreadable(f"{function.name} gets {len(arguments)} arguments")
        variables = dict(zip(names, arguments, strict=False))
        result = self._execute(statements(function.body), variables)
        if result is None and outputs:
            result = variables.get(outputs[0])
        if result is None:
            raise Unreadable(f"{function.name} gives nothing")
        return result

    def _execute(
        self, body: tuple[syntax.Statement, ...], variables: dict[str, Value]
    ) -> Value | None:
        """Value that the body returns; assignments change `variables`."""
        for statement in body:
            if isinstance(statement, syntax.Return):
                return self._evaluate(statement.value, variables)
            if isinstance(statement, syntax.Assignment):
                variables[statement.name] = self._evaluate(statement.value, variables)
            if isinstance(statement, syntax.If):
                taken = statement.yes if self._holds(statement, variables) else statement.no
                result = self._execute(taken, variables)
                if result is not None:
                    return result
        return None

    def _holds(self, statement: syntax.If, variables: Mapping[str, Value]) -> bool:
        """Whether the condition holds, which must be the same for all rows."""
        truth = np.unique(_number(self._evaluate(statement.condition, variables)) != 0.0)
        if len(truth) != 1:
            raise NotRun("a condition differs among the materials")
        return bool(truth[0])

    def _evaluate(self, node: syntax.Expression, variables: Mapping[str, Value]) -> Value:
        match node:
            case syntax.Number(value):
                return np.array([[value]])
            case syntax.Text(value):
                return value
            case syntax.Name(name):
                return self._named(name, variables)
            case syntax.Component(vector, name):
                return _number(self._evaluate(vector, variables))[:, ["xyz".index(name)]]
            case syntax.Operation(sign, left, right):
                return _operate(
                    sign, self._evaluate(left, variables), self._evaluate(right, variables)
                )
            case syntax.Choice(condition, yes, no):
                return _choose(*(self._evaluate(each, variables) for each in (condition, yes, no)))
            case syntax.Call():
                return self._called(node, variables)

    def _named(self, name: str, variables: Mapping[str, Value]) -> Value:
        if name in variables:
            return variables[name]
        if name in self._globals:
            return self._globals[name]
        if name in CONSTANTS:
            return np.array([[CONSTANTS[name]]])
        if name in self._macros:
            return self.value(self._macros[name], {})
        raise Unreadable(f"{name} is not defined")

    def _called(self, call: syntax.Call, variables: Mapping[str, Value]) -> Value:
        arguments = [(name, self._evaluate(each, variables)) for name, each in call.arguments]
        positional = [value for _, value in arguments]
        if call.name in self._closures:
            return self._closures[call.name](_labelled(arguments))
        if call.name in self._functions:
            return self.call(call.name, positional)
        if call.name in self._globals and not positional:
            return self._globals[call.name]
        if call.name in TRIPLES:
            return _triple(positional)
        word = call.name.removeprefix("math::")
        if word in MATHEMATICS:
            return MATHEMATICS[word](*map(_number, positional))
        namespace = call.name.rpartition("::")[0]
        defined = re.search(rf"^[\w ]* {re.escape(call.name)}\s*\(", self._text, re.MULTILINE)
        if not defined and namespace in ("", "df", "math", "base", "state"):
            known = ", ".join(self._closures)
            raise Unreadable(f"function {call.name} is unknown; closures may come from {known}")
        raise NotRun(f"function {call.name} is {'not read' if defined else 'defined elsewhere'}")


def _labelled(arguments: list[tuple[str, Value]]) -> dict[str, Value]:
    """Arguments by name, by position, or, after OSL's strings, by that keyword."""
    labelled: dict[str, Value] = {}
    values = iter(arguments)
    for position, (name, value) in enumerate(values):
        if isinstance(value, str) and not name:
            labelled[f'"{value}"'] = next(values, ("", None))[1]
        else:
            labelled[name or str(position)] = value
    return labelled


def weighted(closures: tuple[Closure, ...], weight: Array) -> tuple[Closure, ...]:
    return tuple(replace(each, weight=each.weight * weight) for each in closures)


def _operate(sign: str, left: Value, right: Value) -> Value:
    if isinstance(left, tuple) and isinstance(right, tuple) and sign == "+":
        return left + right
    if isinstance(left, tuple) and sign in "*/":
        factor = _number(right)
        return weighted(left, factor if sign == "*" else 1.0 / factor)
    if isinstance(right, tuple) and sign == "*":
        return weighted(right, _number(left))
    with np.errstate(all="ignore"):
        return SIGNS[sign](_number(left), _number(right))


def _choose(condition: Value, yes: Value, no: Value) -> Value:
    truth = _number(condition) != 0.0
    if isinstance(yes, tuple) and isinstance(no, tuple):
        return weighted(yes, truth.astype(float)) + weighted(no, 1.0 - truth)
    return np.where(truth, _number(yes), _number(no))


def _triple(values: list[Value]) -> Array:
    """A color or vector of one number, of three, or of another such."""
    columns = [_number(value) for value in values]
    if len(columns) == 1:
        return np.broadcast_to(columns[0], (len(columns[0]), 3))
    if len(columns) != 3 or any(each.shape[1] != 1 for each in columns):
        raise Unreadable(f"a color takes one number or three; got {len(columns)}")
    return reduce(lambda a, b: np.concatenate(np.broadcast_arrays(a, b), axis=1), columns)


def _number(value: Value) -> Array:
    """A value that has to be a number, color or vector."""
    if not isinstance(value, np.ndarray):
        raise Unreadable("a closure or string stands where a number has to")
    return value
