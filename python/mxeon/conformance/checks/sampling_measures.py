# SPDX-License-Identifier: Apache-2.0
"""Measurements of a renderer's own sampling: its density, and its directions against that."""

from collections.abc import Iterable

import numpy as np

from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import SEED, Array, Batch
from mxeon.conformance.samples.measurement import Case, Measurement
from mxeon.models.sampling.cltc import eon_cltc_pdf

COSINES = (0.05, 0.3, 0.7, 0.99)  # of the viewer
SAMPLES = 1 << 15
BINS = 8, 16  # of the cosine and of the azimuth
FINE = 8  # points of a bin, along each axis, at which the density is averaged
LEAST = 10.0  # samples that a bin has to expect
ROUGHNESS = 1.0


def density(probe: Probe) -> Iterable[Case]:
    """The renderer's density against that of the paper's sampling."""
    cases: list[Case] = []
    for batch in probe.few:
        batch = batch.where(batch.wi[:, 2] > 0.0)
        measured = probe.density(batch)[:, np.newaxis]
        expected = eon_cltc_pdf(batch.wo, batch.wi, batch.inputs["roughness"])[:, np.newaxis]
        cases.append(Case(batch, measured, expected))
    return cases


def samples(probe: Probe) -> Measurement:
    """Deviation of the chi-square of directions against their own density, in standard deviations.

    Drawn for COSINES at ROUGHNESS. The cube root of a chi-square over its degrees of freedom is
    nearly normal, which gives the deviation [WilsonHilferty1931].
    """
    deviations = [_deviation(probe, mu) for mu in COSINES]
    worst = int(np.argmax(deviations))
    return Measurement(float(deviations[worst]), {"mu_o": [COSINES[worst]]})


def _deviation(probe: Probe, mu: float) -> float:
    """Standard deviations by which the counts of one viewer's samples leave their density."""
    # Draw directions, and count them in bins of the hemisphere.
    rng = np.random.default_rng(SEED)
    wo = np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])
    wi = probe.sample(_batch(np.broadcast_to(wo, (SAMPLES, 3))), rng.random((SAMPLES, 2)))
    azimuth = np.arctan2(wi[:, 1], wi[:, 0])
    edges = np.linspace(0.0, 1.0, BINS[0] + 1), np.linspace(-np.pi, np.pi, BINS[1] + 1)
    counts, _, _ = np.histogram2d(np.clip(wi[:, 2], 0.0, 1.0), azimuth, edges)
    expected = SAMPLES * _shares(probe, wo)
    kept = expected >= LEAST
    # The rest goes into one bin more; samples that no bin holds are in it too.
    observed = np.append(counts[kept], SAMPLES - counts[kept].sum())
    mean = np.append(expected[kept], SAMPLES - expected[kept].sum())
    mean[-1] = max(mean[-1], LEAST)
    # Make a standard normal of the chi-square, by Wilson and Hilferty.
    chi_square, freedom = ((observed - mean) ** 2 / mean).sum(), len(mean) - 1
    spread = 2.0 / (9.0 * freedom)
    return float(((chi_square / freedom) ** (1.0 / 3.0) - (1.0 - spread)) / np.sqrt(spread))


def _shares(probe: Probe, wo: Array) -> Array:
    """Integral of the renderer's density over each bin."""
    heights, turns = (FINE * count for count in BINS)
    mu, azimuth = np.meshgrid(
        (np.arange(heights) + 0.5) / heights,
        (2.0 * np.arange(turns) + 1.0) / turns * np.pi - np.pi,
        indexing="ij",
    )
    radius = np.sqrt(1.0 - mu * mu)
    wi = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), mu], axis=-1)
    batch = _batch(np.broadcast_to(wo, wi.shape).reshape(-1, 3), wi.reshape(-1, 3))
    values = probe.density(batch).reshape(BINS[0], FINE, BINS[1], FINE)
    shares: Array = values.sum(axis=(1, 3)) * (2.0 * np.pi / (heights * turns))
    return shares


def _batch(wo: Array, wi: Array | None = None) -> Batch:
    """Directions at ROUGHNESS."""
    return Batch(wo, wo if wi is None else wi, {"color": (1.0, 1.0, 1.0), "roughness": ROUGHNESS})
