# SPDX-License-Identifier: Apache-2.0
"""Measurements of the other BSDF nodes of pbrlib: energy, layering, and their frames."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from mxeon.conformance.checks.batch import Array, Batch
from mxeon.conformance.checks.measures import Case, Measurement, Metric, worst_of

LIGHT = ("direct", "environment")  # branches that light a base from above


def layering(probe: Any, metric: Metric) -> Measurement:
    """Throughput of a layer against 1 - E, in the branches that light a base from above."""
    return worst_of(metric, layering_cases(probe))


def layering_cases(probe: Any) -> Iterator[Case]:
    """The cases of `layering`."""
    for branch in LIGHT:
        yield from _throughput_cases(probe, branch)


def transmission(probe: Any, metric: Metric) -> Measurement:
    """Throughput of a layer against 1 - E, in the branch of light through the base."""
    return worst_of(metric, transmission_cases(probe))


def transmission_cases(probe: Any) -> Iterator[Case]:
    """The cases of `transmission`."""
    return _throughput_cases(probe, "transmission")


def _throughput_cases(probe: Any, branch: str) -> Iterator[Case]:
    for batch in probe.cosines:
        yield Case(batch, probe.throughput(batch, branch), probe.subject.passed(batch))


def layer(probe: Any, metric: Metric) -> Measurement:
    """Light that a lobe reflects and light that it passes to a white base, against all of it."""
    views, albedo = _integral(probe)
    passed = probe.throughput(views, "direct")
    expected = np.maximum(1.0, albedo)  # a lobe that gains energy by itself is not to blame twice
    return worst_of(metric, [Case(views, albedo + passed, expected)])


def energy(probe: Any, metric: Metric) -> Measurement:
    """Albedos above 1, and above what the node's own equations have."""
    views, albedo = _integral(probe)
    allowed = np.maximum(1.0, probe.subject.integral(views))
    return worst_of(metric, [Case(views, np.maximum(albedo, allowed), allowed)])


def integral(probe: Any, metric: Metric) -> Measurement:
    """Directional albedo, integrated from the host's values, against that of the equations."""
    views, albedo = _integral(probe)
    return worst_of(metric, [Case(views, albedo, probe.subject.integral(views))])


def _integral(probe: Any) -> tuple[Batch, Array]:
    """Views of the integrated materials, and their albedos from the host's values, (N, 3)."""
    batch, weights = probe.integrated
    count, nodes = weights.shape
    values = probe.direct(batch).reshape(count, nodes, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    return batch.where(np.arange(count) * nodes), albedo
