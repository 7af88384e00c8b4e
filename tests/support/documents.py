# SPDX-License-Identifier: Apache-2.0
"""Small material documents as text, for the tests of the shader chain."""

from mxeon.shaders.nodes import FLAG, INPUT_TYPES, OREN_NAYAR, SURFACE, document_text, lobe_text

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


def textured(files):
    """A document with a color that is the sum of the images in these files."""
    image = (
        '<image name="i{0}" type="color3"><input name="file" type="filename" value="{1}"/></image>'
    )
    add = (
        '<add name="s{0}" type="color3"><input name="in1" type="color3" nodename="{1}"/>'
        '<input name="in2" type="color3" nodename="i{0}"/></add>'
    )
    nodes = [image.format(number, file) for number, file in enumerate(files)]
    names = ["i0", *(f"s{number}" for number in range(1, len(files)))]
    nodes += [add.format(number, names[number - 1]) for number in range(1, len(files))]
    return material("".join(nodes) + connected(color=f'nodename="{names[-1]}"'))
