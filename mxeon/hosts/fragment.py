# SPDX-License-Identifier: Apache-2.0
"""Fragment shaders that evaluate a function once per pixel, made around text that stays as it is.

Arguments arrive in float textures, one texel per pixel. A generated shader keeps every character:
its `main` is renamed by a macro, and a second `main` repeats the statements by which the first one
calls its BSDF. Local variables of the same names hide the shader's uniforms there.
"""

import re

import numpy as np

CLOSURES = {"direct": "CLOSURE_TYPE_REFLECTION", "environment": "CLOSURE_TYPE_INDIRECT"}
FETCH = {
    "float": "float {0} = texelFetch(mxeon_{0}, mxeon_pixel, 0).x;",
    "boolean": "bool {0} = texelFetch(mxeon_{0}, mxeon_pixel, 0).x > 0.5;",
    "color3": "vec3 {0} = texelFetch(mxeon_{0}, mxeon_pixel, 0).xyz;",
}
FETCH["vector3"] = FETCH["vec3"] = FETCH["color3"]
SCALARS = ("float", "boolean")

VERTEX = """#version 430
in vec3 i_position;
void main() { gl_Position = vec4(i_position, 1.0); }
"""
HEADER = "#version 430\nout vec4 mxeon_out;\n"


def bsdf_evaluation(shader, wo, wi, inputs, branch):
    """Pixel stage that evaluates the one BSDF of a generated shader, and its arguments.

    Parameters
    ----------
    shader : Shader
        Of target glsl.
    wo, wi, inputs, branch
        As in `mxeon.hosts`.

    Returns
    -------
    str, dict of str to ndarray
        The text, and float32 texels (N, 1 or 3) by sampler name.

    Raises
    ------
    ValueError
        If the shader does not call exactly one BSDF, or the branch is unknown.
    """
    if branch not in CLOSURES:
        raise ValueError(f"branch must be one of {', '.join(CLOSURES)}; got {branch!r}")
    text = shader.stages["pixel"]
    statements, result, names = _find_call(text, CLOSURES[branch], shader.element)
    arguments = {"V": ("vector3", wo), "L": ("vector3", wi), "N": ("vector3", [0.0, 0.0, 1.0])}
    defaults = {each.name: each for each in shader.inputs}
    for name in names:
        arguments[name] = _argument(defaults.get(name), inputs)
    output = re.search(r"^out vec4 (\w+);", text, re.MULTILINE)[1]
    body = ["vec3 P = vec3(0.0);", "float occlusion = 1.0;", statements]
    store = f"{output} = vec4({result}.response, 1.0);"
    return _evaluation(text, arguments, body, store)


def function_evaluation(source, function, parameters, arguments):
    """Pixel stage that evaluates a function of `source`, and its arguments; see above."""
    named = {
        name: (kind, value) for (kind, name), value in zip(parameters, arguments, strict=True)
    }
    store = f"mxeon_out = vec4(vec3({function}({', '.join(named)})), 1.0);"
    return _evaluation(HEADER + source, named, [], store)


def _find_call(text, closure, element):
    """The statements that evaluate the BSDF for a closure type, its result and its arguments."""
    pattern = (
        rf"ClosureData closureData = makeClosureData\({closure}[^;]*;\s*"
        r"BSDF (\w+) = [^;]*;\s*\w+\(closureData, ([^;]*), \1\);"
    )
    found = list(re.finditer(pattern, text))
    if len(found) != 1:
        raise ValueError(
            f"element {element!r} must call one BSDF and nothing else to be evaluated; "
            f"its shader has {len(found)} such calls"
        )
    return found[0][0], found[0][1], found[0][2].split(", ")


def _argument(default, inputs):
    """Type and value of a BSDF's argument; what is no input of the shader is the normal."""
    if default is None:
        return "vector3", inputs.get("normal", [0.0, 0.0, 1.0])
    return default.type, inputs.get(default.path.rsplit("/", 1)[-1], default.value)


def _evaluation(text, arguments, body, store):
    texels = {
        f"mxeon_{name}": np.asarray(value, dtype=np.float32).reshape(-1, 1 if kind in SCALARS else 3)
        for name, (kind, value) in arguments.items()
    }
    fetches = [FETCH[kind].format(name) for name, (kind, _) in arguments.items()]
    lines = ["ivec2 mxeon_pixel = ivec2(gl_FragCoord.xy);", *fetches, *body, store]
    main = "\n".join(
        ["#undef main", *(f"uniform sampler2D {name};" for name in texels), "void main()", "{"]
        + ["    " + line for line in lines]
        + ["}", ""]
    )
    return text.replace("\n", "\n#define main mxeon_generated_main\n", 1) + main, texels
