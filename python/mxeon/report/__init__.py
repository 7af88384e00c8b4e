# SPDX-License-Identifier: Apache-2.0
"""The report of a run: results.json, junit.xml, pictures, and a page."""

from __future__ import annotations

import json
import re
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from mxeon.conformance.results import JUNIT, PAGE, REPORT, RESULTS, Picture, Run
from mxeon.conformance.results.known_issues import issues_of
from mxeon.conformance.results.records import StoredImage, images_of, make_converter
from mxeon.errors import PackageError, install
from mxeon.io.files import AnyPath, below, check_output, one_name, replacing, write_text
from mxeon.io.images import without_threads, write_exr, write_png
from mxeon.report.junit import to_junit

PAGES = "upstream"  # subfolder of a report for pages on defects

JSON_FORMAT = 5
ADDED = ("document", "element")  # fields of results that earlier reports of this format lack
SCHEMA = f"urn:mxeon:results:{JSON_FORMAT}"  # identifier of `mxeon.report.schema.schema()`

NOT_PLAIN = re.compile("[^A-Za-z0-9]+")
REFERENCE = "reference"
# Metadata that a picture shares with its reference.
SHARED_METADATA = ("version", "library", "document", "element", "scene", "points")


def to_json(run: Run) -> str:
    """A run as JSON text.

    `mxeon report schema` prints the JSON Schema. Non-finite numbers are the strings "NaN",
    "Infinity" and "-Infinity". Missing values are null. Keys:

    - $schema: Identifier of the JSON Schema.
    - format: Version of this layout, which increases when a key changes or is removed.
    - verdict: "passed", "failed" or "not run". The verdict of a check may also be "differs", for a
      difference that the specification permits.
    - counts: Number of checks by verdict.
    - passed: Whether everything requested ran and nothing failed.
    - exit_status: Exit status of the command.
    - sentence: The verdict as a sentence.
    - seconds: Duration of the run, or null.
    - missing: Items that an interrupted run has not finished.
    - refused: Refused documents.
    - errors: Faults of the refused documents.
    - compared: Libraries judged only for comparison, which verdict, counts and sentence ignore.
    - version: Version of mxeon.
    - software: Versions of other software by name.
    - documents: Paths of the documents.
    - notes: Texts.
    - libraries: For each folder, the folder's own files ("folder") and added files ("MaterialX").
    - unjudged: Pairs of an item that no check judges, and the reason.
    - hosts: Objects with name, version, device.
    - results: Objects with the fields of `mxeon.conformance.results.Result`. The field control is
      null or an object with variant, error, caught. The field quantity is null if nothing was
      measured. The field diagnosis has causes, most important first, and distances to the known
      models. Scripts should compare kinds, keys and regions, not sentences.
    - elsewhere: Failures for inputs that a document does not use, as objects with document, check,
      subject, host, library.
    - pictures: Objects with document, element, host, library, scene, exr, png, reference,
      difference. The fields exr, png and reference are paths relative to the JSON file. The field
      difference is an object with scene, largest, highlight, visible. Reference and difference may
      be null.
    """
    data = {
        "$schema": SCHEMA,
        "format": JSON_FORMAT,
        "verdict": run.verdict,
        "passed": run.passed,
        "exit_status": run.exit_status,
        "counts": run.counts,
        "sentence": run.sentence,
        "seconds": run.seconds,
        "missing": run.missing,
        "compared": run.compared,
        "unjudged": run.unjudged,
        "refused": tuple(map(str, run.refused)),
        "errors": run.errors,
        "version": run.version,
        "software": run.software,
        "documents": [str(path) for path in run.documents],
        "notes": run.notes,
        "libraries": run.libraries,
        "hosts": run.hosts,
        "results": run.results,
        "elsewhere": [
            {key: getattr(each, key) for key in ("check", "subject", "host", "library")}
            | {"document": document}
            for document in run.contents
            for each in run.results
            if run.is_elsewhere(each, document)
        ],
        "pictures": _picture_fields(run),
    }
    return json.dumps(make_converter().unstructure(data), indent=1, allow_nan=False) + "\n"


def _picture_fields(run: Run) -> list[dict[str, Any]]:
    pictures = _with_references(run.pictures)
    names = [f"pictures/{name}" for name in image_names(pictures)]
    references = {
        _subject(picture): f"{name}.exr"
        for picture, name in zip(pictures, names, strict=True)
        if picture.host == REFERENCE
    }
    keys = ("document", "element", "host", "library", "scene")
    with in_threads(lambda picture: picture.difference, run.pictures) as differences:
        return [
            {key: getattr(picture, key) for key in keys}
            | {"exr": f"{name}.exr", "png": f"{name}.png"}
            | {"reference": references.get(_subject(picture)), "difference": difference}
            for picture, name, difference in zip(run.pictures, names, differences, strict=False)
        ]


def image_names(pictures: Sequence[Picture]) -> tuple[str, ...]:
    """ASCII file names for pictures, without suffix, which differ even if case is ignored."""
    names, uses = [], Counter[str]()
    for picture in pictures:
        document = Path(picture.document).stem
        words = (document, picture.element, picture.host, picture.library, picture.scene)
        name = "-".join(NOT_PLAIN.sub("_", word)[:40] for word in words)
        uses[name.lower()] += 1
        # Names have five words, and numbered names six, so no two names are equal.
        names.append(name if uses[name.lower()] == 1 else f"{name}-{uses[name.lower()]}")
    return tuple(names)


