# SPDX-License-Identifier: Apache-2.0
"""A run as files: JSON for machines, JUnit for build servers, pictures, and a page for people."""

import json
import math
from dataclasses import replace
from pathlib import Path

from mxeon.conformance.records import make_converter
from mxeon.conformance.results import image_names
from mxeon.errors import PackageError
from mxeon.io.files import replacing, write_text
from mxeon.io.images import difference, write_exr, write_png
from mxeon.report.junit import to_junit

JSON_FORMAT = 1

REFERENCE = "reference"
# What a picture and its reference have in common.
SHARED_METADATA = ("version", "library", "document", "element", "scene")


def to_json(run):
    """A run as JSON text.

    Parameters
    ----------
    run : mxeon.conformance.results.Run

    Returns
    -------
    str
        An object. A number that is not finite is the string "NaN", "Infinity" or "-Infinity";
        what is missing is null. Keys:

        - format: this layout's number, raised when a key changes or goes.
        - verdict: "passed", "failed" or "not run"; counts: the number of checks with each.
        - sentence: the same in words.
        - missing: texts, the items that an interrupted run has not done.
        - errors: texts, why documents were refused.
        - version: of mxeon; software: name to version; documents: paths; notes: texts.
        - hosts: objects of name, version, device.
        - results: objects with the fields of `mxeon.conformance.results.Result`; control is null or an
          object of variant, figure, caught.
        - pictures: objects of document, element, host, library, scene; exr and png, paths
          beside the JSON file; largest_difference from the reference, or null without one.
        - curves: objects with the fields of `mxeon.conformance.results.Curve`.
    """
    summary = run.summary
    hosts = [vars(identity) for identity in run.hosts]
    data = {
        "format": JSON_FORMAT,
        "verdict": summary.verdict,
        "counts": summary.counts,
        "sentence": summary.sentence,
        "missing": run.missing,
        "errors": run.errors,
        "version": run.version,
        "software": run.software,
        "documents": [str(path) for path in run.documents],
        "notes": run.notes,
        "hosts": hosts,
        "results": make_converter().unstructure(run.results),
        "pictures": _picture_fields(run),
        "curves": [vars(curve) for curve in run.curves],
    }
    return json.dumps(_plain(data), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def _picture_fields(run):
    keys = ("document", "element", "host", "library", "scene")
    fields = []
    for picture, stem in zip(run.pictures, run.image_names, strict=True):
        largest = None
        if picture.reference is not None:
            largest = difference(picture.image, picture.reference).max()
        files = {"exr": f"pictures/{stem}.exr", "png": f"pictures/{stem}.png"}
        named = {key: getattr(picture, key) for key in keys}
        fields.append(named | files | {"largest_difference": largest})
    return fields


def _plain(value):
    """`value` in the types of JSON; arrays become lists, numbers that are not finite strings."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value


def write(run, folder):
    """Write report.html, results.json, junit.xml and pictures/ into `folder`.

    The pictures are those of the run and their references, each as EXR and PNG.
    Each file appears whole or not at all and replaces one of the same name. The page comes
    last, so that everything else is there when it cannot be made.

    Parameters
    ----------
    run : mxeon.conformance.results.Run
    folder : path-like
        Made if need be.

    Returns
    -------
    Path
        Of report.html.

    Raises
    ------
    OSError
        If something cannot be written.
    ImportError
        If the page's libraries are not installed; says what to install.
    """
    folder = Path(folder)
    write_text(folder / "results.json", to_json(run))
    write_text(folder / "junit.xml", to_junit(run))
    pictures = _with_references(run.pictures)
    for picture, stem in zip(pictures, image_names(pictures), strict=True):
        path = folder / "pictures" / stem
        write_exr(f"{path}.exr", picture.image, picture.metadata)
        write_png(f"{path}.png", picture.image, picture.metadata)
    with replacing(folder / "report.html") as beside, open(beside, "w", encoding="utf-8") as page:
        for text in html(run):
            page.write(text)
    return folder / "report.html"


def html(run):
    """A run as one self-contained HTML page, for a reader.

    Yields
    ------
    str
        The page's text piece by piece, so that no more than a few pictures are in memory.

    Raises
    ------
    ImportError
        If jinja2 or matplotlib, the `report` extra, is not installed.
    """
    try:
        from mxeon.report.page import render
    except ModuleNotFoundError as error:
        if error.name in ("jinja2", "matplotlib"):
            remedy = "pip install 'mxeon[report]'"
            raise PackageError(f"report.html needs {error.name}: {remedy}") from error
        raise
    files = {id(each): stem for each, stem in zip(run.pictures, run.image_names, strict=True)}
    return render(run, lambda picture: f"pictures/{files[id(picture)]}.png")


def _with_references(pictures):
    """`pictures`, and one of the reference for each that has one, unless it is there already."""
    shown = {_subject(picture) for picture in pictures if picture.host == REFERENCE}
    references = []
    for picture in pictures:
        if picture.reference is None or _subject(picture) in shown:
            continue
        shown.add(_subject(picture))
        kept = {key: picture.metadata[key] for key in SHARED_METADATA if key in picture.metadata}
        references.append(
            replace(
                picture,
                host=REFERENCE,
                image=picture.reference,
                metadata=kept | {"host": REFERENCE},
            )
        )
    return (*pictures, *references)


def _subject(picture):
    return picture.document, picture.element, picture.library, picture.scene
