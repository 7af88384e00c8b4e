# SPDX-License-Identifier: Apache-2.0
"""What a run has finished, on disk as it ends: one line an item, so that any end can be survived.

The folder of a run holds a folder `journal`: its file `items.jsonl`, whose first line is the plan of
the run and each further one the findings of an item, and the pictures as NumPy files, called by
their SHA-256. A line that is not what was written, or whose pictures are not, does not count: its
item is done again. So damage costs the items that it hits, and no more.
"""

import hashlib
import json
import os
import shutil
import warnings
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
from filelock import FileLock, Timeout

from mxeon.conformance.run.journal_lines import (
    FORMAT,
    NAME,
    PLAN,
    StoredImage,
    json_converter,
    read_lines,
    to_line,
)
from mxeon.errors import InputError
from mxeon.io.files import replacing

PREVIOUS, LOCK = "journal.previous", ".journal.lock"  # beside the folder `journal`
LISTED = 8  # names in a message


class Journal:
    """The journal of one run in a folder; a context manager, since it is locked while open.

    Nothing is touched before it is entered.

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
        On entry, if another process writes here, or the run to resume is not this one; says what
        differs.
    OSError
        On entry, if the folder cannot be written.
    """

    def __init__(self, folder, plan, resume=False):
        self._folder, self._plan, self._resume = Path(folder), plan, resume
        self._path = self._folder / NAME
        self._exit = ExitStack()
        self.findings = {}

    def __enter__(self):
        with ExitStack() as stack:
            stack.enter_context(_locked(self._folder))
            lines = self._continue() if self._resume and self._path.exists() else self._begin()
            self._file = os.open(self._path, os.O_WRONLY | os.O_APPEND)
            stack.callback(os.close, self._file)
            self._seed = json.loads(lines[PLAN])["digest"]
            self._exit = stack.pop_all()
        return self

    def __exit__(self, *error):
        self._exit.close()

    def add(self, place, findings):
        """Keep the findings of an item: on disk when this returns, the pictures first.

        Raises
        ------
        OSError
            If there is no room; the journal is then as it was before.
        """
        pictures = tuple(
            replace(each, image=self._store(each.image), reference=self._store(each.reference))
            for each in findings.pictures
        )
        if pictures:
            _sync(self._path.parent)
        findings = replace(findings, pictures=pictures)
        record = {"item": place, "findings": json_converter(self._folder).unstructure(findings)}
        self._append(to_line(record, self._seed))
        self.findings[place] = findings

    def _begin(self):
        """Lines of a new journal; an earlier one makes room."""
        if self._path.exists():
            shutil.rmtree(self._folder / PREVIOUS, ignore_errors=True)
            os.replace(self._path.parent, self._folder / PREVIOUS)
        header = {"format": FORMAT} | json_converter(self._folder).unstructure(self._plan)
        return self._write({PLAN: to_line(header)})

    def _continue(self):
        """Lines of the journal that is there, without those that do not count."""
        contents = read_lines(self._folder)
        if contents.plan != self._plan:
            raise InputError(refusal(self._folder, _differences(contents.plan, self._plan)))
        _warn(self._folder, contents.damaged)
        self.findings = contents.findings
        return self._write(contents.lines)

    def _write(self, lines):
        with replacing(self._path) as beside:
            beside.write_bytes(b"".join(lines.values()))
        _sync(self._path.parent)
        _sync(self._folder)
        return lines

    def _append(self, line):
        size, line = os.fstat(self._file).st_size, memoryview(line)
        try:
            while line:
                line = line[os.write(self._file, line) :]
            os.fsync(self._file)
        except OSError as error:
            os.ftruncate(self._file, size)
            raise OSError(error.errno, error.strerror, str(self._path)) from None

    def _store(self, image):
        """An image in a file of the folder, or None for none."""
        if image is None:
            return None
        pixels = BytesIO()
        np.save(pixels, np.asarray(image, np.float32))
        name = hashlib.sha256(pixels.getbuffer()).hexdigest()
        path = self._path.with_name(f"{name}.npy")
        with replacing(path) as beside:
            beside.write_bytes(pixels.getbuffer())
        return StoredImage(path)


def read_journal(folder):
    """The plan of the run in a folder, and what it has finished.

    Warns of what is damaged, which counts as not done.

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
    contents = read_lines(Path(folder))
    _warn(folder, contents.damaged)
    return contents.plan, contents.findings


def refusal(folder, differences):
    """Why the run in a folder is not resumed: one line that lists what differs."""
    listed = _listed(differences)
    return f"{folder}: --resume must go on with the same run; these differ: {listed}"


@contextmanager
def _locked(folder):
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(folder / LOCK, timeout=0):
            yield
    except Timeout:
        raise InputError(f"{folder}: must have one writer; another run writes there") from None


def _warn(folder, damaged):
    if damaged:
        what = _listed(damaged)
        warnings.warn(
            f"{folder}: damaged in the journal, so that --resume does it again: {what}",
            stacklevel=2,
        )


def _differences(before, after):
    """What two plans do not share: values as they were and are, and names of files."""
    old, new = _facts(before), _facts(after)
    facts = [
        f"{name} ({old.get(name, 'none')}, now {new.get(name, 'none')})"
        for name in old | new
        if old.get(name) != new.get(name)
    ]
    files = {path for path, _ in before.files.items() ^ after.files.items()}
    return (*facts, *sorted(files)) or ("the checks",)


def _facts(plan):
    """What a plan says, but for its files, by names that a reader knows."""
    hosts, libraries = (
        ", ".join(dict.fromkeys(getattr(item, name) for item in plan.items))
        for name in ("host", "library")
    )
    facts = {"mxeon": plan.version} | plan.software | plan.options
    return facts | {"hosts": hosts, "libraries": libraries, "documents": _listed(plan.documents)}


def _listed(names):
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(names[:LISTED]) + more


def _sync(folder):
    """Have the names in a folder on disk."""
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)
