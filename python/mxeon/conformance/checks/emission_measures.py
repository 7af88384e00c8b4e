# SPDX-License-Identifier: Apache-2.0
"""Measurements of the nodes that emit light, and of media."""

from collections.abc import Iterable

import numpy as np

from mxeon.conformance.checks.bsdf_measures import summed
from mxeon.conformance.nodes.emission import EmissionSubject
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.measurement import Case, Measurement


def implemented(probe: Probe) -> Measurement:
    """Number of documents, one, that the target has no implementation for."""
    return Measurement(float(probe.missing(probe.subject.document())), {})


def exitance(probe: Probe) -> Iterable[Case]:
    """Exitance over pi, integrated from the host's radiance, against its closed form."""
    views, measured = summed(probe, *probe.integrated)
    expected = subject_of(probe, EmissionSubject).exitance(views) / np.pi
    return [Case(views, measured, expected)]
