# SPDX-License-Identifier: Apache-2.0
"""Requests to Blender's process for the values of an OSL function.

They are the light that a plane emits: pixel by pixel a shader reads the arguments from images, by
position and without filtering, so that every bit of a float32 survives.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import InputError
from mxeon.hosts.cycles import tracing
from mxeon.io.images import write_image
from mxeon.shaders import functions
from mxeon.shaders.scene import Scene

EMITTER = Scene("emitter")  # without light, for what shines by itself
LEAST_SIZE = 4  # pixels along a side: Blender renders no smaller picture
CALL = """#include "{source}"

shader call(output closure color out = 0)
{{
    float s = 0.5 + 0.5 * P[0];
    float t = 0.5 - 0.5 * P[1];
{reads}
    color value = {function}({names});
    out = value * emission();
}}
"""
READ = '    {type} {name} = texture("{image}", s, t, 0.0, 0.0, 0.0, 0.0, "interp", "closest");'


def request(
    folder: Path, source: str, function: str, *arguments: ArrayLike
) -> tuple[str, dict[str, object], int]:
    """Text of a shader, what the worker needs beside it, and how many pixels have a value."""
    types = [kind for kind, _ in functions.parameters(source, function)]
    if len(types) != len(arguments):
        raise InputError(f"{function} takes {len(types)} arguments; got {len(arguments)}")
    columns = [_columns(*pair) for pair in zip(types, arguments, strict=True)]
    count = max(map(len, columns))
    size = max(LEAST_SIZE, math.isqrt(count - 1) + 1)
    names = [f"argument{index}" for index in range(len(types))]
    reads = []
    for kind, name, column in zip(types, names, columns, strict=True):
        image = folder / f"{name}.exr"
        _write(image, np.broadcast_to(column, (count, column.shape[1])), size)
        reads.append(READ.format(type=kind, name=name, image=image.as_posix()))
    path = folder / "functions.osl"
    path.write_text(source, encoding="utf-8")
    text = CALL.format(
        source=path.as_posix(), reads="\n".join(reads), function=function, names=", ".join(names)
    )
    return text, {**tracing.request(EMITTER, ()), "size": size, "radius": 2.0}, count


def _columns(kind: str, values: ArrayLike) -> NDArray[np.float32]:
    """Values of an OSL type as rows of float32, one row for what is the same everywhere."""
    return np.asarray(values, np.float32).reshape(-1, 1 if kind == "float" else 3)


def _write(path: Path, rows: NDArray[np.float32], size: int) -> None:
    """Write rows as the first pixels of a float32 image of `size` x `size`."""
    channels = rows.shape[1]
    pixels = np.zeros((size * size, channels), np.float32)
    pixels[: len(rows)] = rows
    write_image(path, pixels.reshape(size, size, channels), {})
