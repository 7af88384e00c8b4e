# SPDX-License-Identifier: Apache-2.0
"""Scripts that write pages of docs/. Each measured page has a separate command.

| command (`...`: as in the first row) | what it writes |
|---|---|
| `python -m tools.site` | OSL versions of GLSL files, and tables that need no engine, in a minute |
| `... specification` | table of results.md, measured on gl in some seconds |
| `... surface_texts` | tables of surfaces.md, in some minutes |
| `... field` | data of field.html, measured on every host that runs here |
| `... versions` | versions.md and ledger/versions.json, in a quarter of an hour |
| `... gallery`, `... explorer`, `... note` | pictures for the page of the same name |
| `... wall REPORT...` | wall.md and the tiles of that page, from reports of `mxeon check` |
| `... ledger.measure [HOST ...]`, `... ledger.pictures` | measured.json and pictures in docs/upstream |
"""

import math
import re
from pathlib import Path

from mxeon import survey
from mxeon.conformance import words
from mxeon.conformance.results import Difference
from mxeon.hosts import register

register(*survey.ROWS)
ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def in_percent(share: float) -> str:
    """
    >>> in_percent(-0.1234), in_percent(0.0002)
    ('-12 %', 'none')
    """
    sign = "-" if share < 0.0 else "+"
    return f"{sign}{words.in_words(100.0 * abs(share))} %" if abs(share) >= 0.001 else "none"


def brief(difference: Difference) -> str:
    """Largest difference of a picture, and the fraction of the object that visibly differs.

    >>> brief(Difference("back", 0.2035, False, 0.124))
    '+20 %, visible on 12 %'
    """
    if not math.isfinite(difference.largest):
        return words.appearance(difference)
    share = words.in_words(100.0 * difference.visible)
    visible = f", visible on {share} %" if difference.visible else ""
    return f"{in_percent(difference.largest)}{visible}"


def with_block(page: str, name: str, text: str) -> str:
    """The page with `text` between the comments `name` and `end`."""
    block = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
    return block.sub(lambda found: found[1] + text + found[2], page)
