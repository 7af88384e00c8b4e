# SPDX-License-Identifier: Apache-2.0
"""Check that the shader functions have one text in two languages, but for words of type.

Hosts compare the values of the functions in one language with NumPy; this holds the other to it.
"""

import re

from mxeon.conformance.results import Result
from mxeon.conformance.text.counts import Claim, counted
from mxeon.conformance.text.syntax import macros, without_comments
from mxeon.shaders.functions import LANGUAGES, SIGNATURE, has_functions, twins

WORDS = {"color": "vec3", "vector": "vec3", "output": "out", "atan2": "atan"}  # OSL, GLSL
NUMBER = re.compile(r"\b\d+\.\d+\b")
CLAIM = Claim(
    "languages",
    "The shader functions are identical in OSL and GLSL, apart from type names.",
    "functions",
    "the first number of the OSL text is different",
)


def check_languages(library: str) -> tuple[Result, ...]:
    """The result for a library that brings shader functions in both languages."""
    if not all(has_functions(library, language) for language in LANGUAGES):
        return ()
    glsl, osl = (twins(language, library) for language in LANGUAGES)
    different = differences(glsl, osl)
    control = differences(glsl, NUMBER.sub("777.0", without_comments(osl), count=1))
    meaning = f"different in OSL: {', '.join(different)}"
    return (counted(CLAIM, "shader twins, osl", library, len(different), len(control), meaning),)


def differences(glsl: str, osl: str) -> list[str]:
    """Names of the functions and constants whose text differs."""
    ours, theirs = _parts(glsl), _parts(osl)
    return [name for name in {**ours, **theirs} if ours.get(name) != theirs.get(name)]


def _parts(text: str) -> dict[str, list[str]]:
    """Tokens of each function and constant of a text, in GLSL's words."""
    text = without_comments(text)
    constants = {name: _tokens(value) for name, value in macros(text).items()}
    matches = list(SIGNATURE.finditer(text))
    ends = [match.start() for match in matches[1:]] + [len(text)]
    functions = {
        match[1]: _tokens(text[match.start() : end])
        for match, end in zip(matches, ends, strict=True)
    }
    return constants | functions


def _tokens(text: str) -> list[str]:
    text = "".join(line for line in text.splitlines(keepends=True) if line[:1] != "#")
    return [WORDS.get(word, word) for word in re.findall(r"[\w.]+|\S", text)]
