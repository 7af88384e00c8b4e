# SPDX-License-Identifier: Apache-2.0
"""Figures of the pages on Hydra Storm that no check of the suite measures."""

from dataclasses import replace

from mxeon.conformance.reference import Host as Reference
from mxeon.hosts import open_host
from mxeon.shaders.nodes import OREN_NAYAR, SURFACE, document_text, lobe_text
from mxeon.shaders.scene import FURNACE, SIDE, sphere

HEAD = "| quantity | measured | expected |\n|---|---|---|\n"
SIZE = 64
DOME = 0.98442  # of a dome as the host gives it, which becomes one of 1; see its worker.py
WHITE = (OREN_NAYAR, {"color": (1.0, 1.0, 1.0), "roughness": 0.0})
SHEEN = ("sheen_bsdf", {"mode": "zeltner", "roughness": 0.3})


def dome_block():
    """Radiance of a white Lambert surface in a white dome."""
    return table([("radiance of white Lambert in a white dome", *shown(WHITE, FURNACE))])


def enumerated_block():
    """Radiance of a sheen of mode zeltner."""
    place = (
        "mean radiance of a sphere with sheen_bsdf, mode zeltner, roughness 0.3, lit from the side"
    )
    return table([(place, *shown(SHEEN, SIDE))])


def shown(lobe, scene):
    """Mean of the red of a sphere with a lobe in a scene: Storm's, and the expected one."""
    category, inputs = lobe
    scene = replace(scene, size=SIZE)
    dome = scene if scene.environment is None else replace(scene, environment=DOME)
    with open_host("storm") as host:
        [shader] = host.compile(
            document_text(lobe_text(category, inputs) + SURFACE), library="stock"
        )
        images = host.picture(shader, dome), Reference().picture(shader, scene)
    return [float(image[sphere(SIZE).mask][:, 0].mean()) for image in images]


def table(rows):
    """Rows of a name and two numbers."""
    return HEAD + "".join(f"| {name} | {a:.3f} | {b:.3f} |\n" for name, a, b in rows)


OF_STORM = {
    "storm_dome_steps": dome_block,
    "storm_enumerated_inputs": enumerated_block,
}
