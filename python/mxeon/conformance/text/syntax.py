# SPDX-License-Identifier: Apache-2.0
"""A reader of the arithmetic that generated MDL and OSL have in common.

It knows numbers, names, strings, calls with named arguments, components, `+ - * /`, comparisons, the
choice `? :`, declarations, assignments, `if` and `return`. That is what closures are written with;
loops and arrays are not read.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from mxeon.errors import NotRun, ShaderError
from mxeon.shaders.closure_calls import COMMENT


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


TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?f?)|(?P<text>\"[^\"]*\")"
    r"|(?P<word>(?:::)?[A-Za-z_]\w*(?:::\w+)*)|(?P<sign>[<>=!]=|&&|\|\||[-+*/<>?:(){},;=!.]))"
)
MACRO = re.compile(r"^#define (\w+) (.+)$", re.MULTILINE)
FUNCTION = re.compile(r"^(?:closure )?[A-Za-z]\w* (\w+)\s*\(([^()]*)\)\s*(?=\{)", re.MULTILINE)
LOOPS = ("for", "while", "do")
PRECEDENCE = ({"||"}, {"&&"}, {"<", ">", "<=", ">=", "==", "!="}, {"+", "-"}, {"*", "/"})


class Unreadable(ShaderError):
    """Text that the reader, and so a compiler, refuses."""


def without_comments(text: str) -> str:
    """The text with a space in place of each comment."""
    return COMMENT.sub(" ", text)


def tokens(text: str) -> list[str]:
    """Words, numbers and signs of a text.

    >>> tokens("df::f(tint: 2.0 * x)")
    ['df::f', '(', 'tint', ':', '2.0', '*', 'x', ')']
    """
    result, position = [], 0
    text = without_comments(text).rstrip()
    while position < len(text):
        match = TOKEN.match(text, position)
        if match is None:
            raise Unreadable(f"cannot be read from {text[position : position + 20].strip()!r} on")
        result.append(match[0].strip())
        position = match.end()
    return result


def macros(text: str) -> Mapping[str, str]:
    """Constants that a text defines by `#define`, as text."""
    return dict(MACRO.findall(without_comments(text)))


def function_table(text: str) -> Mapping[str, Function]:
    text = without_comments(text)
    functions = {}
    for match in FUNCTION.finditer(text):
        words = (" ".join(each.split()) for each in match[2].split(",") if each.strip())
        parameters = tuple(
            (kind, name) for kind, _, name in (each.rpartition(" ") for each in words)
        )
        functions[match[1]] = Function(match[1], parameters, braces(text, match.end()))
    return functions


def expression(text: str) -> Expression:
    parser = _Parser(tokens(text))
    result = parser.expression()
    parser.end()
    return result


def statements(text: str) -> tuple[Statement, ...]:
    """The statements of a function's body."""
    parser = _Parser(tokens(text))
    result: list[Statement] = []
    while parser.more:
        result += parser.statement()
    return tuple(result)


def braces(text: str, start: int) -> str:
    """Text between the brace at `start` and the one that closes it."""
    depth = 0
    for position in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[position], 0)
        if depth == 0:
            return text[start + 1 : position]
    raise Unreadable("a brace is not closed")


class _Parser:
    """Recursive descent over tokens."""

    def __init__(self, words: list[str]) -> None:
        self._words, self._next = words, 0

    @property
    def more(self) -> bool:
        """Whether tokens are left."""
        return self._next < len(self._words)

    def end(self) -> None:
        """Raise Unreadable unless all tokens are read."""
        if self.more:
            raise Unreadable(f"{self._peek()!r} is out of place")

    def statement(self) -> list[Statement]:
        """One statement, a block as several; an empty one or a mere declaration as none."""
        if self._take("{"):
            block: list[Statement] = []
            while not self._take("}"):
                block += self.statement()
            return block
        if self._take("return"):
            value = self.expression()
            self._expect(";")
            return [Return(value)]
        if self._take("if"):
            self._expect("(")
            condition = self.expression()
            self._expect(")")
            yes = tuple(self.statement())
            return [If(condition, yes, tuple(self.statement()) if self._take("else") else ())]
        return self._assignment()

    def expression(self) -> Expression:
        """An expression, up to a token that cannot belong to it."""
        condition = self._binary(0)
        if not self._take("?"):
            return condition
        yes = self.expression()
        self._expect(":")
        return Choice(condition, yes, self.expression())

    def _assignment(self) -> list[Statement]:
        words = []
        while self.more and self._peek() not in ("=", ";"):
            words.append(self._peek())
            self._next += 1
        if not words or not words[-1].isidentifier() or "(" in words or words[0] in LOOPS:
            raise NotRun(f"statement {' '.join(words)} is not read")
        # A declaration without a value changes nothing.
        if self._take(";"):
            return []
        self._expect("=")
        value = self.expression()
        self._expect(";")
        return [Assignment(words[-1], value)]

    def _binary(self, level: int) -> Expression:
        if level == len(PRECEDENCE):
            return self._unary()
        left = self._binary(level + 1)
        while self.more and self._peek() in PRECEDENCE[level]:
            sign = self._peek()
            self._next += 1
            left = Operation(sign, left, self._binary(level + 1))
        return left

    def _unary(self) -> Expression:
        if self._take("-"):
            return Operation("-", Number(0.0), self._unary())
        if self._take("!"):
            return Operation("==", self._unary(), Number(0.0))
        value = self._primary()
        while self._take("."):
            value = Component(value, self._peek())
            self._next += 1
        return value

    def _primary(self) -> Expression:
        if self._take("("):
            value = self.expression()
            self._expect(")")
            return value
        word = self._peek()
        self._next += 1
        if word[0].isdigit() or (word[0] == "." and len(word) > 1):
            return Number(float(word.rstrip("f")))
        if word[0] == '"':
            return Text(word[1:-1])
        if not (word[0].isalpha() or word[0] in "_:"):
            raise Unreadable(f"{word!r} is out of place")
        return Call(word, tuple(self._arguments())) if self._take("(") else Name(word)

    def _arguments(self) -> list[tuple[str, Expression]]:
        arguments: list[tuple[str, Expression]] = []
        while not self._take(")"):
            if arguments:
                self._expect(",")
            name = ""
            if self._words[self._next + 1 : self._next + 2] == [":"]:
                name = self._peek()
                self._next += 2
            arguments.append((name, self.expression()))
        return arguments

    def _peek(self) -> str:
        if not self.more:
            raise Unreadable("ends too early")
        return self._words[self._next]

    def _take(self, word: str) -> bool:
        """Whether the next token is `word`, which is then read."""
        taken = self.more and self._words[self._next] == word
        self._next += taken
        return taken

    def _expect(self, word: str) -> None:
        if not self._take(word):
            place = f"; got {self._peek()!r}" if self.more else " at the end"
            raise Unreadable(f"{word!r} is missing{place}")
