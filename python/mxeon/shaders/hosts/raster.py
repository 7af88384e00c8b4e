# SPDX-License-Identifier: Apache-2.0
"""Frames that a rasterizing host draws: one vertex per pixel, at its center.

A pixel of a picture holds the shader's value at an exact point of the sphere, and has neighbors to
take derivatives from.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.shaders.document.values import members
from mxeon.shaders.generation import Shader
from mxeon.shaders.hosts.textures import irradiance, read_latlong, read_texture
from mxeon.shaders.scene import Scene, sphere

VIEW_DISTANCE = 1e8  # makes normalize(u_viewPosition - positionWorld) the z axis, in float32
WHITE = np.ones((1, 1, 3), dtype=np.float32)
# Vertices by attribute, and the indices of their triangles.
Mesh: TypeAlias = tuple[dict[str, NDArray[np.float32]], NDArray[np.uint32]]


def textures(shader: Shader, scene: Scene) -> dict[str, NDArray[Any]]:
    """Texels by sampler: images of a shader's document and the environment, row 0 first in v."""
    radiance = read_latlong(scene.environment)
    images = {
        port.name: read_texture(str(port.value))
        for port in shader.inputs
        if port.type == "filename" and port.value
    }
    return images | {"u_envRadiance": radiance, "u_envIrradiance": irradiance(radiance)}


def environment(irradiance: NDArray[Any] | None) -> dict[str, NDArray[Any]]:
    """Texels of the environment of an evaluation; see `mxeon.shaders.hosts.base.Host.evaluate`."""
    return {
        "u_envRadiance": WHITE,
        "u_envIrradiance": WHITE if irradiance is None else irradiance,
    }


def inputs(shader: Shader) -> dict[str, Any]:
    """Values of the uniforms that carry a shader's inputs, but for its images.

    A matrix is a flat tuple, whose rows are the columns of the uniform; each member of a structure
    is a uniform of its own.
    """
    ports: list[tuple[str, str, Any]] = [
        (port.name, port.type, port.value) for port in shader.inputs
    ]
    uniforms: dict[str, Any] = {}
    while ports:
        name, kind, value = ports.pop()
        if parts := members(kind, shader.document):
            values = zip(parts, value or (), strict=False)
            ports += [(f"{name}.{part}", inner, member) for (part, inner), member in values]
        elif value is not None and not isinstance(value, str):
            uniforms[name] = value
    return uniforms


def light(scene: Scene) -> dict[str, Any]:
    """Values of the uniforms of the viewer and the distant light."""
    values: dict[str, Any] = {"u_viewPosition": (0.0, 0.0, VIEW_DISTANCE), "u_envRadianceMips": 1}
    values["u_numActiveLightSources"] = 0  # or the program keeps the last scene's
    if scene.light is not None:
        values |= {
            "u_numActiveLightSources": 1,
            "u_lightData[0].type": 1,
            "u_lightData[0].direction": tuple(-x for x in scene.light),
            "u_lightData[0].color": (1.0, 1.0, 1.0),
            "u_lightData[0].intensity": np.pi,
        }
    return values


def grid(size: int) -> Mesh:
    """Vertices at the pixel centers, one row more on each side, and triangles between them.

    The triangles that meet in a pixel's vertex surround it, and one of them covers the pixel. A
    center beside the sphere has the normal of the nearest point of the rim.
    """
    points = sphere(size, margin=1)
    size = len(points.mask)
    flat = points.normal.reshape(-1, 3)
    tangent = np.stack([flat[:, 2], np.zeros(len(flat)), -flat[:, 0]], axis=1)
    vertices = {
        "i_position": points.position.reshape(-1, 3),
        "i_normal": flat,
        "i_tangent": tangent / np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-30),
        "i_texcoord_0": points.texcoord.reshape(-1, 2),
    }
    corner = np.arange(size * size).reshape(size, size)[:-1, :-1].ravel()
    square = corner[:, None] + [0, 1, size, size, 1, size + 1]
    return {name: values.astype("f4") for name, values in vertices.items()}, square.astype("u4")


def triangle() -> Mesh:
    """One triangle over the whole frame."""
    corners = np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], dtype="f4")
    normals = np.tile(np.array([[0, 0, 1]], dtype="f4"), (3, 1))
    return {"i_position": corners, "i_normal": normals}, np.arange(3, dtype="u4")


def picture(image: NDArray[Any], size: int) -> NDArray[Any]:
    """Picture of a frame whose row 0 is at the bottom: 0 off the sphere, row 0 at the top."""
    return np.where(sphere(size).mask[..., None], image[::-1], np.float32(0.0))
