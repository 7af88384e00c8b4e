# SPDX-License-Identifier: Apache-2.0
"""Formats of numbers, verdicts and explanations on pages of reports."""

import math
import re
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike

from mxeon.conformance import words
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, Result
from mxeon.conformance.results.known_issues import Issue, folder, issues_of

# CSS class of each verdict, and a sign that does not rely on color.
LOOKS = {
    PASSED: ("passed", "✓"),
    DIFFERS: ("differs", "≠"),
    FAILED: ("failed", "✗"),
    NOT_RUN: ("not-run", "–"),
}

# Matches spaces between numbers and units. The pattern also matches whole code elements, so that
# spaces in code are skipped.
SPACES = re.compile(
    r"<(pre|code|script|style)\b.*?</\1>"
    r"|(?<=\d) (?=(?:%|px|[nµm]m|[µm]?s|[kKMG]i?B|degrees|times|codes|paths)(?!\w))",
    re.DOTALL,
)


def unbroken(html: str) -> str:
    """Keep each number in HTML on one line with its unit.

    >>> unbroken("12 % in 3 s of <code>12 % 3 s</code>")
    '12\\xa0% in 3\\xa0s of <code>12 % 3 s</code>'
    """
    return SPACES.sub(lambda found: found[0] if found[1] else "\xa0", html)


def share(result: Result) -> float:
    """The error divided by the tolerance; infinite if the error is missing or not finite."""
    error, tolerance = result.error, result.tolerance
    if error is None or not math.isfinite(error):
        return math.inf
    if not tolerance:
        return math.inf if error > 0.0 else 0.0
    return error / tolerance


def number(value: float | None, digits: int = 3) -> str:
    """A number as text, without leading zeros in the exponent; a dash for None."""
    return "–" if value is None else re.sub(r"e([+-])0*", r"e\1", f"{value:.{digits}g}")


def nearest(distances: Mapping[str, float], count: int = 5) -> list[tuple[str, float, float]]:
    """The nearest models as (title, distance, distance / largest distance in the list)."""
    rows = sorted(distances.items(), key=lambda pair: pair[1])[:count]
    largest = max((distance for _, distance in rows), default=0.0) or 1.0
    return [(title, distance, distance / largest) for title, distance in rows]


def linked(result: Result) -> Markup:
    """Explanation of a result as HTML: a missed negative control, diagnosis, and known issues."""
    excess = words.excess(result) if result.within and result.verdict != PASSED else ""
    links = [Markup("see ") + each for each in _links(result)]
    return Markup("; ").join(
        [each for each in (excess, words.diagnosis(result.diagnosis), *links) if each]
    )


def causes_of(result: Result) -> list[Markup]:
    """Links to the known issues that explain a failure; the diagnosis if no issue is known."""
    diagnosis = words.diagnosis(result.diagnosis) or words.excess(result)
    return _links(result) or [Markup.escape(diagnosis)]


def _links(result: Result) -> list[Markup]:
    link = Markup('<a href="{}">{}</a>')
    return [link.format(page_address(issue), issue.title) for issue in issues_of(result)]


def page_address(issue: Issue) -> str:
    """Address of an issue's page, which is on the documentation's site or next to the report."""
    site = _site()
    return f"{site}/upstream/{issue.page}.html" if site else f"upstream/{issue.page}.md"


def link(issue: Issue) -> str:
    """Address of an issue's page on the site, or path of the page's file if no site is known."""
    if _site():
        return page_address(issue)
    file = folder().resolve() / f"{issue.page}.md"
    return str(file.relative_to(Path.cwd()) if file.is_relative_to(Path.cwd()) else file)


@cache
def _site() -> str:
    """Address of the documentation in the package's metadata (`project.urls`); "" if unknown."""
    try:
        urls = metadata("mxeon").get_all("Project-URL") or []
    except PackageNotFoundError:  # mxeon is not installed as a package
        return ""
    addresses = dict(each.split(", ", 1) for each in urls)
    return str(addresses.get("Documentation", "")).rstrip("/")


def vector(values: ArrayLike) -> str:
    """One or more numbers as text: "1" or "(0.5, 0.25)"."""
    numbers = [number(float(value), 4) for value in np.ravel(values)]
    return numbers[0] if len(numbers) == 1 else f"({', '.join(numbers)})"
