# SPDX-License-Identifier: Apache-2.0
"""Ports of nodes, as a library defines them."""

from collections.abc import Iterable
from dataclasses import dataclass

import MaterialX as mx

from mxeon.shaders.library import load_library

GROUP = "pbr"  # nodegroup of the specification's nodes; others of a category are other nodes
FLOATS = ("float", "vector2", "vector3", "vector4", "color3", "color4")


@dataclass(frozen=True)
class PortRow:
    """An input or an output of a node."""

    name: str
    description: str
    types: tuple[str, ...]  # one for each definition of the node
    default: str = ""  # value without a connection, or the name of its geometric property
    accepted: str = ""  # a range, as [0, 1], or names with commas between them


@dataclass(frozen=True)
class Table:
    """The ports of a node, inputs first."""

    node: str
    ports: tuple[PortRow, ...]


def library_tables(library: str = "stock") -> dict[str, Table]:
    """Tables by category: of definitions in GROUP if there are any, and of default versions."""
    definitions: dict[str, list[mx.NodeDef]] = {}
    for definition in load_library(library).getNodeDefs():
        if not definition.getVersionString() or definition.getDefaultVersion():
            definitions.setdefault(definition.getNodeString(), []).append(definition)
    return {node: _table(node, same) for node, same in sorted(definitions.items())}


def _table(node: str, definitions: Iterable[mx.NodeDef]) -> Table:
    definitions = list(definitions)
    of_group = [each for each in definitions if each.getNodeGroup() == GROUP]
    chosen = of_group or definitions
    inputs = [port for each in chosen for port in map(_input, each.getActiveInputs())]
    outputs = [port for each in chosen for port in map(_output, each.getActiveOutputs())]
    return Table(node, (*_merged(inputs), *_merged(outputs)))


def _merged(ports: Iterable[PortRow]) -> tuple[PortRow, ...]:
    """One port for each name, with the types of all; the first has the other columns."""
    merged: dict[str, PortRow] = {}
    for port in ports:
        first = merged.get(port.name, port)
        types = tuple(dict.fromkeys(first.types + port.types))
        merged[port.name] = PortRow(
            port.name, first.description, types, first.default, first.accepted
        )
    return tuple(merged.values())


def _input(port: mx.Input) -> PortRow:
    default = port.getDefaultGeomPropString() or _default(port)
    return PortRow(port.getName(), port.getDocString(), (port.getType(),), default, _accepted(port))


def _output(port: mx.Output) -> PortRow:
    return PortRow(port.getName(), port.getDocString(), (port.getType(),))


def _default(port: mx.Input) -> str:
    """Value of an input, each float with a point."""
    text = port.getValueString()
    if port.getType() not in FLOATS or not text:
        return str(text)
    return ", ".join(part if "." in part else f"{part}.0" for part in _parts(text))


def _accepted(port: mx.Input) -> str:
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
