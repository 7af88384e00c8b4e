# SPDX-License-Identifier: Apache-2.0
"""What a claim is, and the page "The paper, checked" with what was measured of each."""

from collections.abc import Callable
from dataclasses import dataclass

HOLDS, IN_PART, FAILS = "holds", "holds in part", "**fails**"

HEAD = """# The paper, checked

`mxeon figures` writes this page. It measures the numbers below, in float64 unless stated otherwise.
Equations, figures and listings are those of [Portsmouth2025], the JCGT 2025 edition; the bibliography
is in the README. The figures are below the claims; their data are in the folder `figures`.

{count} claims: {holds} hold, {part} hold in part, {fails} fail.
"""


@dataclass(frozen=True)
class Claim:
    """A sentence or formula in print, and its test.

    Attributes
    ----------
    where, text : str
        Place in the paper, and what it says, in our words.
    measure : callable
        measure() -> (what was found, HOLDS or IN_PART or FAILS), both str.
    """

    where: str
    text: str
    measure: Callable


def verdict(holds):
    """HOLDS or FAILS."""
    return HOLDS if holds else FAILS


def page(sections):
    """The page as Markdown, from titles and their claims."""
    measured = {
        heading: [(claim, *claim.measure()) for claim in claims]
        for heading, claims in sections.items()
    }
    verdicts = [row[2] for rows in measured.values() for row in rows]
    parts = [
        HEAD.format(
            count=len(verdicts),
            holds=verdicts.count(HOLDS),
            part=verdicts.count(IN_PART),
            fails=verdicts.count(FAILS),
        )
    ]
    for heading, rows in measured.items():
        lines = [f"| {c.where} | {c.text} | {found} | {result} |" for c, found, result in rows]
        head = ["| where | claim | measured | verdict |", "|---|---|---|---|"]
        parts.append("\n".join([f"## {heading}", "", *head, *lines, ""]))
    return "\n".join(parts)
