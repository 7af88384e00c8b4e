# SPDX-License-Identifier: Apache-2.0
"""The type of a known issue, and who may have one."""

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

STOCK = "stock"
RENDERER_NODES = "its own nodes"  # in the place of a library
Row = tuple[str, str]  # key of a check, and subject


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
        Whether each library has it, since no text can repair it or none of ours does.
    says : str
        The diagnosis of the first of `rows`, as the page has it; "" for none.
    patch : tuple of str
        A file of MaterialX, and a text of it before and after the patch; () where there is no patch.
    repaired : tuple of (str, str)
        Results that the issue explains no longer once its patch is applied.
    sizes : mapping of (str, str) to float
        The largest error that was measured of results.
    """

    page: str
    title: str
    host: str
    rows: tuple[Row, ...]
    also: tuple[str, ...] = ()
    implied: tuple[Row, ...] = ()
    library: str = STOCK
    unavoidable: bool = False
    differs: bool = False  # the text leaves the choice
    says: str = ""
    patch: tuple[str, ...] = ()
    repaired: tuple[Row, ...] = ()
    sizes: Mapping[Row, float] = field(default_factory=dict, hash=False)


def read_issues(text: str, measured: str) -> tuple[Issue, ...]:
    """The issues of `known_issues.toml` that a check shows, with what `measured.json` says of them."""
    found = json.loads(measured)
    return tuple(
        _issue(page, entry, found.get(page, {}))
        for page, entry in tomllib.loads(text).items()
        if "host" in entry
    )


def _issue(page: str, entry: Mapping[str, Any], measured: Mapping[str, Any]) -> Issue:
    sizes = measured.get("sizes", {})
    return Issue(
        page,
        entry["title"],
        entry["host"],
        _pairs(entry.get("rows", {})),
        tuple(entry.get("also", ())),
        _pairs(entry.get("implied", {})),
        entry.get("library", STOCK),
        entry.get("unavoidable", False),
        entry.get("differs", False),
        measured.get("says", ""),
        tuple(measured.get("patch", ())),
        (
            *_pairs(entry.get("repaired", {})),
            *(row for each in entry.get("remains", {}).values() for row in _pairs(each)),
        ),
        {(check, subject): size for check in sizes for subject, size in sizes[check].items()},
    )


def _pairs(subjects: Mapping[str, Sequence[str]]) -> tuple[Row, ...]:
    return tuple((check, subject) for check, each in subjects.items() for subject in each)
