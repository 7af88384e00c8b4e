# SPDX-License-Identifier: Apache-2.0
"""Checks of the inversion nodes: generated code on a host against `mxeon.inversion`.

The code of a node is the function that the generator writes for its nodegraph, with those that it
calls. It is taken from a generated shader unchanged, and called with random colors.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mxeon.conformance.check import judge
from mxeon.conformance.diagnosis.candidates import SAME, Diagnosis, sentence
from mxeon.conformance.functions.shader_functions import POINTS
from mxeon.conformance.results import Place, Result
from mxeon.conformance.samples import SEED, Array, float32
from mxeon.conformance.tolerance import (
    Measurement,
    Term,
    Tolerance,
    absolute,
    given,
    roundings,
    sum_of,
)
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.base import Host
from mxeon.models.diffuse import albedo, inversion
from mxeon.shaders.nodes import (
    INVERSIONS,
    OREN_NAYAR,
    SURFACE,
    connection_text,
    document_text,
    input_text,
    node_text,
)

INVERSION_ERROR = sum_of(
    Term(3 * 5e-7, "three constants of six decimals"),
    roundings(12, "of numbers up to 1"),
    unit="reflectance",
    metric=absolute,
)
# An albedo grows at most twice as fast as the reflectance.
ROUND_TRIP = given(2.0 * INVERSION_ERROR.value, "albedo", "twice the error of the reflectance")
VARIANT = "roughness is 5 % off"
FUNCTION = re.compile(r"^\w+ (\w+)\([^()]*\)\s*(?=\{)", re.MULTILINE)
# Its variables must not be those of a nodegraph.
NAME = "mxeon_node"
CALL = re.compile(
    rf"(?:vec3|float3) {NAME}_out = [^;]*;(?:\s*\w+\([^;]*\b{NAME}_out\);)?", re.MULTILINE
)
WRAPPER = f"""
vec3 {NAME}(vec3 {NAME}_color, float {NAME}_roughness)
{{{{
    {{value}}
    return {NAME}_out;
}}}}
"""


@dataclass(frozen=True)
class InversionProbe:
    """An inversion node of a library on a host."""

    host: Host
    node: str
    library: str

    @cached_property
    def inputs(self) -> tuple[Array, Array]:
        """Random colors and roughnesses, an eighth of each on either end of its range."""
        rng = np.random.default_rng(SEED)
        columns = np.clip(1.25 * rng.random((POINTS, 4)) - 0.125, 0.0, 1.0)
        columns = float32(columns)
        return columns[:, :3], columns[:, 3]

    @cached_property
    def code(self) -> str:
        """Functions of the generated shader that the node consists of, and one that calls them."""
        ports = input_text("color", "color3", (0.2, 0.5, 0.8)) + input_text(
            "roughness", "float", 0.5
        )
        color = connection_text("color", "color3", NAME)
        nodes = node_text(self.node, "color3", NAME, ports)
        nodes += node_text(OREN_NAYAR, "BSDF", "lobe", color)
        shader = self.host.compile(document_text(nodes + SURFACE), library=self.library)[0]
        text = shader.stages["pixel"]
        value = CALL.search(text)
        if value is None:
            raise NotRun(f"the code of {self.node} is not a function of its inputs alone")
        return _functions(text, value[0]) + WRAPPER.format(value=value[0])

    def values(self, scale: float = 1.0) -> Array:
        """Reflectances of the node, (N, 3), its roughness times a factor."""
        color, roughness = self.inputs
        values = self.host.execute(self.code, NAME, color, scale * roughness)
        return values.astype(np.float64)


def judge_inversion(probe: InversionProbe) -> tuple[Result, ...]:
    rows = (
        (
            "inversion",
            "The node returns the reflectance of the NumPy function of the same name.",
            INVERSION_ERROR,
            _value,
        ),
        (
            "round_trip",
            "EON with the node's reflectance has the input color as its albedo.",
            ROUND_TRIP,
            _round_trip,
        ),
    )
    return tuple(_judge(probe, *row) for row in rows)


def _judge(
    probe: InversionProbe,
    key: str,
    claim: str,
    tolerance: Tolerance,
    errors: Callable[[InversionProbe, Array], Array],
) -> Result:
    host, library = probe.host.name, probe.library

    def worst(wrong: bool) -> Measurement:
        values = probe.values(0.95 if wrong else 1.0)
        found = errors(probe, values)
        row = int(found.argmax())
        color, roughness = probe.inputs
        columns = {"color": color, "roughness": roughness, "measured": values}
        point = {name: np.ravel(each[row]).tolist() for name, each in columns.items()}
        return Measurement(float(found[row]), point)

    return judge(
        Place(check=key, claim=claim, subject=probe.node, host=host, library=library),
        tolerance,
        worst,
        VARIANT,
        lambda: _nearest(probe, probe.values()),
    )


def _value(probe: InversionProbe, values: Array) -> Array:
    return absolute(values, getattr(inversion, probe.node)(*probe.inputs))


def _round_trip(probe: InversionProbe, values: Array) -> Array:
    """Errors of the albedo that the reflectance leads to."""
    color, roughness = probe.inputs
    finite = np.asarray(np.isfinite(values).all(axis=1))
    rho = np.where(finite[:, None], np.clip(values, 0.0, 1.0), 0.0)
    if probe.node == INVERSIONS[0]:
        reached = albedo.eon_albedo_dir(1.0, rho, roughness)
    else:
        reached = albedo.eon_albedo_avg(rho, roughness)
    return np.where(finite, absolute(reached, color), np.inf)


def _nearest(probe: InversionProbe, values: Array) -> Diagnosis:
    """The other inversion that the values are, if any; the color itself is one."""
    color, roughness = probe.inputs
    known = {"the color itself": color} | {
        name: function(color, roughness)
        for name, function in vars(inversion).items()
        if name.startswith("eon_rho_from")
    }
    if not np.isfinite(values).all():
        return Diagnosis("NaN or infinity")
    distances = {
        name: float(np.sqrt(np.mean((values - each) ** 2))) for name, each in known.items()
    }
    ranking = sorted(distances.items(), key=lambda item: item[1])
    (first, least), (_, rival) = ranking[:2]
    if first != probe.node and least <= SAME * rival:
        return Diagnosis(sentence(ranking), distances)
    text = f"off by rms {distances[probe.node]:.2g}; no known function matches"
    return Diagnosis(text, distances)


def _functions(text: str, use: str) -> str:
    """Functions of a text that a piece of it calls, directly or through others, in their order."""
    bodies = {match[1]: _whole(text, match) for match in FUNCTION.finditer(text)}
    needed, waiting = set[str](), [use]
    while waiting:
        words = set(re.findall(r"\w+", waiting.pop())) & bodies.keys() - needed
        needed |= words
        waiting += [bodies[word] for word in words]
    return "\n".join(body for name, body in bodies.items() if name in needed)


def _whole(text: str, match: re.Match[str]) -> str:
    """A function's text from the start of its signature to the brace that closes it."""
    depth = 0
    for position in range(match.end(), len(text)):
        depth += {"{": 1, "}": -1}.get(text[position], 0)
        if depth == 0:
            return f"{text[match.start() : position + 1]}\n"
    raise ShaderError("a brace is not closed")
