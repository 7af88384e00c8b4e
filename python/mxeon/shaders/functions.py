# SPDX-License-Identifier: Apache-2.0
"""Texts and signatures of a library's shader functions in GLSL and in OSL."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from numpy.typing import ArrayLike

from mxeon.errors import InputError, ShaderError
from mxeon.shaders.library import kind_of, source_folder

LANGUAGES = ("glsl", "osl")
GLSL_WORDS = {"color": "vec3", "vector": "vec3", "output": "out", "atan2": "atan"}
Parts = dict[str, list[str]]  # tokens of each function or constant, keyed by name
FAMILY = "oren_nayar_family"
ALL = "eon_sampling"  # file that includes all other files of shader functions
STEMS = ("eon", FAMILY, "ltc_sampling", ALL)
# Files that, with their includes, contain all functions that exist in both GLSL and OSL.
TWINS = (ALL, "ggx_albedo", "conty_kulla_albedo")
INCLUDE = re.compile(r'^#include "((?:\.\./)?(?:lib/|sampling/)?\w+\.\w+)"$', re.MULTILINE)
SIGNATURE = re.compile(r"^(?:float|vec3|color|vector)\s+(\w+)\s*\(([^)]*)\)\s*(?={)", re.MULTILINE)
EACH = "mxeon_each"  # name of the function that `dispatched` adds
TYPES = {"glsl": ("float", "vec3"), "osl": ("float", "color", "vector")}


def source(language: str, stem: str = ALL, library: str = "eonlib") -> str:
    """Text of a file of shader functions in a library, with expanded includes."""
    return expanded(source_file(language, stem, library))


def has_functions(library: str, language: str = "glsl") -> bool:
    """Whether a library contains the file that includes all of eonlib's shader functions."""
    return kind_of(library) != "stock" and source_file(language, ALL, library).is_file()


def twins(language: str, library: str) -> str:
    """Text of the files TWINS in one language, with expanded includes."""
    stems = [
        stem
        for stem in TWINS
        if all(source_file(each, stem, library).is_file() for each in LANGUAGES)
    ]
    return "\n".join(source(language, stem, library) for stem in stems)


def parts(text: str) -> Parts:
    """Functions and constants of a text, as tokens. GLSL's keywords replace OSL's keywords."""
    found = dict(re.findall(r"^#define (\w+) (.+)$", text, re.MULTILINE))
    for match, body in _definitions(text):
        found[match[1]] = match[0] + re.sub(r"^#.*\n?", "", body, flags=re.MULTILINE)
    return {
        name: [GLSL_WORDS.get(word, word) for word in re.findall(r"[\w.]+|\S", part)]
        for name, part in found.items()
    }


def _definitions(text: str) -> Iterator[tuple[re.Match[str], str]]:
    """The head of each function in a text, and the text up to the head of the next function."""
    matches = list(SIGNATURE.finditer(text))
    ends = [match.start() for match in matches[1:]] + [len(text)]
    return ((each, text[each.end() : end]) for each, end in zip(matches, ends, strict=True))


def expanded(path: Path) -> str:
    """Text of a file with expanded includes."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ShaderError(f"{path}: {error.strerror}") from None
    return INCLUDE.sub(lambda include: expanded(path.parent / include[1]), text)


def names(language: str) -> tuple[str, ...]:
    """Names of all of eonlib's shader functions in a language."""
    return tuple(signatures(source(language)))


def signature(language: str, function: str) -> tuple[tuple[str, str], ...]:
    """Parameter types and names of a shader function of eonlib, in order."""
    return parameters(source(language), function)


def parameters(text: str, function: str) -> tuple[tuple[str, str], ...]:
    """Parameter types and names of a function that a text defines, in order."""
    known = signatures(text)
    if function not in known:
        raise InputError(f"function must be one of {', '.join(known)}; got {function!r}")
    return known[function]


def call(
    text: str, function: str, arguments: Sequence[ArrayLike]
) -> tuple[dict[str, tuple[str, ArrayLike]], str]:
    """Types and values of a call's arguments, keyed by parameter name, and the text of the call."""
    pairs = zip(parameters(text, function), arguments, strict=True)
    values = {name: (kind, value) for (kind, name), value in pairs}
    return values, f"{function}({', '.join(values)})"


@lru_cache(maxsize=4)
def signatures(text: str) -> Mapping[str, tuple[tuple[str, str], ...]]:
    """Parameter types and names of each function that a text defines, in order."""
    known = {}
    for match in SIGNATURE.finditer(text):
        pairs = (" ".join(each.split()).rpartition(" ") for each in match[2].split(","))
        known[match[1]] = tuple((kind, name) for kind, _, name in pairs)
    return known


def uses(text: str) -> Mapping[str, frozenset[str]]:
    """For each function of a text, the functions that are called directly or indirectly."""
    known: dict[str, frozenset[str]] = {}
    for match, body in _definitions(text):
        words = set(re.findall(r"\w+", body)) & known.keys()
        known[match[1]] = frozenset(words).union(*(known[word] for word in words))
    return known


def dispatched(text: str, functions: Iterable[str], language: str) -> str:
    """The text plus a dispatcher, which is a function that calls one of `functions` by number.

    So a host compiles one program for all functions. The first parameter of the dispatcher is the
    number of the function, as a float. For each type, the dispatcher has as many parameters as any
    of the functions has. A function with n parameters of a type receives the first n values.
    """
    known, types = signatures(text), TYPES[language]
    slots = {kind: 0 for kind in types}
    calls = []
    for number, function in enumerate(functions):
        kinds = [kind for kind, _ in known[function]]
        calls.append(
            f"    if (which > {number - 0.5:.1f} && which < {number + 0.5:.1f})\n"
            f"        result = {types[1]}({function}({', '.join(slot_names(kinds))}));\n"
        )
        slots = {kind: max(count, kinds.count(kind)) for kind, count in slots.items()}
    every = slot_names([kind for kind in types for _ in range(slots[kind])])
    listed = ["float which", *(f"{name.partition('_')[0]} {name}" for name in every)]
    return (
        f"{text}\n{types[1]} {EACH}({', '.join(listed)})\n{{\n"
        f"    {types[1]} result = {types[1]}(0.0);\n{''.join(calls)}    return result;\n}}\n"
    )


def slot_names(kinds: Iterable[str]) -> list[str]:
    """Names of the dispatcher's parameters that a function with these parameter types receives.

    >>> slot_names(["vec3", "float", "vec3"])
    ['vec3_0', 'float_0', 'vec3_1']
    """
    seen: dict[str, int] = {}
    result = []
    for kind in kinds:
        seen[kind] = seen.get(kind, -1) + 1
        result.append(f"{kind}_{seen[kind]}")
    return result


def source_file(language: str, stem: str, library: str = "eonlib") -> Path:
    """Path of a file of shader functions in any subfolder of the folder for a language."""
    folder, name = source_folder(library) / f"gen{language}", f"{stem}.{language}"
    return next(folder.rglob(name), folder / name)
