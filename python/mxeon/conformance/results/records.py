# SPDX-License-Identifier: Apache-2.0
"""Results as JSON and back, for reports and journals; each value has to be of its type."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, get_origin

import cattrs
import numpy as np
from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn, override
from numpy.typing import DTypeLike, NDArray

from mxeon.conformance.results.pictures import Picture
from mxeon.conformance.results.result import Control, Result
from mxeon.errors import InputError
from mxeon.io.files import regular

NOT_FINITE = ("NaN", "Infinity", "-Infinity")
# Raised on reading JSON of unknown origin.
ERRORS = (
    ValueError,
    KeyError,
    TypeError,
    AttributeError,
    RecursionError,
    cattrs.BaseValidationError,
)
# JSON calls the error of a result or a control its figure.
FIGURE = {"error": override(rename="figure")}
T = TypeVar("T")
Overrides: TypeAlias = dict[str, Any]  # by field; cattrs types the options beside them alone


@dataclass(frozen=True)
class StoredImage:
    """Pixels in a file, read anew by every `np.asarray`, so that a run holds none of them.

    Attributes
    ----------
    path : Path
        Its stem is the SHA-256 of the file.
    """

    path: Path

    def __array__(
        self, dtype: DTypeLike | None = None, copy: bool | None = None
    ) -> NDArray[np.generic]:
        return np.asarray(np.load(self.path), dtype=dtype)

    @property
    def whole(self) -> bool:
        """Whether the file is there, and as it was written."""
        try:
            with open(self.path, "rb", opener=regular) as file:
                if hashlib.file_digest(file, "sha256").hexdigest() != self.path.stem:
                    return False
            # Mapped, not read: a header may declare any number of pixels.
            pixels = np.lib.format.open_memmap(self.path, mode="r")
        except (OSError, ValueError, OverflowError):
            return False
        return bool(pixels.ndim == 3 and pixels.dtype == np.float32)


def make_converter(folder: Path | None = None) -> cattrs.Converter:
    """A converter between the dataclasses of `mxeon.conformance.results` and the types of JSON.

    Numbers that are not finite are written as the texts NOT_FINITE.

    Parameters
    ----------
    folder : Path or None
        Of the pictures' files, which JSON names; None where no pictures are converted.

    Returns
    -------
    cattrs.Converter
        Its `structure` raises some of ERRORS.
    """
    converter = cattrs.Converter(
        forbid_extra_keys=True, unstruct_collection_overrides={tuple: list}
    )
    # Types are exact: JSON takes true for 1.
    for kind, words in ((str, "a text"), (bool, "true or false"), (int, "a whole number")):
        converter.register_structure_hook(kind, _exactly(kind, words))
    # Numbers that are not finite are texts.
    converter.register_structure_hook(float, _number)
    converter.register_unstructure_hook(float, spelled)
    converter.register_structure_hook_func(_is_array, lambda rows, _: np.array(rows, dtype=float))
    converter.register_unstructure_hook_func(_is_array, lambda array: array.tolist())
    # Records whose keys in JSON are other ones.
    for record in (Control, Result):
        _register(converter, record, FIGURE)
    if folder is not None:
        _register(converter, Picture, _image_fields(folder))
    return converter


def spelled(number: float) -> float | str:
    """A number as JSON can hold it: one that is not finite as a text."""
    if math.isfinite(number):
        return number
    return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "-Infinity"


def read_record(value: object, kind: type[T]) -> T:
    """An instance of a dataclass from JSON's types; every key has to be there.

    Raises
    ------
    ValueError
        Names the first value that is wrong, its path and the rule.
    """
    converter = make_converter()
    try:
        record = converter.structure(value, kind)
    except ERRORS as error:
        raise InputError(_first(error)) from None
    if converter.unstructure(record) != value:  # a text was taken for a list, for example
        raise InputError("it must have the structure that mxeon writes")
    return record


def _is_array(kind: object) -> bool:
    return (get_origin(kind) or kind) is np.ndarray


def _register(converter: cattrs.Converter, kind: type, fields: Overrides) -> None:
    """Convert some fields of a dataclass in another way than their types say."""
    to_json: Callable[[object], dict[str, object]] = make_dict_unstructure_fn(
        kind, converter, **fields
    )
    converter.register_unstructure_hook(kind, to_json)
    converter.register_structure_hook(kind, make_dict_structure_fn(kind, converter, **fields))


def _image_fields(folder: Path) -> Overrides:
    """Conversion of images to the names of their files in a folder, and back."""

    def name(image: StoredImage | None) -> str | None:
        return None if image is None else image.path.name

    def stored(name: str, _: object = None) -> StoredImage:
        return StoredImage((folder / "name").with_name(name))

    def stored_or_none(name: str | None, _: object) -> StoredImage | None:
        return None if name is None else stored(name)

    return {
        "image": override(unstruct_hook=name, struct_hook=stored),
        "reference": override(unstruct_hook=name, struct_hook=stored_or_none),
        "judged": override(unstruct_hook=name, struct_hook=stored_or_none),
    }


def _exactly(kind: type[T], words: str) -> Callable[[object, type], T]:
    def structure(value: object, _: type) -> T:
        if type(value) is not kind:
            raise InputError(f"must be {words}; got {value!r}")
        return value

    return structure


def _number(value: object, _: type) -> float:
    if type(value) not in (int, float) and value not in NOT_FINITE:
        raise InputError(f"must be a number; got {value!r}")
    assert isinstance(value, (int, float, str))
    try:
        return float(value)
    except OverflowError:
        raise InputError(
            f"must be a number below 1.8e308; got one of {len(str(value))} digits"
        ) from None


def _first(error: BaseException) -> str:
    """The first reason of an error, with its path."""
    return cattrs.transform_error(error, format_exception=_reason)[0]


def _reason(error: BaseException, kind: type | None) -> str:
    return f"lacks {error}" if isinstance(error, KeyError) else str(error)
