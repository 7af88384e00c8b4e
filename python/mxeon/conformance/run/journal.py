# SPDX-License-Identifier: Apache-2.0
"""The journal of a run: the findings of each task, on disk as soon as it ends.

The folder of a run holds a folder `journal`: its file `items.jsonl`, whose first line is the plan of
the run and each further one the findings of a task, and the pictures as NumPy files, named by
their SHA-256. A line that is not as it was written, or whose pictures are not, does not count: its
task is done again. So damage costs the tasks that it hits, and no more.
"""

import hashlib
import json
import os
import shutil
import warnings
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Self, cast

import numpy as np
from filelock import FileLock, Timeout
from numpy.lib.format import header_data_from_array_1_0, write_array_header_1_0
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance.results.records import StoredImage, make_converter
from mxeon.conformance.run.journal_lines import FORMAT, JOURNAL, PLAN, read_lines, to_line
from mxeon.conformance.run.tasks import Findings, Plan
from mxeon.errors import InputError
from mxeon.io.files import below, replacing

PREVIOUS, LOCK = "journal.previous", ".journal.lock"  # beside the folder `journal`
LISTED = 8  # names in a message


class Journal:
    """The journal of one run in a folder; a context manager, since it is locked while open.

    Nothing is touched before it is entered.

    Raise ValueError on entry, if another process writes here, or the run to resume is not this
    one; says what differs; OSError on entry, if the folder cannot be written.
    """

    def __init__(self, folder: str | os.PathLike[str], plan: Plan, resume: bool = False) -> None:
        self._folder, self._plan, self._resume = Path(folder), plan, resume
        self._path = self._folder / JOURNAL
        self._exit = ExitStack()
        self._converter = make_converter(self._path.parent)
        self.findings: dict[int, Findings] = {}

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            for name in (JOURNAL, PREVIOUS, LOCK):
                below(self._folder, name)
            stack.enter_context(_locked(self._folder))
            lines = self._continue() if self._resume and self._path.exists() else self._begin()
            self._file = os.open(self._path, os.O_WRONLY | os.O_APPEND)
            stack.callback(os.close, self._file)
            self._seed = json.loads(lines[PLAN])["digest"]
            self._exit = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        self._exit.close()

    def add(self, number: int, findings: Findings) -> None:
        """Keep the findings of a task: on disk when this returns, the pictures first.

        Raise OSError if there is no room; the journal is then as it was before.
        """
        pictures = tuple(
            replace(
                picture,
                image=self._store(picture.image),
                reference=None if picture.reference is None else self._store(picture.reference),
                judged=None if picture.judged is None else self._store(picture.judged),
            )
            for picture in findings.pictures
        )
        if pictures:
            _sync(self._path.parent)
        findings = replace(findings, pictures=pictures)
        record = {"task": number, "findings": self._to_json(findings)}
        self._append(to_line(record, self._seed))
        self.findings[number] = findings

    def _begin(self) -> dict[int, bytes]:
        """Lines of a new journal; an earlier one makes room."""
        if self._path.exists():
            shutil.rmtree(self._folder / PREVIOUS, ignore_errors=True)
            os.replace(self._path.parent, self._folder / PREVIOUS)
        header = {"format": FORMAT} | self._to_json(self._plan)
        return self._write({PLAN: to_line(header)})

    def _continue(self) -> dict[int, bytes]:
        """Valid lines of the journal that is there."""
        contents = read_lines(self._folder)
        if contents.plan != self._plan:
            raise InputError(refusal(self._folder, _differences(contents.plan, self._plan)))
        _warn(self._folder, contents.damaged)
        self.findings = contents.findings
        return self._write(contents.lines)

    def _to_json(self, record: Plan | Findings) -> dict[str, object]:
        values: dict[str, object] = self._converter.unstructure(record)
        return values

    def _write(self, lines: dict[int, bytes]) -> dict[int, bytes]:
        with replacing(self._path) as beside:
            beside.write_bytes(b"".join(lines.values()))
        _sync(self._path.parent)
        _sync(self._folder)
        return lines

    def _append(self, line: bytes) -> None:
        size, rest = os.fstat(self._file).st_size, memoryview(line)
        try:
            while rest:
                rest = rest[os.write(self._file, rest) :]
            os.fsync(self._file)
        except OSError as error:
            os.ftruncate(self._file, size)
            raise OSError(error.errno, error.strerror, str(self._path)) from None

    def _store(self, image: ArrayLike) -> NDArray[np.float32]:
        """An image in a file of the folder."""
        pixels, header = np.ascontiguousarray(image, np.float32), BytesIO()
        write_array_header_1_0(header, header_data_from_array_1_0(pixels))
        parts = header.getvalue(), pixels.data
        digest = hashlib.sha256(parts[0])
        digest.update(parts[1])
        path = below(self._path.parent, f"{digest.hexdigest()}.npy")
        with replacing(path) as beside, open(beside, "wb") as file:
            file.writelines(parts)
        return cast(NDArray[np.float32], StoredImage(path))  # read anew by each use


def read_journal(folder: str | os.PathLike[str]) -> tuple[Plan, dict[int, Findings]]:
    """The plan of the run in a folder, and the findings of the tasks that are done.

    Warns of damaged lines and pictures, whose tasks count as not done.

    Raise ValueError if the folder holds no journal that this version reads.
    """
    contents = read_lines(Path(folder))
    _warn(folder, contents.damaged)
    return contents.plan, contents.findings


def refusal(folder: str | os.PathLike[str] | None, differences: Sequence[str]) -> str:
    """The reason for not resuming the run in a folder: one line that lists what differs."""
    listed = _listed(differences)
    return f"{folder}: --resume must go on with the same run; these differ: {listed}"


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(folder / LOCK, timeout=0):
            yield
    except Timeout:
        raise InputError(f"{folder}: must have one writer; another run writes there") from None


def _warn(folder: str | os.PathLike[str], damaged: Sequence[str]) -> None:
    if damaged:
        warnings.warn(
            f"{folder}: damaged in the journal, so that --resume does it again: {_listed(damaged)}",
            stacklevel=2,
        )


def _differences(before: Plan, after: Plan) -> tuple[str, ...]:
    """The differences of two plans: values before and now, and names of files."""
    old, new = _facts(before), _facts(after)
    facts = [
        f"{name} ({old.get(name, 'none')}, now {new.get(name, 'none')})"
        for name in old | new
        if old.get(name) != new.get(name)
    ]
    files = {path for path, _ in before.files.items() ^ after.files.items()}
    return (*facts, *sorted(files)) or ("the checks",)


def _facts(plan: Plan) -> dict[str, str]:
    """The values of a plan, except its files, by names for a reader."""
    hosts, libraries = (
        ", ".join(dict.fromkeys(getattr(task, name) for task in plan.tasks))
        for name in ("host", "library")
    )
    facts = {"mxeon": plan.version} | plan.software | plan.options
    return facts | {"hosts": hosts, "libraries": libraries, "documents": _listed(plan.documents)}


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(names[:LISTED]) + more


def _sync(folder: Path) -> None:
    """Flush the names in a folder to disk."""
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)
