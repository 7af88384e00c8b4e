# SPDX-License-Identifier: Apache-2.0
"""The report page: one HTML file with everything inside. Needs the `report` extra."""

import math
import re
from base64 import b64encode
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, Result
from mxeon.io.images import difference, difference_scale, srgb_encoded
from mxeon.report.plots import albedo_plot, difference_gradient, difference_pixels, picture_uri

# Hosts in plots, in order: matplotlib's marker, and the character that looks like it.
MARKERS = (("o", "○"), ("s", "□"), ("^", "△"), ("D", "◇"))
# Materials whose pictures are in the page, a megabyte or so each; those of others lie beside it.
SHOWN_MATERIALS = 60
# How each verdict looks: its CSS class and its mark, for those who do not see the colour.
LOOKS = {PASSED: ("passed", "✓"), FAILED: ("failed", "✗"), NOT_RUN: ("not-run", "–")}


@dataclass(frozen=True)
class Check:
    """One row of the table of checks on one host with one library.

    Attributes
    ----------
    key : str
    anchor : str
        Its identifier in the page.
    results : tuple of Result
        At least one, of different subjects.
    """

    key: str
    anchor: str
    results: tuple[Result, ...]

    @property
    def claim(self):
        """What it tests, the same in all its results."""
        return self.results[0].claim

    @property
    def verdict(self):
        """The worst of its results."""
        found = {result.verdict for result in self.results}
        return next(verdict for verdict in (FAILED, NOT_RUN, PASSED) if verdict in found)

    @property
    def tightest(self):
        """The result closest to its tolerance or furthest beyond, None if none ran."""
        ran = [result for result in self.results if result.error is not None]
        return max(ran, key=share, default=None)

    @property
    def diagnoses(self):
        """The subjects that failed, by their diagnosis."""
        found = {}
        for one in self.results:
            if one.verdict == FAILED:
                words = one.diagnosis if one.error is None or share(one) > 1.0 else one.explanation
                found.setdefault(words, []).append(one.subject)
        return found

    def distinct(self, attribute, verdict=None):
        """The different non-empty values of `attribute`, of results with `verdict` or of all."""
        found = [one for one in self.results if verdict in (None, one.verdict)]
        return [value for value in dict.fromkeys(getattr(one, attribute) for one in found) if value]


def share(result):
    """Figure over tolerance; infinite where the figure is no finite number."""
    if not math.isfinite(result.error):
        return math.inf
    if not result.tolerance:
        return math.inf if result.error > 0.0 else 0.0
    return result.error / result.tolerance


def number(value, digits=3):
    """A number as text, or a dash for None.

    Examples
    --------
    >>> number(2.3456e-07), number(0.25), number(None)
    ('2.35e-7', '0.25', '–')
    """
    return "–" if value is None else re.sub(r"e([+-])0*", r"e\1", f"{value:.{digits}g}")


def nearest(distances, count=5):
    """The nearest models of a classification: title, distance, and its share of the largest shown."""
    found = sorted(distances.items(), key=lambda pair: pair[1])[:count]
    largest = max((distance for _, distance in found), default=0.0) or 1.0
    return [(title, distance, distance / largest) for title, distance in found]


def vector(values):
    """One or more numbers as text.

    Examples
    --------
    >>> vector([1.0]), vector((0.5, 0.25))
    ('1', '(0.5, 0.25)')
    """
    words = [number(float(value), 4) for value in np.ravel(values)]
    return words[0] if len(words) == 1 else f"({', '.join(words)})"


def checks_by_place(results):
    """Mapping of (host, library) to the Checks made there, in order of appearance."""
    found = {}
    for result in results:
        place = found.setdefault((result.host, result.library), {})
        place.setdefault(result.check, []).append(result)
    return {
        place: [
            Check(key, f"check-{column}-{row}", tuple(members))
            for row, (key, members) in enumerate(rows.items())
        ]
        for column, (place, rows) in enumerate(found.items())
    }


