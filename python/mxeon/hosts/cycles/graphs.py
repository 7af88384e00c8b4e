# SPDX-License-Identifier: Apache-2.0
"""The graph of a generated OSL shader as a function of its inputs, around text left unchanged.

The functions before the shader stay as they are. One more function repeats the statements before the
shader's uniform EDF, and returns its color.
"""

import re

import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import InputError
from mxeon.hosts.base import Inputs
from mxeon.shaders.generation import Shader

FUNCTION = "mxeon_graph"
BRANCH = "graph"  # see `mxeon.hosts.base.Host.evaluate`


def graph_function(shader: Shader, inputs: Inputs) -> tuple[str, list[ArrayLike]]:
    """Text that defines FUNCTION, and the values of its arguments.

    `inputs` has values by path or by name; others have the document's. InputError without a uniform EDF.
    """
    text = shader.stages["pixel"]
    head, _, body = text.rpartition("\n)\n{\n")
    call = re.search(r"\n *EDF \w+ = uniform_edf\((\w+)\);", "\n" + body)
    if not call:
        raise InputError(
            f"element {shader.element!r} must call a uniform EDF; its shader calls none"
        )
    statements = ("\n" + body)[: call.start()]
    functions = head[: head.rindex("\nshader ")]
    words = set(re.findall(r"\w+", statements + call[1]))
    count = max([np.shape(value)[0] for value in inputs.values() if np.ndim(value)], default=1)
    parameters, locals_ = ["float mxeon_row"], []  # of a graph that reads nothing
    arguments: list[ArrayLike] = [np.zeros(count)]
    for port in shader.inputs:
        if port.name not in words:
            continue
        key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
        value = np.asarray(inputs.get(key, port.value), np.float32)
        if port.type == "vector2":  # which OSL's textures do not have
            parts = [f"{port.name}_{axis}" for axis in "xy"]
            parameters += [f"float {part}" for part in parts]
            locals_.append(f"    vector2 {port.name} = vector2({', '.join(parts)});")
            arguments += [value[..., 0], value[..., 1]]
        else:
            kind = {"color3": "color", "vector3": "vector"}.get(port.type, port.type)
            parameters.append(f"{kind} {port.name}")
            arguments.append(value)
    lines = [
        functions,
        f"color {FUNCTION}({', '.join(parameters)})",
        "{",
        *locals_,
        statements,
        f"    return {call[1]};",
        "}",
        "",
    ]
    return "\n".join(lines), arguments
