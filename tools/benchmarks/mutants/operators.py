# SPDX-License-Identifier: Apache-2.0
"""Mutants of every shader by rule: each operator at each place where it applies."""

import random
import re
from collections.abc import Iterator
from functools import cache

from tools.benchmarks.mutants.mutant import ROOT, Mutant, read_table

GROUP = "Operators"
FOLDERS = ("genglsl", "genosl")
COMMENT = re.compile(
    r"//[^\n]*|/\*.*?\*/|^[ \t]*#(?:include|if|el|end|pragma|undef)[^\n]*", re.M | re.S
)
RAISED = 1.1  # a constant; 0 becomes 0.1
SWAPPED = {
    " + ": " - ", " - ": " + ", " += ": " -= ", " -= ": " += ",
    " * ": " / ", " / ": " * ",
    " < ": " >= ", " > ": " <= ", " <= ": " > ", " >= ": " < ", " == ": " != ", " != ": " == ",
    ".x": ".y", ".y": ".x", ".z": ".x", ".r": ".g", ".g": ".b", ".b": ".r",
    "min(": "max(", "max(": "min(",
}  # fmt: skip
CONSTANT = re.compile(r"(?<![\w.])\d+\.\d*(?:[eE][-+]?\d+)?(?![\w.])")
GROUP1 = r"\((?:[^()]|\([^()]*\))*\)"  # parentheses that hold others
PARENTHESES = rf"\((?:[^()]|{GROUP1})*\)"
# A name, a number, a call, or parentheses; and a product of such.
OPERAND = rf"(?<![\w.)\]])(?:-?[\w.]+(?:\[\w+\])?(?:{PARENTHESES})?|{PARENTHESES})(?![\w.(\[])"
PRODUCT = rf"{OPERAND}(?: [*/] {OPERAND})*"
OPERATORS = {
    "constant": CONSTANT,
    "unit": re.compile(r"(?<![\w.])[01]\.0(?![\w.])"),
    "sign": re.compile(r" (?:[-+]=?) (?=\S)"),
    "negative": re.compile(r"(?<=[ (])-(?=[\w(])"),
    "product": re.compile(r" [*/] "),
    "comparison": re.compile(r" (?:[<>]=?|[=!]=) "),
    "channel": re.compile(r"(?<=[\w)])\.[xyzrgb]\b"),
    "bound": re.compile(r"\b(?:min|max)\("),
    "call": re.compile(r"\b(?:sqrt|abs|exp|log|sin|cos|tan|acos|asin|atan|not|!)(?=\()|!(?=\w)"),
    "factor": re.compile(rf"(?<!/ ){OPERAND} \* | [*/] {OPERAND}"),
    "term": re.compile(rf"(?:(?<=[=(?:,] )|(?<=\()|(?<=return )){PRODUCT} [-+] | [-+] {PRODUCT}"),
    "yes": re.compile(rf"(?<=\bif ){PARENTHESES}(?=\n)|(?<=[=(,] )!?{OPERAND}(?= \?)"),
    "no": re.compile(rf"(?<=\bif ){PARENTHESES}(?=\n)|(?<=[=(,] )!?{OPERAND}(?= \?)"),
    "statement": re.compile(r"^[ \t]+[\w.]+(?:\[\w+\])? [-+*/]?= [^;]*;[ \t]*\n", re.M),
}


def made(seed: int, share: float) -> tuple[Mutant, ...]:
    """A share in (0, 1] of the mutants that the operators make, the same for the same seed."""
    mutants = every()
    chosen = random.Random(seed).sample(range(len(mutants)), round(share * len(mutants)))
    return tuple(mutants[place] for place in sorted(chosen))


def _digest(mutant: Mutant) -> tuple[str, str]:
    """The file of a mutant, and its text but for white space."""
    return mutant.file, "".join(mutant.texts()[mutant.file].split())


@cache
def every() -> tuple[Mutant, ...]:
    """All of them; where the table lists a survivor with the same text, that."""
    survivors = {_digest(each): each for each in read_table() if each.survives}
    found = (each for name in files() for each in mutants_of(name))
    return tuple(survivors.get(_digest(each), each) for each in found)


@cache
def files() -> tuple[str, ...]:
    """Shaders of eonlib, by their paths from the root."""
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.*sl")]
    return tuple(sorted(path.relative_to(ROOT).as_posix() for path in found))


def mutants_of(file: str) -> Iterator[Mutant]:
    """Mutants of a file, each text once; those whose twin in OSL differs at the place are left out."""
    texts = set()
    text = (ROOT / file).read_text(encoding="utf-8")
    code = COMMENT.sub(lambda match: re.sub(r"\S", " ", match[0]), text)
    for operator, pattern in OPERATORS.items():
        match = pattern.search(code)
        while match:
            found, put = match[0], changed(operator, match[0])
            old, new = unique(text, match.start(), match.end(), put)
            line = text.count("\n", 0, match.start()) + 1
            column = match.start() - text.rfind("\n", 0, match.start())
            name = f"{operator}, {file}:{line}:{column}, {len(found)}"
            reason = f"{found.strip()!r} becomes {put.strip()!r}"
            mutant = Mutant(name, GROUP, file, old, new, reason, "gl", False, False)
            match = pattern.search(code, match.start() + 1)  # which may overlap this one
            try:
                made = mutant.texts()[file]
            except ValueError:
                continue
            if made not in texts:
                texts.add(made)
                yield mutant


def changed(operator: str, code: str) -> str:
    """What an operator puts instead of the code that it found; nothing for a dropped part."""
    if operator == "constant":
        return f"{RAISED * float(code) or 0.1:.9g}"
    if operator in ("yes", "no"):
        word = "true" if operator == "yes" else "false"
        return f"({word})" if code[0] == "(" else word
    return ("0.0" if code == "1.0" else "1.0") if operator == "unit" else SWAPPED.get(code, "")


def unique(text: str, start: int, end: int, new: str) -> tuple[str, str]:
    """The fewest whole lines around a place that occur once, as they are and changed."""
    first = text.rfind("\n", 0, start) + 1
    last = text.find("\n", end - 1) + 1 or len(text)
    while text.count(text[first:last]) > 1:
        first = text.rfind("\n", 0, first - 1) + 1
    return text[first:last], text[first:start] + new + text[end:last]
