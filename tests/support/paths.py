# SPDX-License-Identifier: Apache-2.0
"""What a path tracer asks a material, on a host that executes functions, and statistics of the answers.

Bins are cells of the angle from the x axis and of the azimuth about it: fibers lie along x, and the horizon is an
edge of cells. Lobes too sharp for them have a cone of their own.
"""

import numpy as np
from scipy import special

from mxeon.shaders.generation import generate

CALL = """
vec3 path_tracer(float what, vec3 wo, vec3 wi, vec3 u, float inside)
{
    Point p;
    p.position = vec3(0.0);
    p.normal = vec3(0.0, 0.0, 1.0);
    p.tangent = vec3(1.0, 0.0, 0.0);
    p.texcoord = vec3(0.3, 0.4, 0.0).xy;
    p.inside = inside > 0.5;
    if (what < 0.5)
        return material_evaluate(p, wo, wi);
    if (what < 1.5)
        return vec3(material_pdf(p, wo, wi));
    if (what < 2.5)
        return vec3(material_opacity(p, wo));
    if (what < 3.5)
        return material_emission(p, wo);
    if (what < 4.5)
    {
        path_ask(PATH_DRAW, p, wo, wo, u);  // as material_sample begins, for a third of its time
        bool drawn = path_root.x > 0.0 && path_root.y <= 2.0;
        return path_u.z >= path_out.a ? -wo : drawn ? path_unpacked(path_root.yz) : vec3(0.0);
    }
    vec3 weight;
    float pdf;
    bool kept = material_sample(p, wo, u, wi, weight, pdf);
    return what < 5.5 ? (kept ? wi : vec3(0.0)) : what < 6.5 ? (kept ? weight : vec3(0.0)) : vec3(pdf);
}
"""
WHAT = ("evaluate", "pdf", "opacity", "emission", "draw", "wi", "weight", "density")
CELLS, NODES, CONE = 32, 16, 0.02
CHUNK = 1 << 20


def uniforms(count, seed=1):
    """Random numbers with the 24 bits that a shader's generator gives, (count, 3)."""
    return np.random.default_rng(seed).integers(0, 1 << 24, (count, 3)) * 2.0**-24


class Material:
    """The text for path tracers of a document's one material, and of a library."""

    def __init__(self, host, document, library="eonlib"):
        [shader] = generate(document, host.target, profile="path", library=library)
        self.host, self.source = host, shader.stages["pixel"] + CALL

    def ask(self, what, wo, wi=(0.0, 0.0, 1.0), u=(0.0, 0.0, 0.0), inside=False):
        """Answers (N, 3) of a function, in float64."""
        rows = map(np.atleast_2d, (float(WHAT.index(what)), wo, wi, u, float(inside)))
        return np.float64(self.host.execute(self.source, "path_tracer", *rows))


def axes(w):
    across = np.cross(w, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    return across, np.cross(w, across)


def cell(w, sharp):
    """Number of the bin of each direction: a cell, the cone, or the last for none."""
    theta = np.arccos(np.clip(w[:, 0], -1.0, 1.0)) / np.pi
    phi = np.arctan2(w[:, 2], w[:, 1]) / (2.0 * np.pi) % 1.0
    row, column = (np.minimum(np.int64(CELLS * each), CELLS - 1) for each in (theta, phi))
    inside = np.linalg.norm(w - sharp, axis=1) < CONE
    bins = np.where(inside, CELLS * CELLS, row * CELLS + column)
    return np.where(np.linalg.norm(w, axis=1) < 0.5, CELLS * CELLS + 1, bins)


def nodes(sharp, per_cell=NODES):
    """Directions and solid angles of a quadrature over the cells, and over the cone in rings."""
    step = np.pi / (CELLS * per_cell)
    theta, phi = (
        step * (np.arange(CELLS * per_cell) + 0.5),
        2.0 * step * (np.arange(CELLS * per_cell) + 0.5),
    )
    T, P = np.meshgrid(theta, phi, indexing="ij")
    w = np.stack([np.cos(T), np.sin(T) * np.cos(P), np.sin(T) * np.sin(P)], axis=-1).reshape(-1, 3)
    area = (2.0 * step * step * np.sin(T)).ravel()
    outside = np.linalg.norm(w - sharp, axis=1) >= CONE
    edges = np.append(0.0, np.geomspace(1e-7, CONE, 513))
    chord, ring = 0.5 * (edges[1:] + edges[:-1]), np.pi * np.diff(edges**2)
    angle, turn = (
        2.0 * np.arcsin(0.5 * chord)[:, None, None],
        2.0 * np.pi * (np.arange(64) + 0.5)[:, None] / 64,
    )
    across, other = axes(sharp)
    cone = np.cos(angle) * sharp + np.sin(angle) * (np.cos(turn) * across + np.sin(turn) * other)
    return np.concatenate([w[outside], cone.reshape(-1, 3)]), np.append(
        area[outside], np.repeat(ring / 64, 64)
    )


def expected(material, wo, sharp, per_cell=NODES, **options):
    """Probability of each bin; the last two are of the cone, and of draws that are lost or pass straight on."""
    w, area = nodes(sharp, per_cell)
    mass = material.ask("pdf", wo, w, **options)[:, 0] * area
    bins = np.bincount(cell(w, sharp), mass, minlength=CELLS * CELLS + 1)
    return np.append(bins, max(1.0 - bins.sum(), 0.0))


def counted(material, wo, sharp, count, **options):
    """Draws in each bin of `expected`."""
    bins = np.zeros(CELLS * CELLS + 2)
    for start in range(0, count, CHUNK):
        u = uniforms(min(CHUNK, count - start), 1 + start)
        wi = material.ask("draw", wo, u=u, **options)
        passed = material.ask("opacity", wo)[0, 0] < 1.0 and np.linalg.norm(wi + wo, axis=1) < 1e-6
        wi[passed] = 0.0
        bins += np.bincount(cell(wi, sharp), minlength=len(bins))
    return bins


def chi_square(counts, probabilities, least=20.0):
    """Probability of counts at least so far from what is expected; rare bins are put together."""
    rare = probabilities * counts.sum() < least
    observed = np.append(counts[~rare], counts[rare].sum())
    mean = np.append(probabilities[~rare], probabilities[rare].sum()) * counts.sum()
    observed, mean = observed[mean > 5.0], mean[mean > 5.0]
    return special.chdtrc(len(mean) - 1, ((observed - mean) ** 2 / mean).sum())
