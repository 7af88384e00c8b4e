# SPDX-License-Identifier: Apache-2.0
"""Figures of pages on subsurface scattering that no check of the suite measures."""

from dataclasses import replace

import numpy as np

from mxeon.hosts import open_host
from mxeon.models.media.subsurface import subsurface_albedo
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import SURFACE, document_text, input_text, node_text
from mxeon.shaders.scene import FURNACE, Paths, sphere
from tools.site.upstream.random_walk import distances

HEAD = "| quantity | measured | expected |\n|---|---|---|\n"
WALKS, PATHS = ((0.2, -0.5), (0.5, 0.0), (0.8, 0.0), (0.95, 0.0), (0.5, 0.5)), 20_000
COLOR, SHORT = (0.2, 0.5, 0.8), (0.01, 0.01, 0.01)


def subsurface(color, radius):
    """Document of one lobe of subsurface scattering."""
    inputs = input_text("color", "color3", color) + input_text("radius", "color3", radius)
    return document_text(node_text("subsurface_bsdf", "BSDF", "lobe", inputs) + SURFACE)


def cycles_color_block():
    """Mean radiance of a small sphere in a furnace of radiance 1, from stock MaterialX in Cycles."""
    scene = replace(FURNACE, size=16, paths=Paths(samples=64))
    with open_host("cycles") as host:
        [shader] = generate(subsurface(COLOR, SHORT), "osl", library="stock")
        mean = host.picture(shader, scene)[sphere(16).mask].mean(axis=0)
    name = "radiance of a sphere under a sky of 1, radius 0.01, red, green and blue"
    return _table([(name, mean, COLOR)], "{:.1f}")


def profile_block():
    """Mean distances of random walks, and that of the profile."""
    rows = []
    for color, anisotropy in WALKS:
        albedo = float(subsurface_albedo(color, anisotropy))
        mean = distances(albedo, anisotropy, PATHS).mean()
        rows.append((f"walk, and profile, of color {color}, anisotropy {anisotropy}", mean, 2.5))
    return _table(rows, "{:.1f}")


def _table(rows, form):
    lines = [
        f"| {name} | {' '.join(map(form.format, np.atleast_1d(measured)))} | "
        f"{' '.join(map(form.format, np.atleast_1d(expected)))} |\n"
        for name, measured, expected in rows
    ]
    return HEAD + "".join(lines)


OF_SUBSURFACE = {
    "cycles_subsurface_color": cycles_color_block,
    "pbrlib_diffusion_profile": profile_block,
}
