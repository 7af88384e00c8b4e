# SPDX-License-Identifier: Apache-2.0
"""What testrender makes of light through a surface, and of a layer times a color.

    python -m docs.upstream.testrender_figures

prints the figures of two pages, with the programs that MXEON_OSLC and MXEON_TESTRENDER name.
"""

import numpy as np

from mxeon.conformance.nodes.combinations import node_over
from mxeon.conformance.nodes.transmission import TRANSMITTING
from mxeon.conformance.probes.rendered import apart
from mxeon.hosts.testrender import Host
from mxeon.shaders.nodes import SURFACE, document_text, input_text, lobe_text

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


def refraction(host):
    """Print the light of glass of alpha 1 in a white environment: from lights, and by its samples."""
    [subject] = [each for each in TRANSMITTING if each.title == "dielectric_bsdf, scatter_mode RT"]
    [shader] = host.compile(subject.document(), library="stock")
    above, below = lit(host, shader, 1.0), lit(host, shader, -1.0)
    sampled = host.evaluate(shader, VIEW, VIEW, GLASS, "environment")[0, 0]
    print(f"reflected {above:.3f}, transmitted {below:.3f}, sampled in all {sampled:.3f}")


def multiplied(host):
    """Print the ratio of a coated base times a color to the same without the color."""
    factor = node_over("multiply", value=input_text("in2", "color3", COLOR), in1="coated")
    layered = node_over("layer", "coated", top="coat", base="base")
    texts = (COATED + layered + factor, COATED + node_over("layer", top="coat", base="base"))
    colored, plain = (
        host.evaluate(
            host.compile(document_text(text + SURFACE), library="stock")[0],
            VIEW,
            LIGHT,
            {},
            "direct",
        )
        for text in texts
    )
    print("a coated base times", *COLOR, "over the same:", *np.round(colored / plain, 4)[0])


if __name__ == "__main__":
    with Host() as testrender:
        refraction(testrender)
        multiplied(testrender)
