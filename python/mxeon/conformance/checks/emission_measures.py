# SPDX-License-Identifier: Apache-2.0
"""Measurements of the nodes that emit light, and of media."""

from collections.abc import Iterator

import numpy as np

from mxeon.conformance.nodes.emission import EmissionSubject
from mxeon.conformance.probes.cases import back_cases, transmittance_cases
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.measurement import Case, Measurement, Metric, worst_of


def implemented(probe: Probe, _: Metric) -> Measurement:
    """Number of documents, one, that the target has no implementation for."""
    return Measurement(float(probe.missing(probe.subject.document())), {})


def back(probe: Probe, metric: Metric) -> Measurement:
    """Radiance towards views from the back."""
    return worst_of(metric, back_cases(probe))


def exitance(probe: Probe, metric: Metric) -> Measurement:
    """Exitance over pi, integrated from the host's radiance, against its closed form."""
    batch, weights = probe.integrated
    count, nodes = weights.shape
    values = probe.direct(batch).reshape(count, nodes, 3)
    each = batch.where(np.arange(count) * nodes)
    measured = (weights[..., np.newaxis] * values).sum(axis=1)
    return worst_of(
        metric, [Case(each, measured, subject_of(probe, EmissionSubject).exitance(each) / np.pi)]
    )


def transmittance(probe: Probe, metric: Metric) -> Measurement:
    """Light through a medium and the throughput of a surface over it, against its transmittance."""
    return worst_of(metric, transmittance_cases(probe))


def opacity(probe: Probe, metric: Metric) -> Measurement:
    """Pictures of a surface that emits, against its radiance times its opacity."""
    return worst_of(metric, opacity_cases(probe))


def opacity_cases(probe: Probe) -> Iterator[Case]:
    """The cases of `opacity`."""
    for batch in probe.batches:
        yield Case(batch, probe.direct(batch), probe.expected(batch))
