# SPDX-License-Identifier: Apache-2.0
"""Fragment shaders that evaluate a function once per pixel, around source text left unchanged.

Arguments arrive in float textures, one texel per pixel. A generated shader keeps every character:
a macro renames its `main`, and a second `main` repeats the statements by which the first one calls
its BSDF. There, local variables of the same names hide the shader's uniforms.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import InputError, InterfaceError
from mxeon.shaders.generation import Input, Shader
from mxeon.shaders.hosts.surface import Prelude, prelude
from mxeon.shaders.nodes import types_of

# By branch: the closure type of the call that is repeated, and the one that takes its place. A BSDF
# that only reflects is called in the first two branches alone.
CLOSURES = {
    "direct": ("CLOSURE_TYPE_REFLECTION", "CLOSURE_TYPE_REFLECTION"),
    "environment": ("CLOSURE_TYPE_INDIRECT", "CLOSURE_TYPE_INDIRECT"),
    "transmission": ("CLOSURE_TYPE_REFLECTION", "CLOSURE_TYPE_TRANSMISSION"),
    "emission": ("CLOSURE_TYPE_REFLECTION", "CLOSURE_TYPE_EMISSION"),
}
EMISSION = "CLOSURE_TYPE_EMISSION"  # of the call of an EDF, in every branch
GRAPH = "graph"  # in place of a branch: the color that the shader gives to its uniform EDF
OUTPUTS = ("response", "throughput", "radiance")  # the last is that of an EDF
TEXEL = "texelFetch(mxeon_{}, mxeon_pixel, 0)"
FETCH = {
    "float": "float {0} = {1}.x;",
    "boolean": "bool {0} = {1}.x > 0.5;",
    "color3": "vec3 {0} = {1}.xyz;",
}
FETCH["vector3"] = FETCH["vec3"] = FETCH["color3"]
FETCH["vector2"] = "vec2 {0} = {1}.xy;"
FETCH["integer"] = "int {0} = int({1}.x);"
# More arguments than a stage may have textures share one, whose layers lie above each other.
STACK = "mxeon_stack"
MOST = 12  # textures of arguments; every device has 16, of which some are the environment's
LAYER = (
    f"texelFetch({STACK}, mxeon_pixel + ivec2(0, {{0}} * (textureSize({STACK}, 0).y / {{1}})), 0)"
)
COMPONENTS = {"float": 1, "boolean": 1, "integer": 1, "vector2": 2}  # 3 of every other type
NORMAL, TANGENT = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
ASKED = "throughput_asked"  # variable of an evaluation
WIDTH = 1024  # most pixels in a row of an evaluation

Arguments: TypeAlias = dict[str, tuple[str, ArrayLike]]  # type and values by name
Columns: TypeAlias = dict[str, NDArray[np.float32]]  # rows of 1 to 3 values by name


@dataclass(frozen=True)
class Dialect:
    """Text that a language of the GLSL family needs around a function.

    Attributes
    ----------
    version : str
        First line of a stage.
    prelude : str
        Lines between the version and a generated text.
    output : str
        Declaration of a pixel stage's output, for text that has none.
    sampler : str
        Declaration of an argument's sampler, with its name and its number.
    vertex : str
        Vertex stage for text that reads nothing from one.
    """

    version: str
    prelude: str
    output: str
    sampler: str
    vertex: str


RENAME = "#define main mxeon_generated_main\n"
VERTEX = "in vec3 i_position;\nvoid main() { gl_Position = vec4(i_position, 1.0); }\n"

# WebGPU's Vulkan has separate textures and samplers, the generated text has combined ones: here its
# sampler2D is a texture that is always read through the same sampler.
SEPARATE = """#extension GL_EXT_samplerless_texture_functions : require
layout (set = 1, binding = 0) uniform sampler mxeon_sampler;
vec4 mxeon_lookup(texture2D t, vec2 uv) { return texture(sampler2D(t, mxeon_sampler), uv); }
vec4 mxeon_lookup_lod(texture2D t, vec2 uv, float lod)
{
    return textureLod(sampler2D(t, mxeon_sampler), uv, lod);
}
#define sampler2D texture2D
#define texture mxeon_lookup
#define textureLod mxeon_lookup_lod
"""

DIALECTS = {
    "glsl": Dialect(
        version="#version 430\n",
        prelude="",
        output="out vec4 mxeon_out;\n",
        sampler="uniform sampler2D {name};",
        vertex="#version 430\n" + VERTEX,
    ),
    "essl": Dialect(
        version="#version 300 es\n",
        prelude="",
        output="precision highp float;\nout vec4 mxeon_out;\n",
        sampler="uniform highp sampler2D {name};",
        vertex="#version 300 es\n" + VERTEX,
    ),
    "vulkan": Dialect(
        version="#version 450\n",
        prelude=SEPARATE,
        output="layout (location = 0) out vec4 mxeon_out;\n",
        sampler="layout (set = 2, binding = {number}) uniform texture2D {name};",
        vertex="#version 450\nlayout (location = 0) " + VERTEX,
    ),
}
DIALECTS["wgsl"] = replace(DIALECTS["vulkan"], prelude="")  # its textures are separate already

# How MaterialX's text for WGSL, which has no booleans in memory, makes one of an integer.
BOOLEAN = re.compile(r"^#define (\w+) bool\(\1\)$", re.MULTILINE)


@dataclass(frozen=True)
class Call:
    """How a generated shader calls its BSDFs.

    Attributes
    ----------
    statements : str
        Statements of the shader's main up to the call.
    value : str
        Expression of the output that is asked for, a color. It is the same for every output, so
        that they share a program.
    arguments : dict of str to (str, array_like)
        Type and values of every variable that the statements and the expression read, but P.
    """

    statements: str
    value: str
    arguments: Arguments


def bsdf_call(
    shader: Shader,
    wo: ArrayLike,
    wi: ArrayLike,
    inputs: Mapping[str, Any],
    branch: str,
    output: str = OUTPUTS[0],
) -> Call:
    """Call of a shader's BSDF, with the values of its arguments.

    Parameters
    ----------
    shader : Shader
        Of a rasterized target.
    wo, wi, inputs, branch, output
        As in `mxeon.shaders.hosts.base.Host.evaluate`.

    Returns
    -------
    Call

    Raises
    ------
    ValueError
        If the shader calls no BSDF or, for GRAPH, no uniform EDF, or branch or output is unknown.
    """
    branches = (GRAPH, *CLOSURES)
    for rule, word, known in (("branch", branch, branches), ("output", output, OUTPUTS)):
        if word not in known:
            raise InputError(f"{rule} must be one of {', '.join(known)}; got {word!r}")
    if branch == GRAPH:
        return _graph_call(shader, wo, inputs)
    emitted = output == "radiance"
    called, closure = (EMISSION, EMISSION) if emitted else CLOSURES[branch]
    text = shader.stages["pixel"]
    start, statements, result, names = _find_calls(text, called, shader.element)
    arguments: Arguments = {"V": ("vector3", wo), "L": ("vector3", wi), "N": ("vector3", NORMAL)}
    arguments["occlusion"] = ("float", inputs.get("occlusion", 1.0))
    if not emitted:
        arguments[ASKED] = ("boolean", output == "throughput")
    if before := prelude(text, start):
        statements = before.statements + statements
        arguments = _surface_arguments(shader, before, inputs) | arguments
    else:
        ports = _ports(shader)
        arguments |= {name: _argument(name, ports, inputs) for name in names}
    value = result if emitted else f"{ASKED} ? {result}.throughput : {result}.response"
    return Call(statements.replace(called, closure), value, arguments)


def bsdf_evaluation(
    shader: Shader,
    wo: ArrayLike,
    wi: ArrayLike,
    inputs: Mapping[str, Any],
    branch: str,
    output: str = OUTPUTS[0],
) -> tuple[str, Columns]:
    """Pixel stage that evaluates the BSDF of a generated shader, and its arguments.

    Parameters
    ----------
    shader : Shader
        Of a target in DIALECTS.
    wo, wi, inputs, branch, output
        As in `mxeon.shaders.hosts.base.Host.evaluate`.

    Returns
    -------
    str, dict of str to ndarray
        The text, and float32 texels (N, 1 to 3) by sampler name.

    Raises
    ------
    ValueError
        If the shader calls no BSDF, or branch or output is unknown.
    """
    dialect = DIALECTS[shader.target]
    call = bsdf_call(shader, wo, wi, inputs, branch, output)
    version, text = shader.stages["pixel"].split("\n", 1)
    # Subsurface scattering divides by what P changes from pixel to pixel: here it is that of a plane.
    body = [
        "vec3 P = vec3(gl_FragCoord.xy, 0.0);",
        call.statements,
        f"{_output(text)} = vec4({call.value}, 1.0);",
    ]
    head = f"{version}\n{dialect.prelude}{RENAME}"
    main, texels = _main(dialect, call.arguments, body)
    macros = "".join(f"#undef {name}\n" for name in ["main", *_booleans(text)])
    return f"{head}{text}{macros}{main}", texels


def function_evaluation(
    source: str,
    function: str,
    parameters: Sequence[tuple[str, str]],
    arguments: Sequence[ArrayLike],
    target: str = "glsl",
) -> tuple[str, Columns]:
    """Pixel stage that evaluates a function of `source`, and its texels as in `bsdf_evaluation`."""
    dialect = DIALECTS[target]
    values = {
        name: (kind, value) for (kind, name), value in zip(parameters, arguments, strict=True)
    }
    store = f"mxeon_out = vec4(vec3({function}({', '.join(values)})), 1.0);"
    main, texels = _main(dialect, values, [store])
    return dialect.version + dialect.prelude + dialect.output + source + main, texels


def frame(arguments: Mapping[str, NDArray[Any]]) -> tuple[int, tuple[int, int]]:
    """Number of elements, that of the longest argument, and size of the frame for them.

    Width and height are even: a change from pixel to pixel is that within a square of 2 x 2.
    """
    count = max(map(len, arguments.values()))
    height = 2 * -(-count // (2 * WIDTH))
    return count, (2 * -(-count // (2 * height)), height)


def texels(values: NDArray[Any], size: tuple[int, int]) -> NDArray[np.float32]:
    """Values, a row or layers of them per element or one for all, laid out over a frame of `size`."""
    width, height = size
    layers = values[:, np.newaxis] if values.ndim == 2 else values  # one above the other
    count, number, components = layers.shape
    rows = np.zeros((number, width * height, components), dtype=np.float32)
    rows[:, : count if count > 1 else None] = np.moveaxis(layers, 1, 0)
    return rows.reshape(number * height, width, components)


def columns(arguments: Mapping[str, tuple[str, ArrayLike]]) -> Columns:
    """Values of (type, values) as float32 rows of 1 to 3, by name."""
    return {
        name: np.asarray(value, dtype=np.float32).reshape(-1, COMPONENTS.get(kind, 3))
        for name, (kind, value) in arguments.items()
    }


@lru_cache(maxsize=16)  # the checks of a node share its shader
def _find_calls(text: str, closure: str, element: str) -> tuple[int, str, str, list[str]]:
    """Place and text of the statements that evaluate BSDFs for a closure type, result, arguments.

    The last call combines what the others before it return, or is the only one.
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


