# SPDX-License-Identifier: Apache-2.0
"""Mutants of every shader by rule: each operator at each place where it applies."""

import random
import re
from collections.abc import Iterator
from functools import cache

from tools.benchmarks.mutants.mutant import ROOT, Mutant

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
OPERAND = r"(?<![\w.])[\w.]+(?:\([^()]*\))?(?![\w.(\[])"  # a name, a number, or a simple call
OPERATORS = {
    "constant": CONSTANT,
    "sign": re.compile(r" (?:[-+]=?) (?=\S)"),
    "product": re.compile(r" [*/] "),
    "comparison": re.compile(r" (?:[<>]=?|[=!]=) "),
    "channel": re.compile(r"(?<=[\w)])\.[xyzrgb]\b"),
    "bound": re.compile(r"\b(?:min|max)\("),
    "factor": re.compile(rf"{OPERAND} \* | [*/] {OPERAND}"),
    "term": re.compile(rf" [-+] {OPERAND}(?! [*/])"),
    "statement": re.compile(r"^[ \t]+[\w.]+(?:\[\w+\])? [-+*/]?= [^;]*;[ \t]*\n", re.M),
}


def made(seed: int, share: float) -> tuple[Mutant, ...]:
    """A share in (0, 1] of the mutants that the operators make, the same for the same seed."""
    mutants = [each for name in files() for each in mutants_of(name)]
    chosen = random.Random(seed).sample(range(len(mutants)), round(share * len(mutants)))
    return tuple(mutants[place] for place in sorted(chosen))


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
        for match in pattern.finditer(code):
            old, new = unique(text, match.start(), match.end(), changed(match[0]))
            line = text.count("\n", 0, match.start()) + 1
            name = (
                f"{operator}, {file}:{line}:{match.start() - text.rfind(chr(10), 0, match.start())}"
            )
            reason = f"{match[0].strip()!r} becomes {changed(match[0]).strip()!r}"
            mutant = Mutant(name, GROUP, file, old, new, reason, "gl", False, False)
            try:
                made = mutant.texts()[file]
            except ValueError:
                continue
            if made not in texts:
                texts.add(made)
                yield mutant


def changed(code: str) -> str:
    """What an operator puts instead of the code that it found; nothing for a dropped part."""
    if code in SWAPPED:
        return SWAPPED[code]
    return f"{RAISED * float(code) or 0.1:.9g}" if CONSTANT.fullmatch(code) else ""


def unique(text: str, start: int, end: int, new: str) -> tuple[str, str]:
    """The fewest whole lines around a place that occur once, as they are and changed."""
    first = text.rfind("\n", 0, start) + 1
    last = text.find("\n", end - 1) + 1 or len(text)
    while text.count(text[first:last]) > 1:
        first = text.rfind("\n", 0, first - 1) + 1
    return text[first:last], text[first:start] + new + text[end:last]
