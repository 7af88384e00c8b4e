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
    """An issue upstream: its page, and the results that show it."""

    page: str  # its name without suffix
    title: str  # its heading, which says what is wrong
    host: str  # the host that shows it; "source" for generated text
    rows: tuple[Row, ...]  # results that all fail
    also: tuple[str, ...] = ()  # other hosts that show it
    implied: tuple[Row, ...] = ()  # other results that fail for it, on those hosts or in the text
    library: str = STOCK  # the library that has it; RENDERER_NODES for a renderer's own nodes
    unavoidable: bool = False  # each library has it: no text can repair it, or none of ours does
    differs: bool = False  # the text leaves the choice
    says: str = ""  # the diagnosis of the first of `rows`, as the page has it
    patch: tuple[str, ...] = ()  # a file of MaterialX, and a text of it before and after
    repaired: tuple[Row, ...] = ()  # results that it explains no longer once it is patched
    # The largest errors that were measured.
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
    plain = ("title", "host", "library", "unavoidable", "differs")
    pairs: dict[str, Any] = {
        name: _pairs(entry.get(name, {})) for name in ("rows", "implied", "repaired")
    }
    for remains in entry.get("remains", {}).values():
        pairs["repaired"] += _pairs(remains)
    sizes = measured.get("sizes", {})
    return Issue(
        page,
        **{name: entry[name] for name in plain if name in entry},
        **pairs,
        also=tuple(entry.get("also", ())),
        says=measured.get("says", ""),
        patch=tuple(measured.get("patch", ())),
        sizes={(check, subject): size for check in sizes for subject, size in sizes[check].items()},
    )


def _pairs(subjects: Mapping[str, Sequence[str]]) -> tuple[Row, ...]:
    return tuple((check, subject) for check, each in subjects.items() for subject in each)