def _surface_arguments(shader: Shader, before: Prelude, inputs: Mapping[str, Any]) -> Arguments:
    """Types and values of the inputs of a surface shader's function."""
    ports = {port.path.rsplit("/", 1)[-1]: port for port in shader.inputs}
    arguments: Arguments = {}
    for name, kind in before.inputs.items():
        default = ports[name].value if name in ports else _argument(name, {}, {})[1]
        arguments[name] = kind, inputs.get(name, default)
    return arguments


def _graph_call(shader: Shader, wo: ArrayLike, inputs: Mapping[str, Any]) -> Call:
    """Call of a shader's graph: the statements before its surface, and the color of its uniform EDF."""
    text = shader.stages["pixel"]
    color = re.search(r"\bmx_uniform_edf\(closureData, (\w+), \w+\);", text)
    if not color:
        raise InputError(
            f"element {shader.element!r} must call a uniform EDF; its shader calls none"
        )
    before = re.split(r"\n *surfaceshader \w+ = ", text)[0]
    # Slang's own main begins with its stage's inputs and outputs.
    statements = re.split(r"\n\{\n|_vd;\n|float4 out1;\n", before)[-1]
    ports = _ports(shader)
    words = dict.fromkeys(re.findall(r"\w+", statements + color[1]))
    arguments: Arguments = {"V": ("vector3", wo)}  # of a graph that reads nothing
    arguments |= {name: _argument(name, ports, inputs) for name in words if name in ports}
    return Call(statements, color[1], arguments)


