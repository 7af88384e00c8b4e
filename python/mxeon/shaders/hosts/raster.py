# SPDX-License-Identifier: Apache-2.0
"""What a rasterising host draws: one vertex per pixel, placed at its centre.

Each pixel of a picture so holds the shader's value at an exact point of the sphere, with
neighbours to take derivatives from.
"""

import numpy as np

from mxeon.shaders.document.values import members
from mxeon.shaders.hosts.textures import irradiance, read_latlong, read_texture
from mxeon.shaders.scene import sphere

VIEW_DISTANCE = 1e8  # makes normalize(u_viewPosition - positionWorld) the z axis, in float32
WHITE = np.ones((1, 1, 3), dtype=np.float32)
SURROUNDING = {"u_envRadiance": WHITE, "u_envIrradiance": WHITE}


def textures(shader, scene):
    """Texels by sampler: the images of a shader's document and the surrounding, row 0 first in v."""
    radiance = read_latlong(scene.environment)
    images = {
        each.name: read_texture(each.value)
        for each in shader.inputs
        if each.type == "filename" and each.value
    }
    return images | {"u_envRadiance": radiance, "u_envIrradiance": irradiance(radiance)}


def inputs(shader):
    """Values of the uniforms that carry a shader's inputs, but for its images.

    A matrix is a flat tuple, whose rows are the columns of the uniform; each member of a structure
    is a uniform of its own.
    """
    found = [(each.name, each.type, each.value) for each in shader.inputs]
    uniforms = {}
    while found:
        name, kind, value = found.pop()
        if parts := members(kind, shader.document):
            named = zip(parts, value or (), strict=False)
            found += [(f"{name}.{part}", each, inner) for (part, each), inner in named]
        elif value is not None and not isinstance(value, str):
            uniforms[name] = value
    return uniforms


def light(scene):
    """Values of the uniforms by which a shader knows the viewer and the distant light."""
    values = {"u_viewPosition": (0.0, 0.0, VIEW_DISTANCE), "u_envRadianceMips": 1}
    values["u_numActiveLightSources"] = 0  # a program keeps what the last scene gave it
    if scene.light is not None:
        values |= {
            "u_numActiveLightSources": 1,
            "u_lightData[0].type": 1,
            "u_lightData[0].direction": tuple(-x for x in scene.light),
            "u_lightData[0].color": (1.0, 1.0, 1.0),
            "u_lightData[0].intensity": np.pi,
        }
    return values


def grid(size):
    """Vertices at the pixel centres, one row more on each side, and triangles between them.

    The triangles that meet in a pixel's vertex surround it, and one of them covers the pixel. A
    centre beside the sphere has the normal of the nearest point of the rim.
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


def triangle():
    """One triangle over the whole frame."""
    corners = np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], dtype="f4")
    normals = np.tile(np.array([[0, 0, 1]], dtype="f4"), (3, 1))
    return {"i_position": corners, "i_normal": normals}, np.arange(3, dtype="u4")


def picture(image, size):
    """A frame, row 0 at the bottom, as a picture: 0 off the sphere, row 0 at the top."""
    return np.where(sphere(size).mask[..., None], image[::-1], np.float32(0.0))
