# SPDX-License-Identifier: Apache-2.0
"""Measurements of the nodes that emit light, and of media."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from mxeon.conformance.probes.cases import back_cases, transmittance_cases
from mxeon.conformance.samples.measurement import Case, Measurement, Metric, worst_of


def implemented(probe: Any, _: Metric) -> Measurement:
    """Number of documents, one, that the target has no implementation for."""
    return Measurement(float(probe.missing(probe.subject.document())), {})


def back(probe: Any, metric: Metric) -> Measurement:
    """Radiance towards views from the back."""
    return worst_of(metric, back_cases(probe))


def exitance(probe: Any, metric: Metric) -> Measurement:
    """Exitance over pi, integrated from the host's radiance, against its closed form."""
    batch, weights = probe.integrated
    count, nodes = weights.shape
    values = probe.direct(batch).reshape(count, nodes, 3)
    each = batch.where(np.arange(count) * nodes)
    measured = (weights[..., np.newaxis] * values).sum(axis=1)
    return worst_of(metric, [Case(each, measured, probe.subject.exitance(each) / np.pi)])


def transmittance(probe: Any, metric: Metric) -> Measurement:
    """Light through a medium and the throughput of a surface over it, against its transmittance."""
    return worst_of(metric, transmittance_cases(probe))


def opacity(probe: Any, metric: Metric) -> Measurement:
    """Pictures of a surface that emits, against its radiance times its opacity."""
    return worst_of(metric, opacity_cases(probe))


def opacity_cases(probe: Any) -> Iterator[Case]:
    """The cases of `opacity`."""
    for batch in probe.batches:
        yield Case(batch, probe.direct(batch), probe.expected(batch))
