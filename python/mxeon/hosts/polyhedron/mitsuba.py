# SPDX-License-Identifier: Apache-2.0
"""Mitsuba's own BSDFs, in its scalar variant, and those of `mxeon.mitsuba`, compiled by LLVM."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from mxeon.hosts.base import Array
from mxeon.hosts.polyhedron import Material, PolyhedronHost


class Host(PolyhedronHost):
    """Mitsuba with its own BSDFs, which it evaluates for any pair of directions."""

    name = "mitsuba"
    script = "mitsuba_worker.py"
    samples = 64
    device = "CPU, scalar_rgb; plugins llvm_ad_rgb"
    # Without specular reflection nothing but the diffuse lobe is left of the principled BSDF.
    nodes: ClassVar[Mapping[str, Material]] = {
        "diffuse": {"type": "diffuse", "reflectance": "{color}"},
        "principled": {
            "type": "principled",
            "base_color": "{color}",
            "roughness": "{roughness}",
            "specular": 0.0,
        },
        **{
            f"{model} of mxeon.mitsuba": {
                "type": model,
                "reflectance": "{color}",
                "sigma" if model == "qon" else "roughness": "{roughness}",
            }
            for model in ("eon", "fon", "qon")
        },
        # The dielectric of the model "eon_coated".
        "dielectric_over_eon of mxeon.mitsuba": {
            "type": "dielectric_over_eon",
            "reflectance": "{color}",
            "roughness": "{roughness}",
            "alpha": 0.5,
            "ior": 1.5,
        },
        # The numbers of the model "openpbr_half_metal".
        "openpbr_base of mxeon.mitsuba": {
            "type": "openpbr_base",
            "base_color": "{color}",
            "base_diffuse_roughness": "{roughness}",
            "base_metalness": 0.5,
            "specular_roughness": 0.75,
            "specular_ior": 1.5,
        },
    }

    def pairs(self, title: str, wo: Array, wi: Array, color: Array, roughness: Array) -> Array:
        path = self._folder / "pairs.npz"
        np.savez(path, wo=wo, wi=wi, color=color, roughness=roughness)
        material = self._material(title, "{color}", "{roughness}")
        return self._ask(material=material, pairs=str(path))
