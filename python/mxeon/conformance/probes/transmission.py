# SPDX-License-Identifier: Apache-2.0
"""Probes of the nodes that transmit through microfacets."""

from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.nodes.transmission import (
    SCHLICK_TRANSMITTED,
    TRANSMITTED,
    TransmissionSubject,
)
from mxeon.conformance.probes.bsdf import MicrofacetProbe
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch


class TransmissionProbe(MicrofacetProbe):
    """A node that transmits, on a host that evaluates any pairs."""

    kind: ClassVar[str] = TRANSMITTED

    subject: TransmissionSubject

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        return self._evaluate(batch, "transmission", irradiance=radiance)

    @cached_property
    def reflection(self) -> MicrofacetProbe:
        return MicrofacetProbe(self.host, self.subject.reflection, self.library)


class SchlickTransmissionProbe(TransmissionProbe):
    """A node that transmits by Schlick's curve."""

    kind: ClassVar[str] = SCHLICK_TRANSMITTED


def transmission_probe_type(subject: Subject, probe: type[Probe]) -> type[TransmissionProbe] | None:
    """Class of a subject's probes on a host that has probes of a class; None if it has none.

    A picture of a solid shows light that enters and leaves it, which no equation of the node has.
    """
    if probe is not PairProbe:
        return None
    return SchlickTransmissionProbe if subject.kind == SCHLICK_TRANSMITTED else TransmissionProbe
