# SPDX-License-Identifier: Apache-2.0
"""Small material documents as text, for the tests of the shader chain."""

OREN_NAYAR = "oren_nayar_diffuse_bsdf"
EON = "eon_diffuse_bsdf"
TYPES = {
    "weight": "float",
    "color": "color3",
    "roughness": "float",
    "normal": "vector3",
    "energy_compensation": "boolean",
}
FLAG = {"energy_compensation": "true"}

MATERIAL = """<?xml version="1.0"?>
<materialx version="1.39">
  {nodes}
  <surface name="shading" type="surfaceshader">
    <input name="bsdf" type="BSDF" nodename="lobe"/>
  </surface>
  <surfacematerial name="look" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="shading"/>
  </surfacematerial>
</materialx>
"""


def material(nodes):
    """A document of some nodes, of which `lobe` is the material's BSDF."""
    return MATERIAL.format(nodes=nodes)


def lobe(category=OREN_NAYAR, name="lobe", **inputs):
    """A rough diffuse node with the given values of its inputs.

    MaterialX takes no value for a normal, so that comes from a node of its own.
    """
    turned = inputs.pop("normal", None)
    values = "".join(
        f'<input name="{each}" type="{TYPES[each]}" value="{value}"/>'
        for each, value in inputs.items()
    )
    if turned is None:
        return f'<{category} name="{name}" type="BSDF">{values}</{category}>'
    return (
        f'<constant name="{name}_turned" type="vector3">'
        f'<input name="value" type="vector3" value="{turned}"/></constant>'
        f'<{category} name="{name}" type="BSDF">{values}'
        f'<input name="normal" type="vector3" nodename="{name}_turned"/></{category}>'
    )


def connected(**inputs):
    """A rough diffuse node with inputs connected as their attributes say."""
    ports = "".join(
        f'<input name="{each}" type="{TYPES[each]}" {attributes}/>'
        for each, attributes in inputs.items()
    )
    return f'<{OREN_NAYAR} name="lobe" type="BSDF">{ports}</{OREN_NAYAR}>'
