# SPDX-License-Identifier: Apache-2.0
"""Figures of the pages on testrender that no check of the suite measures."""

import numpy as np

from mxeon.conformance.nodes.combinations import node_over
from mxeon.conformance.nodes.transmission import TRANSMITTING
from mxeon.conformance.probes.rendered import apart
from mxeon.hosts.testrender.renderer import Host
from mxeon.shaders.nodes import SURFACE, document_text, input_text, lobe_text
from tools.site.upstream.storm_quantities import table

COSINE, NODES, COLOR = 0.95, 48, (0.2, 0.5, 0.8)
VIEW = np.array([[np.sqrt(1.0 - COSINE**2), 0.0, COSINE]])
LIGHT = np.array([[0.0, 0.6, 0.8]])
GLASS = {"ior": 1.5, "roughness": (1.0, 1.0)}
COATED = lobe_text("dielectric_bsdf", {"scatter_mode": "R"}, "coat") + lobe_text(
    "burley_diffuse_bsdf", {}, "base"
)


def lit(host, shader, side):
    """Integral of the values for lights on a side of the surface, by Gauss nodes and even azimuths."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    mu, weight = np.repeat([0.5 * (x + 1.0), 0.5 * w], NODES, axis=1)
    azimuth = np.tile(2.0 * np.pi * (np.arange(NODES) + 0.5) / NODES, NODES)
    radius = np.sqrt(1.0 - mu * mu)
    wi = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), side * mu], axis=-1)
    wo = np.repeat(VIEW, len(wi), axis=0)
    values = host.evaluate(shader, wo, apart(wo, wi), GLASS, "direct")[:, 0]
    return 2.0 * np.pi / NODES * (weight * values).sum()


def refraction_block():
    """Light of glass of alpha 1 in a white environment: from lights on every side, and by its samples."""
    [subject] = [each for each in TRANSMITTING if each.title == "dielectric_bsdf, scatter_mode RT"]
    with Host() as host:
        [shader] = host.compile(subject.document(), library="stock")
        above, below = lit(host, shader, 1.0), lit(host, shader, -1.0)
        sampled = host.evaluate(shader, VIEW, VIEW, GLASS, "environment")[0, 0]
    rows = {"lights on every side": above + below, "a white sky, by samples": sampled}
    return table((f"light of {name}", value, 1.0) for name, value in rows.items())


def multiplied_block():
    """Ratio of a coated base times a color to the same without the color."""
    factor = node_over("multiply", value=input_text("in2", "color3", COLOR), in1="coated")
    layered = node_over("layer", "coated", top="coat", base="base")
    texts = (COATED + layered + factor, COATED + node_over("layer", top="coat", base="base"))
    with Host() as host:
        colored, plain = (
            host.evaluate(shader, VIEW, LIGHT, {}, "direct")[0]
            for text in texts
            for shader in host.compile(document_text(text + SURFACE), library="stock")
        )
    channels = zip(("red", "green", "blue"), colored / plain, COLOR, strict=True)
    return table((f"{name}, over that without the color", *pair) for name, *pair in channels)


OF_TESTRENDER = {
    "testrender_refraction_lit": refraction_block,
    "testrender_multiplied_layer": multiplied_block,
}
