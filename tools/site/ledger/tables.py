# SPDX-License-Identifier: Apache-2.0
"""Prints differences between a specification's tables of ports and MaterialX's node definitions.

    python -m tools.site.ledger.tables MaterialX.PBRSpec.md

The numbers in docs/upstream/pbrlib_tables.md are from the output of this script.
"""

import re
import sys
from pathlib import Path

import MaterialX as mx

from mxeon.shaders.library import load_library

GROUP = "pbr"  # nodegroup of the nodes in the specification
NONE = ("", "__zero__", "__empty__")  # attribute values that mean that there is no default
KEYS = ("type", "default", "accepted values")  # compared columns
Port = dict[str, object]


def printed(text: str) -> dict[str, dict[str, Port]]:
    """Ports by node and name, read from all tables whose first column is Port."""
    nodes: dict[str, dict[str, Port]] = {}
    node, columns = "", []
    for line in text.splitlines():
        if heading := re.match(r"#+ *`(\w+)`", line):
            node, columns = heading[1], []
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if [cell.lower() for cell in cells[:1]] == ["port"]:
            columns, nodes[node] = [cell.lower() for cell in cells], {}
        elif columns and len(cells) == len(columns) and cells[0].startswith("`"):
            row, ports = dict(zip(columns, cells, strict=True)), nodes[node]
            same = re.fullmatch(r"same as `?(\w+)`?", row["type"], re.IGNORECASE)
            types = set(re.split(r",\s*or\s+|\s+or\s+|,\s*", row["type"]))
            ports[row["port"].strip("` ")] = {
                "type": ports[same[1]]["type"] if same else types,
                "default": value(row.get("default", "")),
                "accepted values": accepted(row.get("accepted values", "")),
            }
    return nodes


def defined(node: str) -> dict[str, Port]:
    """Ports of a node by name, from all definitions of the node in MaterialX."""
    nodes = [each for each in load_library("stock").getNodeDefs() if each.getNodeString() == node]
    default = [each for each in nodes if not each.getVersionString() or each.getDefaultVersion()]
    ports: dict[str, Port] = {}
    for each in [each for each in default if each.getNodeGroup() == GROUP] or default:
        for port in (*each.getActiveInputs(), *each.getActiveOutputs()):
            default, values = "", port.getAttribute("enum")
            if isinstance(port, mx.Input):
                default = port.getDefaultGeomPropString() or port.getValueString()
                values = values or interval(port.getAttribute("uimin"), port.getAttribute("uimax"))
            found = set(), value(default), accepted(values)
            entry = ports.setdefault(port.getName(), dict(zip(KEYS, found, strict=True)))
            entry["type"] = {*entry["type"], port.getType()}
    return ports


def interval(least: str, most: str) -> str:
    """An interval in the specification's notation, or "" if both ends are missing."""
    if not least and not most:
        return ""
    return f"{f'[{least}' if least else '(-inf'}, {f'{most}]' if most else 'inf)'}"


def value(text: str) -> object:
    """A default as text, or as a tuple of numbers. Equal numbers are reduced to one number."""
    try:
        numbers = tuple(map(float, text.split(",")))
    except ValueError:
        return "" if text in NONE else text
    return numbers[:1] if len(set(numbers)) == 1 else numbers


def accepted(text: str) -> object:
    """The brackets and the ends of an accepted range, or the set of accepted names."""
    text = text.replace(" ", "").replace("∞", "inf")
    if text.startswith(("[", "(")):
        return text[0], text[-1], *map(value, text[1:-1].split(","))
    return set(filter(None, text.split(",")))


def main(path: str) -> None:
    count = 0
    for node, table in printed(Path(path).read_text(encoding="utf-8")).items():
        ports = defined(node)
        for name in dict.fromkeys((*table, *ports)):
            for key in KEYS:
                text, library = (
                    each[name][key] if name in each else "no port" for each in (table, ports)
                )
                if text != library:
                    count += 1
                    print(f"{node}.{name}: {key}: the text has {text}, the library {library}")
    print(f"{count} entries differ")


if __name__ == "__main__":
    main(sys.argv[1])
