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
from numpy.typing import ArrayLike, DTypeLike, NDArray

from mxeon.conformance.results import Control, Picture, Result
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
IMAGES = ("image", "reference", "judged")  # fields of a picture
FIGURE = {"error": override(rename="figure")}
T = TypeVar("T")
Overrides: TypeAlias = dict[str, Any]  # by field; cattrs types the options beside them alone


@dataclass(frozen=True)
class StoredImage:
    """Pixels in a file, read anew by every `np.asarray`, so that a run holds none of them."""

    path: Path  # its stem is the SHA-256 of the file

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

    Numbers that are not finite are written as the texts NOT_FINITE, and pictures as the names of
    their files in a folder, if there is one. `structure` raises some of ERRORS.
    """
    converter = cattrs.Converter(
        forbid_extra_keys=True, unstruct_collection_overrides={tuple: list}
    )
    # Types are exact: Python takes true for 1.
    for kind, words in ((str, "a text"), (bool, "true or false"), (int, "a whole number")):
        converter.register_structure_hook(kind, _exactly(kind, words))
    converter.register_structure_hook(float, _number)
    converter.register_unstructure_hook(float, spelled)
    converter.register_structure_hook_func(_is_array, lambda rows, _: np.array(rows, dtype=float))
    converter.register_unstructure_hook_func(_is_array, lambda array: array.tolist())
    fields: dict[Any, Overrides] = {
        Control: FIGURE,
        Result: FIGURE,
    }  # records with other keys, or fields of other types
    for record, own in (fields | ({Picture: _image_fields(folder)} if folder else {})).items():
        to_json: Any = make_dict_unstructure_fn(record, converter, **own)
        converter.register_unstructure_hook(record, to_json)
        converter.register_structure_hook(record, make_dict_structure_fn(record, converter, **own))
    return converter


def spelled(number: float) -> float | str:
    """A number as JSON can hold it: one that is not finite as a text."""
    if math.isfinite(number):
        return number
    return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "-Infinity"


def read_record(value: object, kind: type[T]) -> T:
    """An instance of a dataclass from JSON's types; every key has to be there.

    Raise InputError for the first value that is wrong, with its path and the rule.
    """
    converter = make_converter()
    try:
        record = converter.structure(value, kind)
    except ERRORS as error:
        first = cattrs.transform_error(error, format_exception=_reason)[0]
        raise InputError(first) from None
    if converter.unstructure(record) != value:  # a text was taken for a list, for example
        raise InputError("it must have the structure that mxeon writes")
    return record


def _is_array(kind: object) -> bool:
    return (get_origin(kind) or kind) is np.ndarray


def _image_fields(folder: Path) -> Overrides:
    """Conversion of images to the names of their files in a folder, and back."""

    def name(image: StoredImage | None) -> str | None:
        return None if image is None else image.path.name

    def stored(name: str, _: object = None) -> StoredImage:
        return StoredImage((folder / "name").with_name(name))

    def optional(name: str | None, _: object) -> StoredImage | None:
        return None if name is None else stored(name)

    structure = dict.fromkeys(IMAGES, optional) | {"image": stored}
    return {each: override(unstruct_hook=name, struct_hook=structure[each]) for each in IMAGES}


def images_of(picture: Picture) -> dict[str, ArrayLike]:
    """The images that a picture has, by the field."""
    images = {name: getattr(picture, name) for name in IMAGES}
    return {name: image for name, image in images.items() if image is not None}


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


def _reason(error: BaseException, kind: type | None) -> str:
    return f"lacks {error}" if isinstance(error, KeyError) else str(error)