def write(run: Run, folder: str | PathLike[str]) -> Path:
    """Write report.html, results.json, junit.xml and pictures/ into `folder`.

    Pictures and references are EXR and PNG files. The subfolder upstream/ has pages on defects that
    explain failures. Each file is written completely or not at all, and report.html is written
    last. If `check` had no folder, the documents are first drawn in the studio.

    Returns the path of report.html. Raises InputError rather than replace a document, a library or
    the run's journal; OSError if a file cannot be written; ImportError without the `report` extra.
    """
    folder = Path(one_name("folder", folder))
    check_output(folder, _inputs(run), replaced=REPORT)
    if run.policy:
        from mxeon.conformance.run import with_studio  # loads rendering engines

        run = with_studio(run, run.policy)
    write_text(below(folder, RESULTS), to_json(run))
    write_text(below(folder, JUNIT), to_junit(run))
    pictures = _with_references(run.pictures)
    stems = [f"pictures/{stem}" for stem in image_names(pictures)]
    with (
        without_threads(),
        in_threads(partial(_write_picture, folder), zip(pictures, stems, strict=True)) as written,
    ):
        for _ in written:
            pass
    # The report links to these Markdown files if the documentation's address is unknown.
    for issue in {each for one in run.results for each in issues_of(one)}:
        write_text(below(folder, f"{PAGES}/{issue.page}.md"), issue.text)
    with (
        closing(html(run)) as pieces,
        replacing(below(folder, PAGE)) as temporary,
        open(temporary, "w", encoding="utf-8") as page,
    ):
        page.writelines(pieces)
    return folder / PAGE


def _inputs(run: Run) -> Iterator[AnyPath]:
    """Paths of the run's documents, libraries and journal, which must not be replaced."""
    from mxeon.shaders.document.policy import Policy
    from mxeon.shaders.document.references import files_read

    yield from files_read(run.documents, Policy(outside=True), run.libraries).values()
    for picture in run.pictures:
        for image in images_of(picture).values():
            if isinstance(image, StoredImage):
                yield from (image.path, *image.path.parent.glob("*.jsonl"))


def _write_picture(folder: Path, place: tuple[Picture, str]) -> None:
    """Write a picture as EXR and as PNG. `place` is the picture, and a file name without suffix."""
    picture, name = place
    image = np.asarray(picture.image)
    write_exr(below(folder, f"{name}.exr"), image, picture.metadata)
    write_png(below(folder, f"{name}.png"), image, picture.metadata)


def require_extra(name: str) -> None:
    """Raise PackageError unless the `report` extra, which `name` needs, is installed."""
    for package in ("jinja2", "matplotlib"):
        if find_spec(package) is None:
            raise PackageError(f"{name} needs {package}: {install('report')}")


def html(run: Run) -> Generator[str, None, None]:
    """Generate a run's self-contained HTML page in pieces, to keep few pictures in memory.

    Close the generator to stop the threads that draw the pictures.
    """
    require_extra("report.html")
    from mxeon.report.page import render

    files = {
        id(each): stem for each, stem in zip(run.pictures, image_names(run.pictures), strict=True)
    }
    return render(run, lambda picture: f"pictures/{files[id(picture)]}.png")


def _with_references(pictures: Iterable[Picture]) -> tuple[Picture, ...]:
    """The given pictures, followed by references that are missing among the pictures."""
    known = {_subject(each) for each in pictures if each.host == REFERENCE}
    added = []
    for picture in pictures:
        if picture.reference is None or _subject(picture) in known:
            continue
        known.add(_subject(picture))
        shared = {key: picture.metadata[key] for key in SHARED_METADATA if key in picture.metadata}
        metadata = shared | {"host": REFERENCE}
        added.append(replace(picture, host=REFERENCE, image=picture.reference, metadata=metadata))
    return (*pictures, *added)


def _subject(picture: Picture) -> tuple[str, ...]:
    """Key that a picture and its reference share. Portraits must also agree on rendered points."""
    points = picture.metadata.get("points", "")
    return *picture.shown, picture.library, picture.scene, points


# Threads help because encoders release the interpreter's lock.
THREADS = 4  # each thread keeps one or two pictures in memory and often waits for a disk

T = TypeVar("T")
R = TypeVar("R")


@contextmanager
def in_threads(work: Callable[[T], R], items: Iterable[T]) -> Iterator[Iterator[R]]:
    """Run `work` on every item in threads, a few items ahead, and yield the results in order.

    The first error stops the work and is raised. The threads end with the block. If garbage
    collection ended the threads instead, a thread that runs the collection would wait for itself.
    """
    begun = deque[Future[R]]()
    with ThreadPoolExecutor(THREADS) as pool:
        futures = (pool.submit(work, item) for item in items)

        def results() -> Iterator[R]:
            begun.extend(islice(futures, 2 * THREADS))
            while begun:
                yield begun.popleft().result()
                begun.extend(islice(futures, 1))

        try:
            yield results()
        finally:
            for future in begun:
                future.cancel()
