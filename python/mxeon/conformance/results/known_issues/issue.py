# SPDX-License-Identifier: Apache-2.0
"""The type of a known issue, and who may have one."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypedDict

STOCK = "stock"
RENDERER_NODES = "its own nodes"  # in the place of a library


@dataclass(frozen=True)
class Issue:
    """An issue upstream: its page, and the results that show it.

    Attributes
    ----------
    page : str
        Its name without suffix.
    title : str
        Its heading, which says what is wrong.
    host : str
        The host that shows it; "source" for generated text.
    rows : tuple of (str, str)
        Key of the check and subject of each result, all of which fail.
    also : tuple of str
        Other hosts that show it.
    implied : tuple of (str, str)
        Key and subject of other results that fail for it, on those hosts or in the text.
    library : str
        The library that has it; RENDERER_NODES for a renderer's own nodes.
    unavoidable : bool
        Whether no text can repair it, so that each library has it.
    """

    page: str
    title: str
    host: str
    rows: tuple[tuple[str, str], ...]
    also: tuple[str, ...] = ()
    implied: tuple[tuple[str, str], ...] = ()
    library: str = STOCK
    unavoidable: bool = False


class _Row(TypedDict):
    """An issue in issues.json."""

    page: str
    title: str
    host: str
    rows: list[tuple[str, str]]
    also: list[str]
    implied: list[tuple[str, str]]
    library: str
    unavoidable: bool


def read_issues(text: str) -> tuple[Issue, ...]:
    """The issues in a text of JSON, which `docs/upstream/ledger.py` writes from the pages."""
    rows: list[_Row] = json.loads(text)
    return tuple(
        Issue(
            row["page"],
            row["title"],
            row["host"],
            _pairs(row["rows"]),
            tuple(row["also"]),
            _pairs(row["implied"]),
            row["library"],
            row["unavoidable"],
        )
        for row in rows
    )


def _pairs(rows: Iterable[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    return tuple((check, subject) for check, subject in rows)
