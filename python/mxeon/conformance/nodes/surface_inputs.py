# SPDX-License-Identifier: Apache-2.0
"""Inputs of surface shaders, with the ranges that are asked of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from mxeon.conformance.samples.batch import Array

Range: TypeAlias = tuple[float, float] | str  # of a number, or COLOR

COLOR = "color"
SHARE, ROUGH, INDEX = (0.0, 1.0), (0.1, 1.0), (1.1, 2.5)
SHEEN_ROUGH = (0.15, 1.0)
CHANGED_COLOR = (0.9, 0.1, 0.6)
# The mean free path below the surface, which shows on a curved one: an evaluation has a plane.
FREE_PATHS = ("subsurface_radius", "subsurface_scale", "subsurface_radius_scale")


@dataclass(frozen=True, eq=False)
class Inputs:
    """Inputs of a surface shader that its lobes may depend on.

    Attributes
    ----------
    judged : mapping of str to range
        Those whose values have a reference.
    others : mapping of str to range
        Those of other lobes and of thin films, which are asked for energy.
    seen : mapping of str to value
        A material in which every lobe takes part.
    changed : mapping of str to value
        For each input but FREE_PATHS a value that this material does not have.
    without_effect : tuple of str
        Inputs of `changed` that change no value of rasterized targets; docs/upstream/
        surface_inputs.md says why.
    white : mapping of str to value
        A material that loses no light, by the layer equation.
    needs : mapping of str to mapping
        What else the material has where an input is changed.
    curved : tuple of str
        Inputs of `changed` that a curved surface alone has to show; that of pairs is a plane.
    """

    judged: Mapping[str, Range]
    others: Mapping[str, Range]
    seen: Mapping[str, Any]
    changed: Mapping[str, Any]
    without_effect: tuple[str, ...]
    white: Mapping[str, Any]
    needs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    curved: tuple[str, ...] = ()


def drawn(rng: np.random.Generator, count: int, ranges: Mapping[str, Range]) -> dict[str, Array]:
    """Random values in their ranges, a tenth of each on either end, float32 numbers."""
    values = {}
    for name, limits in ranges.items():
        low, high = (0.0, 1.0) if isinstance(limits, str) else limits
        share = rng.random((count, 3) if isinstance(limits, str) else count)
        share = np.clip(1.25 * share - 0.125, 0.0, 1.0)
        values[name] = (low + (high - low) * share).astype(np.float32).astype(np.float64)
    return values


def _changed(ranges: Mapping[str, Range], **others: Any) -> dict[str, Any]:
    """A change for each input of a table, and for others."""
    changes: dict[str, Any] = {
        name: CHANGED_COLOR
        if isinstance(limits, str)
        else limits[0] + 0.7 * (limits[1] - limits[0])
        for name, limits in ranges.items()
        if name not in FREE_PATHS
    }
    return {**changes, **others}


TURNED = {"normal": (0.0, 0.6, 0.8), "tangent": (0.6, 0.8, 0.0)}

_STANDARD: dict[str, Range] = {
    "base": SHARE,
    "base_color": COLOR,
    "diffuse_roughness": SHARE,
    "metalness": SHARE,
    "specular": SHARE,
    "specular_color": COLOR,
    "specular_roughness": ROUGH,
    "specular_IOR": INDEX,
    "specular_anisotropy": SHARE,
    "specular_rotation": SHARE,
    "sheen": SHARE,
    "sheen_color": COLOR,
    "sheen_roughness": SHEEN_ROUGH,
    "coat": SHARE,
    "coat_color": COLOR,
    "coat_roughness": ROUGH,
    "coat_anisotropy": SHARE,
    "coat_rotation": SHARE,
    "coat_IOR": INDEX,
    "coat_affect_color": SHARE,
    "coat_affect_roughness": SHARE,
}
_STANDARD_OTHERS: dict[str, Range] = {
    "transmission": SHARE,
    "transmission_color": COLOR,
    "transmission_extra_roughness": SHARE,
    "subsurface": SHARE,
    "subsurface_color": COLOR,
    "subsurface_radius": COLOR,
    "subsurface_scale": SHARE,
}
_STANDARD_FILM: dict[str, Range] = {
    "thin_film_thickness": (0.0, 1000.0),
    "thin_film_IOR": INDEX,
}
STANDARD = Inputs(
    _STANDARD,
    {**_STANDARD_OTHERS, **_STANDARD_FILM},
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
    changed=_changed(
        {**_STANDARD, **_STANDARD_OTHERS, **_STANDARD_FILM},
        transmission_depth=2.0,
        transmission_scatter=CHANGED_COLOR,
        transmission_scatter_anisotropy=0.5,
        transmission_dispersion=20.0,
        subsurface_anisotropy=0.5,
        thin_walled=True,
        coat_normal=TURNED["normal"],
        **TURNED,
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

_OPEN: dict[str, Range] = {
    "base_weight": SHARE,
    "base_color": COLOR,
    "base_diffuse_roughness": SHARE,
    "base_metalness": SHARE,
    "specular_weight": SHARE,
    "specular_color": COLOR,
    "specular_roughness": ROUGH,
    "specular_ior": INDEX,
    "specular_roughness_anisotropy": SHARE,
    "coat_weight": SHARE,
    "coat_color": COLOR,
    "coat_roughness": ROUGH,
    "coat_roughness_anisotropy": SHARE,
    "coat_ior": INDEX,
    "coat_darkening": SHARE,
    "fuzz_weight": SHARE,
    "fuzz_color": COLOR,
    "fuzz_roughness": SHEEN_ROUGH,
}
_OPEN_OTHERS: dict[str, Range] = {
    "transmission_weight": SHARE,
    "transmission_color": COLOR,
    "subsurface_weight": SHARE,
    "subsurface_color": COLOR,
    "subsurface_radius": SHARE,
    "subsurface_radius_scale": COLOR,
}
_OPEN_FILM: dict[str, Range] = {
    "thin_film_weight": SHARE,
    "thin_film_thickness": SHARE,
    "thin_film_ior": INDEX,
}
OPEN_PBR = Inputs(
    _OPEN,
    {**_OPEN_OTHERS, **_OPEN_FILM},
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
    changed=_changed(
        {**_OPEN, **_OPEN_OTHERS, **_OPEN_FILM},
        transmission_depth=2.0,
        transmission_scatter=CHANGED_COLOR,
        transmission_scatter_anisotropy=0.5,
        transmission_dispersion_scale=0.5,
        transmission_dispersion_abbe_number=40.0,
        subsurface_scatter_anisotropy=0.5,
        geometry_thin_walled=True,
        geometry_normal=TURNED["normal"],
        geometry_tangent=TURNED["tangent"],
        geometry_coat_normal=TURNED["normal"],
        geometry_coat_tangent=TURNED["tangent"],
    ),
    without_effect=(
        "transmission_scatter",
        "transmission_scatter_anisotropy",
        "transmission_dispersion_scale",
        "transmission_dispersion_abbe_number",
        "subsurface_scatter_anisotropy",
    ),
    curved=("subsurface_radius", "subsurface_radius_scale"),
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

_GLTF: dict[str, Range] = {
    "base_color": COLOR,
    "metallic": SHARE,
    "roughness": ROUGH,
    "ior": INDEX,
    "specular": SHARE,
    "specular_color": COLOR,
    "anisotropy_strength": SHARE,
    "anisotropy_rotation": SHARE,
    "sheen_color": COLOR,
    "sheen_roughness": (0.4, 1.0),
    "clearcoat": SHARE,
    "clearcoat_roughness": ROUGH,
}
_GLTF_OTHERS: dict[str, Range] = {"transmission": SHARE}
_GLTF_FILM: dict[str, Range] = {
    "iridescence": SHARE,
    "iridescence_ior": INDEX,
    "iridescence_thickness": (100.0, 1000.0),
}
GLTF = Inputs(
    _GLTF,
    {**_GLTF_OTHERS, **_GLTF_FILM},
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
    changed=_changed(
        {**_GLTF, **_GLTF_OTHERS, **_GLTF_FILM},
        thickness=0.5,
        attenuation_distance=2.0,
        attenuation_color=CHANGED_COLOR,
        dispersion=0.5,
        clearcoat_normal=TURNED["normal"],
        **TURNED,
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

_PREVIEW: dict[str, Range] = {
    "diffuseColor": COLOR,
    "specularColor": COLOR,
    "metallic": SHARE,
    "roughness": ROUGH,
    "clearcoat": SHARE,
    "clearcoatRoughness": ROUGH,
    "ior": INDEX,
}
_PREVIEW_OTHERS: dict[str, Range] = {"opacity": SHARE}
PREVIEW = Inputs(
    _PREVIEW,
    _PREVIEW_OTHERS,
    seen={"metallic": 0.4, "clearcoat": 0.5, "opacity": 0.6},
    changed=_changed(
        {**_PREVIEW, **_PREVIEW_OTHERS},
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
