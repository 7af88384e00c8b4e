# SPDX-License-Identifier: Apache-2.0
"""LuxCoreRender's own materials, by its path tracer on the CPU."""

from __future__ import annotations

from pathlib import Path

from mxeon.survey.polyhedron import PolyhedronHost
from mxeon.survey.specs import COLOR, node

# What switches off all but the diffuse lobe of the Disney material; what is left of its specular
# lobe does not depend on the color.
DISNEY = dict.fromkeys(
    [
        "subsurface",
        "metallic",
        "specular",
        "speculartint",
        "clearcoat",
        "clearcoatgloss",
        "anisotropic",
        "sheen",
        "sheentint",
    ],
    0.0,
)
MATTE = {"type": "roughmatte", "kd": "{color}"}
NODES = (
    node("matte", "lambert", {"type": "matte", "kd": "{color}"}, COLOR),
    node("roughmatte", "qon", {**MATTE, "sigma": "{roughness}"}),
    node("roughmatte, sigma in degrees", "qon", {**MATTE, "sigma": "{degrees}"}),
    node(
        "disney",
        "burley",
        {"type": "disney", "basecolor": "{color}", "roughness": "{roughness}", **DISNEY},
        beside=True,
    ),
)


class Host(PolyhedronHost):
    name = "luxcore"
    script = Path(__file__).with_name("luxcore_worker.py")
    samples = 64
    device = "CPU, PATHCPU"
