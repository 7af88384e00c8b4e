# SPDX-License-Identifier: Apache-2.0
"""The statements with which the main of a generated shader evaluates its BSDFs, EDFs or graph.

A host repeats the statements with its own arguments, in local variables that hide the shader's.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import InputError, InterfaceError
from mxeon.hosts.base import Inputs, Query
from mxeon.shaders.nodes import types_of

if TYPE_CHECKING:  # which loads MaterialX
    from mxeon.shaders.generation import Input, Shader

# A function that fills in a surface shader, and its statements before those of the lights. Slang
# hands the vertex data on as the first parameter.
FUNCTION = re.compile(
    r"^void \w+\(([^)]*)out surfaceshader \w+\)\n\{\n(.*?)^ *surfaceshader \w+ = ",
    re.MULTILINE | re.DOTALL,
)
# A property of the surface in world space, which an evaluation sets.
GEOMETRY = re.compile(r"^ *\w+ (geomprop_\w+) = [^;]*;\n", re.MULTILINE)
KINDS = {
    "float": "float",
    "int": "integer",
    "bool": "boolean",
    "vec2": "vector2",
    "vec3": "vector3",
    "float2": "vector2",
    "float3": "vector3",
}


@dataclass(frozen=True)
class Prelude:
    statements: str
    inputs: dict[str, str]  # types of what they read: parameters, and properties of the surface


@lru_cache(maxsize=16)  # the checks of a node share its shader
def prelude(text: str, end: int) -> Prelude | None:
    """The statements before the first BSDF, at `end`; None outside a surface shader's function."""
    *_, function = [None, *FUNCTION.finditer(text, 0, end)]
    if function is None or "\n}\n" in text[function.end() : end]:
        return None
    parameters = (each.split() for each in function[1].split(",") if each.strip())
    inputs = {name: KINDS[kind] for kind, name in parameters if kind in KINDS}
    properties = dict.fromkeys(GEOMETRY.findall(function[2]), "vector3")
    return Prelude(GEOMETRY.sub("", function[2]), inputs | properties)


# By branch: the closure type of the repeated call, and the first step of its evaluation. A BSDF that only reflects
# is only called in the first two branches.
CLOSURES = {
    "direct": ("CLOSURE_TYPE_REFLECTION", 1),
    "environment": ("CLOSURE_TYPE_INDIRECT", 2),
    "transmission": ("CLOSURE_TYPE_REFLECTION", 3),
    "emission": ("CLOSURE_TYPE_REFLECTION", 4),
}
EMISSION = "CLOSURE_TYPE_EMISSION"  # of the call of an EDF, in every branch
GRAPH = "graph"  # instead of a branch: the color that the shader gives to its uniform EDF
LIT = "lit"  # instead of a branch: several lights, then an environment on both sides, in one pixel
# Inputs of LIT: number of lights, up to 2, direction of the second in world space, and whether an environment follows.
LIGHTS, SECOND_LIGHT, SKY = "mxeon_lights", "mxeon_second", "mxeon_sky"
# Steps 0 and 1 are lights, 2 an environment, 3 what it sends through. Every branch is the same program, which takes
# a driver as long to compile as one branch for each.
# The first, the one behind the last, and the irradiance of a light, or -1 where the throughput is asked.
STEPS = "mxeon_steps"
LOOP = """{type} mxeon_sum = {type}(0.0);
for (int mxeon_step = int(mxeon_steps.x); mxeon_step < int(mxeon_steps.y); ++mxeon_step)
{{
    int mxeon_closure = mxeon_step < 2 ? CLOSURE_TYPE_REFLECTION : mxeon_step < 3 ? CLOSURE_TYPE_INDIRECT
        : mxeon_step < 4 ? CLOSURE_TYPE_TRANSMISSION : CLOSURE_TYPE_EMISSION;
    {type} mxeon_first = L;
    {{
        {type} L = mxeon_step == 1 && mxeon_steps.x < 0.5 ? mxeon_second : mxeon_first;
{block}
        float mxeon_strength = mxeon_step < 2 ? mxeon_steps.z : 1.0;
        mxeon_sum += mxeon_steps.z < 0.0 ? {result}.throughput : mxeon_strength * {result}.response;
    }}
}}
"""
OUTPUTS = ("response", "throughput", "radiance")  # the last is that of an EDF
NORMAL, TANGENT = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
FAR = (0.0, 0.0, 1e31)  # instead of a position: the host takes that of its pixel, on a plane
GIVEN = "P = P.z < 1e30 ? P : {};"
FILES = ("filename", "string")  # types of inputs that an evaluation does not set
# How each image lies in its texture, by the end of the variable's name.
PLACED = {"_uv_scale": (1.0, 1.0), "_uv_offset": (0.0, 0.0)}
# How MaterialX's text for WGSL, which has no booleans in memory, makes one of an integer.
BOOLEAN = re.compile(r"^#define (\w+) bool\(\1\)$", re.MULTILINE)

