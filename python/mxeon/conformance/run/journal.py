# SPDX-License-Identifier: Apache-2.0
"""The journal of a run, which records the findings of a task as soon as the task ends.

The file `journal/items.jsonl` in a run's folder has JSON Lines. The first line contains the plan of
the run, with mxeon's version, the options and the hashes of files. A run can only be resumed with
an equal plan. Every other line contains the findings of a task. An incomplete last line is dropped.
Pictures are NumPy files named by SHA-256.
"""

import hashlib
import json
import os
import re
import shutil
from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from itertools import chain
from pathlib import Path
from typing import Any, Self, cast

import numpy as np
from filelock import FileLock, Timeout

from mxeon.conformance.results import JUNIT, PAGE, RESULTS, Picture
from mxeon.conformance.results.records import StoredImage, images_of, make_converter
from mxeon.conformance.run.plan import Findings, Plan
from mxeon.conformance.words import counted, listed
from mxeon.errors import InputError
from mxeon.io.files import BINARY, below, regular, replacing, sync
from mxeon.io.records import UNREADABLE

FORMAT = 10
JOURNAL = "journal/items.jsonl"
REPORTS = (RESULTS, JUNIT, PAGE)
PREVIOUS, LOCK = "previous_run", ".journal.lock"
TASK = re.compile(rb'\{"task": (\d+),.*\n')


class Journal:
    """A context manager that locks the folder of a run and clears earlier results.

    Entering the context moves the journal, results and page of an earlier run to the folder
    PREVIOUS. If `resume` is set, the journal stays. Entering raises InputError if another process
    writes to the folder, or if an earlier run was interrupted and `resume` is not set. `begin`
    creates the folder if the folder is missing.
    """

    def __init__(self, folder: str | os.PathLike[str], resume: bool = False) -> None:
        self._folder, self._resume = Path(folder), resume
        self._path = self._folder / JOURNAL
        self._lock = FileLock(self._folder / LOCK, timeout=0)
        self._file: int | None = None
        self._converter = make_converter(self._path.parent)
        self.findings: dict[int, Findings] = {}  # findings by the number of the task in the plan

    def __enter__(self) -> Self:
        if os.path.lexists(self._folder):
            self._claim()
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            os.close(self._file)
        self._lock.release()

    def _claim(self) -> None:
        for name in (JOURNAL, LOCK, *REPORTS, PREVIOUS, f"{PREVIOUS}/{JOURNAL}"):
            below(self._folder, name)
        self._folder.mkdir(parents=True, exist_ok=True)
        try:
            self._lock.acquire()
        except Timeout:
            rule = "must have one writer; another run writes there"
            raise InputError(f"{self._folder}: {rule}") from None
        try:
            if not self._resume and (remaining := _remaining(self._path)):
                raise InputError(
                    f"{self._folder}: holds an interrupted run with {remaining} left: "
                    f"--resume continues it; to begin anew, remove {self._path.parent} or name "
                    "another folder"
                )
            self._clear()
        except BaseException:
            self._lock.release()
            raise

    def _clear(self) -> None:
        """Move earlier results to PREVIOUS. If a run is resumed, only delete the run's reports."""
        names = [name for name in REPORTS if (self._folder / name).is_file()]
        if self._path.exists() and self._resume:
            for name in names:
                (self._folder / name).unlink()
            return
        if self._path.exists():
            names.append(self._path.parent.name)
        if names:
            previous = self._folder / PREVIOUS
            previous.mkdir(exist_ok=True)
            if (previous / JOURNAL).exists():
                shutil.rmtree((previous / JOURNAL).parent)
            for name in REPORTS:
                (previous / name).unlink(missing_ok=True)
            for name in names:
                os.replace(self._folder / name, previous / name)

    def begin(self, plan: Plan) -> None:
        """Write the plan of the run, or read the completed part of the run that is resumed.

        Raises InputError if the resumed run has another plan, and OSError if nothing can be
        written.
        """
        if not self._lock.is_locked:
            self._claim()
        if self._resume and self._path.exists():
            earlier, self.findings, size = _read(self._folder)
            if earlier != plan:
                raise InputError(refusal(self._folder, _differences(earlier, plan)))
            os.truncate(self._path, size)
        else:
            header = {"format": FORMAT} | self._converter.unstructure(plan)
            with replacing(self._path) as temporary:
                temporary.write_bytes(_line(header))
            sync(self._path.parent)
            sync(self._folder)
        self._file = os.open(self._path, os.O_WRONLY | os.O_APPEND | BINARY)

    def add(self, number: int, findings: Findings) -> None:
        """Record the findings of a task.

        The pictures are written first. When the method returns, all data are on disk. Raises
        OSError if the disk is full. In this case, the journal is unchanged.
        """

        def stored(picture: Picture) -> Picture:
            images: dict[str, Any] = {}
            for name, image in images_of(picture).items():
                stream = BytesIO()
                np.save(stream, np.ascontiguousarray(image, np.float32))
                digest = hashlib.sha256(stream.getbuffer()).hexdigest()
                path = below(self._path.parent, f"{digest}.npy")
                with replacing(path) as temporary:
                    temporary.write_bytes(stream.getbuffer())
                images[name] = StoredImage(path)
            return replace(picture, **images)

        assert self._file is not None, "begin must be called before add"
        findings = replace(findings, pictures=tuple(map(stored, findings.pictures)))
        if findings.pictures:
            sync(self._path.parent)
        record = {"task": number, "findings": self._converter.unstructure(findings)}
        size, remaining = os.fstat(self._file).st_size, memoryview(_line(record))
        try:
            while remaining:
                remaining = remaining[os.write(self._file, remaining) :]
            os.fsync(self._file)
        except OSError as error:
            os.ftruncate(self._file, size)
            raise OSError(error.errno, error.strerror, str(self._path)) from None
        self.findings[number] = findings