def matrix(places):
    """Rows of (key, Check or None in each place), one for each check made anywhere."""
    columns = [{check.key: check for check in checks} for checks in places.values()]
    keys = dict.fromkeys(key for column in columns for key in column)
    return [(key, [column.get(key) for column in columns]) for key in keys]


def reasons(results):
    """Mapping of each reason for not running to the Results that it stopped."""
    found = {}
    for result in results:
        if result.verdict == NOT_RUN:
            found.setdefault(result.reason, []).append(result)
    return found


def materials(pictures):
    """Mapping of (document, element) to mappings of scene to its Pictures."""
    found = {}
    for picture in pictures:
        scenes = found.setdefault((picture.document, picture.element), {})
        scenes.setdefault(picture.scene, []).append(picture)
    return found


def panels(pictures):
    """Panels of one scene: the reference if there is one, then pictures and differences."""
    references = [one.reference for one in pictures if one.reference is not None]
    found = []
    if references:
        found.append(_panel("reference", "reference", "float64", srgb_encoded(references[0])))
    for one in pictures:
        place = {"host": one.host, "library": one.library}
        found.append(_panel("image", one.host, one.library, srgb_encoded(one.image), **place))
        if one.reference is not None:
            apart = difference(one.image, one.reference)
            scale = difference_scale(apart)
            note = f"{one.host}, max {number(apart.max(), 2)}"
            pixels = difference_pixels(apart, scale)
            found.append(_panel("difference", "difference", note, pixels, scale=scale, **place))
    return found


def _panel(kind, title, note, pixels, **more):
    common = {"kind": kind, "title": title, "note": note, "image": picture_uri(pixels)}
    return {"host": "", "library": ""} | common | more


def plots(curves):
    """A plot for each subject, library, rho and roughness, with all its hosts."""
    hosts = list(dict.fromkeys(curve.host for curve in curves))
    marks = {host: MARKERS[row % len(MARKERS)] for row, host in enumerate(hosts)}
    found = {}
    for curve in curves:
        key = (curve.subject, curve.library, tuple(curve.rho), curve.roughness)
        found.setdefault(key, []).append(curve)
    return [_plot(members, marks, f"plot-{row}-") for row, members in enumerate(found.values())]


def _plot(curves, marks, prefix):
    svg = albedo_plot(curves, [marks[curve.host][0] for curve in curves], prefix)
    legend = [
        (marks[curve.host][1], curve.host, np.abs(curve.measured - curve.expected).max())
        for curve in curves
    ]
    return {"curve": curves[0], "svg": Markup(svg), "legend": legend}


def render(run, file_of):
    """The page for `run`, an `mxeon.conformance.results.Run`.

    Parameters
    ----------
    run : mxeon.conformance.results.Run
    file_of : callable (Picture) -> str
        The file beside the page that holds a picture, for those that the page does not show.

    Yields
    ------
    str
        HTML that loads nothing and runs nothing but its own script, without which it shows all.
        All that comes from documents, shaders and hosts is escaped. Pieces of the text: a picture
        is read when its turn has come.
    """
    places = checks_by_place(run.results)
    found = list(materials(run.pictures).items())
    script = files("mxeon.report").joinpath("templates/report.js").read_text(encoding="utf-8")
    environment = Environment(
        loader=PackageLoader("mxeon.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "vector": vector}
    environment.filters |= {"share": share, "look": LOOKS.__getitem__, "nearest": nearest}
    return environment.get_template("report.html.jinja").generate(
        run=run,
        summary=run.summary,
        script=Markup(script),
        script_hash=b64encode(sha256(script.encode()).digest()).decode(),
        places=places,
        matrix=matrix(places),
        identities={identity.name: identity for identity in run.hosts},
        reasons=reasons(run.results),
        shown=found[:SHOWN_MATERIALS],
        listed=found[SHOWN_MATERIALS:],
        panels=panels,
        file_of=file_of,
        gradient=Markup(difference_gradient()),
        plots=plots(run.curves),
        verdicts=tuple(LOOKS),
        FAILED=FAILED,
    )
