# SPDX-License-Identifier: Apache-2.0
"""Compares models of EON below an interface with random walks: python -m tools.fits.varnish_walk.

In `dielectric_over_eon`, EON receives the light that the dielectric does not reflect, and no light
from EON is reflected back. `varnished` has closed forms for transmission and internal reflections.
The random walks visit EON and GGX facets, and go from facet to facet as in [Heitz2016], so the
interface loses no light. For each rho, the script prints the ratios of both models' albedos to the
albedo of the walks, and the largest error of `varnished`. The script also prints the ratios of
`varnished` to the walks for the albedo due to EON in twelve bins of the hemisphere.
"""

from itertools import product

import numpy as np

from mxeon import models
from mxeon.models.microfacet.fresnel import dielectric
from mxeon.models.sampling import eon_sample, visible_normal

SEED, PATHS = 1, 1 << 18
FAINT = 1e-5  # paths end if the weight is smaller
RHO = np.array([0.0, 0.2, 0.5, 0.8, 1.0])
BINS, NODES = (4, 3), 8  # bins of squared cosine and of azimuth, and nodes per bin
COSINES, ROUGHNESSES = (1.0, 0.5, 0.15, 0.05), (0.0, 1.0)
ALPHAS, INDICES = (0.05, 0.1, 0.2, 0.4, 0.7), (1.1, 1.3, 1.5, 2.0)


def interface(w, alpha, ior, rng):
    """Directions with z >= 0 in which paths from w leave, and whether each path is transmitted."""
    out, transmitted = np.zeros_like(w), np.zeros(len(w), bool)
    # A path has an index, a direction, a height, and a flag that is set below the interface. The
    # height is the fraction of facets that are lower than the path.
    i, d, height, below = np.arange(len(w)), -w, np.ones(len(w)), transmitted.copy()
    while i.size:
        # By [Heitz2016], the distance to the next facet depends on Lambda, which is negative for
        # downward directions.
        tangent2 = (1.0 - d[:, 2] ** 2) / np.maximum(d[:, 2] ** 2, 1e-12)
        root = np.sqrt(1.0 + alpha**2 * tangent2)
        Lambda = np.maximum(0.5 * (np.where(d[:, 2] > 0.0, root, -root) - 1.0), -1e9)
        Lambda = np.where(np.abs(Lambda) < 1e-9, 1e-9, Lambda)
        with np.errstate(over="ignore", divide="ignore"):
            height = height / rng.random(i.size) ** (1.0 / Lambda)
        leaves = (height > 1.0) & (d[:, 2] > 0.0)
        out[i[leaves]], transmitted[i[leaves]] = d[leaves], below[leaves]
        i, d, height, below = (each[~leaves] for each in (i, d, height, below))
        u2, u1 = rng.random((2, i.size))
        eta, h = np.where(below, 1.0 / ior, ior), visible_normal(-d.T, u1, u2, (alpha, alpha)).T
        c = -(d * h).sum(axis=1)
        through = rng.random(i.size) >= dielectric(c, eta)
        bent = np.sqrt(np.clip(1.0 - (1.0 - c * c) / eta**2, 0.0, None))
        refracted = d / eta[:, None] + (c / eta - bent)[:, None] * h
        d = np.where(through[:, None], refracted, d + 2.0 * c[:, None] * h)
        d[through, 2] *= -1.0
        height, below = np.where(through, 1.0 - height, height), below ^ through
    return out, transmitted


def walk(mu, roughness, alpha, ior, paths=PATHS):
    """Final weights of paths for each of RHO, (paths, 5), and final directions, (paths, 3)."""
    rng = np.random.default_rng(SEED)
    out, below = interface(np.tile(view(mu), (paths, 1)), alpha, ior, rng)
    total, weight = np.where(below, 0.0, 1.0)[:, np.newaxis] + 0.0 * RHO, 1.0
    active, w = np.flatnonzero(below), out[below]
    while active.size:
        # Both layers are isotropic, so the azimuth of a direction does not matter.
        wi, pdf = eon_sample(w, rng.random((active.size, 2)), roughness, rho=1.0)
        value = models.eon_brdf(w, wi, np.broadcast_to(RHO, (active.size, RHO.size)), roughness)
        weight = weight * value * (wi[:, 2] / pdf)[:, np.newaxis]
        w, leaves = interface(wi, alpha, 1.0 / ior, rng)
        total[active[leaves]], out[active[leaves]] = weight[leaves], w[leaves]
        stays = ~leaves & (weight[:, -1] > FAINT)
        w, weight, active = w[stays], weight[stays], active[stays]
    return total, out


def view(mu):
    return np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])


def walked_bins(total, out):
    """Albedo due to EON in each bin and for each nonzero rho, by random walks, (12, 4)."""
    azimuth = np.abs(np.arctan2(out[:, 1], out[:, 0])) / np.pi
    row, column = (
        np.minimum((x * n).astype(int), n - 1)
        for x, n in zip((out[:, 2] ** 2, azimuth), BINS, strict=True)
    )
    place = row * BINS[1] + column
    eon = total[:, 1:] - total[:, :1]
    return np.stack([np.bincount(place, each, np.prod(BINS)) for each in eon.T], axis=1) / len(eon)


def model_bins(mu, *inputs):
    """Albedo due to EON in each bin and for each nonzero rho, by the model `varnished`, (12, 4)."""
    x, weight = (each / 2.0 for each in np.polynomial.legendre.leggauss(NODES))
    square, azimuth = ((np.arange(n)[:, np.newaxis] + 0.5 + x) / n for n in BINS)
    square, azimuth = square[:, np.newaxis, :, np.newaxis], np.pi * azimuth[:, np.newaxis]
    S = np.sqrt(1.0 - square)
    parts = S * np.cos(azimuth), S * np.sin(azimuth), np.sqrt(square)
    value = models.varnished_brdf(
        view(mu), np.stack(np.broadcast_arrays(*parts), axis=-1), RHO, *inputs
    )
    bins = np.einsum("abijc,i,j->abc", value, weight, weight) * np.pi / np.prod(BINS)
    bins = bins.reshape(-1, RHO.size)
    return bins[:, 1:] - bins[:, :1]


def rows(paths=PATHS):
    """Yield albedos of both models and of the walk, (3, 5), and ratios in the bins, (12, 4)."""
    for ior, alpha, roughness, mu in product(INDICES, ALPHAS, ROUGHNESSES, COSINES):
        inputs = roughness, alpha, ior
        total, out = walk(mu, *inputs, paths)
        layer, varnished = (
            albedo(mu, RHO, *inputs)
            for albedo in (models.dielectric_over_eon_albedo_dir, models.varnished_albedo_dir)
        )
        ratios = model_bins(mu, *inputs) / walked_bins(total, out)
        yield np.stack([layer, varnished, total.mean(axis=0)]), ratios


def span(values):
    return f"{values.min():.2f} to {values.max():.2f}"


if __name__ == "__main__":
    albedos, bins = map(np.array, zip(*rows(), strict=True))
    layer, varnished, walked = albedos.transpose(1, 2, 0)
    for k, rho in enumerate(RHO):
        spans = f"{span(layer[k] / walked[k])} | {span(varnished[k] / walked[k])}"
        error, parts = np.abs(varnished - walked)[k].max(), span(bins[..., k - 1]) if k else ""
        print(f"| {rho} | {spans} | {error:.3f} | {parts} |")
