# SPDX-License-Identifier: Apache-2.0
"""The lines of a journal, and a check that each is as it was written.

The first line is the plan of a run, each further one the number of a task in it and its findings.
Each has a digest of itself and of the plan, so that findings stay with their task and their run.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import cattrs

from mxeon.conformance.results.records import ERRORS, StoredImage, make_converter
from mxeon.conformance.run.tasks import Findings, Plan
from mxeon.errors import InputError
from mxeon.io.files import regular

FORMAT = 4
JOURNAL = "journal/items.jsonl"
HALF = b"\\ud"  # begins the escape of half of a character
PLAN = -1  # number of the plan among the lines


@dataclass(frozen=True)
class Contents:
    """The contents of a journal file."""

    plan: Plan
    lines: dict[int, bytes]  # the valid lines, by the number of the task; that of the plan by PLAN
    findings: dict[int, Findings]
    damaged: tuple[str, ...]  # what is not valid: the pictures of a task, or the number of a line


def read_lines(folder: Path) -> Contents:
    """The Contents of the journal in a folder.

    Raise ValueError if there is none, or none that this version reads.
    """
    path = folder / JOURNAL
    converter = make_converter(path.parent)
    try:
        with open(path, "rb", opener=regular) as file:
            header, *lines = list(file) or [b""]
    except FileNotFoundError:
        raise InputError(f"{folder}: must hold the {JOURNAL} of a run; there is none") from None
    plan, seed = _header(header, path, converter)
    valid = {PLAN: header}
    findings: dict[int, Findings] = {}
    damaged = []
    for number, line in enumerate(lines, 2):
        if not line.endswith(b"\n"):  # torn by the end of the last run
            break
        try:
            task, part = _task(line, seed, plan, converter)
        except ERRORS:
            damaged.append(f"line {number}")
            continue
        if all(image.whole for image in _images(part)):
            valid[task], findings[task] = line, part
        else:
            damaged.append(f"pictures of {plan.tasks[task]}")
    return Contents(plan, valid, findings, tuple(damaged))


def _header(line: bytes, path: Path, converter: cattrs.Converter) -> tuple[Plan, str]:
    """The plan that the first line holds, and its digest."""
    try:
        if (version := json.loads(line)["format"]) != FORMAT:
            raise InputError(f"it has format {version!r}")
        record, seed = _checked(line)
        del record["format"]
        return converter.structure(record, Plan), seed
    except ERRORS as error:
        reason = f"its first line is damaged or of another program; {error}"
        raise InputError(f"{path}: must be a journal of format {FORMAT}; {reason}") from None


def _task(line: bytes, seed: str, plan: Plan, converter: cattrs.Converter) -> tuple[int, Findings]:
    """Number and findings of a task. Raise one of ERRORS if the line is not as it was written."""
    record, _ = _checked(line, seed)
    number, findings = record["task"], converter.structure(record["findings"], Findings)
    if type(number) is not int or not 0 <= number < len(plan.tasks):
        raise InputError(f"task must be one of {len(plan.tasks)}; got {number!r}")
    if not findings.answer(plan.tasks[number]):
        raise InputError(f"findings must be those of {plan.tasks[number]}")
    return number, findings


def _images(findings: Findings) -> list[StoredImage]:
    images = (
        each
        for picture in findings.pictures
        for each in (picture.image, picture.reference, picture.judged)
    )
    return [cast(StoredImage, image) for image in images if image is not None]


def to_line(record: dict[str, object], seed: str = "") -> bytes:
    """A record as a line, with a digest of it and of the plan's line, whose digest is `seed`."""
    return (json.dumps(record | {"digest": _digest(record, seed)}) + "\n").encode()


def _checked(line: bytes, seed: str = "") -> tuple[dict[str, object], str]:
    """The record of a line, and its digest."""
    record = json.loads(line)
    if HALF in line.lower():
        json.dumps(record, ensure_ascii=False).encode()  # which no half of a character survives
    digest = record.pop("digest")
    if digest != _digest(record, seed):
        raise InputError("its digest is that of another text")
    return record, digest


def _digest(record: dict[str, object], seed: str) -> str:
    return hashlib.sha256((seed + json.dumps(record)).encode()).hexdigest()
