# SPDX-License-Identifier: Apache-2.0
"""Port tables in Markdown: written into a template, and read from a specification."""

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise

from mxeon.doc.ports import PortRow, Table
from mxeon.errors import DocumentError, PackageError, install, printable

MARKER = re.compile(r"@MX_TABLE_(\w+)@")
COLUMNS = ("Port", "Description", "Type", "Default", "Accepted Values")


def fill(template: str, tables: Mapping[str, Table]) -> str:
    """A template with every @MX_TABLE_node@ replaced by the table of that node."""

    def table(marker: re.Match[str]) -> str:
        node = marker[1]
        if node not in tables:
            line = template.count("\n", 0, marker.start()) + 1
            raise DocumentError(f"line {line}: {marker[0]} must name a node of the library")
        return table_text(tables[node])

    return MARKER.sub(table, template)


def table_text(table: Table) -> str:
    """A table as Markdown, its columns aligned."""
    rows = [COLUMNS, *(tuple(map(_cell, _cells(port, table.ports))) for port in table.ports)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    rows.insert(1, tuple("-" * width for width in widths))
    return "\n".join(f"|{'|'.join(map(str.ljust, row, widths))}|" for row in rows)


def _cell(text: str) -> str:
    """A text that ends no cell, breaks no row and steers no terminal."""
    return " ".join(printable(text).split()).replace("|", "\\|")


def read_tables(text: str) -> dict[str, Table]:
    """Tables of a specification whose first column is headed Port, by the node of the heading above."""
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
        ports = tuple(_port(dict(zip(columns, row, strict=True))) for row in rows[1:] if row[0])
        tables[node] = Table(node, _resolved(ports))
    if not tables:
        raise DocumentError("the text must have a table whose first column is headed Port")
    return tables


def _cells(port: PortRow, ports: Sequence[PortRow]) -> tuple[str, ...]:
    """A row of a table."""
    return (f"`{port.name}`", port.description, _types(port, ports), port.default, port.accepted)


def _types(port: PortRow, ports: Sequence[PortRow]) -> str:
    """Types of a port in words; of several ports with the same choice, all refer to the first."""
    first = next(other for other in ports if other.types == port.types)
    if len(port.types) == 1:
        return port.types[0]
    if first is not port:
        return f"Same as `{first.name}`"
    comma = "," if len(port.types) > 2 else ""
    return f"{', '.join(port.types[:-1])}{comma} or {port.types[-1]}"


def _port(row: Mapping[str, str]) -> PortRow:
    """A port from the cells of a row, by the name of their column."""
    return PortRow(
        row["port"].strip("` "),
        row.get("description", ""),
        (row.get("type", ""),),
        row.get("default", ""),
        row.get("accepted values", ""),
    )


def _resolved(ports: Sequence[PortRow]) -> tuple[PortRow, ...]:
    """Ports whose types are names, in place of words such as "A or B" and "Same as `port`"."""
    types: dict[str, tuple[str, ...]] = {}
    for port in ports:
        same = re.fullmatch(r"same as `?(\w+)`?", port.types[0], re.IGNORECASE)
        names = re.split(r",\s*or\s+|\s+or\s+|,\s*", port.types[0])
        types[port.name] = types.get(same[1], ()) if same else tuple(names)
    return tuple(
        PortRow(port.name, port.description, types[port.name], port.default, port.accepted)
        for port in ports
    )


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
