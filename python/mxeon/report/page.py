# SPDX-License-Identifier: Apache-2.0
"""The report page, one self-contained HTML file. Needs the `report` extra."""

from base64 import b64encode
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from numpy.typing import NDArray

from mxeon.conformance.results import (
    DIFFERS,
    FAILED,
    NOT_RUN,
    PASSED,
    SHADER_FUNCTIONS,
    SOURCE,
    AlbedoCurve,
    Picture,
    Result,
    Run,
)
from mxeon.io.images import difference, difference_scale
from mxeon.io.srgb import srgb_encoded
from mxeon.report.formats import LOOKS, linked, nearest, number, share, vector
from mxeon.report.plots import albedo_plot, difference_gradient, difference_pixels, picture_uri
from mxeon.report.threads import in_threads

# Markers of hosts in plots, in order: matplotlib's name, and the character that looks like it.
MARKERS = (("o", "○"), ("s", "□"), ("^", "△"), ("D", "◇"))
# Materials whose pictures are inside the page, about a megabyte each; others are linked.
SHOWN_MATERIALS = 60


@dataclass(frozen=True)
class CheckResults:
    """Results of one check on one host with one library.

    Attributes
    ----------
    key : str
        Name of the check.
    anchor : str
        Identifier in the page.
    results : tuple of Result
        At least one, of different subjects.
    """

    key: str
    anchor: str
    results: tuple[Result, ...]

    @property
    def claim(self) -> str:
        """The sentence that the check tests."""
        return self.results[0].claim

    @property
    def verdict(self) -> str:
        """The worst verdict of the results."""
        verdicts = {result.verdict for result in self.results}
        return next(
            verdict for verdict in (FAILED, NOT_RUN, DIFFERS, PASSED) if verdict in verdicts
        )

    @property
    def tightest(self) -> Result | None:
        """The result with the largest share of its tolerance; None if none ran."""
        ran = [result for result in self.results if result.error is not None]
        return max(ran, key=share, default=None)

    @property
    def diagnoses(self) -> dict[Markup, list[str]]:
        """Subjects that failed or differ, by what explains that."""
        subjects: dict[Markup, list[str]] = {}
        for one in self.results:
            if one.verdict in (FAILED, DIFFERS):
                within = one.error is not None and share(one) <= 1.0
                words = linked(one, one.excess if within else "")
                subjects.setdefault(words, []).append(one.subject)
        return subjects

    def distinct(self, attribute: str) -> list[str]:
        """Different non-empty values of an attribute of the results."""
        values = dict.fromkeys(getattr(one, attribute) for one in self.results)
        return [value for value in values if value]


def _audit_apart(results: Iterable[Result]) -> tuple[list[Result], list[Result]]:
    """Results of nodes and documents, and those of the library itself, its functions and its text."""
    asked: list[Result] = []
    own: list[Result] = []
    for result in results:
        audits = result.host == SOURCE or result.subject == SHADER_FUNCTIONS
        (own if audits else asked).append(result)
    return asked, own


def checks_by_place(
    results: Iterable[Result], prefix: str = "check"
) -> dict[tuple[str, str], list[CheckResults]]:
    """Checks by host and library, in order of appearance; the prefix is that of their anchors."""
    places: dict[tuple[str, str], dict[str, list[Result]]] = {}
    for result in results:
        place = places.setdefault((result.host, result.library), {})
        place.setdefault(result.check, []).append(result)
    return {
        location: [
            CheckResults(key, f"{prefix}-{column}-{row}", tuple(members))
            for row, (key, members) in enumerate(rows.items())
        ]
        for column, (location, rows) in enumerate(places.items())
    }


def matrix(
    places: Mapping[tuple[str, str], Sequence[CheckResults]],
) -> list[tuple[str, list[CheckResults | None]]]:
    """Rows of the table of checks: the name, and the CheckResults of each host and library, or None."""
    columns = [{check.key: check for check in checks} for checks in places.values()]
    keys = dict.fromkeys(key for column in columns for key in column)
    return [(key, [column.get(key) for column in columns]) for key in keys]


def reasons(results: Iterable[Result]) -> dict[str, list[Result]]:
    """Results that did not run, by reason."""
    stopped: dict[str, list[Result]] = {}
    for result in results:
        if result.verdict == NOT_RUN:
            stopped.setdefault(result.reason, []).append(result)
    return stopped


