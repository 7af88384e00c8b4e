# SPDX-License-Identifier: Apache-2.0
"""Variance of the samplers, by quadrature: of the throughput, and of the light received.

    python tools/benchmarks/sampling_variance.py

Prints the tables of docs/sampling.md. Nothing in them is random: the variance of one sample is an
integral over the hemisphere, here a Gauss-Legendre rule between the kinks of EON. That of LTC and
CLTC alone does not exist: their density falls to 0 along a line on which EON does not.
"""

import numpy as np

from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.diffuse.brdf import eon_brdf
from mxeon.models.sampling import SAMPLERS, eon_pdf

# From 0.01 on: towards 0 the variance of cosine sampling grows without bound, as its logarithm.
COSINES = np.linspace(0.01, 1.0, 100)
ROUGHNESS = (0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
VIEWS = (1.0, 0.7, 0.3, 0.1)
BY_NAME = {sampler.name: sampler for sampler in SAMPLERS}
PRINTED = [BY_NAME[name] for name in ("uniform", "cosine", "ltc0", "eon_cltc", "eon")]


def lobe(polar, sharpness):
    """Light from around a polar angle in degrees, in the view's plane; > 0 on the view's side."""
    towards = np.array([np.sin(np.radians(polar)), 0.0, np.cos(np.radians(polar))])
    return lambda wi: np.exp(sharpness * (wi @ towards - 1.0))


LIGHTS = (
    ("uniform", lambda wi: np.ones(len(wi))),
    ("brighter towards the zenith, z^2", lambda wi: wi[:, 2] ** 2),
    ("brighter towards the horizon, (1 - z)^2", lambda wi: (1.0 - wi[:, 2]) ** 2),
    ("the half on the side of the view", lambda wi: (wi[:, 0] > 0.0) * 1.0),
    ("the half opposite", lambda wi: (wi[:, 0] < 0.0) * 1.0),
    ("wide lobe at the zenith", lobe(0.0, 10.0)),
    ("wide lobe, 60 degrees, view's side", lobe(60.0, 10.0)),
    ("wide lobe, 60 degrees, opposite", lobe(-60.0, 10.0)),
    ("narrow lobe at the zenith", lobe(0.0, 200.0)),
    ("narrow lobe, 60 degrees, view's side", lobe(60.0, 200.0)),
    ("narrow lobe, 60 degrees, opposite", lobe(-60.0, 200.0)),
    ("narrow lobe, 85 degrees, opposite", lobe(-85.0, 200.0)),
)


def moments(sampler, mu, roughness, light=None):
    """Mean, variance and largest value of one sample of light times EON at reflectance 1."""
    wo, wi, projected = hemisphere_nodes(mu, 96)
    value, cosine = eon_brdf(wo, wi, 1.0, roughness)[:, 0], wi[:, 2]
    value = value if light is None else value * light(wi)
    pdf = sampler.pdf(wo, wi, roughness)
    drawn = pdf > 0.0
    sample = value[drawn] * cosine[drawn] / pdf[drawn]
    weights = projected[drawn] * pdf[drawn] / cosine[drawn]
    mean = sample @ weights
    return mean, (sample - mean) ** 2 @ weights, sample.max()


def print_row(first, cells):
    """One row of a table in Markdown."""
    print("| " + " | ".join([str(first), *cells]) + " |")


def print_head(first, cells):
    """Head of a table in Markdown."""
    print()
    print_row(first, cells)
    print("|---" * (1 + len(cells)) + "|")


def print_throughput():
    """Largest variance and weight over the polar angle, and the most that CLTC alone loses."""
    rows = {r: [worst_of(sampler, r) for sampler in PRINTED] for r in ROUGHNESS}
    for column, title in enumerate(("variance, r", "largest weight, r")):
        print_head(title, [sampler.title for sampler in PRINTED])
        for r, worst in rows.items():
            print_row(r, [f"{quantities[column]:.3g}" for quantities in worst])
    print_head("r", ["lost by CLTC alone"])
    for r in ROUGHNESS:
        print_row(r, [f"{worst_of(BY_NAME['cltc'], r)[2]:.2g}"])


def worst_of(sampler, roughness):
    """Largest variance, largest weight and largest distance of the mean from 1."""
    mean, variance, weight = zip(*(moments(sampler, mu, roughness) for mu in COSINES), strict=True)
    return max(variance), max(weight), max(abs(1.0 - value) for value in mean)


def print_lighting(name):
    """Variance of a sampler over that of the exact one, by light and view."""
    for r in (0.25, 1.0):
        print_head(f"{BY_NAME[name].title} / exact, r = {r}", [f"mu_o = {mu}" for mu in VIEWS])
        for title, light in LIGHTS:
            ratios = (
                moments(BY_NAME[name], mu, r, light)[1] / moments(BY_NAME["eon"], mu, r, light)[1]
                for mu in VIEWS
            )
            print_row(title, [f"{ratio:.2f}" if ratio < 1e6 else "all" for ratio in ratios])


def relative_variance(mu, rho, roughness):
    """Largest variance of a channel's weight over its mean squared, sampling rho = 1 and gray."""
    wo, wi, projected = hemisphere_nodes(mu, 96)
    value, weights = eon_brdf(wo, wi, rho, roughness) * wi[:, 2:], projected / wi[:, 2]
    albedo = weights @ value
    found = []
    for gray in (1.0, np.mean(rho)):
        pdf = eon_pdf(wo, wi, roughness, rho=gray)[:, np.newaxis]
        found.append(np.max(weights @ ((value / pdf / albedo - 1.0) ** 2 * pdf)))
    return found


def print_color():
    """Variance that exact sampling for one reflectance leaves in channels of another."""
    print_head("rho, r = 1", ["sampled for rho = 1", "sampled for the mean of rho"])
    for rho in ((1e-6, 1e-6, 1e-6), (0.1, 0.1, 0.1), (0.5, 0.5, 0.5), (0.8, 0.2, 0.05)):
        worst = np.max([relative_variance(mu, rho, 1.0) for mu in COSINES], axis=0)
        print_row(rho, [f"{value:.2g}" for value in worst])


if __name__ == "__main__":
    print_throughput()
    for other in ("eon_cltc", "cosine"):
        print_lighting(other)
    print_color()
