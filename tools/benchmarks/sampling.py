# SPDX-License-Identifier: Apache-2.0
"""Prints the tables of docs/sampling.md with the variance of EON's samplers.

    python -m tools.benchmarks.sampling

The variance of a sample's weight is an integral over the hemisphere, computed by Gauss-Legendre
rules between the kinks of EON. LTC, and CLTC without uniform sampling, have infinite variance,
because the density of samples is 0 along a line where EON is positive.
"""

import numpy as np

from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.diffuse import eon_brdf
from mxeon.models.sampling import eon_pdf
from tools.paper.samplers import BY_NAME, moments

COSINES = np.linspace(0.01, 1.0, 100)  # cosine sampling: infinite variance at mu = 0
ROUGHNESSES = (0.01, 0.1, 0.5, 0.75, 1.0)
VIEWS = (1.0, 0.3, 0.1)
PRINTED = ("uniform", "cosine", "eon_cltc", "eon")


def narrow(polar):
    """Radiance of a narrow light. `polar`, in degrees, is positive on the viewer's side."""
    towards = np.array([np.sin(np.radians(polar)), 0.0, np.cos(np.radians(polar))])
    return lambda wi: np.exp(200.0 * (wi @ towards - 1.0))


RADIANCES = {
    "uniform": lambda wi: np.ones(len(wi)),
    "brighter towards the horizon, (1 - z)^2": lambda wi: (1.0 - wi[:, 2]) ** 2,
    "the half on the side of the view": lambda wi: (wi[:, 0] > 0.0) * 1.0,
    "the half opposite": lambda wi: (wi[:, 0] < 0.0) * 1.0,
    "narrow lobe, 60 degrees, opposite": narrow(-60.0),
    "narrow lobe, 85 degrees, opposite": narrow(-85.0),
}


def print_table(first, columns, rows):
    """Print a Markdown table. The keys of `rows` are the cells of the first column."""
    print("\n| " + " | ".join([first, *columns]) + " |")
    print("|---" * (1 + len(columns)) + "|")
    for name, cells in rows.items():
        print("| " + " | ".join([str(name), *cells]) + " |")


def print_throughput():
    """Print samplers' largest variances and weights, and CLTC's loss of energy, by roughness."""

    def over_cosines(name, roughness):
        return np.transpose([moments(name, mu, roughness) for mu in COSINES])

    largest = {r: [over_cosines(name, r)[1:].max(axis=1) for name in PRINTED] for r in ROUGHNESSES}
    for column, title in enumerate(("variance, r", "largest weight, r")):
        rows = {r: [f"{each[column]:.3g}" for each in found] for r, found in largest.items()}
        print_table(title, [BY_NAME[name].title for name in PRINTED], rows)
    losses = {r: np.abs(1.0 - over_cosines("cltc", r)[0]).max() for r in ROUGHNESSES}
    print_table("r", ["lost by CLTC alone"], {r: [f"{each:.2g}"] for r, each in losses.items()})


def print_lighting(name):
    """Print a sampler's variance at roughness 1, divided by the variance of the exact sampler."""
    rows = {}
    for title, light in RADIANCES.items():
        ratios = [
            moments(name, mu, 1.0, light)[1] / moments("eon", mu, 1.0, light)[1] for mu in VIEWS
        ]
        rows[title] = [f"{ratio:.2f}" if ratio < 1e6 else "all" for ratio in ratios]
    print_table(f"{BY_NAME[name].title} / exact", [f"mu_o = {mu}" for mu in VIEWS], rows)


def print_color():
    """Print the largest relative variance of a color channel if sampling is exact for gray."""
    rows = {}
    for rho in ((1e-6, 1e-6, 1e-6), (0.1, 0.1, 0.1), (0.5, 0.5, 0.5), (0.8, 0.2, 0.05)):
        found = []
        for mu in COSINES:
            wo, wi, projected = hemisphere_nodes(mu, 96)
            value, weights = eon_brdf(wo, wi, rho, 1.0) * wi[:, 2:], projected / wi[:, 2]
            for gray in (1.0, np.mean(rho)):
                pdf = eon_pdf(wo, wi, 1.0, rho=gray)[:, np.newaxis]
                weight = value / pdf / (weights @ value)
                found.append(np.max(weights @ ((weight - 1.0) ** 2 * pdf)))
        rows[rho] = [f"{value:.2g}" for value in np.reshape(found, (-1, 2)).max(axis=0)]
    print_table("rho, r = 1", ["sampled for rho = 1", "sampled for the mean of rho"], rows)


if __name__ == "__main__":
    print_throughput()
    for other in ("eon_cltc", "cosine"):
        print_lighting(other)
    print_color()
