# SPDX-License-Identifier: Apache-2.0
"""Generates mutants of all shaders by applying each operator wherever its pattern matches."""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from hashlib import sha256
from pathlib import Path

from tools.benchmarks.mutants.mutant import ROOT, Mutant, read_table

GROUP = "Operators"
SURVIVORS = Path(__file__).with_name("survivors.toml")  # known undetected mutants
FOLDERS = ("genglsl", "genosl")
# Mutants of environment lookups are listed in `table/`, because programs with many mutants do not
# compile environment lookups.
ENVIRONMENT = "genglsl/environment/"
UNCOMPILED = r"^#ifdef (?:EONLIB_PREFILTERED|MX_REFRACTION_UNMASKED)\b.*?(?=^#e)"
COMMENT = re.compile(
    rf"{UNCOMPILED}|//[^\n]*|/\*.*?\*/|^[ \t]*#(?:include|if|el|end|pragma|undef)[^\n]*",
    re.M | re.S,
)
RAISED = 1.1  # factor for constants; 0 becomes 0.1
SWAPPED = {
    " + ": " - ", " - ": " + ", " += ": " -= ", " -= ": " += ",
    " * ": " / ", " / ": " * ",
    " < ": " >= ", " > ": " <= ", " <= ": " > ", " >= ": " < ", " == ": " != ", " != ": " == ",
    ".x": ".y", ".y": ".x", ".z": ".x", ".r": ".g", ".g": ".b", ".b": ".r",
    "min(": "max(", "max(": "min(",
}  # fmt: skip
CONSTANT = re.compile(r"(?<![\w.])\d+\.\d*(?:[eE][-+]?\d+)?(?![\w.])")
GROUP1 = r"\((?:[^()]|\([^()]*\))*\)"  # parentheses with at most one level of nested parentheses
PARENTHESES = rf"\((?:[^()]|{GROUP1})*\)"
# An OPERAND is a name, a number, a call or a parenthesized expression. A PRODUCT is a sequence of
# operands joined by * or /.
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
    """A random fraction `share`, in (0, 1], of the operators' mutants.

    A hash of the seed and of the mutant decides whether a mutant is chosen.
    """
    return tuple(each for each in every() if _fraction(f"{seed} {each.file} {each.new}") < share)


def _fraction(text: str) -> float:
    return int.from_bytes(sha256(text.encode()).digest()[:6]) * 2.0**-48


def _digest(mutant: Mutant) -> tuple[str, str]:
    """The file of a mutant, and the mutated text without white space."""
    return mutant.file, "".join(mutant.texts()[mutant.file].split())


def known_survivors() -> dict[tuple[str, str], str]:
    """The reasons in `survivors.toml`, by file and change."""
    listed = tomllib.loads(SURVIVORS.read_text(encoding="utf-8"))["survivors"]
    return {(group["file"], line): group["reason"] for group in listed for line in group["lines"]}


def change(mutant: Mutant) -> tuple[str, str]:
    """A mutant's file, and the change as written in `survivors.toml`."""
    return mutant.file, " ".join(f"{mutant.old} => {mutant.new}".split())


@cache
def every() -> tuple[Mutant, ...]:
    """All mutants. Reasons of known survivors are read from `table/` and SURVIVORS."""
    table = {_digest(each): each.reason for each in read_table() if each.survives}
    reasons, found = known_survivors(), []
    for each in (each for name in files() for each in mutants_of(name)):
        reason = table.get(_digest(each)) or reasons.get(change(each))
        found.append(replace(each, reason=reason, survives=True) if reason else each)
    return tuple(found)


@cache
def files() -> tuple[str, ...]:
    paths = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.*sl")]
    found = sorted(path.relative_to(ROOT).as_posix() for path in paths)
    return tuple(each for each in found if not each.startswith(ENVIRONMENT))


def mutants_of(file: str) -> Iterator[Mutant]:
    """Distinct mutants of a file, except changes that do not apply to the OSL version."""
    texts, text = set(), (ROOT / file).read_text(encoding="utf-8")
    code = code_of(text)
    for operator, pattern in OPERATORS.items():
        match = pattern.search(code)
        while match:
            found, put = match[0], changed(operator, match[0])
            old, new = unique(text, match.start(), match.end(), put)
            line = text.count("\n", 0, match.start()) + 1
            column = match.start() - text.rfind("\n", 0, match.start())
            name = f"{operator}, {file}:{line}:{column}, {len(found)}"
            reason = f"{found.strip()!r} becomes {put.strip()!r}"
            flags = {"equivalent": False, "survives": False}
            place = {"operator": operator, "place": match.span()}
            mutant = Mutant(name, GROUP, file, old, new, reason, "gl", **flags, **place)
            match = pattern.search(code, match.start() + 1)  # matches may overlap
            try:
                made = mutant.texts()[file]
            except ValueError:
                continue
            if made not in texts:
                texts.add(made)
                yield mutant


def code_of(text: str) -> str:
    """Source code in which comments, includes and inactive code are replaced by blanks."""
    return COMMENT.sub(lambda match: re.sub(r"\S", " ", match[0]), text)


def changed(operator: str, code: str) -> str:
    """The replacement for the matched code, or "" if the operator removes the code."""
    if operator == "constant":
        return f"{RAISED * float(code) or 0.1:.9g}"
    if operator in ("yes", "no"):
        word = "true" if operator == "yes" else "false"
        return f"({word})" if code[0] == "(" else word
    return ("0.0" if code == "1.0" else "1.0") if operator == "unit" else SWAPPED.get(code, "")


def unique(text: str, start: int, end: int, new: str) -> tuple[str, str]:
    """Old and new text of a change, extended to whole lines that are unique in the file."""
    first = text.rfind("\n", 0, start) + 1
    last = text.find("\n", end - 1) + 1 or len(text)
    while text.count(text[first:last]) > 1:
        first = text.rfind("\n", 0, first - 1) + 1
    return text[first:last], text[first:start] + new + text[end:last]
