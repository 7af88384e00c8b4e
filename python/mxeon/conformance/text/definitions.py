# SPDX-License-Identifier: Apache-2.0
"""Check of the definitions of nodes: every input against the table of its specification.

`oren_nayar_diffuse_bsdf` is specified by pbrlib, the other nodes by mxeon. A range only guides an
editor, and pbrlib's own definition leaves some out; so of pbrlib's node a range that is stated has to
be the specification's, and one that is missing is no fault.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import MaterialX as mx

from mxeon.conformance.results import Result
from mxeon.conformance.text.counts import Claim, counted
from mxeon.shaders.library import load_library
from mxeon.shaders.nodes import EON, FLAG, INVERSIONS, OREN_NAYAR

WORDS = {
    "type": "type",
    "value": "default",
    "uimin": "lower end of the range",
    "uimax": "upper end of the range",
    "uniform": "uniform",
    "defaultgeomprop": "defaultgeomprop",
}
RANGE = ("uimin", "uimax")
CLAIM = Claim(
    "definition",
    "The node's inputs and output match its specification.",
    "differences",
    "the default of roughness is 0.3",
)

Ports = Mapping[str, Mapping[str, str]]  # attributes by the names of inputs, the type of outputs


def _port(
    kind: str, value: str = "", lowest: str = "", highest: str = "", **more: str
) -> Mapping[str, str]:
    """Attributes of an input: its type, default and range, and others."""
    attributes = {"type": kind, "value": value, "uimin": lowest, "uimax": highest, **more}
    return MappingProxyType({name: each for name, each in attributes.items() if each})


WEIGHT = _port("float", "1.0", "0.0", "1.0")
COLOR = _port("color3", "0.18, 0.18, 0.18", "0.0, 0.0, 0.0", "1.0, 1.0, 1.0")
ROUGHNESS = _port("float", "0.0", "0.0", "1.0")
NORMAL = _port("vector3", defaultgeomprop="Nworld")
LOBE: Ports = {"weight": WEIGHT, "color": COLOR, "roughness": ROUGHNESS, "normal": NORMAL}
FLAGGED: Ports = {**LOBE, FLAG: _port("boolean", "false", uniform="true")}


@dataclass(frozen=True)
class Specification:
    """The interface that a node has to have."""

    node: str  # its category, and who specifies it
    author: str
    inputs: Ports  # attributes of each input, in order
    output: str  # type of its output
    bsdf: str = ""  # whether a lobe reflects ("R"), transmits ("T"), or both; "" for other nodes
    ranges: bool = True  # whether the ranges have to be stated


# [pbrlib], table of <oren_nayar_diffuse_bsdf>; a reflectance lies in [0, 1].
SPECIFICATIONS = (
    Specification(OREN_NAYAR, "pbrlib", FLAGGED, "BSDF", "R", ranges=False),
    Specification(EON, "mxeon", LOBE, "BSDF", "R"),
    *(
        Specification(node, "mxeon", {"color": COLOR, "roughness": ROUGHNESS}, "color3")
        for node in INVERSIONS
    ),
)


def check_definitions(library: str) -> tuple[Result, ...]:
    document = load_library(library)
    return tuple(
        _judge(specification, definition, library)
        for specification in SPECIFICATIONS
        for definition in _definitions(document, specification.node)
    )


def _definitions(document: mx.Document, node: str) -> list[mx.NodeDef]:
    """Definitions of a category, and the one that has its name but another category."""
    definitions: list[mx.NodeDef] = document.getMatchingNodeDefs(node)
    named = document.getNodeDef(f"ND_{node}")
    return definitions + ([named] if named and named.getNodeString() != node else [])


def _judge(specification: Specification, definition: mx.NodeDef, library: str) -> Result:
    inputs = {
        each.getName(): {name: each.getAttribute(name) for name in WORDS if each.getAttribute(name)}
        for each in definition.getActiveInputs()
    }
    outputs = [each.getType() for each in definition.getActiveOutputs()]
    wrong = {**inputs, "roughness": {**inputs.get("roughness", {}), "value": "0.3"}}
    faults = _kind(specification, definition) + differences(specification, inputs, outputs)
    control = differences(specification, wrong, outputs)
    return counted(
        CLAIM,
        f"{specification.node}, definition",
        library,
        len(faults),
        len(control),
        "; ".join(faults),
    )


def _kind(specification: Specification, definition: mx.NodeDef) -> list[str]:
    """Differences of the category and of the kind of lobe, in words."""
    author, node, lobe = specification.author, definition.getNodeString(), specification.bsdf
    faults = []
    if node != specification.node:
        faults.append(f"the category is {node}; {author} says {specification.node}")
    if (kind := definition.getAttribute("bsdf")) != lobe:
        faults.append(f"bsdf is {kind or 'missing'}; {author} says {lobe or 'none'}")
    return faults


def differences(specification: Specification, inputs: Ports, outputs: list[str]) -> list[str]:
    """Differences between a definition and its specification, in words."""
    author, expected = specification.author, specification.inputs
    faults = [f"there is no input {name}" for name in expected if name not in inputs]
    faults += [f"{author} has no input {name}" for name in inputs if name not in expected]
    order = [name for name in inputs if name in expected]
    if order != [name for name in expected if name in inputs]:
        faults.append(f"the inputs are in the order {', '.join(order)}")
    for name in order:
        faults += _differences(specification, name, inputs[name])
    if outputs != [specification.output]:
        types = " and ".join(outputs) or "nothing"
        faults.append(f"the output is {types}; {author} says {specification.output}")
    return faults


def _differences(
    specification: Specification, name: str, attributes: Mapping[str, str]
) -> list[str]:
    expected = specification.inputs[name]
    faults = []
    for key, word in WORDS.items():
        value, right = attributes.get(key, ""), expected.get(key, "")
        optional = key in RANGE and not specification.ranges and not value
        if not optional and _plain(value) != _plain(right):
            faults.append(
                f"{word} of {name} is {value or 'missing'}; "
                f"{specification.author} says {right or 'none'}"
            )
    return faults


def _plain(text: str) -> tuple[object, ...]:
    """A value for comparison: numbers as numbers, and "false" as what is not said."""
    parts = text.replace("false", "").replace(",", " ").split()
    try:
        return tuple(map(float, parts))
    except ValueError:
        return tuple(parts)
