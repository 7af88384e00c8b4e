# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the rough diffuse nodes, each with the model it has to be."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from mxeon.shaders.nodes import (
    EON,
    FLAG,
    INPUT_TYPES,
    OREN_NAYAR,
    document_text,
    input_text,
    material_text,
    node_text,
)


@dataclass(frozen=True)
class Subject:
    """A node with its flag and the model it has to be.

    Attributes
    ----------
    node : str
        Node category.
    flag : bool or None
        energy_compensation, or None where the node has no such input.
    model : str
        Name of a row of `mxeon.models.table.MODELS`.
    names : tuple of str
        Inputs that it may have; the flag counts only where it is not None.
    """

    node: str
    flag: bool | None
    model: str
    names: tuple[str, ...] = tuple(INPUT_TYPES)

    @property
    def title(self) -> str:
        """Name in reports."""
        flag = "" if self.flag is None else f", energy_compensation {str(self.flag).lower()}"
        return self.node + flag

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the node's inputs."""
        return tuple(name for name in self.names if self.flag is not None or name != FLAG)

    def with_flag(self, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        """Inputs with the subject's flag, unless they set it."""
        return inputs if self.flag is None else {FLAG: self.flag, **inputs}

    def document(self, inputs: Mapping[str, Any] | None = None) -> str:
        """MaterialX text of a material that is this node alone, with these inputs."""
        return material_text(self.node, self.with_flag(inputs or {}), self.node)


SUBJECTS = (
    Subject(OREN_NAYAR, True, "eon"),
    Subject(OREN_NAYAR, False, "qon"),
    Subject(EON, None, "eon"),
)


@dataclass(frozen=True)
class Surface:
    """The diffuse lobe of a surface shader, whose other lobes cannot be switched off.

    What lies over the lobe depends on the directions alone, so that pictures of other colors
    tell the lobe apart; see `mxeon.conformance.checks.surface_probes.SurfaceProbe`.

    Attributes
    ----------
    title, node, model : str
        Name in reports, node category, and the model that its specification asks for.
    color, roughness : str
        Names of the inputs of the lobe; "" for no roughness.
    fixed : tuple of (str, str, str)
        Name, type and value of further inputs.
    libraries : tuple of str
        The libraries with which it is judged; () for all.
    """

    title: str
    node: str
    model: str
    color: str
    roughness: str
    fixed: tuple[tuple[str, str, str], ...] = ()
    libraries: tuple[str, ...] = ()

    inputs: ClassVar[tuple[str, ...]] = ()

    def document(self, inputs: Mapping[str, Any]) -> str:
        """MaterialX text of a material that is this shader alone."""
        values = [(self.color, "color3", inputs["color"]), *self.fixed]
        if self.roughness:
            values.append((self.roughness, "float", inputs["roughness"]))
        ports = "".join(input_text(name, kind, value) for name, kind, value in values)
        return document_text(node_text(self.node, "surfaceshader", "shading", ports))


# OpenPBR asks for EON, Standard Surface for Oren-Nayar, USD Preview Surface and glTF for Lambert.
# The thin-walled lobe is MaterialX's own whatever the library, so it is judged once.
THIN_WALLED = (
    ("geometry_thin_walled", "boolean", "true"),
    ("subsurface_weight", "float", "1.0"),
)
SURFACES = (
    Surface("open_pbr_surface", "open_pbr_surface", "eon", "base_color", "base_diffuse_roughness"),
    Surface(
        "open_pbr_surface, thin-walled",
        "open_pbr_surface",
        "eon",
        "subsurface_color",
        "base_diffuse_roughness",
        THIN_WALLED,
        ("stock",),
    ),
    Surface(
        "standard_surface",
        "standard_surface",
        "qon",
        "base_color",
        "diffuse_roughness",
        (("base", "float", "1.0"),),
    ),
    Surface("UsdPreviewSurface", "UsdPreviewSurface", "lambert", "diffuseColor", ""),
    Surface("gltf_pbr", "gltf_pbr", "lambert", "base_color", "", (("metallic", "float", "0.0"),)),
)

# Nodes that a renderer has of its own; Blender's are meant to be EON.
NATIVE = tuple(
    Subject(node, None, "eon", ("color", "roughness"))
    for node in ("Diffuse BSDF", "Principled BSDF")
)
