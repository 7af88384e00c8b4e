# SPDX-License-Identifier: Apache-2.0
"""Conversion of results to JSON and back, for reports and journals."""

from dataclasses import dataclass
from pathlib import Path
from threading import Lock

import cattrs
import numpy as np
from cattrs.gen import override
from numpy.typing import ArrayLike, DTypeLike, NDArray

from mxeon.conformance.results import Picture, Verdict, assert_verdict
from mxeon.io import files, records

# NumPy parses file headers with `ast`. In Python 3.11, `ast` can fail when two threads use it:
# https://github.com/python/cpython/issues/106905.
READING = Lock()
IMAGES = ("image", "reference", "judged")  # fields of a picture that contain images


@dataclass(frozen=True)
class StoredImage:
    """Pixels in a file. Each `np.asarray` reads the file again, so that memory holds no pixels."""

    path: Path  # a file whose name is the SHA-256 of its contents

    def __array__(
        self, dtype: DTypeLike | None = None, copy: bool | None = None
    ) -> NDArray[np.generic]:
        with READING:
            return np.asarray(np.load(self.path), dtype=dtype)

    @property
    def whole(self) -> bool:
        """Whether the file exists and is unchanged since it was written."""
        if files.digest(self.path) != self.path.stem:
            return False
        try:  # memory-map the file, because a header may declare any number of pixels
            pixels = np.lib.format.open_memmap(self.path, mode="r")
        except (OSError, ValueError, OverflowError):
            return False
        return bool(pixels.ndim == 3 and pixels.dtype == np.float32)


def make_converter(folder: Path | None = None) -> cattrs.Converter:
    """A converter between the dataclasses of `mxeon.conformance.results` and JSON types.

    If `folder` is given, JSON contains the names of picture files in that folder.
    """
    own = {} if folder is None else {Picture: _in_files(folder)}
    converter = records.strict_converter(own)
    # The message for an invalid verdict must list the valid verdicts.
    converter.register_structure_hook_func(
        lambda kind: kind == Verdict, lambda word, _: assert_verdict(word)
    )
    return converter


def _in_files(folder: Path) -> records.Overrides:
    def name(image: StoredImage | None) -> str | None:
        return None if image is None else image.path.name

    def stored(name: str, _: object = None) -> StoredImage:
        return StoredImage((folder / "name").with_name(name))

    def optional(name: str | None, _: object) -> StoredImage | None:
        return None if name is None else stored(name)

    structure = dict.fromkeys(IMAGES, optional) | {"image": stored}
    hooks = ((each, structure[each]) for each in IMAGES)
    return {each: override(unstruct_hook=name, struct_hook=hook) for each, hook in hooks}


def images_of(picture: Picture) -> dict[str, ArrayLike]:
    """The images of a picture by field name, without fields that are None."""
    images = {name: getattr(picture, name) for name in IMAGES}
    return {name: image for name, image in images.items() if image is not None}
