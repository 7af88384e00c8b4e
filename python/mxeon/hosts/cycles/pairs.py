# SPDX-License-Identifier: Apache-2.0
"""Requests to Blender's process for pictures that show a pair of directions in each pixel."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.base import Array, Inputs
from mxeon.hosts.cycles import tracing
from mxeon.hosts.osl.points import IMAGE, columns_of, side, statements, with_variables
from mxeon.hosts.pairs import DISTANCE, HEIGHT, LAMP, SKY, tilted_triangles
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene

SKY_SAMPLES = 64  # paths of a pixel


def request(
    folder: Path, shader: Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
) -> tuple[str, dict[str, object], NDArray[np.float64]]:
    """Text of a shader, what the worker needs beside it, and what its values are multiplied by."""
    count, size = len(wo), side(len(wo))
    scene = tilted_triangles(wo, wi, size)
    columns = {
        name: replace(each, values=scene.turned(each.rows)) if each.directed else each
        for name, each in columns_of(shader, inputs).items()
    }
    block = statements(columns, folder / IMAGE, count, scene.place)
    text = with_variables(shader, block, lambda output: last.format(output=output))
    corners = folder / "triangles.npy"
    np.save(corners, scene.corners.astype(np.float32))
    frame: dict[str, object] = {**tracing.request(Scene("pairs"), ()), "size": size}
    frame |= {"radius": 0.5 * HEIGHT, "width": scene.width, "triangles": str(corners)}
    if light == LAMP:
        return text, frame | {"lamp": DISTANCE}, DISTANCE**2 * scene.irradiance
    if light == SKY:
        frame |= {"samples": SKY_SAMPLES, "environment": 1.0}
    return text, frame, np.ones((1, 1))
