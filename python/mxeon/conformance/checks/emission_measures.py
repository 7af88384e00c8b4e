# SPDX-License-Identifier: Apache-2.0
"""Measurements of the nodes that emit light, and of media."""

import numpy as np

from mxeon.conformance.checks.bsdf_measures import summed
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
    views, measured = summed(probe, *probe.integrated)
    expected = subject_of(probe, EmissionSubject).exitance(views) / np.pi
    return worst_of(metric, [Case(views, measured, expected)])


def transmittance(probe: Probe, metric: Metric) -> Measurement:
    """Light through a medium and the throughput of a surface over it, against its transmittance."""
    return worst_of(metric, transmittance_cases(probe))