def materials(
    pictures: Iterable[Picture],
) -> dict[tuple[str, str], dict[str, list[Picture]]]:
    """Pictures by document and element, then by scene."""
    groups: dict[tuple[str, str], dict[str, list[Picture]]] = {}
    for picture in pictures:
        scenes = groups.setdefault((picture.document, picture.element), {})
        scenes.setdefault(picture.scene, []).append(picture)
    return groups


def panels(pictures: Iterable[Picture]) -> list[dict[str, Any]]:
    """Panels of one scene: the reference if there is one, then pictures and differences."""
    row: list[dict[str, Any]] = []
    for one in pictures:
        # Read it once: pixels of a run that is kept are in a file.
        image = np.asarray(one.image)
        reference = None if one.reference is None else np.asarray(one.reference)
        # Begin with the reference.
        if reference is not None and not any(each["kind"] == "reference" for each in row):
            pixels = srgb_encoded(reference)
            row.insert(0, _panel("reference", "reference", "NumPy, float64", pixels))
        # Add each picture.
        place = {"host": one.host, "library": one.library}
        row.append(_panel("image", one.host, one.library, srgb_encoded(image), **place))
        if reference is not None:
            # Add its difference from the reference.
            apart = difference(image, reference)
            scale = difference_scale(apart)
            note = f"{one.host}, max {number(apart.max(), 2)}"
            pixels = difference_pixels(apart, scale)
            row.append(_panel("difference", "difference", note, pixels, scale=scale, **place))
    return row


def _panel(
    kind: str, title: str, note: str, pixels: NDArray[np.uint8], **more: Any
) -> dict[str, Any]:
    common = {"kind": kind, "title": title, "note": note, "image": picture_uri(pixels)}
    return {"host": "", "library": ""} | common | more


def plots(curves: Sequence[AlbedoCurve]) -> list[dict[str, Any]]:
    """One plot with all hosts for each subject, library, rho and roughness."""
    hosts = list(dict.fromkeys(curve.host for curve in curves))
    marks = {host: MARKERS[row % len(MARKERS)] for row, host in enumerate(hosts)}
    groups: dict[tuple[Any, ...], list[AlbedoCurve]] = {}
    for curve in curves:
        key = (curve.subject, curve.library, tuple(curve.rho), curve.roughness)
        groups.setdefault(key, []).append(curve)
    return [_plot(members, marks, f"plot-{row}-") for row, members in enumerate(groups.values())]


def _plot(
    curves: Sequence[AlbedoCurve], marks: Mapping[str, tuple[str, str]], prefix: str
) -> dict[str, Any]:
    svg = albedo_plot(curves, [marks[curve.host][0] for curve in curves], prefix)
    legend = [
        (marks[curve.host][1], curve.host, np.abs(curve.measured - curve.expected).max())
        for curve in curves
    ]
    return {"curve": curves[0], "svg": Markup(svg), "legend": legend}


def render(run: Run, file_of: Callable[[Picture], str]) -> Generator[str, None, None]:
    """The page of a run.

    Parameters
    ----------
    run : mxeon.conformance.results.Run
    file_of : callable (Picture) -> str
        Path of the file of a picture, for pictures that the page links to.

    Yields
    ------
    str
        Pieces of HTML; a picture is read when its piece is due. The page loads nothing, runs only its
        own script, and is complete without it. Text from documents, shaders and hosts is escaped.
    """
    asked, own = _audit_apart(run.results)
    places, audit = checks_by_place(asked), checks_by_place(own, "audit")
    rows = list(materials(run.pictures).items())
    shown = rows[:SHOWN_MATERIALS]
    script = files("mxeon.report").joinpath("templates/report.js").read_text(encoding="utf-8")
    environment = Environment(
        loader=PackageLoader("mxeon.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "vector": vector}
    environment.filters |= {
        "linked": linked,
        "share": share,
        "look": LOOKS.__getitem__,
        "nearest": nearest,
    }
    with in_threads(panels, (each for _, scenes in shown for each in scenes.values())) as drawn:
        yield from environment.get_template("report.html.jinja").generate(
            run=run,
            summary=run.summary,
            script=Markup(script),
            script_hash=b64encode(sha256(script.encode()).digest()).decode(),
            places=places,
            audit=audit,
            matrix=matrix(places),
            identities={identity.name: identity for identity in run.hosts},
            reasons=reasons(run.results),
            shown=shown,
            listed=rows[SHOWN_MATERIALS:],
            next_panels=drawn.__next__,
            file_of=file_of,
            gradient=Markup(difference_gradient()),
            plots=plots(run.curves),
            verdicts=tuple(LOOKS),
            FAILED=FAILED,
            PASSED=PASSED,
            DIFFERS=DIFFERS,
        )
