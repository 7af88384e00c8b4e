# SPDX-License-Identifier: Apache-2.0
"""Albedo of EON below an interface, of both models and of light that walks: python -m tools.fits.varnish_walk.

`dielectric_over_eon` is a `layer`: EON gets what the dielectric does not reflect, and what EON returns
passes freely. `varnished` has exits and internal reflections in closed form. Here light walks between EON and
GGX facets, and among the facets as in [Heitz2016], so that the interface loses nothing.
"""

from itertools import product

import numpy as np

from mxeon.models import dielectric_over_eon_albedo_dir, eon_brdf, varnished_albedo_dir
from mxeon.models.microfacet.fresnel_formulas import dielectric
from mxeon.sampling import eon_sample

SEED, PATHS = 1, 1 << 18
FAINT = 1e-5  # weight at which a path ends
RHO = np.array([0.2, 0.5, 0.8, 1.0])
COSINES, ROUGHNESSES = (1.0, 0.5, 0.15, 0.05), (0.0, 1.0)
ALPHAS, INDICES = (0.05, 0.1, 0.2, 0.4, 0.7), (1.1, 1.3, 1.5, 2.0)


def facets(w, alpha, rng):
    """Visible normals of GGX, [Dupuy2023]."""
    stretch = np.array([alpha, alpha, 1.0])
    v = w * stretch
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    azimuth, z = 2.0 * np.pi * rng.random(len(w)), 1.0 - rng.random(len(w)) * (1.0 + v[:, 2])
    radius = np.sqrt(np.clip(1.0 - z * z, 0.0, 1.0))
    h = (np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1) + v) * stretch
    return h / np.linalg.norm(h, axis=1, keepdims=True)


def interface(w, alpha, ior, rng):
    """Directions in which light from above, along -w, leaves facets, z >= 0, and whether below them."""
    out, passed = np.zeros_like(w), np.zeros(len(w), bool)
    # Each path: its index, direction, height as the share of heights below it, and side; z is up there.
    i, d, height, below = np.arange(len(w)), -w, np.ones(len(w)), passed.copy()
    while i.size:
        # Lambda, negative downwards, tells how far the next facet is: [Heitz2016].
        tangent2 = (1.0 - d[:, 2] ** 2) / np.maximum(d[:, 2] ** 2, 1e-12)
        root = np.sqrt(1.0 + alpha**2 * tangent2)
        Lambda = np.maximum(0.5 * (np.where(d[:, 2] > 0.0, root, -root) - 1.0), -1e9)
        Lambda = np.where(np.abs(Lambda) < 1e-9, 1e-9, Lambda)
        with np.errstate(over="ignore", divide="ignore"):
            height = height / rng.random(i.size) ** (1.0 / Lambda)
        leaves = (height > 1.0) & (d[:, 2] > 0.0)
        out[i[leaves]], passed[i[leaves]] = d[leaves], below[leaves]
        i, d, height, below = (each[~leaves] for each in (i, d, height, below))
        # Reflect or refract at a facet.
        eta, h = np.where(below, 1.0 / ior, ior), facets(-d, alpha, rng)
        c = -(d * h).sum(axis=1)
        through = rng.random(i.size) >= dielectric(c, eta)
        bent = np.sqrt(np.clip(1.0 - (1.0 - c * c) / eta**2, 0.0, None))
        refracted = d / eta[:, None] + (c / eta - bent)[:, None] * h
        d = np.where(through[:, None], refracted, d + 2.0 * c[:, None] * h)
        d[through, 2] *= -1.0
        height, below = np.where(through, 1.0 - height, height), below ^ through
    return out, passed


def walk(mu, roughness, alpha, ior, paths=PATHS, seed=SEED):
    """Light that leaves along each path, (paths, 4), for each of RHO."""
    rng = np.random.default_rng(seed)
    w = np.tile([np.sqrt(1.0 - mu * mu), 0.0, mu], (paths, 1))
    w, inside = interface(w, alpha, ior, rng)
    total, paths_left, weight = (
        np.where(inside, 0.0, 1.0)[:, np.newaxis] + 0.0 * RHO,
        np.flatnonzero(inside),
        1.0,
    )
    w = w[inside]
    while len(w):
        # Neither layer has a grain, so that the side of a direction does not matter.
        wi, pdf = eon_sample(w, rng.random((len(w), 2)), roughness, rho=1.0)
        value = eon_brdf(w, wi, np.broadcast_to(RHO, (len(w), 4)), roughness)
        weight = weight * value * (wi[:, 2] / pdf)[:, np.newaxis]
        w, leaves = interface(wi, alpha, 1.0 / ior, rng)
        total[paths_left[leaves]] = weight[leaves]
        stays = ~leaves & (weight[:, -1] > FAINT)
        w, weight, paths_left = w[stays], weight[stays], paths_left[stays]
    return total


def rows(paths=PATHS):
    """Albedos by the layer, varnished and the walk, for each of RHO: (cases, 3, 4)."""
    return np.array([
        [
            dielectric_over_eon_albedo_dir(mu, RHO, roughness, alpha, ior),
            varnished_albedo_dir(mu, RHO, roughness, alpha, ior),
            walk(mu, roughness, alpha, ior, paths).mean(axis=0),
        ]
        for ior, alpha, roughness, mu in product(INDICES, ALPHAS, ROUGHNESSES, COSINES)
    ])  # fmt: skip


if __name__ == "__main__":
    layer, varnished, walked = rows().transpose(1, 0, 2)
    for k, rho in enumerate(RHO):
        spans = [
            f"{q.min():.2f} to {q.max():.2f}"
            for q in ((layer / walked)[:, k], (varnished / walked)[:, k])
        ]
        off = np.abs(varnished - walked)[:, k].max()
        print(f"| {rho} | {' | '.join(spans)} | {off:.3f} |")
