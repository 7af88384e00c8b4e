# SPDX-License-Identifier: Apache-2.0
"""Fragment shaders that evaluate a function once per pixel, made around text that stays as it is.

Arguments arrive in float textures, one texel per pixel. A generated shader keeps every character:
its `main` is renamed by a macro, and a second `main` repeats the statements by which the first one
calls its BSDF. Local variables of the same names hide the shader's uniforms there.
"""

import re
from dataclasses import dataclass

import numpy as np

from mxeon.errors import InputError

CLOSURES = {"direct": "CLOSURE_TYPE_REFLECTION", "environment": "CLOSURE_TYPE_INDIRECT"}
FETCH = {
    "float": "float {0} = texelFetch(mxeon_{0}, mxeon_pixel, 0).x;",
    "boolean": "bool {0} = texelFetch(mxeon_{0}, mxeon_pixel, 0).x > 0.5;",
    "color3": "vec3 {0} = texelFetch(mxeon_{0}, mxeon_pixel, 0).xyz;",
}
FETCH["vector3"] = FETCH["vec3"] = FETCH["color3"]
SCALARS = ("float", "boolean")
WIDTH = 1024  # pixels in a row of an evaluation


@dataclass(frozen=True)
class Dialect:
    """What a language of the GLSL family wants around the text.

    Attributes
    ----------
    version : str
        First line of a stage.
    prelude : str
        Lines that go between the version and a generated text.
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

# Vulkan as WebGPU has it keeps textures and samplers apart. The generated text joins them: to it a
# sampler2D is a texture that is always read through one and the same sampler.
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


@dataclass(frozen=True)
class Call:
    """How a generated shader calls its one BSDF.

    Attributes
    ----------
    statements : str
        What the shader's main does to call it.
    result : str
        The variable that receives the result.
    arguments : dict of str to (str, array_like)
        Type and values of every variable that the statements read, but P and occlusion.
    """

    statements: str
    result: str
    arguments: dict


def bsdf_call(shader, wo, wi, inputs, branch):
    """How a shader calls its BSDF, with the values that its arguments are to have.

    Parameters
    ----------
    shader : Shader
        Of a rasterised target.
    wo, wi, inputs, branch
        As in `mxeon.shaders.hosts`.

    Returns
    -------
    Call

    Raises
    ------
    ValueError
        If the shader does not call exactly one BSDF, or the branch is unknown.
    """
    if branch not in CLOSURES:
        raise InputError(f"branch must be one of {', '.join(CLOSURES)}; got {branch!r}")
    statements, result, names = _find_call(shader.stages["pixel"], CLOSURES[branch], shader.element)
    arguments = {"V": ("vector3", wo), "L": ("vector3", wi), "N": ("vector3", [0.0, 0.0, 1.0])}
    defaults = {each.name: each for each in shader.inputs}
    for name in names:
        arguments[name] = _argument(defaults.get(name), inputs)
    return Call(statements, result, arguments)


def bsdf_evaluation(shader, wo, wi, inputs, branch):
    """Pixel stage that evaluates the one BSDF of a generated shader, and its arguments.

    Parameters
    ----------
    shader : Shader
        Of a target in DIALECTS.
    wo, wi, inputs, branch
        As in `mxeon.shaders.hosts`.

    Returns
    -------
    str, dict of str to ndarray
        The text, and float32 texels (N, 1 or 3) by sampler name.

    Raises
    ------
    ValueError
        If the shader does not call exactly one BSDF, or the branch is unknown.
    """
    dialect = DIALECTS[shader.target]
    call = bsdf_call(shader, wo, wi, inputs, branch)
    version, text = shader.stages["pixel"].split("\n", 1)
    output = re.search(r"\bout vec4 (\w+);", text)[1]
    body = ["vec3 P = vec3(0.0);", "float occlusion = 1.0;", call.statements]
    body.append(f"{output} = vec4({call.result}.response, 1.0);")
    head = f"{version}\n{dialect.prelude}{RENAME}"
    main, texels = _main(dialect, call.arguments, body)
    return f"{head}{text}#undef main\n{main}", texels


def function_evaluation(source, function, parameters, arguments, target="glsl"):
    """Pixel stage that evaluates a function of `source`, and its arguments; see above."""
    dialect = DIALECTS[target]
    named = {name: (kind, value) for (kind, name), value in zip(parameters, arguments, strict=True)}
    store = f"mxeon_out = vec4(vec3({function}({', '.join(named)})), 1.0);"
    main, texels = _main(dialect, named, [store])
    return dialect.version + dialect.prelude + dialect.output + source + main, texels


def frame(arguments):
    """How many elements there are, as many as the longest argument has, and the frame for them."""
    count = max(map(len, arguments.values()))
    return count, (WIDTH, -(-count // WIDTH))


def texels(values, size):
    """Values, one row per element or one for all, laid out over a frame of `size`."""
    width, height = size
    laid = np.zeros((width * height, values.shape[1]), dtype=np.float32)
    laid[: len(values) if len(values) > 1 else None] = values
    return laid.reshape(height, width, -1)


def columns(arguments):
    """Values of (type, values) as float32 rows of 1 or 3, by name."""
    return {
        name: np.asarray(value, dtype=np.float32).reshape(-1, 1 if kind in SCALARS else 3)
        for name, (kind, value) in arguments.items()
    }


def _find_call(text, closure, element):
    """The statements that evaluate the BSDF for a closure type, its result and its arguments."""
    # MaterialX before 1.39.5 calls the constructor itself.
    constructor = r"(?:makeClosureData|ClosureData)"
    block = re.search(rf"ClosureData closureData = {constructor}\({closure}[^}}]*", text)
    calls = re.findall(r"\w+\(closureData, ([^;]*), (\w+)\);", block[0]) if block else []
    if len(calls) != 1:
        raise InputError(
            f"element {element!r} must call one BSDF and nothing else to be evaluated; "
            f"its shader calls {len(calls)}"
        )
    (arguments, result), end = calls[0], f", {calls[0][1]});"
    return block[0][: block[0].index(end) + len(end)], result, arguments.split(", ")


def _argument(default, inputs):
    """Type and value of a BSDF's argument; what is no input of the shader is the normal."""
    if default is None:
        return "vector3", inputs.get("normal", [0.0, 0.0, 1.0])
    return default.type, inputs.get(default.path.rsplit("/", 1)[-1], default.value)


def _main(dialect, arguments, body):
    """A main that reads the arguments and then does `body`, and the arguments' texels."""
    values = {f"mxeon_{name}": rows for name, rows in columns(arguments).items()}
    fetches = [FETCH[kind].format(name) for name, (kind, _) in arguments.items()]
    lines = ["ivec2 mxeon_pixel = ivec2(gl_FragCoord.xy);", *fetches, *body]
    samplers = [
        dialect.sampler.format(name=name, number=number) for number, name in enumerate(values)
    ]
    text = [*samplers, "void main()", "{", *("    " + line for line in lines), "}", ""]
    return "\n".join(text), values
