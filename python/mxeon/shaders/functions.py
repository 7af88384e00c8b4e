# SPDX-License-Identifier: Apache-2.0
"""The shader twins as text: models and sampling in GLSL and in OSL, and the functions' signatures."""

import re

from mxeon.errors import InputError
from mxeon.shaders.library import data_folder

LANGUAGES = ("glsl", "osl")
FAMILY = "oren_nayar_family"
# Includes all the others.
ALL = "eon_sampling"
INCLUDE = re.compile(r'^#include "(\w+\.\w+)"$', re.MULTILINE)


def source(language, stem=ALL):
    """Text of a twin with its own includes put in place.

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
    return INCLUDE.sub(lambda found: source(language, found[1].split(".")[0]), text)


def names(language):
    """Names of all functions.

    Returns
    -------
    tuple of str
    """
    return tuple(_parameters(language))


def signature(language, function):
    """Parameter types and names of a twin's function, in order.

    Returns
    -------
    tuple of (str, str)
        Type word and name of each parameter.

    Raises
    ------
    ValueError
        If there is no such function; lists the known ones.
    """
    parameters = _parameters(language)
    if function not in parameters:
        raise InputError(f"function must be one of {', '.join(parameters)}; got {function!r}")
    return tuple(tuple(each.split()) for each in parameters[function].split(", "))


def _parameters(language):
    """Text of the parameters of each function, by its name."""
    return dict(re.findall(r"^\w+ (\w+)\(([^)]*)\)$", source(language), re.MULTILINE))
