# SPDX-License-Identifier: Apache-2.0
"""Port tables of nodes: from node definitions into Markdown, and compared with a specification's."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, TypeAlias

import MaterialX as mx

from mxeon.errors import DocumentError, PackageError, install, printable
from mxeon.shaders.library import load_library

GROUP = "pbr"  # nodegroup of the specification's nodes; others of a category are other nodes
FLOATS = ("float", "vector2", "vector3", "vector4", "color3", "color4")
MARKER = re.compile(r"@MX_TABLE_(\w+)@")
COLUMNS = ("Port", "Description", "Type", "Default", "Accepted Values")
NONE = ("", "__zero__", "__empty__")  # defaults that are not values


@dataclass(frozen=True)
class PortRow:
    name: str
    description: str
    types: tuple[str, ...]  # one for each definition of the node
    default: str = ""  # value without a connection, or the name of its geometric property
    accepted: str = ""  # a range, as [0, 1], or names with commas between them


Table: TypeAlias = tuple[PortRow, ...]  # ports of a node, inputs first


def library_tables(library: str = "stock") -> dict[str, Table]:
    """Tables by category: of definitions in GROUP if there are any, and of default versions."""
    definitions: dict[str, list[mx.NodeDef]] = {}
    for definition in load_library(library).getNodeDefs():
        if not definition.getVersionString() or definition.getDefaultVersion():
            definitions.setdefault(definition.getNodeString(), []).append(definition)
    return {node: _table(same) for node, same in sorted(definitions.items())}


def _table(definitions: Sequence[mx.NodeDef]) -> Table:
    chosen = [each for each in definitions if each.getNodeGroup() == GROUP] or definitions
    inputs = [
        PortRow(
            port.getName(),
            port.getDocString(),
            (port.getType(),),
            port.getDefaultGeomPropString() or _default(port),
            _range(port),
        )
        for each in chosen
        for port in each.getActiveInputs()
    ]
    outputs = [
        PortRow(port.getName(), port.getDocString(), (port.getType(),))
        for each in chosen
        for port in each.getActiveOutputs()
    ]
    return (*_merged(inputs), *_merged(outputs))


def _merged(ports: Iterable[PortRow]) -> Iterable[PortRow]:
    """One port per name, with the types of all; the other columns come from the first."""
    merged: dict[str, PortRow] = {}
    for port in ports:
        first = merged.get(port.name, port)
        types = tuple(dict.fromkeys(first.types + port.types))
        merged[port.name] = replace(first, types=types)
    return merged.values()


def _default(port: mx.Input) -> str:
    """Value of an input, each float with a point."""
    text = str(port.getValueString())
    if port.getType() not in FLOATS:
        return text
    return ", ".join(part if "." in part else f"{part}.0" for part in _parts(text))


def _range(port: mx.Input) -> str:
    """Range or names of an input, as a table states them."""
    if names := port.getAttribute("enum"):
        return ", ".join(_parts(names))
    least, largest = (_bound(port.getAttribute(name)) for name in ("uimin", "uimax"))
    if not least and not largest:
        return ""
    return f"{f'[{least}' if least else '(-∞'}, {f'{largest}]' if largest else '∞)'}"


def _bound(text: str) -> str:
    """A bound without trailing zeros; one number where all components have the same."""
    numbers = dict.fromkeys(f"{float(part):g}" for part in _parts(text))
    return next(iter(numbers)) if len(numbers) == 1 else ", ".join(_parts(text))


def _parts(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def fill(template: str, tables: Mapping[str, Table]) -> str:
    """A template with every @MX_TABLE_node@ replaced by the table of that node."""

    def table(marker: re.Match[str]) -> str:
        if marker[1] not in tables:
            line = template.count("\n", 0, marker.start()) + 1
            raise DocumentError(f"line {line}: {marker[0]} must name a node of the library")
        return table_text(tables[marker[1]])

    return MARKER.sub(table, template)


def table_text(table: Table) -> str:
    """A table as Markdown, its columns aligned."""
    rows: list[Sequence[str]] = [COLUMNS]
    for port in table:
        types = _types_text(port, table)
        cells = (f"`{port.name}`", port.description, types, port.default, port.accepted)
        # Escape a text so that it cannot end a cell, break a row or control a terminal.
        rows.append(tuple(" ".join(printable(x).split()).replace("|", "\\|") for x in cells))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    rows.insert(1, tuple("-" * width for width in widths))
    return "\n".join(f"|{'|'.join(map(str.ljust, row, widths))}|" for row in rows)


def _types_text(port: PortRow, table: Table) -> str:
    """Types of a port in words; if several ports have the same choice, each refers to the first."""
    first = next(other for other in table if other.types == port.types)
    if len(port.types) == 1:
        return port.types[0]
    if first is not port:
        return f"Same as `{first.name}`"
    comma = "," if len(port.types) > 2 else ""
    return f"{', '.join(port.types[:-1])}{comma} or {port.types[-1]}"


def read_tables(text: str) -> dict[str, Table]:
    """Tables of a specification whose first column is headed Port, by the node in the heading above."""
    tables: dict[str, Table] = {}
    for heading, rows in _headed_tables(text):
        columns = [cell.lower() for cell in rows[0]]
        if columns[:1] != ["port"]:
            continue
        node = heading.strip("` ")
        if not node:
            raise DocumentError("a table of ports must follow a heading that names its node")
        if node in tables:
            raise DocumentError(f"there must be one table of ports below the heading {node}")
        cells = [dict(zip(columns, row, strict=True)) for row in rows[1:] if row[0]]
        tables[node] = tuple(_read_ports(cells))
    if not tables:
        raise DocumentError("the text must have a table whose first column is headed Port")
    return tables


def _read_ports(rows: Iterable[Mapping[str, str]]) -> Iterator[PortRow]:
    """Ports of cells by column, with the types that words such as "A or B" and "Same as `x`" mean."""
    known: dict[str, tuple[str, ...]] = {}
    for row in rows:
        name, words = row["port"].strip("` "), row.get("type", "")
        same = re.fullmatch(r"same as `?(\w+)`?", words, re.IGNORECASE)
        types = tuple(re.split(r",\s*or\s+|\s+or\s+|,\s*", words))
        known[name] = known.get(same[1], ()) if same else types
        others = (row.get(column, "") for column in ("default", "accepted values"))
        yield PortRow(name, row.get("description", ""), known[name], *others)


def _headed_tables(text: str) -> list[tuple[str, list[list[str]]]]:
    """Every table as its rows of cells, with the heading above it."""
    try:
        from markdown_it import MarkdownIt
    except ImportError:
        raise PackageError(f"doc --compare needs markdown-it-py: {install('doc')}") from None
    heading = ""
    tables: list[tuple[str, list[list[str]]]] = []
    tokens = MarkdownIt("commonmark").enable("table").parse(text)
    for before, token in pairwise(tokens):
        if before.type == "heading_open":
            heading = token.content
        elif before.type == "table_open":
            tables.append((heading, []))
        elif before.type == "tr_open":
            tables[-1][1].append([])
        if before.type in ("th_open", "td_open"):
            tables[-1][1][-1].append(token.content.strip())
    return tables


@dataclass(frozen=True)
class Difference:
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
    found: list[Difference] = []
    for node, table in specification.items():
        if node not in library:
            found.append(Difference(node, "", "node", node, ""))
            continue
        ours, stated = {port.name: port for port in library[node]}, {port.name for port in table}
        for port in table:
            if port.name in ours:
                found += _of_port(node, port, ours[port.name])
            else:
                found.append(Difference(node, port.name, "port", port.name, ""))
        found += [Difference(node, name, "port", "", name) for name in ours if name not in stated]
    return tuple(found)


def _of_port(node: str, port: PortRow, defined: PortRow) -> Iterator[Difference]:
    if set(port.types) != set(defined.types):
        types = (" or ".join(each.types) for each in (port, defined))
        yield Difference(node, port.name, "type", *types)
    if _value(port.default) != _value(defined.default):
        yield Difference(node, port.name, "default", port.default, defined.default)
    if _accepted(port.accepted) != _accepted(defined.accepted):
        yield Difference(node, port.name, "accepted values", port.accepted, defined.accepted)


def _value(text: str) -> Any:
    """A default as its distinct numbers in order, or as text: 1.0 also stands for 1.0, 1.0, 1.0."""
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
