# SPDX-License-Identifier: Apache-2.0
"""Compares models of EON below an interface with random walks: python -m tools.fits.varnish_walk.

`dielectric_over_eon` is a `layer`: EON receives the light that the dielectric does not reflect, and
returns it without loss. `varnished` has closed forms for exits and internal reflections. The random
walks here go between EON and GGX facets, and from facet to facet as in [Heitz2016], so the
interface loses no light. For each rho, the script prints the ratios of both models' albedos to the
walk's, the largest error of `varnished`, and its ratios for the light that EON returns into each of
twelve bins of the hemisphere.
"""

from itertools import product

import numpy as np

from mxeon.models import (
    dielectric_over_eon_albedo_dir,
    eon_brdf,
    varnished_albedo_dir,
    varnished_brdf,
)
from mxeon.models.microfacet.fresnel import dielectric
from mxeon.models.sampling import eon_sample

SEED, PATHS = 1, 1 << 18
FAINT = 1e-5  # paths with a smaller weight end
RHO = np.array([0.0, 0.2, 0.5, 0.8, 1.0])
BINS, NODES = (4, 3), 8  # bins of squared cosine and of half the azimuth; nodes per bin
COSINES, ROUGHNESSES = (1.0, 0.5, 0.15, 0.05), (0.0, 1.0)
ALPHAS, INDICES = (0.05, 0.1, 0.2, 0.4, 0.7), (1.1, 1.3, 1.5, 2.0)


def facets(w, alpha, rng):
    """Samples of GGX's visible normals, [Dupuy2023]."""
    stretch = np.array([alpha, alpha, 1.0])
    v = w * stretch
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    azimuth, z = 2.0 * np.pi * rng.random(len(w)), 1.0 - rng.random(len(w)) * (1.0 + v[:, 2])
    radius = np.sqrt(np.clip(1.0 - z * z, 0.0, 1.0))
    h = (np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1) + v) * stretch
    return h / np.linalg.norm(h, axis=1, keepdims=True)


def interface(w, alpha, ior, rng):
    """Directions, z >= 0, of light from w after the facets, and whether it leaves below them."""
    out, passed = np.zeros_like(w), np.zeros(len(w), bool)
    # State of each path: index, direction, share of the heights below it, and side.
    i, d, height, below = np.arange(len(w)), -w, np.ones(len(w)), passed.copy()
    while i.size:
        # The distance to the next facet depends on Lambda, negative downwards, [Heitz2016].
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


def walk(mu, roughness, alpha, ior, paths=PATHS):
    """Light that each path returns for each of RHO, (paths, 5), and its direction, (paths, 3)."""
    rng = np.random.default_rng(SEED)
    out, inside = interface(np.tile(view(mu), (paths, 1)), alpha, ior, rng)
    total, weight = np.where(inside, 0.0, 1.0)[:, np.newaxis] + 0.0 * RHO, 1.0
    left, w = np.flatnonzero(inside), out[inside]
    while left.size:
        # Both layers are isotropic, so the azimuth of a direction does not matter.
        wi, pdf = eon_sample(w, rng.random((left.size, 2)), roughness, rho=1.0)
        value = eon_brdf(w, wi, np.broadcast_to(RHO, (left.size, RHO.size)), roughness)
        weight = weight * value * (wi[:, 2] / pdf)[:, np.newaxis]
        w, leaves = interface(wi, alpha, 1.0 / ior, rng)
        total[left[leaves]], out[left[leaves]] = weight[leaves], w[leaves]
        stays = ~leaves & (weight[:, -1] > FAINT)
        w, weight, left = w[stays], weight[stays], left[stays]
    return total, out


def view(mu):
    return np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])


def walked_bins(total, out):
    """Light that EON returns into each bin, for each nonzero rho, (12, 4)."""
    azimuth = np.abs(np.arctan2(out[:, 1], out[:, 0])) / np.pi
    row, column = (
        np.minimum((x * n).astype(int), n - 1)
        for x, n in zip((out[:, 2] ** 2, azimuth), BINS, strict=True)
    )
    which = row * BINS[1] + column
    own = total[:, 1:] - total[:, :1]
    return np.stack([np.bincount(which, each, np.prod(BINS)) for each in own.T], axis=1) / len(own)


def model_bins(mu, *inputs):
    """Light that EON returns into each bin by the model `varnished`, as in `walked_bins`."""
    x, weight = (each / 2.0 for each in np.polynomial.legendre.leggauss(NODES))
    square, azimuth = ((np.arange(n)[:, np.newaxis] + 0.5 + x) / n for n in BINS)
    square, azimuth = square[:, np.newaxis, :, np.newaxis], np.pi * azimuth[:, np.newaxis]
    S = np.sqrt(1.0 - square)
    parts = S * np.cos(azimuth), S * np.sin(azimuth), np.sqrt(square)
    value = varnished_brdf(view(mu), np.stack(np.broadcast_arrays(*parts), axis=-1), RHO, *inputs)
    bins = np.einsum("abijc,i,j->abc", value, weight, weight) * np.pi / np.prod(BINS)
    return bins.reshape(-1, RHO.size)[:, 1:] - bins.reshape(-1, RHO.size)[:, :1]


def rows(paths=PATHS):
    """For each case, albedos by layer, varnished and walk, (3, 5), and ratios of bins, (12, 4)."""
    for ior, alpha, roughness, mu in product(INDICES, ALPHAS, ROUGHNESSES, COSINES):
        inputs = roughness, alpha, ior
        walked = walk(mu, *inputs, paths)
        models = (
            function(mu, RHO, *inputs)
            for function in (dielectric_over_eon_albedo_dir, varnished_albedo_dir)
        )
        yield (
            np.stack([*models, walked[0].mean(axis=0)]),
            model_bins(mu, *inputs) / walked_bins(*walked),
        )


def span(values):
    return f"{values.min():.2f} to {values.max():.2f}"


if __name__ == "__main__":
    albedos, bins = map(np.array, zip(*rows(), strict=True))
    layer, varnished, walked = albedos.transpose(1, 2, 0)
    for k, rho in enumerate(RHO):
        spans = span(layer[k] / walked[k]), span(varnished[k] / walked[k])
        parts = span(bins[..., k - 1]) if k else ""
        print(
            f"| {rho} | {' | '.join(spans)} | {np.abs(varnished - walked)[k].max():.3f} | {parts} |"
        )
