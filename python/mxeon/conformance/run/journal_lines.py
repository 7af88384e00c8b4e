# SPDX-License-Identifier: Apache-2.0
"""The lines of a journal: what each holds, and whether it is as it was written.

The first line is the plan of a run, each further one the place of an item in it and its findings.
Each has a digest of itself and of the plan, so that findings stay with their item and their run.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn, override

from mxeon.conformance.records import ERRORS, make_converter
from mxeon.conformance.results import Findings, Picture, Plan
from mxeon.errors import InputError
from mxeon.io.files import regular

FORMAT = 2
NAME = "journal/items.jsonl"
PLAN = -1  # place of the plan among the lines


@dataclass(frozen=True)
class StoredImage:
    """Pixels in a file, read anew by every `np.asarray`, so that a run holds none of them.

    Attributes
    ----------
    path : Path
        Its stem is the SHA-256 of the file.
    """

    path: Path

    def __array__(self, dtype=None, copy=None):
        return np.asarray(np.load(self.path), dtype=dtype)

    @property
    def whole(self):
        """Whether the file is there, and as it was written."""
        try:
            with open(self.path, "rb", opener=regular) as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            # Mapped, not read: a header may declare any number of pixels.
            pixels = digest == self.path.stem and np.lib.format.open_memmap(self.path, mode="r")
        except (OSError, ValueError, OverflowError):
            return False
        return pixels is not False and (pixels.ndim, pixels.dtype) == (3, np.float32)


@dataclass(frozen=True)
class Contents:
    """A journal as it was read.

    Attributes
    ----------
    plan : Plan
    lines : dict of int to bytes
        The lines that count, by the place of the item; that of the plan by PLAN.
    findings : dict of int to Findings
    damaged : tuple of str
        What does not count: an item, or the number of a line that says of none.
    """

    plan: Plan
    lines: dict[int, bytes]
    findings: dict[int, Findings]
    damaged: tuple[str, ...]


def read_lines(folder):
    """The Contents of the journal in a folder.

    Raises
    ------
    ValueError
        If there is none, or none that this version reads.
    """
    path, converter = folder / NAME, json_converter(folder)
    try:
        with open(path, "rb", opener=regular) as file:
            header, *lines = list(file) or [b""]
    except FileNotFoundError:
        raise InputError(f"{folder}: must hold the {NAME} of a run; there is none") from None
    plan, seed = _header(header, path, converter)
    counting, findings, damaged = {PLAN: header}, {}, []
    for number, line in enumerate(lines, 2):
        if not line.endswith(b"\n"):  # torn by the end of the last run
            break
        try:
            place, found = _item(line, seed, plan, converter)
        except ERRORS:
            damaged.append(f"line {number}")
            continue
        if all(image.whole for image in _images(found)):
            counting[place], findings[place] = line, found
        else:
            damaged.append(f"pictures of {plan.items[place]}")
    return Contents(plan, counting, findings, tuple(damaged))


def _header(line, path, converter):
    """The plan that the first line holds, and its digest."""
    try:
        if (written := json.loads(line)["format"]) != FORMAT:
            raise InputError(f"it has format {written!r}")
        record, seed = _checked(line)
        del record["format"]
        return converter.structure(record, Plan), seed
    except ERRORS as error:
        reason = f"its first line is damaged or of another program; {error}"
        raise InputError(f"{path}: must be a journal of format {FORMAT}; {reason}") from None


def _item(line, seed, plan, converter):
    """Place and findings of an item; one of ERRORS, if the line is not what was written."""
    record, _ = _checked(line, seed)
    place, findings = record["item"], converter.structure(record["findings"], Findings)
    if type(place) is not int or not 0 <= place < len(plan.items):
        raise InputError(f"item must be one of {len(plan.items)}; got {place!r}")
    if not findings.answer(plan.items[place]):
        raise InputError(f"findings must be those of {plan.items[place]}")
    return place, findings


def _images(findings):
    return [
        image
        for each in findings.pictures
        for image in (each.image, each.reference)
        if image is not None
    ]


def to_line(record, seed=""):
    """A record as a line, with a digest of it and of the plan's line, whose digest is `seed`."""
    return (json.dumps(record | {"digest": _digest(record, seed)}) + "\n").encode()


def _checked(line, seed=""):
    """The record of a line, and its digest."""
    record = json.loads(line)
    digest = record.pop("digest")
    if digest != _digest(record, seed):
        raise InputError("its digest is that of another text")
    return record, digest


def _digest(record, seed):
    return hashlib.sha256((seed + json.dumps(record)).encode()).hexdigest()


def json_converter(folder):
    """A converter to and from JSON for the journal in a folder; images stay in their files."""
    converter = make_converter()

    def stored(name):
        return StoredImage((folder / NAME).with_name(name))

    fields = {
        "image": override(unstruct_hook=_name, struct_hook=lambda name, _: stored(name)),
        "reference": override(
            unstruct_hook=_name, struct_hook=lambda name, _: None if name is None else stored(name)
        ),
    }
    to_json = make_dict_unstructure_fn(Picture, converter, **fields)
    converter.register_unstructure_hook(Picture, to_json)
    converter.register_structure_hook(Picture, make_dict_structure_fn(Picture, converter, **fields))
    return converter


def _name(image):
    return None if image is None else image.path.name
