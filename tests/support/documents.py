# SPDX-License-Identifier: Apache-2.0
"""Small material documents as text, for the tests of the shader chain."""

from mxeon.shaders.nodes import FLAG, INPUT_TYPES, OREN_NAYAR, SURFACE, document_text, lobe_text

COMPENSATED = {FLAG: True}


def material(nodes):
    """A document of some nodes, of which `lobe` is the material's BSDF."""
    return document_text(nodes + SURFACE)


def lobe(category=OREN_NAYAR, name="lobe", **inputs):
    """A rough diffuse node with values of its inputs."""
    return lobe_text(category, inputs, name)


def connected(**inputs):
    """A rough diffuse node with inputs connected as their attributes say."""
    ports = "".join(
        f'<input name="{each}" type="{INPUT_TYPES[each]}" {attributes}/>'
        for each, attributes in inputs.items()
    )
    return f'<{OREN_NAYAR} name="lobe" type="BSDF">{ports}</{OREN_NAYAR}>'
