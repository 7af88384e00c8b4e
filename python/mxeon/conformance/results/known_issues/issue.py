# SPDX-License-Identifier: Apache-2.0
"""The type of a known issue, and who may have one."""

import json
from collections.abc import Mapping
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
    says: str = ""
    patch: tuple[str, ...] = ()
    repaired: tuple[Row, ...] = ()
    sizes: Mapping[Row, float] = field(default_factory=dict, hash=False)


def read_issues(text: str) -> tuple[Issue, ...]:
    """The issues in a text of JSON, which `tools/site/upstream/ledger.py` writes from the pages."""
    return tuple(map(_issue, json.loads(text)))


def _issue(table: dict[str, Any]) -> Issue:
    pairs = {key: tuple(map(tuple, table[key])) for key in ("rows", "implied", "repaired")}
    sizes = zip((*pairs["rows"], *pairs["implied"]), table["sizes"], strict=True)
    known = {row: size for row, size in sizes if size is not None}
    lists = {key: tuple(table[key]) for key in ("also", "patch")}
    return Issue(**table | pairs | lists | {"sizes": known})
