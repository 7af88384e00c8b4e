# SPDX-License-Identifier: Apache-2.0
"""The page "The paper, checked", and its claims. A claim is a measurement with limits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

HOLDS, IN_PART, FAILS = "holds", "holds in part", "**fails**"
COLUMNS = ("where", "claim", "measured", "required", "verdict")

HEAD = """# The paper, checked

Does the EON paper say what is true? `python -m tools.paper` measures its claims in float64 unless stated otherwise, writes
this page, and prints the figures of those that hold. Equations, figures and listings have the numbers of [Portsmouth2025],
the JCGT 2025 edition ([bibliography](bibliography.md)).

A claim *holds* if all of its measured values meet its limit, holds *in part* if some do, and *fails* if none
does; NaN meets no limit. The tables have the claims that do not hold, with the limit in the column *required*.
The paper's formulas of values and albedos, and of rho for an albedo, are not among the claims: the tests compare them
with 50 digits of the printed equations. They also test that densities integrate to 1 and mean weights are 1.
"""

# Result of a measurement: a sentence for the page, and values to compare with the limits.
Measured = tuple[str, ArrayLike]
Measure = Callable[[], Measured]
ROUNDING = 1e-12  # largest difference between equivalent formulas


@dataclass
class Section:
    """Claims under one heading. Each function in `rows` measures a claim."""

    heading: str
    rows: list[Callable[[], tuple[str, ...]]] = field(default_factory=list)

    def claim(
        self,
        where: str,
        text: str,
        required: str,
        *,
        least: float = -np.inf,
        most: float | None = None,
    ) -> Callable[[Measure], Measure]:
        """Decorator for measurements. The claim is that all values are in [least, most]."""
        top = most if most is not None else ROUNDING if least == -np.inf else np.inf
        limit = f"in [{least:.3g}, {top:.3g}]"
        if not np.isfinite(top):
            limit = f"≥ {least:.3g}"
        elif not np.isfinite(least):
            limit = f"≤ {top:.3g}"

        def add(measure: Measure) -> Measure:
            def row() -> tuple[str, ...]:
                sentence, values = measure()
                return where, text, sentence, f"{required} {limit}", verdict(values, least, top)

            self.rows.append(row)
            return measure

        return add


def verdict(values: ArrayLike, least: float, most: float) -> str:
    """HOLDS if all values lie in [least, most], IN_PART if some values do, otherwise FAILS.

    >>> verdict([1.0, 3.0], 0.0, 2.0), verdict(float("nan"), 0.0, 2.0)
    ('holds in part', '**fails**')
    """
    values = np.asarray(values, dtype=np.float64)
    within = (least <= values) & (values <= most)
    if within.all():
        return HOLDS
    return IN_PART if within.any() else FAILS


def page(sections: Sequence[Section]) -> str:
    """Measure every claim, print the claims that hold, and return the page as Markdown."""
    parts = [HEAD]
    for section in sections:
        rows = [row() for row in section.rows]
        holding = [row for row in rows if row[-1] == HOLDS]
        for row in holding:
            print("; ".join(row))
        rest = [row for row in rows if row[-1] != HOLDS]
        in_part = [row for row in rest if row[-1] == IN_PART]
        tally = (
            f"{len(rows)} claims; verdicts: {len(holding)} holds, {len(in_part)} holds in part, "
            f"{len(rest) - len(in_part)} fails."
        )
        lines = [f"| {' | '.join(cells)} |" for cells in (COLUMNS, *rest)]
        lines.insert(1, "|---" * len(COLUMNS) + "|")
        lines += ["", f"These hold: {'; '.join(f'{row[0]}, {row[1]}' for row in holding)}."]
        parts.append("\n".join([f"## {section.heading}", "", tally, "", *lines, ""]))
    return "\n".join(parts)
