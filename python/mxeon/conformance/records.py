# SPDX-License-Identifier: Apache-2.0
"""Plain data of a run read from JSON: each value has to be of its type, none is converted."""

import math

import cattrs
import numpy as np

from mxeon.errors import InputError

NOT_FINITE = ("NaN", "Infinity", "-Infinity")
# What the reading of JSON that somebody wrote raises.
ERRORS = (
    ValueError,
    KeyError,
    TypeError,
    AttributeError,
    RecursionError,
    cattrs.BaseValidationError,
)


def make_converter():
    """A converter between the dataclasses of `mxeon.conformance.results` and the types of JSON.

    Numbers that are not finite are written as the texts NOT_FINITE.

    Returns
    -------
    cattrs.Converter
        Its `structure` raises some of ERRORS.
    """
    converter = cattrs.Converter(
        forbid_extra_keys=True, unstruct_collection_overrides={tuple: list}
    )
    for kind, words in ((str, "a text"), (bool, "true or false"), (int, "a whole number")):
        converter.register_structure_hook(kind, _exactly(kind, words))
    converter.register_structure_hook(float, _number)
    converter.register_unstructure_hook(float, spelled)
    converter.register_structure_hook(np.ndarray, lambda rows, _: np.array(rows, dtype=float))
    converter.register_unstructure_hook(np.ndarray, lambda array: array.tolist())
    return converter


def spelled(number):
    """A number as JSON can hold it: one that is not finite as a text."""
    if math.isfinite(number):
        return number
    return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "-Infinity"


def read_record(value, kind):
    """An instance of a dataclass from JSON's types; every key has to be there.

    Raises
    ------
    ValueError
        Names the first value that is wrong, its place and the rule.
    """
    converter = make_converter()
    try:
        record = converter.structure(value, kind)
    except ERRORS as error:
        raise InputError(_first(error)) from None
    if converter.unstructure(record) != value:  # a text was taken for a list, say
        raise InputError("it must hold the lists and names that mxeon writes")
    return record


def _exactly(kind, words):
    def structure(value, _):
        if type(value) is not kind:
            raise InputError(f"must be {words}; got {value!r}")
        return value

    return structure


def _number(value, _):
    if type(value) not in (int, float) and value not in NOT_FINITE:
        raise InputError(f"must be a number; got {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise InputError(
            f"must be a number below 1.8e308; got one of {len(str(value))} digits"
        ) from None


def _first(error):
    """The first reason of an error, with its place."""
    return cattrs.transform_error(error, format_exception=_reason)[0]


def _reason(error, kind):
    return f"lacks {error}" if isinstance(error, KeyError) else str(error)
