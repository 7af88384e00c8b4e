# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: surface shaders, each with all of its lobes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.rows import CHANGED_COLOR, Port, color, draw
from mxeon.conformance.samples.batch import Array, Values
from mxeon.shaders.nodes import document_text, node_text

# Ports by the range that is asked of them; a change is another value than any default.
RANGES = {
    "color": color("", edges=()),
    "share": Port("", change=0.7),
    "rough": Port("", low=0.1, change=0.73),
    "sheen_rough": Port("", low=0.15, change=0.745),
    "fuzz_rough": Port("", low=0.4, change=0.82),
    "index": Port("", low=1.1, high=2.5, change=2.08),
    "thickness": Port("", high=1000.0, change=700.0),
    "film": Port("", low=100.0, high=1000.0, change=730.0),
}
# The mean free path below the surface, which shows on a curved one: an evaluation has a plane.
FREE_PATHS = ("subsurface_radius", "subsurface_scale", "subsurface_radius_scale")
TURNED_FRAME = {"normal": (0.0, 0.6, 0.8), "tangent": (0.6, 0.8, 0.0)}


def _ports(**names: str) -> tuple[Port, ...]:
    """Ports with the names in each of RANGES."""
    return tuple(
        replace(RANGES[key], name=name) for key, words in names.items() for name in words.split()
    )


@dataclass(frozen=True, eq=False)
class Inputs:
    """Inputs of a surface shader that its lobes may depend on."""

    judged: tuple[Port, ...]  # those whose values have a reference
    others: tuple[Port, ...]  # those of other lobes and of thin films, which are asked for energy
    seen: Values  # a material in which every lobe takes part
    more: Values  # further inputs, with values that this material does not have
    # Inputs of `changed` that change no value of rasterized targets; docs/upstream/
    # surface_inputs.md says why.
    without_effect: tuple[str, ...]
    white: Values  # a material that loses no light, by the layer equation
    # What else the material has where an input is changed.
    needs: Mapping[str, Values] = field(default_factory=dict)
    # Inputs of `changed` that a curved surface alone has to show; that of pairs is a plane.
    curved: tuple[str, ...] = ()

    @cached_property
    def changed(self) -> Values:
        """For each input but FREE_PATHS a value that the material with every lobe does not have."""
        ports = (port for port in (*self.judged, *self.others) if port.name not in FREE_PATHS)
        changes = {port.name: port.change for port in ports if port.change is not None}
        return {**changes, **self.more}


STANDARD = Inputs(
    _ports(
        share="base diffuse_roughness metalness specular specular_anisotropy specular_rotation sheen coat coat_anisotropy coat_rotation coat_affect_color coat_affect_roughness",
        color="base_color specular_color sheen_color coat_color",
        rough="specular_roughness coat_roughness",
        index="specular_IOR coat_IOR",
        sheen_rough="sheen_roughness",
    ),
    _ports(
        share="transmission transmission_extra_roughness subsurface subsurface_scale",
        color="transmission_color subsurface_color subsurface_radius",
        thickness="thin_film_thickness",
        index="thin_film_IOR",
    ),
    seen={
        "metalness": 0.4,
        "specular_anisotropy": 0.5,
        "sheen": 0.5,
        "coat": 0.5,
        "coat_anisotropy": 0.5,
        "coat_affect_color": 0.5,
        "coat_affect_roughness": 0.5,
        "transmission": 0.4,
        "subsurface": 0.4,
        "thin_film_thickness": 400.0,
    },
    more=dict(
        transmission_depth=2.0,
        transmission_scatter=CHANGED_COLOR,
        transmission_scatter_anisotropy=0.5,
        transmission_dispersion=20.0,
        subsurface_anisotropy=0.5,
        thin_walled=True,
        coat_normal=TURNED_FRAME["normal"],
        **TURNED_FRAME,
    ),
    without_effect=(
        "transmission_depth",
        "transmission_scatter",
        "transmission_scatter_anisotropy",
        "transmission_dispersion",
        "subsurface_anisotropy",
    ),
    curved=("subsurface_radius", "subsurface_scale"),
    white={
        "base": 1.0,
        "base_color": (1.0, 1.0, 1.0),
        "specular_roughness": 0.4,
        "sheen": 1.0,
        "coat": 1.0,
    },
)

