# SPDX-License-Identifier: Apache-2.0
"""An OSL shader that evaluates a function at every point of testshade's grid.

Arguments arrive in float32 textures, one texel per point.
"""

from collections.abc import Sequence

SHADER = "mxeon_call"
OPTIONS = ("--center", "-d", "float", SHADER, "-o", "result")
TEXEL = '{kind} mxeon_{name} = ({kind}) {read} texture("{file}", u, v, 0.0, 0.0, 0.0, 0.0, "interp", "closest");'
SCALARS = ("float", "int")


def texture(argument: str) -> str:
    return f"{argument}.tif"


def text(source: str, function: str, parameters: Sequence[tuple[str, str]]) -> str:
    """Text of a shader whose output `result` is a function of its textures."""
    reads = [
        TEXEL.format(
            kind=kind,
            name=name,
            read="(float)" if kind in SCALARS else "(color)",
            file=texture(name),
        )
        for kind, name in parameters
    ]
    names = ", ".join(f"mxeon_{name}" for _, name in parameters)
    lines = [*reads, f"result = (color) {function}({names});"]
    body = "\n".join(f"    {line}" for line in lines)
    return f"{source}\nshader {SHADER}(output color result = 0)\n{{\n{body}\n}}\n"
