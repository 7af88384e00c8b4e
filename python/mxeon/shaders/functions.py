# SPDX-License-Identifier: Apache-2.0
"""Shader functions as text, in GLSL and in OSL, and their signatures."""

import re
from functools import lru_cache

from mxeon.errors import InputError
from mxeon.shaders.library import data_folder

LANGUAGES = ("glsl", "osl")
FAMILY = "oren_nayar_family"
ALL = "eon_sampling"  # includes all the others
INCLUDE = re.compile(r'^#include "(\w+\.\w+)"$', re.MULTILINE)


def source(language: str, stem: str = ALL) -> str:
    """Text of a file of shader functions, its includes expanded.

    Parameters
    ----------
    language : str
        "glsl" or "osl".
    stem : str
        File name without its ending.

    Returns
    -------
    str
    """
    folder = data_folder() / f"gen{language}"
    text = (folder / f"{stem}.{language}").read_text(encoding="utf-8")
    return INCLUDE.sub(lambda include: source(language, include[1].split(".")[0]), text)


def names(language: str) -> tuple[str, ...]:
    """Names of all shader functions of a language."""
    return tuple(_parameters(source(language)))


def signature(language: str, function: str) -> tuple[tuple[str, str], ...]:
    """Parameter types and names of a shader function, in order.

    Parameters
    ----------
    language : str
        "glsl" or "osl".
    function : str

    Returns
    -------
    tuple of (str, str)
        Type word and name of each parameter.

    Raises
    ------
    ValueError
        If there is no such function; lists the known ones.
    """
    parameters = _parameters(source(language))
    if function not in parameters:
        raise InputError(f"function must be one of {', '.join(parameters)}; got {function!r}")
    pairs = (each.rpartition(" ") for each in parameters[function].split(", "))
    return tuple((kind, name) for kind, _, name in pairs)


@lru_cache(maxsize=4)
def _parameters(text: str) -> dict[str, str]:
    """Text of the parameters of each function of a source, by its name."""
    return dict(re.findall(r"^\w+ (\w+)\(([^)]*)\)$", text, re.MULTILINE))
