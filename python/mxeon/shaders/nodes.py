# SPDX-License-Identifier: Apache-2.0
"""The rough diffuse nodes, their inputs, and materials of one node as MaterialX text."""

from collections.abc import Mapping

OREN_NAYAR = "oren_nayar_diffuse_bsdf"
EON = "eon_diffuse_bsdf"

# Categories of the nodes that eonlib implements. Its GLSL functions have the same names.
DIFFUSE_NODES = (OREN_NAYAR, EON)

FLAG = "energy_compensation"  # which the first alone has: EON if true, else QON
INPUT_TYPES = {
    "weight": "float",
    "color": "color3",
    "roughness": "float",
    "normal": "vector3",
    FLAG: "boolean",
}

SURFACE = """  <surface name="shading" type="surfaceshader">
    <input name="bsdf" type="BSDF" nodename="lobe" />
  </surface>
"""
DOCUMENT = """<?xml version="1.0"?>
<materialx version="1.39">
{nodes}  <surfacematerial name="{name}" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="shading" />
  </surfacematerial>
</materialx>
"""


def nodedef(category: str) -> str:
    """Name of the nodedef of a rough diffuse node.

    Examples
    --------
    >>> nodedef("eon_diffuse_bsdf")
    'ND_eon_diffuse_bsdf'
    """
    return f"ND_{category}"


def value_text(value: object) -> str:
    """A value as MaterialX writes it.

    Examples
    --------
    >>> value_text(True), value_text(0.5), value_text((0.2, 0.5, 1))
    ('true', '0.5', '0.2, 0.5, 1.0')
    """
    if isinstance(value, (bool, str)):
        return str(value).lower() if isinstance(value, bool) else value
    if isinstance(value, (int, float)):
        return repr(float(value))
    return ", ".join(map(value_text, value))  # type: ignore[call-overload]


def input_text(name: str, kind: str, value: object) -> str:
    """An input with a value, as XML."""
    return f'    <input name="{name}" type="{kind}" value="{value_text(value)}" />\n'


def node_text(category: str, kind: str, name: str, inputs: str = "") -> str:
    """A node around the XML of its inputs."""
    return f'  <{category} name="{name}" type="{kind}">\n{inputs}  </{category}>\n'


def document_text(nodes: str, name: str = "look") -> str:
    """A document whose material shows the surface shader `shading`, which the nodes include.

    Parameters
    ----------
    nodes : str
        XML of the nodes.
    name : str
        Name of the material.
    """
    return DOCUMENT.format(nodes=nodes, name=name)


def material_text(
    category: str, inputs: Mapping[str, object] | None = None, name: str = "look"
) -> str:
    """A document of a material that is one rough diffuse node, called `lobe`.

    Parameters
    ----------
    category : str
        One of DIFFUSE_NODES.
    inputs : mapping of str to bool, float, str or a sequence of floats
        Values by names of INPUT_TYPES. MaterialX ignores that of a normal: it needs a connection.
    name : str
        Name of the material.

    Returns
    -------
    str
        XML text.

    Raises
    ------
    KeyError
        If there is no input of that name.
    """
    values = (input_text(each, INPUT_TYPES[each], value) for each, value in (inputs or {}).items())
    lobe = node_text(category, "BSDF", "lobe", "".join(values))
    return document_text(lobe + SURFACE, name)
