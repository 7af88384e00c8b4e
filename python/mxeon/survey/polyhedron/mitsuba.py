# SPDX-License-Identifier: Apache-2.0
"""Mitsuba's own BSDFs, in its scalar variant, and those of `mxeon.mitsuba`, compiled by LLVM."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mxeon.hosts.base import Array
from mxeon.survey.polyhedron import PolyhedronHost
from mxeon.survey.specs import COLOR, Material, node

# Without specular reflection nothing but the diffuse lobe is left of the principled BSDF.
PRINCIPLED = {
    "type": "principled",
    "base_color": "{color}",
    "roughness": "{roughness}",
    "specular": 0.0,
}
# The interface of the models "eon_coated" and "eon_varnished".
COATED = {
    "type": "dielectric_over_eon",
    "reflectance": "{color}",
    "roughness": "{roughness}",
    "alpha": 0.5,
    "ior": 1.5,
}
# The numbers of the model "openpbr_half_metal".
BASE = {
    "type": "openpbr_base",
    "base_color": "{color}",
    "base_diffuse_roughness": "{roughness}",
    "base_metalness": 0.5,
    "specular_roughness": 0.75,
    "specular_ior": 1.5,
}
NODES = (
    node("diffuse", "lambert", {"type": "diffuse", "reflectance": "{color}"}, COLOR),
    node("principled", "burley", PRINCIPLED),
    *(
        node(
            f"{model} of mxeon.mitsuba",
            model,
            {"type": model, "reflectance": "{color}", name: "{roughness}"},
        )
        for model, name in (("eon", "roughness"), ("fon", "roughness"), ("qon", "sigma"))
    ),
    node("dielectric_over_eon of mxeon.mitsuba", "eon_coated", COATED),
    node("varnished of mxeon.mitsuba", "eon_varnished", COATED | {"type": "varnished"}),
    node("openpbr_base of mxeon.mitsuba", "openpbr_half_metal", BASE),
)


class Host(PolyhedronHost):
    """Mitsuba with its own BSDFs, which it evaluates for any pair of directions."""

    name = "mitsuba"
    script = Path(__file__).with_name("mitsuba_worker.py")
    samples = 64
    device = "CPU, scalar_rgb; plugins llvm_ad_rgb"

    def pairs(
        self, material: Material, wo: Array, wi: Array, color: Array, roughness: Array
    ) -> Array:
        path = self._folder / "pairs.npz"
        np.savez(path, wo=wo, wi=wi, color=color, roughness=roughness)
        return self._ask(material=material, pairs=str(path))
