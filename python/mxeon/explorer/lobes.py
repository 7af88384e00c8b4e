# SPDX-License-Identifier: Apache-2.0
"""The materials that every page compares: each lobe that eonlib repairs, and OpenPBR."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from numpy.typing import ArrayLike

from mxeon.conformance.results.known_issues import ISSUES
from mxeon.shaders.nodes import (
    FLAG,
    OREN_NAYAR,
    document_text,
    input_types,
    material_text,
    node_text,
)

Inputs: TypeAlias = Mapping[str, ArrayLike]

ROUGH: Inputs = {"roughness": (0.5, 0.5)}
FILM: Inputs = {"thinfilm_thickness": 420.0, "thinfilm_ior": 1.4}
COPPER: Inputs = {"ior": (0.216, 0.905, 1.137), "extinction": (3.67, 2.59, 2.43), **ROUGH}
BRONZE: Inputs = {"color0": (0.85, 0.55, 0.25), "color82": (0.9, 0.8, 0.7), **ROUGH}
GLASS: Inputs = {"ior": 1.5, "scatter_mode": "R", **ROUGH}
VELVET: Inputs = {"color": (0.75, 0.12, 0.2), "roughness": 0.4}
LACQUER = """    <input name="base_color" type="color3" value="0.55, 0.12, 0.08" />
    <input name="base_diffuse_roughness" type="float" value="0.8" />
    <input name="specular_roughness" type="float" value="0.5" />
    <input name="coat_weight" type="float" value="0.5" />
    <input name="coat_roughness" type="float" value="0.3" />
    <input name="fuzz_weight" type="float" value="0.4" />
    <input name="fuzz_color" type="color3" value="0.9, 0.75, 0.6" />
"""


@dataclass(frozen=True)
class ComparedMaterial:
    """A material that both libraries have."""

    key: str  # its name in addresses
    title: str
    text: str
    subjects: tuple[str, ...] = field(default=())  # what checks call its nodes

    @property
    def pages(self) -> tuple[str, ...]:
        """Names of the pages on what MaterialX's own GLSL does wrong with it."""
        return tuple(dict.fromkeys(self._pages()))

    def _pages(self) -> Iterator[str]:
        for issue in ISSUES:
            named = {subject for _, subject in (*issue.rows, *issue.implied)}
            shown = "webgl" in (issue.host, *issue.also) and issue.library == "stock"
            if shown and named & set(self.subjects):
                yield issue.page


def _lobe(key: str, title: str, category: str, inputs: Inputs, *subjects: str) -> ComparedMaterial:
    """A material that is one BSDF node."""
    return ComparedMaterial(
        key, title, material_text(category, inputs, types=input_types(category)), subjects
    )


DIFFUSE = _lobe(
    "shader",
    "Rough diffuse",
    OREN_NAYAR,
    {"color": (0.8, 0.4, 0.1), "roughness": 1.0, FLAG: True},
    f"{OREN_NAYAR}, {FLAG} true",
    f"{OREN_NAYAR}, {FLAG} false",
)
MATERIALS = (
    DIFFUSE,
    _lobe(
        "lobe/sheen",
        "Sheen, Conty-Kulla",
        "sheen_bsdf",
        {**VELVET, "mode": "conty_kulla"},
        "sheen_bsdf, mode conty_kulla",
    ),
    _lobe(
        "lobe/sheen_zeltner",
        "Sheen, Zeltner",
        "sheen_bsdf",
        {**VELVET, "mode": "zeltner"},
        "sheen_bsdf, mode zeltner",
    ),
    _lobe(
        "lobe/dielectric",
        "Dielectric",
        "dielectric_bsdf",
        GLASS,
        "dielectric_bsdf, scatter_mode R",
    ),
    _lobe("lobe/conductor", "Conductor", "conductor_bsdf", COPPER, "conductor_bsdf"),
    _lobe(
        "lobe/schlick",
        "Schlick",
        "generalized_schlick_bsdf",
        {**BRONZE, "scatter_mode": "R"},
        "generalized_schlick_bsdf, scatter_mode R",
    ),
    _lobe(
        "lobe/film_dielectric",
        "Film on dielectric",
        "dielectric_bsdf",
        {**GLASS, **FILM},
        "dielectric_bsdf, thin film",
    ),
    _lobe(
        "lobe/film_conductor",
        "Film on conductor",
        "conductor_bsdf",
        {**COPPER, **FILM},
        "conductor_bsdf, thin film",
    ),
    _lobe(
        "lobe/film_schlick",
        "Film on Schlick",
        "generalized_schlick_bsdf",
        {**BRONZE, **FILM, "scatter_mode": "R"},
        "generalized_schlick_bsdf, thin film",
    ),
    _lobe(
        "lobe/hair",
        "Hair",
        "chiang_hair_bsdf",
        {
            "absorption_coefficient": (0.25, 0.6, 1.4),
            **dict.fromkeys(("roughness_R", "roughness_TT", "roughness_TRT"), (0.1, 0.3)),
        },
        "chiang_hair_bsdf",
    ),
    ComparedMaterial(
        "lobe/openpbr",
        "OpenPBR",
        document_text(node_text("open_pbr_surface", "surfaceshader", "shading", LACQUER)),
        ("open_pbr_surface, every lobe",),
    ),
)