Arguments: TypeAlias = dict[str, tuple[str, ArrayLike]]  # type and values by name


@dataclass(frozen=True)
class BsdfCall:
    statements: str  # of the shader's main up to the call
    value: str  # a color
    arguments: Arguments  # types and values of what both read


def bsdf_call(query: Query) -> BsdfCall:
    """Call of a rasterized shader's BSDF.

    InputError if it calls no BSDF or, for GRAPH, no uniform EDF, or branch or output is unknown.
    """
    shader, wo, wi, inputs, branch, output, _ = query
    branches = (GRAPH, LIT, *CLOSURES)
    for rule, word, known in (("branch", branch, branches), ("output", output, OUTPUTS)):
        if word not in known:
            raise InputError(f"{rule} must be one of {', '.join(known)}; got {word!r}")
    if branch == GRAPH:
        return _graph_call(shader, wo, inputs)
    emitted = output == "radiance"
    called, first = CLOSURES.get(branch, CLOSURES["direct"])
    called = EMISSION if emitted else called
    text = shader.stages["pixel"]
    start, statements, value, names = _find_calls(text, called, shader.element)
    arguments: Arguments = {"V": ("vector3", wo), "L": ("vector3", wi), "N": ("vector3", NORMAL)}
    arguments["occlusion"] = ("float", inputs.get("occlusion", 1.0))
    arguments["P"] = ("vector3", inputs.get("position", FAR))
    if not emitted:
        steps: ArrayLike = (first, first + 1, -1.0 if output == "throughput" else 1.0)
        if branch == LIT:
            ends = 2.0 - np.asarray(inputs[LIGHTS]), np.where(inputs[SKY], 4.0, 2.0)
            steps = np.stack(np.broadcast_arrays(*ends, np.pi), axis=-1)
        arguments[STEPS] = ("vector3", steps)
        arguments[SECOND_LIGHT] = ("vector3", inputs.get(SECOND_LIGHT, NORMAL))
        kind = "float3" if shader.target == "slang" else "vec3"
        block = statements.replace(called, "mxeon_closure")
        statements, value = LOOP.format(type=kind, block=block, result=value), "mxeon_sum"
    if before := prelude(text, start):
        statements = before.statements + statements
        ports = {port.path.rsplit("/", 1)[-1]: port for port in shader.inputs}
        own: Arguments = {}
        for name, kind in before.inputs.items():
            default = _default(ports[name]) if name in ports else _argument(name, {}, {})[1]
            own[name] = kind, inputs.get(name, default)
        arguments = own | arguments
    else:
        ports = _ports(shader)
        # What nodes compute for a closure, without properties of the surface.
        computed = GEOMETRY.sub("", _main(text) + "\n")
        if any(f" {name} = " in computed for name in names):
            names = [name for name in names if f" {name} = " not in computed]
            words = _words(computed)
            names += [each for each in words if each in ports and ports[each].type not in FILES]
            arguments |= {
                each: ("vector2", value)
                for each in words
                for end, value in PLACED.items()
                if each.endswith(end)
            }
            statements = computed + statements
        arguments |= {name: _argument(name, ports, inputs) for name in names}
    return BsdfCall(statements, value, arguments)


