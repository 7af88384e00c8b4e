# SPDX-License-Identifier: Apache-2.0
"""Probes of the nodes that transmit through microfacets."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes.transmission import TransmissionSubject
from mxeon.conformance.probes.bsdf import MicrofacetProbe
from mxeon.conformance.samples.batch import Array, Batch


class TransmissionProbe(MicrofacetProbe):
    """A node that transmits, on a host that evaluates any pairs."""

    subject: TransmissionSubject

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        return self._evaluate(batch, "transmission", irradiance=radiance)

    @cached_property
    def reflection(self) -> MicrofacetProbe:
        return MicrofacetProbe(self.host, self.subject.reflection, self.library, self.counts)
