# SPDX-License-Identifier: Apache-2.0
"""Figures of the page on the average of F in MaterialX's energy compensation: index 0."""

from contextlib import closing
from dataclasses import replace

import numpy as np

from mxeon.hosts import open_host
from mxeon.shaders.nodes import material_text

STOCK, PAIRS = "stock", 1000
HEAD = "| quantity | measured | expected |\n|---|---|---|\n"
# MaterialX 1.39.5 has F of one direction here; pull request 2958 takes the average of F by its ends.
ONE = "mx_ggx_energy_compensation(NdotV, avgAlpha, F)"
AVERAGE = (
    "mx_ggx_energy_compensation"
    "(NdotV, avgAlpha, mix(mx_compute_fresnel(1.0, fd), vec3(1.0), 1.0 / 21.0))"
)
REPAIR = ("if (g2 < 0.0)", "if (g2 <= 0.0)")
FORMS = (
    ("F at the half vector, as in 1.39.5", ()),
    ("the average, as in pull request 2958", ((ONE, AVERAGE),)),
    ("the average, with the repair", ((ONE, AVERAGE), REPAIR)),
)


def average_block():
    """Values of a dielectric of index 0 that are not finite, with each compensation."""
    rng = np.random.default_rng(1)
    z, phi = rng.uniform(0.05, 1.0, (2, PAIRS)), rng.uniform(0.0, 2.0 * np.pi, (2, PAIRS))
    radius = np.sqrt(1.0 - z * z)
    wo, wi = np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)
    with closing(open_host("gl")) as host:
        text = material_text("dielectric_bsdf", {"ior": 0.0, "roughness": (0.3, 0.3)})
        [shader] = host.compile(text, library=STOCK)
        rows = [(name, _unbounded(host, changed(shader, *each), wo, wi)) for name, each in FORMS]
    title = f"values, of {PAIRS}, that are not finite at index 0"
    return HEAD + "".join(f"| {title}: {name} | {count} | 0 |\n" for name, count in rows)


def changed(shader, *changes):
    """A stock shader of a dielectric with other text in the place of some."""
    pixel = shader.stages["pixel"]
    for old, new in changes:
        if old not in pixel:
            raise ValueError(f"stock's shader must hold {old}")
        pixel = pixel.replace(old, new)
    return replace(shader, stages={**shader.stages, "pixel": pixel})


def _unbounded(host, shader, wo, wi):
    values = host.evaluate(shader, wo, wi, {}, "direct")
    return int((~np.isfinite(values)).any(axis=-1).sum())


OF_AVERAGES = {"genglsl_compensation_average": average_block}