def read_journal(folder: str | os.PathLike[str]) -> tuple[Plan, dict[int, Findings]]:
    """The plan of the run in a folder, and the findings of the completed tasks.

    A task with modified or missing pictures is not complete. Raises InputError if the folder has no
    journal, or if another version of mxeon wrote the journal.
    """
    return _read(Path(folder))[:2]


def refusal(folder: str | os.PathLike[str] | None, differences: Sequence[str]) -> str:
    """A message that lists the differences due to which the run in a folder cannot be resumed."""
    remedy = "use a new folder, or omit --resume"
    return f"{folder}: holds another run ({listed(differences)}); {remedy}"


def _remaining(path: Path) -> str:
    """The number of remaining tasks of an interrupted run in words, or "" without such a run.

    Only the numbers of tasks are read, because the journal may have the format of another version.
    """
    try:
        with open(path, "rb", opener=regular) as file:
            total = len(json.loads(file.readline())["tasks"])
            done = {match[1] for match in map(TASK.fullmatch, file) if match}
    except (OSError, *UNREADABLE):
        return ""
    return f"{total - len(done)} of {counted(total, 'task')}" if len(done) < total else ""


def _read(folder: Path) -> tuple[Plan, dict[int, Findings], int]:
    """The plan and findings of a journal, and the size of all complete lines in bytes."""
    path, converter = folder / JOURNAL, make_converter((folder / JOURNAL).parent)
    try:
        with open(path, "rb", opener=regular) as file:
            # An interrupted run may leave an incomplete last line.
            lines = [line for line in file if line.endswith(b"\n")]
    except FileNotFoundError:
        raise InputError(f"{folder}: must hold the {JOURNAL} of a run; there is none") from None
    completed: dict[int, Findings] = {}
    place = "its first line"
    try:
        header = json.loads((lines or [b""])[0])
        if (version := header.pop("format")) != FORMAT:
            raise InputError(f"it has format {version!r}")
        plan = converter.structure(header, Plan)
        for number, line in enumerate(lines[1:], 2):
            place = f"line {number}"
            record = json.loads(line)
            task, findings = record["task"], converter.structure(record["findings"], Findings)
            if type(task) is not int or not 0 <= task < len(plan.tasks):
                raise InputError(f"task must be one of {len(plan.tasks)}; got {task!r}")
            if not findings.belong_to(plan.tasks[task]):
                raise InputError(f"findings must be those of {plan.tasks[task]}")
            images = chain.from_iterable(images_of(each).values() for each in findings.pictures)
            if all(cast(StoredImage, image).whole for image in images):
                completed[task] = findings
    except UNREADABLE as error:
        rule = f"{path}: must be a journal of format {FORMAT} as mxeon wrote it"
        reason = f"{place} is of another run or program; {error}"
        raise InputError(f"{rule}; {reason}; run again without --resume") from None
    return plan, completed, sum(map(len, lines))


def _line(record: dict[str, object]) -> bytes:
    return (json.dumps(record) + "\n").encode()


def _differences(before: Plan, after: Plan) -> tuple[str, ...]:
    """The differences between two plans: options with old and new values, and changed files."""
    old, new = (
        {
            **{"mxeon": plan.version, **plan.software, **plan.options},
            "hosts": ", ".join(dict.fromkeys(task.host for task in plan.tasks)),
            "libraries": ", ".join(dict.fromkeys(task.library for task in plan.tasks)),
            "documents": listed(list(map(str, plan.documents))),
        }
        for plan in (before, after)
    )
    values = {name: (old.get(name, "none"), new.get(name, "none")) for name in old | new}
    facts = [f"{name} ({was}, now {now})" for name, (was, now) in values.items() if was != now]
    files = {path for path, _ in before.files.items() ^ after.files.items()}
    return (*facts, *sorted(files)) or ("the checks",)
