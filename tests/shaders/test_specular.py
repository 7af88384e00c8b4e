# SPDX-License-Identifier: Apache-2.0
"""eonlib's microfacet and sheen nodes: a white furnace over white, and MaterialX's own as control.

A node's function is called as generated shaders call it, for each direction of light of a quadrature.
"""

import re

import numpy as np
import pytest

from mxeon.shaders.generation import generate
from tests.support.documents import material
from tests.support.tolerances import FURNACE_OVER_WHITE

# Parameters of a probe, and the arguments of the node between weight and BSDF.
PLANE = "vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), 0"
NODES = {
    "dielectric_bsdf": (
        "float ior, float alpha",
        f"vec3(1.0), ior, vec2(alpha), false, 0.0, 1.5, {PLANE}, 0",
    ),
    "generalized_schlick_bsdf": (
        "float color82, float alpha",
        f"vec3(0.5), vec3(color82), vec3(1.0), 5.0, vec2(alpha), false, 0.0, 1.5, {PLANE}, 0",
    ),
    "sheen_bsdf": (
        "float mode, float roughness",
        "vec3(1.0), roughness, vec3(0.0, 0.0, 1.0), int(mode)",
    ),
}
PROBE = """
vec3 probe_{name}(vec3 wo, vec3 wi, {parameters})
{{
    ClosureData closureData = makeClosureData(1, wi, wo, vec3(0.0, 0.0, 1.0), vec3(0.0), 1.0);
    BSDF bsdf = BSDF(vec3(0.0), vec3(1.0));
    {function}(closureData, 1.0, {arguments}, bsdf);
    return bsdf.{name};
}}
"""
ROWS = {
    "dielectric_bsdf": [(n, alpha) for n in (1.05, 1.5, 2.5) for alpha in (0.05, 0.2, 1.0)],
    "generalized_schlick_bsdf": [(t, alpha) for t in (0.5, 1.0) for alpha in (0.05, 0.2, 1.0)],
    "sheen_bsdf": [(0.0, r) for r in (0.25, 0.5, 1.0)],
}
NODES_OF_ANGLE = 28  # on either side of the mirror direction, and of the azimuth
COSINES = np.array([0.02, 0.1, 0.4, 1.0])


def source(node, library):
    """Generated text with a probe for the response and one for the throughput, without its main."""
    text = generate(material(f'<{node} name="lobe" type="BSDF"/>'), "glsl", library=library)[0]
    text = text.stages["pixel"].split("\n", 1)[1]
    text = re.sub(r"\bout vec4", "vec4", text)
    text = re.sub(
        r"\bin VertexData\s*({.*?})\s*vd;", r"struct Vertex \1; Vertex vd;", text, flags=re.S
    )
    function = re.search(rf"\bvoid (\w*{node})\(", text)[1]
    parameters, arguments = NODES[node]
    probes = [
        PROBE.format(name=name, function=function, parameters=parameters, arguments=arguments)
        for name in ("response", "throughput")
    ]
    return "\n".join(["#define main generated_main", text, "#undef main", *probes])


def lights(mu, alpha):
    """Directions of light, dense around the mirror direction, and their solid angles."""
    x, w = np.polynomial.legendre.leggauss(NODES_OF_ANGLE)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    theta = np.arccos(mu)
    directions, weights = [], []
    for end in (0.5 * theta, 0.5 * theta - 0.25 * np.pi):
        v = np.arcsinh(np.tan(end) / alpha)
        half = np.arctan(alpha * np.sinh(v * x))
        width = np.abs(v) * alpha * np.cosh(v * x) / (1.0 + np.square(alpha * np.sinh(v * x)))
        polar = theta - 2.0 * half
        scale = (
            np.sqrt(
                (np.square(half) + alpha**2) / (np.square(np.sin(0.5 * (theta + polar))) + alpha**2)
            )
            * np.cos(0.5 * (theta + polar))
            + 1e-6
        )
        u = np.arcsinh(np.pi / scale)[:, None]
        azimuth = scale[:, None] * np.sinh(u * x)
        turn = u * scale[:, None] * np.cosh(u * x) * w
        sine = np.sin(polar)[:, None]
        ends = np.broadcast_arrays(
            -sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(polar)[:, None]
        )
        directions.append(np.stack(ends, axis=-1).reshape(-1, 3))
        weights.append((4.0 * (w * width)[:, None] * turn * sine).ravel())
    return np.concatenate(directions), np.concatenate(weights)


def returned(gl, node, library):
    """Response over all light plus throughput at each cosine and row of a node."""
    text = source(node, library)
    cases = [(mu, *row) for mu in COSINES for row in ROWS[node]]
    grids = [lights(mu, alpha if node != "sheen_bsdf" else 0.3) for mu, _, alpha in cases]
    counts = [len(weights) for _, weights in grids]
    columns = np.array(cases)
    wo = np.stack([np.sqrt(1.0 - columns[:, 0] ** 2), 0.0 * columns[:, 0], columns[:, 0]], axis=-1)
    wi = np.concatenate([directions for directions, _ in grids])
    repeated = [np.repeat(each, counts, axis=0) for each in (wo, columns[:, 1], columns[:, 2])]
    response = gl.execute(text, "probe_response", repeated[0], wi, *repeated[1:])[:, 0]
    weights = np.concatenate([weights for _, weights in grids])
    albedo = np.add.reduceat(np.float64(response) * weights, np.cumsum([0, *counts[:-1]]))
    throughput = gl.execute(text, "probe_throughput", wo, wo, columns[:, 1], columns[:, 2])[:, 0]
    return albedo + throughput


@pytest.mark.parametrize("node", NODES)
def test_a_layer_over_white_returns_all_light_of_a_white_furnace(gl, node):
    assert np.abs(returned(gl, node, "eonlib") - 1.0).max() <= FURNACE_OVER_WHITE


@pytest.mark.parametrize("node", NODES)
def test_materialx_own_node_loses_or_gains_light_there(gl, node):
    assert np.abs(returned(gl, node, "stock") - 1.0).max() > 5.0 * FURNACE_OVER_WHITE
