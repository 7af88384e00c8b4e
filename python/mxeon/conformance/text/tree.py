# SPDX-License-Identifier: Apache-2.0
"""Expressions, statements and functions as the reader of MDL and OSL has them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    value: float


@dataclass(frozen=True)
class Text:
    """A string."""

    value: str


@dataclass(frozen=True)
class Name:
    """A variable or constant."""

    name: str


@dataclass(frozen=True)
class Call:
    """A call of a function or constructor; the names of arguments are "" where they have none."""

    name: str
    arguments: tuple[tuple[str, "Expression"], ...]


@dataclass(frozen=True)
class Operation:
    """An operation of two operands."""

    sign: str
    left: "Expression"
    right: "Expression"


@dataclass(frozen=True)
class Choice:
    """One of two values."""

    condition: "Expression"
    yes: "Expression"
    no: "Expression"


@dataclass(frozen=True)
class Component:
    vector: "Expression"
    name: str


Expression = Number | Text | Name | Call | Operation | Choice | Component


@dataclass(frozen=True)
class Assignment:
    """A variable and its new value."""

    name: str
    value: Expression


@dataclass(frozen=True)
class Return:
    """The value of a function."""

    value: Expression


@dataclass(frozen=True)
class If:
    """Statements of two branches."""

    condition: Expression
    yes: tuple["Statement", ...]
    no: tuple["Statement", ...]


Statement = Assignment | Return | If


@dataclass(frozen=True)
class Function:
    """A function: names of its parameters, and its body."""

    name: str
    parameters: tuple[tuple[str, str], ...]  # type and name; an output's type begins with "output"
    body: str  # text between its braces
