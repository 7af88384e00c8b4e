# SPDX-License-Identifier: Apache-2.0
"""Statements, in the `main` of a generated shader, that evaluate BSDFs, EDFs or a node graph.

A host repeats these statements with other arguments, in local variables that hide the uniforms.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import InputError, InterfaceError
from mxeon.hosts.base import Inputs, Query
from mxeon.shaders.nodes import types_of

if TYPE_CHECKING:  # the import would load MaterialX
    from mxeon.shaders.generation import Input, Shader

# Matches a function that computes a surface shader, and the function's statements before the loop
# over lights. In Slang, the first parameter is the vertex data.
FUNCTION = re.compile(
    r"^void \w+\(([^)]*)out surfaceshader \w+\)\n\{\n(.*?)^ *surfaceshader \w+ = ",
    re.MULTILINE | re.DOTALL,
)
# Matches the declaration of a geometric property, which a host replaces by an argument.
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
    inputs: dict[str, str]  # types of the function's parameters and geometric properties, by name


@lru_cache(maxsize=16)  # the checks of a node share a shader
def prelude(text: str, end: int) -> Prelude | None:
    """The statements before the first BSDF, whose position in the text is `end`.

    None if the BSDF is not in the function of a surface shader.
    """
    functions = list(FUNCTION.finditer(text, 0, end))
    if not functions or "\n}\n" in text[functions[-1].end() : end]:
        return None
    function = functions[-1]
    parameters = (each.split() for each in function[1].split(",") if each.strip())
    inputs = {name: KINDS[kind] for kind, name in parameters if kind in KINDS}
    properties = dict.fromkeys(GEOMETRY.findall(function[2]), "vector3")
    return Prelude(GEOMETRY.sub("", function[2]), inputs | properties)


# For each branch, the closure type of BSDF calls and the first step of the evaluation loop. Opaque
# BSDFs are called only in the first two branches.
CLOSURES = {
    "direct": ("CLOSURE_TYPE_REFLECTION", 1),
    "environment": ("CLOSURE_TYPE_INDIRECT", 2),
    "transmission": ("CLOSURE_TYPE_REFLECTION", 3),
    "emission": ("CLOSURE_TYPE_REFLECTION", 4),
}
EMISSION = "CLOSURE_TYPE_EMISSION"  # closure type that evaluates EDFs, in every branch
GRAPH = "graph"  # branch whose value is the color of the uniform EDF
LIT = "lit"  # branch that sums lights, the reflected environment and the transmitted environment
# Inputs of the branch LIT: number of lights (up to 2), direction of the second light in world
# space, and whether there is an environment.
LIGHTS, SECOND_LIGHT, SKY = "mxeon_lights", "mxeon_second", "mxeon_sky"
# An evaluation is a loop. Steps 0 and 1 are lights, step 2 is the reflected environment, and step 3
# is the transmitted environment. All branches share one program, which compiles as fast as a
# program for one branch. The vector `mxeon_steps` has the first step, the end of the loop, and a
# factor for lights, which is -1 if the output is the throughput.
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
OUTPUTS = ("response", "throughput", "radiance")  # only EDFs have a radiance
NORMAL, TANGENT = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
SURFACE = "surface_normal"  # the geometric normal; "normal" is the shading normal
NO_POSITION = (0.0, 0.0, 1e31)  # the statement POSITION replaces this placeholder
POSITION = "P = P.z < 1e30 ? P : {};"
FILES = ("filename", "string")  # types of inputs that an evaluation does not set
# Values for which an image fills the whole texture, keyed by the end of the variable's name.
PLACED = {"_uv_scale": (1.0, 1.0), "_uv_offset": (0.0, 0.0)}
# Matches a macro that converts an integer to a boolean, because WGSL has no boolean uniforms.
BOOLEAN = re.compile(r"^#define (\w+) bool\(\1\)$", re.MULTILINE)

Arguments: TypeAlias = dict[str, tuple[str, ArrayLike]]  # type and values by name


@dataclass(frozen=True)
class BsdfCall:
    statements: str  # part of the shader's `main` that computes the value
    value: str  # expression of the value, which is a color
    arguments: Arguments  # variables that `statements` and `value` read


def bsdf_call(query: Query) -> BsdfCall:
    """Statements that call the BSDF of a generated shader for rasterization.

    Raises InputError if the branch or the output is unknown, or if the shader calls no BSDF. The
    branch GRAPH needs a uniform EDF instead of a BSDF.
    """
    shader, wo, wi, inputs, branch, output, *_ = query
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
    arguments: Arguments = {"V": ("vector3", wo), "L": ("vector3", wi)}
    arguments["N"] = ("vector3", inputs.get(SURFACE, NORMAL))
    arguments["occlusion"] = ("float", inputs.get("occlusion", 1.0))
    arguments["P"] = ("vector3", inputs.get("position", NO_POSITION))
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
        for name, kind in before.inputs.items():
            # A value in the document is a number, a color or a vector.
            default = ports[name].value if name in ports else _argument(name, {}, {})[1]
            arguments.setdefault(name, (kind, inputs.get(name, cast(ArrayLike, default))))
    else:
        ports = _ports(shader)
        # Statements that compute a closure's inputs from nodes, without geometric properties.
        computed = GEOMETRY.sub("", _main(text) + "\n")
        if any(f" {name} = " in computed for name in names):
            names = [name for name in names if f" {name} = " not in computed]
            words = _words(computed)
            names += [each for each in words if each in ports and ports[each].type not in FILES]
            arguments |= _placed(words)
            statements = computed + statements
        arguments |= {name: _argument(name, ports, inputs) for name in names}
    return BsdfCall(statements, value, arguments)


@lru_cache(maxsize=16)  # the checks of a node share a shader
def _find_calls(text: str, closure: str, element: str) -> tuple[int, str, str, list[str]]:
    """Position and text of the statements that call BSDFs or EDFs with a closure type.

    Also returns the variable of the last result and the names of the arguments. If there are
    several calls, the last call combines the results of the earlier calls.
    """
    # MaterialX before 1.39.5 has no makeClosureData.
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
    """The statements before a shader's surface, and the color of the shader's uniform EDF."""
    text = shader.stages["pixel"]
    color = re.search(r"\bmx_uniform_edf\(closureData, (\w+), \w+\);", text)
    if not color:
        raise InputError(
            f"element {shader.element!r} must call a uniform EDF; its shader calls none"
        )
    statements, ports = _main(text), _ports(shader)
    words = _words(statements + color[1])
    arguments: Arguments = {"V": ("vector3", wo), "P": ("vector3", NO_POSITION)}
    # Inputs of the types in `unset` stay uniforms. Variables replace all other inputs.
    unset = (*FILES, "color4", "vector4", "matrix33", "matrix44")
    names = [name for name in words if name in ports and ports[name].type not in unset]
    arguments |= {name: _argument(name, ports, inputs) for name in names} | _placed(words)
    return BsdfCall(statements, color[1], arguments)


def _placed(words: Iterable[str]) -> Arguments:
    """Default values of those `words` that name the scale or the offset of an image."""
    return {
        each: ("vector2", value)
        for each in words
        for end, value in PLACED.items()
        if each.endswith(end)
    }


@lru_cache(maxsize=16)
def _main(text: str) -> str:
    """Statements of a `main` function before the declaration of the surface shader."""
    before = re.split(r"\n *surfaceshader \w+ = ", text)[0]
    # In Slang, `main` begins with the inputs and outputs of the stage.
    return re.split(r"\n\{\n|_vd;\n|float4 out1;\n", before)[-1]


def _words(text: str) -> list[str]:
    return list(dict.fromkeys(re.findall(r"\w+", text)))


def _ports(shader: Shader) -> dict[str, Input]:
    """Inputs of a shader by name. Integers that WGSL converts to booleans get the type boolean."""
    ports = {port.name: port for port in shader.inputs}
    for name in booleans(shader.stages["pixel"]):
        if name in ports:
            ports[name] = replace(ports[name], type="boolean")
    return ports


@lru_cache(maxsize=16)
def booleans(text: str) -> list[str]:
    """Names of the integer inputs that a shader for WGSL converts to booleans."""
    return BOOLEAN.findall(text)


def _argument(name: str, ports: Mapping[str, Input], inputs: Inputs) -> tuple[str, ArrayLike]:
    """Type and value of a BSDF's argument, which is a shader input or an axis of the surface."""
    port = ports.get(name)
    if port is None:
        normal, tangent = inputs.get("normal", NORMAL), inputs.get("tangent", TANGENT)
        name = name.lower().removeprefix("geomprop_")
        if name.startswith("bworld"):
            return "vector3", np.cross(np.asarray(normal), np.asarray(tangent))
        if name[:1] in "tnb" and name[1:].startswith("object"):
            raise InterfaceError(
                f"an input's default is {name[0].upper()}object, which no pair of directions has"
            )
        return "vector3", tangent if "tangent" in name or "tworld" in name else normal
    key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
    types = types_of(key.rsplit("/", 1)[-1])
    if key in inputs and types and port.type not in types:
        required = " or ".join(sorted(types))
        raise InterfaceError(
            f"input {key} must have the type {required} to be evaluated; got {port.type}"
        )
    return port.type, inputs.get(key, cast(ArrayLike, port.value))
