# SPDX-License-Identifier: Apache-2.0
"""How much brighter a dielectric over EON is than EON below its interface: python -m tools.fits.varnish_walk.

`dielectric_over_eon` is a `layer`: EON gets what the dielectric does not reflect, and what EON returns
passes freely. Below an interface light is reflected and refracted on its way out too. Here it walks between
EON and GGX facets, and among the facets as in [Heitz2016], so that the interface loses nothing.
"""

import numpy as np

from mxeon.models import dielectric_over_eon_albedo_dir, eon_albedo_dir
from mxeon.models.microfacet.fresnel_formulas import dielectric
from mxeon.sampling import eon_sample

SEED, PATHS = 1, 1 << 16
FAINT = 1e-5  # weight at which a path ends
RHO, COSINES, ALPHAS, ROUGHNESSES = (0.2, 0.5, 0.8, 1.0), (1.0, 0.5, 0.15), (0.1, 0.5), (0.0, 1.0)


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


def walk(mu, rho, roughness, alpha, ior=1.5, paths=PATHS):
    """Directional albedo of EON below the interface."""
    rng = np.random.default_rng(SEED)
    w = np.tile([np.sqrt(1.0 - mu * mu), 0.0, mu], (paths, 1))
    w, inside = interface(w, alpha, ior, rng)
    total, weight = np.sum(~inside), np.ones(paths)
    while inside.any():
        # Neither layer has a grain, so that the side of a direction does not matter.
        w, weight = w[inside], weight[inside]
        wi, _ = eon_sample(w, rng.random((weight.size, 2)), roughness, rho=rho)
        weight = weight * eon_albedo_dir(w[:, 2], rho, roughness)[:, 0]
        w, leaves = interface(wi, alpha, 1.0 / ior, rng)
        total += weight[leaves].sum()
        inside = ~leaves & (weight > FAINT)
    return total / paths


def quotients(rho, paths=PATHS):
    """Albedos of the layer over those of the walk, for all views and roughnesses."""
    return np.array([
        dielectric_over_eon_albedo_dir(mu, rho, roughness, alpha, 1.5)[0]
        / walk(mu, rho, roughness, alpha, paths=paths)
        for mu in COSINES for alpha in ALPHAS for roughness in ROUGHNESSES
    ])  # fmt: skip


if __name__ == "__main__":
    for rho in RHO:
        found = quotients(rho)
        print(f"| {rho} | {found.min():.2f} to {found.max():.2f} |")
