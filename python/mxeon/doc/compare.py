# SPDX-License-Identifier: Apache-2.0
"""The port tables of a specification against those of a library."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mxeon.doc.ports import PortRow, Table

NONE = ("", "__zero__", "__empty__")  # defaults that are no value


@dataclass(frozen=True)
class Difference:
    """A difference between a specification and a library."""

    node: str
    port: str  # "" where the node as a whole differs
    subject: str  # "node", "port", "type", "default" or "accepted values"
    specification: str  # "" for nothing
    library: str

    def __str__(self) -> str:
        place = f"{self.node}.{self.port}" if self.port else self.node
        if self.subject in ("node", "port"):
            only = "specification" if self.specification else "library"
            return f"{place}: only the {only} has this {self.subject}"
        return (
            f"{place}: {self.subject}: the specification has {self.specification or 'none'}, "
            f"the library {self.library or 'none'}"
        )


def compare(
    specification: Mapping[str, Table], library: Mapping[str, Table]
) -> tuple[Difference, ...]:
    """Differences in the nodes that a specification has, in its order."""
    return tuple(
        difference
        for node, table in specification.items()
        for difference in _of_node(table, library.get(node))
    )


def _of_node(table: Table, defined: Table | None) -> Iterator[Difference]:
    if defined is None:
        yield Difference(table.node, "", "node", table.node, "")
        return
    ours = {port.name: port for port in defined.ports}
    for port in table.ports:
        if port.name in ours:
            yield from _of_port(table.node, port, ours[port.name])
        else:
            yield Difference(table.node, port.name, "port", port.name, "")
    stated = {port.name for port in table.ports}
    for name in (name for name in ours if name not in stated):
        yield Difference(table.node, name, "port", "", name)


def _of_port(node: str, port: PortRow, defined: PortRow) -> Iterator[Difference]:
    if set(port.types) != set(defined.types):
        types = (" or ".join(each.types) for each in (port, defined))
        yield Difference(node, port.name, "type", *types)
    if _value(port.default) != _value(defined.default):
        yield Difference(node, port.name, "default", port.default, defined.default)
    if _accepted(port.accepted) != _accepted(defined.accepted):
        yield Difference(node, port.name, "accepted values", port.accepted, defined.accepted)


def _value(text: str) -> Any:
    """A default as its different numbers in order, or as text: 1.0 means 1.0, 1.0, 1.0 as well."""
    if text in NONE:
        return ""
    try:
        numbers = tuple(map(float, text.split(",")))
    except ValueError:
        return text
    return numbers[:1] if len(set(numbers)) == 1 else numbers


def _accepted(text: str) -> Any:
    """A range as its brackets and bounds, names as a set."""
    text = text.replace(" ", "").replace("∞", "inf")
    if text.startswith(("[", "(")):
        return text[0], text[-1], *map(_value, text[1:-1].split(","))
    return frozenset(filter(None, text.split(",")))
