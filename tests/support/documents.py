# SPDX-License-Identifier: Apache-2.0
"""Small material documents as text, for the tests of the shader chain."""

import numpy as np
import pytest

from mxeon.errors import DocumentError
from mxeon.io.images import write_image
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import (
    FLAG,
    INPUT_TYPES,
    OREN_NAYAR,
    SURFACE,
    connection_text,
    document_text,
    input_text,
    lobe_text,
    node_text,
)

COMPENSATED = {FLAG: True}


def material(nodes):
    """A document of some nodes; `lobe` is the material's BSDF."""
    return document_text(nodes + SURFACE)


def lobe(category=OREN_NAYAR, name="lobe", **inputs):
    """A rough diffuse node with values of its inputs."""
    return lobe_text(category, inputs, name)


def connected(**inputs):
    """A rough diffuse node with inputs connected by the given attributes."""
    ports = "".join(
        f'<input name="{each}" type="{INPUT_TYPES[each]}" {attributes}/>'
        for each, attributes in inputs.items()
    )
    return f'<{OREN_NAYAR} name="lobe" type="BSDF">{ports}</{OREN_NAYAR}>'


def written(folder, text):
    """The file of a document in a folder."""
    path = folder / "look.mtlx"
    path.write_text(text)
    return path


def including(file):
    """A document that includes another one."""
    include = f'<xi:include href="{file}"/>'
    space = "http://www.w3.org/2001/XInclude"
    return f'<materialx version="1.39" xmlns:xi="{space}">{include}</materialx>'


def refusal(source, policy=DEFAULT):
    """The one-line refusal of a document."""
    with pytest.raises(DocumentError) as refused:
        generate(source, "glsl", policy=policy)
    message = str(refused.value)
    assert message and message.isprintable()
    return message


def image(file, name="image"):
    """An image node."""
    return f'<image name="{name}" type="color3"><input name="file" type="filename" value="{file}"/></image>'


def textured(files):
    """A document with a color that is the sum of the images in these files."""
    add = (
        '<add name="s{0}" type="color3"><input name="in1" type="color3" nodename="{1}"/>'
        '<input name="in2" type="color3" nodename="i{0}"/></add>'
    )
    nodes = [image(file, f"i{number}") for number, file in enumerate(files)]
    names = ["i0", *(f"s{number}" for number in range(1, len(files)))]
    nodes += [add.format(number, names[number - 1]) for number in range(1, len(files))]
    return material("".join(nodes) + connected(color=f'nodename="{names[-1]}"'))


def _open_pbr(**inputs):
    kinds = {"geometry_thin_walled": "boolean"}
    ports = "".join(
        input_text(name, "color3" if "color" in name else kinds.get(name, "float"), value)
        for name, value in inputs.items()
    )
    return node_text("open_pbr_surface", "surfaceshader", "shading", ports)


# Materials as artists bring them, by the names of their elements.
ARTISTS = {
    "car_paint": _open_pbr(
        base_color=(0.6, 0.02, 0.02), base_metalness=0.7, specular_roughness=0.35, coat_weight=1.0,
        coat_roughness=0.05, thin_film_weight=1.0, thin_film_thickness=0.4, thin_film_ior=1.8,
    ),
    "brushed_aluminium": lobe_text("conductor_bsdf", {
        "ior": (1.3, 0.96, 0.6), "extinction": (7.5, 6.4, 5.3), "roughness": (0.1, 0.5),
    }) + SURFACE,
    "velvet": lobe_text("sheen_bsdf", {"color": (0.7, 0.3, 0.4), "roughness": 0.4}, "fibers")
    + lobe_text(OREN_NAYAR, {"color": (0.1, 0.01, 0.03), "roughness": 0.9} | COMPENSATED, "pile")
    + node_text("layer", "BSDF", "lobe", connection_text("top", "BSDF", "fibers")
                + connection_text("base", "BSDF", "pile"))
    + SURFACE,
    "tiled_floor": node_text("tiledimage", "color3", "tiles",
                             input_text("file", "filename", "tiles.png")
                             + input_text("uvtiling", "vector2", (4.0, 4.0)))
    + node_text(OREN_NAYAR, "BSDF", "lobe", connection_text("color", "color3", "tiles")
                + input_text("roughness", "float", 0.8) + input_text(FLAG, "boolean", True))
    + SURFACE,
    "thin_glass": _open_pbr(
        transmission_weight=1.0, transmission_color=(0.8, 0.95, 0.9), specular_roughness=0.2,
        geometry_thin_walled=True,
    ),
}  # fmt: skip


def from_artist(folder, name):
    """The file of a document of `ARTISTS` in a folder, with the image that it reads."""
    tiles = np.full((8, 8, 3), (200, 130, 90), np.uint8)
    tiles[0] = tiles[:, 0] = 40
    write_image(folder / "tiles.png", tiles, {})
    path = folder / f"{name}.mtlx"
    path.write_text(document_text(ARTISTS[name], name))
    return path