OPEN_PBR = Inputs(
    _ports(
        share="base_weight base_diffuse_roughness base_metalness specular_weight specular_roughness_anisotropy coat_weight coat_roughness_anisotropy coat_darkening fuzz_weight",
        color="base_color specular_color coat_color fuzz_color",
        rough="specular_roughness coat_roughness",
        index="specular_ior coat_ior",
        sheen_rough="fuzz_roughness",
    ),
    (
        *_ports(
            share="transmission_weight subsurface_weight subsurface_radius",
            color="transmission_color subsurface_color subsurface_radius_scale",
        ),
        *_ports(share="thin_film_weight thin_film_thickness", index="thin_film_ior"),
    ),
    seen={
        "base_metalness": 0.4,
        "specular_roughness_anisotropy": 0.5,
        "coat_weight": 0.5,
        "coat_roughness": 0.4,
        "coat_roughness_anisotropy": 0.5,
        "fuzz_weight": 0.5,
        "transmission_weight": 0.4,
        "transmission_color": (0.5, 0.6, 0.7),
        "subsurface_weight": 0.4,
        "thin_film_weight": 0.5,
    },
    more=dict(
        transmission_depth=2.0,
        transmission_scatter=CHANGED_COLOR,
        transmission_scatter_anisotropy=0.5,
        transmission_dispersion_scale=0.5,
        transmission_dispersion_abbe_number=40.0,
        subsurface_scatter_anisotropy=0.5,
        geometry_thin_walled=True,
        geometry_normal=TURNED_FRAME["normal"],
        geometry_tangent=TURNED_FRAME["tangent"],
        geometry_coat_normal=TURNED_FRAME["normal"],
        geometry_coat_tangent=TURNED_FRAME["tangent"],
    ),
    without_effect=(
        "transmission_scatter",
        "transmission_scatter_anisotropy",
        "transmission_dispersion_scale",
        "transmission_dispersion_abbe_number",
        "subsurface_scatter_anisotropy",
    ),
    curved=("subsurface_radius", "subsurface_radius_scale"),
    needs={"subsurface_weight": {"subsurface_color": CHANGED_COLOR}},  # on a plane, its base else
    white={
        "base_weight": 1.0,
        "base_color": (1.0, 1.0, 1.0),
        "base_diffuse_roughness": 0.5,
        "coat_weight": 1.0,
        "coat_roughness": 0.3,
        "coat_darkening": 0.0,
        "fuzz_weight": 1.0,
        "fuzz_color": (1.0, 1.0, 1.0),
    },
)

GLTF = Inputs(
    _ports(
        color="base_color specular_color sheen_color",
        share="metallic specular anisotropy_strength anisotropy_rotation clearcoat",
        rough="roughness clearcoat_roughness",
        index="ior",
        fuzz_rough="sheen_roughness",
    ),
    _ports(share="transmission iridescence", index="iridescence_ior", film="iridescence_thickness"),
    seen={
        "metallic": 0.4,
        "roughness": 0.5,
        "anisotropy_strength": 0.5,
        "sheen_color": (0.4, 0.5, 0.6),
        "sheen_roughness": 0.5,
        "clearcoat": 0.5,
        "transmission": 0.4,
        "iridescence": 0.5,
        "iridescence_thickness": 400.0,
    },
    more=dict(
        thickness=0.5,
        attenuation_distance=2.0,
        attenuation_color=CHANGED_COLOR,
        dispersion=0.5,
        clearcoat_normal=TURNED_FRAME["normal"],
        **TURNED_FRAME,
    ),
    without_effect=("thickness", "attenuation_distance", "attenuation_color", "dispersion"),
    white={
        "base_color": (1.0, 1.0, 1.0),
        "metallic": 0.0,
        "roughness": 0.5,
        "sheen_color": (1.0, 1.0, 1.0),
        "sheen_roughness": 0.6,
        "clearcoat": 1.0,
        "clearcoat_roughness": 0.4,
    },
)

PREVIEW = Inputs(
    _ports(
        color="diffuseColor specularColor",
        share="metallic clearcoat",
        rough="roughness clearcoatRoughness",
        index="ior",
    ),
    _ports(share="opacity"),
    seen={"metallic": 0.4, "clearcoat": 0.5, "opacity": 0.6},
    more=dict(
        useSpecularWorkflow=1,
        opacityMode=1,
        opacityThreshold=0.5,
        normal=(0.6, 0.0, 0.8),
        displacement=0.5,
    ),
    without_effect=("displacement",),
    white={"diffuseColor": (1.0, 1.0, 1.0), "clearcoat": 1.0, "clearcoatRoughness": 0.4},
    needs={"specularColor": {"useSpecularWorkflow": 1}},
)


@dataclass(frozen=True)
class SurfaceShader:
    """A surface shader with every lobe on."""

    node: str  # category
    table: Inputs  # its inputs

    libraries: ClassVar[tuple[str, ...]] = ()
    closure: ClassVar[bool] = True
    kind: ClassVar[str] = kinds.SURFACE_SHADER

    @property
    def title(self) -> str:
        return f"{self.node}, every lobe"

    @property
    def model(self) -> str:
        """Name of its equations: its own."""
        return self.node

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(self.table.changed)

    def with_flag(self, inputs: Values) -> Values:
        return inputs

    def document(self, inputs: Values | None = None) -> str:
        return document_text(node_text(self.node, "surfaceshader", "shading"))

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw(rng, count, self.table.judged)

    def every_input(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw(rng, count, (*self.table.judged, *self.table.others))


SHADERS = (
    SurfaceShader("standard_surface", STANDARD),
    SurfaceShader("open_pbr_surface", OPEN_PBR),
    SurfaceShader("gltf_pbr", GLTF),
    SurfaceShader("UsdPreviewSurface", PREVIEW),
)
