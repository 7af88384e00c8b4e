# SPDX-License-Identifier: Apache-2.0
"""Inputs of nodes as checks ask them: ranges, edges, a change that must show, and what is drawn."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.samples.batch import Array, Changes, Values, float32
from mxeon.conformance.samples.edge_cases import with_edges

COMPONENTS = {"float": (), "vector2": (2,), "vector3": (3,), "color3": (3,)}  # shape by type
CHANGED_COLOR = (0.9, 0.1, 0.6)


@dataclass(frozen=True)
class Port:
    """An input of a node."""

    name: str  # name or path of the input
    kind: str = "float"  # type in MaterialX
    low: ArrayLike = 0.0  # ends of the range of random values, of all components or of each
    high: ArrayLike = 1.0
    edges: tuple[float, ...] = ()  # what half of the special values are; () for none
    # Another value than the default, which must show; None where it shows nothing by itself.
    change: ArrayLike | None = None
    # Other inputs with which the change shows.
    needs: Values = field(default_factory=dict, hash=False)
    # Whether random values are uniform in their logarithm; others have a tenth on either end.
    logarithmic: bool = False
    # What every other random value is: the usual one of an input that is rarely set.
    often: float | None = None
    equal: bool = False  # whether both components are the same in every other random value
    # Values in the two materials that stand for a node in pictures; () for the default.
    materials: tuple[ArrayLike, ...] = ()
    # The variable that a host sets in its place, of an input whose default is one.
    variable: str = ""
    default: ArrayLike = 1.0  # value in a document that has to set it


def color(name: str, *materials: ArrayLike, edges: tuple[float, ...] = (0.0, 1e-3, 1.0)) -> Port:
    return Port(name, "color3", 0.0, 1.0, edges, CHANGED_COLOR, materials=materials)


def draw(rng: np.random.Generator, count: int, ports: Iterable[Port]) -> dict[str, Array]:
    """Random values of ports in their ranges, float32 numbers, by name."""
    return {port.name: _drawn(rng, count, port) for port in ports}


def _drawn(rng: np.random.Generator, count: int, port: Port) -> Array:
    low, high = np.asarray(port.low, np.float64), np.asarray(port.high, np.float64)
    share = rng.random((count, *COMPONENTS[port.kind]))
    if port.logarithmic:
        values = low * (high / low) ** share
    else:
        values = low + (high - low) * np.clip(1.25 * share - 0.125, 0.0, 1.0)
    if port.often is not None:
        values[::2] = port.often
    if port.equal:
        values[::2] = values[::2, :1]
    return float32(values)


def draw_edges(rng: np.random.Generator, count: int, ports: Iterable[Port]) -> dict[str, Array]:
    """Random values of ports, of which half lie on an edge where the port has some."""
    ports = tuple(ports)
    values = draw(rng, count, ports)
    edged = {
        port.name: with_edges(rng, values[port.name], port.edges) for port in ports if port.edges
    }
    return values | edged


def changes(ports: Iterable[Port]) -> dict[str, Changes]:
    """For each port with a change: inputs without and with it alone."""
    return {
        port.name: (port.needs, {**port.needs, port.variable or port.name: port.change})
        for port in ports
        if port.change is not None
    }


def materials(ports: Iterable[Port]) -> tuple[Mapping[str, ArrayLike], ...]:
    """Inputs of the two materials that stand for a node in pictures."""
    return tuple(
        {port.name: port.materials[which] for port in ports if len(port.materials) > which}
        for which in (0, 1)
    )