@lru_cache(maxsize=16)  # the checks of a node share its shader
def _find_calls(text: str, closure: str, element: str) -> tuple[int, str, str, list[str]]:
    """Position and text of the statements that evaluate BSDFs, by closure type, result and arguments.

    The last call combines the results of the others, or is the only one.
    """
    # MaterialX before 1.39.5 calls the constructor itself.
    constructor = r"(?:makeClosureData|ClosureData)"
    match = re.search(rf"ClosureData closureData = {constructor}\({closure}[^}}]*", text)
    block = match[0] if match else ""
    calls = re.findall(r"\w+\(closureData, ([^;]*), (\w+)\);", block)
    if not calls:
        kind = "an EDF" if closure == EMISSION else "a BSDF"
        raise InputError(
            f"element {element!r} must call {kind} to be evaluated; its shader calls none"
        )
    end, results = f", {calls[-1][1]});", [result for _, result in calls]
    names = [name for arguments, _ in calls for name in arguments.split(", ")]
    arguments = [name for name in dict.fromkeys(names) if name not in results]
    start = match.start() if match else 0
    return start, block[: block.index(end) + len(end)], results[-1], arguments


def _graph_call(shader: Shader, wo: ArrayLike, inputs: Inputs) -> BsdfCall:
    """Call of a shader's graph: the statements before its surface, and the color of its uniform EDF."""
    text = shader.stages["pixel"]
    color = re.search(r"\bmx_uniform_edf\(closureData, (\w+), \w+\);", text)
    if not color:
        raise InputError(
            f"element {shader.element!r} must call a uniform EDF; its shader calls none"
        )
    statements, ports = _main(text), _ports(shader)
    words = _words(statements + color[1])
    arguments: Arguments = {"V": ("vector3", wo), "P": ("vector3", FAR)}
    arguments |= {name: _argument(name, ports, inputs) for name in words if name in ports}
    return BsdfCall(statements, color[1], arguments)


@lru_cache(maxsize=16)
def _main(text: str) -> str:
    """The statements of a main before its surface."""
    before = re.split(r"\n *surfaceshader \w+ = ", text)[0]
    # Slang's own main begins with its stage's inputs and outputs.
    return re.split(r"\n\{\n|_vd;\n|float4 out1;\n", before)[-1]


def _words(text: str) -> list[str]:
    return list(dict.fromkeys(re.findall(r"\w+", text)))


def _default(port: Input) -> ArrayLike:
    """The document's value of an input that a closure reads: a number, a color or a vector."""
    return cast(ArrayLike, port.value)


def _ports(shader: Shader) -> dict[str, Input]:
    """Inputs of a shader by name, with the booleans that its text makes of integers."""
    ports = {port.name: port for port in shader.inputs}
    for name in booleans(shader.stages["pixel"]):
        if name in ports:
            ports[name] = replace(ports[name], type="boolean")
    return ports


@lru_cache(maxsize=16)
def booleans(text: str) -> list[str]:
    """Names of the inputs that a text for WGSL turns into booleans."""
    return BOOLEAN.findall(text)


def _argument(name: str, ports: Mapping[str, Input], inputs: Inputs) -> tuple[str, ArrayLike]:
    """Type and value of a BSDF's argument; if it is not an input of the shader, it belongs to the surface."""
    port = ports.get(name)
    if port is None:
        tangent = "tangent" in name.lower() or "tworld" in name.lower()
        return "vector3", inputs.get(*(("tangent", TANGENT) if tangent else ("normal", NORMAL)))
    key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
    types = types_of(key.rsplit("/", 1)[-1])
    if key in inputs and types and port.type not in types:
        required = " or ".join(sorted(types))
        raise InterfaceError(
            f"input {key} must have the type {required} to be evaluated; got {port.type}"
        )
    return port.type, inputs.get(key, _default(port))
