# SPDX-License-Identifier: Apache-2.0
"""LuxCoreRender's own materials, by its path tracer on the CPU."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from mxeon.hosts.polyhedron import PolyhedronHost

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
    """LuxCoreRender with its own materials.

    Raises
    ------
    NotRun
        If the interpreter that is to have it is missing.
    """

    name = "luxcore"
    samples = 64
    device = "CPU, PATHCPU"
    nodes: ClassVar[dict[str, dict[str, Any]]] = {
        "matte": {"type": "matte", "kd": "{color}"},
        "roughmatte": {"type": "roughmatte", "kd": "{color}", "sigma": "{roughness}"},
        "roughmatte, sigma in degrees": {
            "type": "roughmatte",
            "kd": "{color}",
            "sigma": "{roughness}",
        },
        "disney": {"type": "disney", "basecolor": "{color}", "roughness": "{roughness}", **DISNEY},
    }

    def _material(self, title: str, color: Any, roughness: Any) -> dict[str, Any]:
        """Properties of a material; its sigma is in the unit of the node's title."""
        degrees = title.endswith("degrees")
        return super()._material(title, color, math.degrees(roughness) if degrees else roughness)
