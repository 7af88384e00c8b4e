# SPDX-License-Identifier: Apache-2.0
"""What a run has finished, on disk as it ends: one line an item, so that any end can be survived.

The folder of a run holds a folder `journal`: its file `items.jsonl`, whose first line is the plan of
the run and each further one the place of an item and its findings, and the pictures as NumPy files.
A line counts once its newline is there.
"""

import json
import os
import shutil
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import cattrs
import numpy as np
from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn, override
from filelock import FileLock, Timeout

from mxeon.results import Findings, Picture, Plan
from mxeon.writing import replacing

FORMAT = 1
NAME = "journal/items.jsonl"
PREVIOUS, LOCK = "journal.previous", ".journal.lock"  # beside the folder `journal`


@dataclass(frozen=True)
class StoredImage:
    """Pixels in a file, read anew by every `np.asarray`, so that a run holds none of them."""

    path: Path

    def __array__(self, dtype=None, copy=None):
        return np.asarray(np.load(self.path), dtype=dtype)


class Journal:
    """The journal of one run in a folder; a context manager, since it is locked while open.

    Parameters
    ----------
    folder : path-like
        Made if need be.
    plan : Plan
    resume : bool
        Whether to go on with the run that the folder holds, if one was begun. If not, an earlier
        journal is kept beside with its pictures, as PREVIOUS.

    Attributes
    ----------
    findings : dict of int to Findings
        Those finished so far, by the place of the item in the plan.

    Raises
    ------
    ValueError
        If another process writes here, or the run to resume is not this one.
    OSError
        If the folder cannot be written.
    """

    def __init__(self, folder, plan, resume=False):
        self._folder = Path(folder)
        self._path = self._folder / NAME
        self._folder.mkdir(parents=True, exist_ok=True)
        self._lock = FileLock(self._folder / LOCK, timeout=0)
        try:
            self._lock.acquire()
        except Timeout:
            raise ValueError(f"{folder}: must have one writer; another run writes there") from None
        try:
            begun = resume and self._path.exists() and b"\n" in self._path.read_bytes()
            self.findings = self._continue(plan) if begun else self._begin(plan)
        except BaseException:
            self._lock.release()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *error):
        os.close(self._file)
        self._lock.release()

    def add(self, place, findings):
        """Keep the findings of an item: on disk when this returns.

        Raises
        ------
        OSError
            If there is no room; the journal is then as it was before.
        """
        pictures = tuple(
            replace(
                picture,
                image=self._store(picture.image, f"{place}-{row}.npy"),
                reference=self._store(picture.reference, f"{place}-{row}-reference.npy"),
            )
            for row, picture in enumerate(findings.pictures)
        )
        findings = replace(findings, pictures=pictures)
        record = {"item": place, "findings": _converter(self._folder).unstructure(findings)}
        self._append(record)
        self.findings[place] = findings

    def _begin(self, plan):
        if self._path.exists():
            shutil.rmtree(self._folder / PREVIOUS, ignore_errors=True)
            os.replace(self._path.parent, self._folder / PREVIOUS)
        self._path.parent.mkdir(exist_ok=True)
        self._open()
        self._append({"format": FORMAT} | _converter(self._folder).unstructure(plan))
        return {}

    def _continue(self, plan):
        found, findings, size = _read(self._folder)
        if found != plan:
            raise ValueError(f"{self._folder}: --resume must go on with the same run; {_apart(found, plan)}")
        self._open()
        os.ftruncate(self._file, size)  # a line torn by the end of the last run
        return findings

    def _open(self):
        self._file = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)

    def _append(self, record):
        size = os.fstat(self._file).st_size
        line = memoryview((json.dumps(record) + "\n").encode())
        try:
            while line:
                line = line[os.write(self._file, line) :]
            os.fsync(self._file)
        except OSError as error:
            os.ftruncate(self._file, size)
            raise OSError(error.errno, error.strerror, str(self._path)) from None

    def _store(self, image, name):
        """An image in a file of the folder, or None for none."""
        if image is None:
            return None
        path = self._path.with_name(name)
        pixels = BytesIO()
        np.save(pixels, np.asarray(image, np.float32))
        with replacing(path) as beside:
            beside.write_bytes(pixels.getbuffer())
        return StoredImage(path)


def read_journal(folder):
    """The plan of the run in a folder, and what it has finished.

    Parameters
    ----------
    folder : path-like

    Returns
    -------
    Plan, dict of int to Findings

    Raises
    ------
    ValueError
        If the folder holds no journal that this version reads.
    """
    plan, findings, _ = _read(Path(folder))
    return plan, findings


def _read(folder):
    """Plan and findings of a journal, and the bytes up to the end of its last whole line."""
    path = folder / NAME
    try:
        whole = path.read_bytes().rpartition(b"\n")[0]
    except OSError:
        raise ValueError(f"{folder}: must hold the {NAME} of a run; there is none") from None
    converter = _converter(folder)
    try:
        header, *records = map(json.loads, whole.split(b"\n"))
        if header.pop("format") != FORMAT:
            raise ValueError("it has another format")
        plan = converter.structure(header, Plan)
        found = {
            record["item"]: converter.structure(record["findings"], Findings)
            for record in records
        }
    except (ValueError, KeyError, TypeError, AttributeError, cattrs.BaseValidationError) as error:
        raise ValueError(f"{path}: must be a journal of mxeon {FORMAT}; {error}") from None
    return plan, found, len(whole) + 1


def _apart(found, plan):
    """In words, what two plans do not share."""
    if found.version != plan.version:
        return f"it is of mxeon {found.version}, this is {plan.version}"
    if found.software != plan.software:
        return f"it ran with {found.software}, this has {plan.software}"
    if found.documents != plan.documents:
        changed = found.documents.items() ^ plan.documents.items()
        return f"these documents differ: {', '.join(sorted({path for path, _ in changed}))}"
    return "its hosts, libraries or documents were others"


def _converter(folder):
    """To and from JSON; images stay in their files."""
    converter = cattrs.Converter()
    converter.register_unstructure_hook(np.ndarray, lambda array: array.tolist())
    converter.register_structure_hook(np.ndarray, lambda rows, _: np.array(rows))
    image = override(
        unstruct_hook=lambda image: image and image.path.name,
        struct_hook=lambda name, _: name and StoredImage((folder / NAME).with_name(name)),
    )
    fields = {"image": image, "reference": image}
    to_json = make_dict_unstructure_fn(Picture, converter, **fields)
    converter.register_unstructure_hook(Picture, to_json)
    converter.register_structure_hook(Picture, make_dict_structure_fn(Picture, converter, **fields))
    return converter
