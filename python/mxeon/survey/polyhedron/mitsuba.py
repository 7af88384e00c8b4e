# SPDX-License-Identifier: Apache-2.0
"""Mitsuba's built-in BSDFs in a scalar variant, and BSDFs of `mxeon.mitsuba` compiled by LLVM."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mxeon.hosts.base import Array
from mxeon.survey.polyhedron import PolyhedronHost
from mxeon.survey.specs import COLOR, Material, node

# Without specular reflection, the principled BSDF has only its diffuse lobe.
PRINCIPLED = {
    "type": "principled",
    "base_color": "{color}",
    "roughness": "{roughness}",
    "specular": 0.0,
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
)


class MitsubaHost(PolyhedronHost):
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