def _ports(shader: Shader) -> dict[str, Input]:
    """Inputs of a shader by name, with the booleans that its text makes of integers."""
    ports = {port.name: port for port in shader.inputs}
    for name in _booleans(shader.stages["pixel"]):
        if name in ports:
            ports[name] = replace(ports[name], type="boolean")
    return ports


@lru_cache(maxsize=16)
def _booleans(text: str) -> list[str]:
    """Names of the inputs that a text for WGSL makes booleans of."""
    return BOOLEAN.findall(text)


@lru_cache(maxsize=16)
def _output(text: str) -> str:
    """Name of the output of a pixel stage."""
    return str(re.findall(r"\bout vec4 (\w+);", text)[0])


def _argument(
    name: str, ports: Mapping[str, Input], inputs: Mapping[str, Any]
) -> tuple[str, ArrayLike]:
    """Type and value of a BSDF's argument; one that is no input of the shader is of the surface."""
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
    return port.type, inputs.get(key, port.value)


def _main(
    dialect: Dialect, arguments: Mapping[str, tuple[str, ArrayLike]], body: Sequence[str]
) -> tuple[str, Columns]:
    """A main that reads the arguments and then executes `body`, and the arguments' texels."""
    rows = columns(arguments)
    if len(rows) <= MOST:
        values = {f"mxeon_{name}": each for name, each in rows.items()}
        texels = [TEXEL.format(name) for name in rows]
    else:
        values = {STACK: _stacked(rows)}
        texels = [LAYER.format(index, len(rows)) for index in range(len(rows))]
    fetches = [
        FETCH[kind].format(name, texel)
        for (name, (kind, _)), texel in zip(arguments.items(), texels, strict=True)
    ]
    lines = ["ivec2 mxeon_pixel = ivec2(gl_FragCoord.xy);", *fetches, *body]
    samplers = [
        dialect.sampler.format(name=name, number=number) for number, name in enumerate(values)
    ]
    text = [*samplers, "void main()", "{", *("    " + line for line in lines), "}", ""]
    return "\n".join(text), values


def _stacked(rows: Columns) -> NDArray[np.float32]:
    """Columns of three values each as layers, (N, layers, 3)."""
    count = max(map(len, rows.values()))
    layers = np.zeros((count, len(rows), 3), np.float32)
    for index, each in enumerate(rows.values()):
        layers[:, index, : each.shape[1]] = each
    return layers
