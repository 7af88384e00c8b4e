# SPDX-License-Identifier: Apache-2.0
"""LuxCoreRender's own materials, by its path tracer on the CPU."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

from mxeon.hosts.polyhedron import Material, PolyhedronHost

# What switches off all but the diffuse lobe of the Disney material; what is left of its specular
# lobe does not depend on the color.
DISNEY = dict.fromkeys(
    (
        "subsurface",
        "metallic",
        "specular",
        "speculartint",
        "clearcoat",
        "clearcoatgloss",
        "anisotropic",
        "sheen",
        "sheentint",
    ),
    0.0,
)


class Host(PolyhedronHost):
    name = "luxcore"
    script = "luxcore_worker.py"
    samples = 64
    device = "CPU, PATHCPU"
    nodes: ClassVar[Mapping[str, Material]] = {
        "matte": {"type": "matte", "kd": "{color}"},
        "roughmatte": {"type": "roughmatte", "kd": "{color}", "sigma": "{roughness}"},
        "roughmatte, sigma in degrees": {
            "type": "roughmatte",
            "kd": "{color}",
            "sigma": "{roughness}",
        },
        "disney": {"type": "disney", "basecolor": "{color}", "roughness": "{roughness}", **DISNEY},
    }

    def _material(
        self, title: str, color: Sequence[float] | str, roughness: float | str
    ) -> dict[str, object]:
        """Properties of a material; its sigma is in the unit of the node's title."""
        if title.endswith("degrees"):
            roughness = math.degrees(float(roughness))
        return super()._material(title, color, roughness)
