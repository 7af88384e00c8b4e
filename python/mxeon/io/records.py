# SPDX-License-Identifier: Apache-2.0
"""Convert dataclasses to JSON and back, with strict types."""

import math
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias, TypeVar, get_origin

import cattrs
import numpy as np
from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn
from numpy.typing import NDArray

from mxeon.errors import InputError

NOT_FINITE = ("NaN", "Infinity", "-Infinity")
# Exceptions that may be raised when JSON from an unknown source is read.
UNREADABLE = (
    ValueError,
    KeyError,
    TypeError,
    AttributeError,
    RecursionError,
    cattrs.BaseValidationError,
)
T = TypeVar("T")
Overrides: TypeAlias = dict[str, Any]  # overrides of cattrs by field name


def strict_converter(fields: Mapping[Any, Overrides]) -> cattrs.Converter:
    """A converter between dataclasses and values that JSON can represent.

    `fields` has overrides of cattrs for each dataclass whose JSON differs from the fields.
    Non-finite numbers become the strings NOT_FINITE. The method `structure` may raise any exception
    in UNREADABLE.
    """
    converter = cattrs.Converter(
        forbid_extra_keys=True, unstruct_collection_overrides={tuple: list}
    )
    # Types must match exactly, because Python accepts True as the number 1.
    for kind, words in ((str, "a text"), (bool, "true or false"), (int, "a whole number")):
        converter.register_structure_hook(kind, _exactly(kind, words))
    converter.register_structure_hook(float, _number)
    converter.register_unstructure_hook(float, spelled)
    converter.register_structure_hook_func(_is_array, _array)
    converter.register_unstructure_hook_func(_is_array, lambda array: array.tolist())
    for record, overrides in fields.items():
        to_json: Any = make_dict_unstructure_fn(record, converter, **overrides)
        from_json = make_dict_structure_fn(record, converter, **overrides)
        converter.register_unstructure_hook(record, to_json)
        converter.register_structure_hook(record, from_json)
    return converter


def read_strictly(converter: cattrs.Converter, value: object, kind: type[T]) -> T:
    """Convert JSON values to a dataclass. An InputError names the first wrong or missing value."""

    def reason(error: BaseException, kind: type | None) -> str:
        return f"lacks {error}" if isinstance(error, KeyError) else str(error)

    try:
        record = converter.structure(value, kind)
    except UNREADABLE as error:
        first = cattrs.transform_error(error, format_exception=reason)[0]
        raise InputError(first) from None
    if converter.unstructure(record) != value:  # example: a text read as a list
        raise InputError("it must have the structure that mxeon writes")
    return record


def spelled(number: float) -> float | str:
    """A number for JSON. Non-finite numbers are converted to strings."""
    if math.isfinite(number):
        return number
    return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "-Infinity"


def _is_array(kind: object) -> bool:
    return (get_origin(kind) or kind) is np.ndarray


def _array(value: object, _: type) -> NDArray[np.float64]:
    if not _has_numbers(value):
        raise InputError(f"must be numbers in arrays; got {value!r}")
    return np.array(value, dtype=float)


def _has_numbers(value: object) -> bool:
    """Whether a value is a list of numbers, or a nested list of numbers."""
    return type(value) is list and all(type(e) in (int, float) or _has_numbers(e) for e in value)


def _exactly(kind: type[T], words: str) -> Callable[[object, type], T]:
    def structure(value: object, _: type) -> T:
        if type(value) is not kind:
            raise InputError(f"must be {words}; got {value!r}")
        return value

    return structure


def _number(value: object, _: type) -> float:
    if type(value) not in (int, float) and value not in NOT_FINITE:
        raise InputError(f"must be a number; got {value!r}")
    try:
        return float(value)  # type: ignore[arg-type]
    except OverflowError:
        raise InputError(
            f"must be a number below 1.8e308; got one of {len(str(value))} digits"
        ) from None
