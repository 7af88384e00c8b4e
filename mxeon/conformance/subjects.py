# SPDX-License-Identifier: Apache-2.0
"""What is judged: the rough diffuse nodes, each with the model it has to be."""

from dataclasses import dataclass

import numpy as np

NODE_DOCUMENT = """<?xml version="1.0"?>
<materialx version="1.39">
  <constant name="shading_normal" type="vector3">
    <input name="value" type="vector3" value="{normal}" />
  </constant>
  <{node} name="lobe" type="BSDF">
{inputs}
  </{node}>
  <surface name="shading" type="surfaceshader">
    <input name="bsdf" type="BSDF" nodename="lobe" />
  </surface>
  <surfacematerial name="{node}" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="shading" />
  </surfacematerial>
</materialx>
"""
FLAG = "energy_compensation"
TYPES = {
    "weight": "float",
    "color": "color3",
    "roughness": "float",
    "normal": "vector3",
    FLAG: "boolean",
}


@dataclass(frozen=True)
class Subject:
    """A node as it is judged: with the flag it is used with and the model it has to be.

    Attributes
    ----------
    node : str
        Node category.
    flag : bool or None
        energy_compensation, or None where the node has no such input.
    model : str
        Name of a row of `mxeon.reference.MODELS`.
    names : tuple of str
        Inputs that it may have; the flag counts only where it is not None.
    """

    node: str
    flag: bool | None
    model: str
    names: tuple[str, ...] = tuple(TYPES)

    @property
    def stock(self):
        """Whether MaterialX has this node as it comes."""
        return self.node != "eon_diffuse_bsdf"

    @property
    def title(self):
        """How reports call it."""
        flag = "" if self.flag is None else f", energy_compensation {str(self.flag).lower()}"
        return self.node + flag

    @property
    def inputs(self):
        """Names of the node's inputs."""
        return tuple(name for name in self.names if self.flag is not None or name != FLAG)

    def with_flag(self, inputs):
        """Inputs with the subject's flag, unless they set it."""
        return inputs if self.flag is None else {FLAG: self.flag, **inputs}

    def document(self, inputs=None):
        """MaterialX text of a material that is this node alone, with the inputs given."""
        given = self.with_flag(inputs or {})
        lines = "\n".join(
            f'    <input name="{name}" type="{TYPES[name]}" {_source(name, value)} />'
            for name, value in given.items()
        )
        normal = _text(given.get("normal", (0.0, 0.0, 1.0)))
        return NODE_DOCUMENT.format(node=self.node, inputs=lines, normal=normal)


SUBJECTS = (
    Subject("oren_nayar_diffuse_bsdf", True, "eon"),
    Subject("oren_nayar_diffuse_bsdf", False, "qon"),
    Subject("eon_diffuse_bsdf", None, "eon"),
)

# Nodes that a renderer has of its own; Blender's are meant to be EON.
NATIVE = tuple(
    Subject(node, None, "eon", ("color", "roughness")) for node in ("Diffuse BSDF", "Principled BSDF")
)


def _source(name, value):
    """Where an input comes from. MaterialX drops the value of a normal that is not connected."""
    return 'nodename="shading_normal"' if name == "normal" else f'value="{_text(value)}"'


def _text(value):
    if isinstance(value, bool):
        return str(value).lower()
    return ", ".join(repr(float(each)) for each in np.ravel(value))
