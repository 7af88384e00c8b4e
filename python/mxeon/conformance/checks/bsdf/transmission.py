# SPDX-License-Identifier: Apache-2.0
"""Subjects and probes of the nodes that transmit through microfacets, scatter modes T and RT."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

from mxeon.conformance.checks.batch import Array, Batch
from mxeon.conformance.checks.bsdf.probes import MicrofacetProbe
from mxeon.conformance.checks.bsdf.subjects import SCHLICK, BsdfSubject
from mxeon.conformance.checks.probes import PairProbe
from mxeon.models.pbrlib.transmissions import TRANSMISSION_NODES, TRANSMISSIONS, Transmission

# Kinds of probes.
TRANSMITTED, SCHLICK_TRANSMITTED = TRANSMISSION_KINDS = (
    "transmission pairs",
    "Schlick transmission pairs",
)


@dataclass(frozen=True)
class TransmissionSubject(BsdfSubject):
    """A node of `mxeon.models.pbrlib.transmissions`."""

    @property
    def kind(self) -> str:
        """Kind of its probe."""
        return SCHLICK_TRANSMITTED if super().kind == SCHLICK else TRANSMITTED

    @property
    def functions(self) -> Transmission:
        """Functions of its transmission."""
        return TRANSMISSIONS[self.node]

    @property
    def reflects(self) -> bool:
        """Whether it reflects as well."""
        return self.row.fixed["scatter_mode"] == "RT"

    @property
    def reflection(self) -> BsdfSubject:
        """The node where it only reflects."""
        return BsdfSubject(replace(self.row, fixed={"scatter_mode": "R"}))


@dataclass(frozen=True, eq=False)
class TransmissionProbe(MicrofacetProbe):
    """A node that transmits, on a host that evaluates any pairs."""

    kind: ClassVar[str] = TRANSMITTED

    subject: TransmissionSubject

    def transmitted(self, batch: Batch, radiance: Array | None = None) -> Array:
        """Light of an environment through the surface, (N, 3); it is uniform unless given."""
        return self._evaluate(batch, "transmission", irradiance=radiance)

    @cached_property
    def reflection(self) -> MicrofacetProbe:
        """The probe of the node where it only reflects."""
        return MicrofacetProbe(self.host, self.subject.reflection, self.library)


@dataclass(frozen=True, eq=False)
class SchlickTransmissionProbe(TransmissionProbe):
    """A node that transmits by Schlick's curve."""

    kind: ClassVar[str] = SCHLICK_TRANSMITTED


def transmission_probe_type(
    subject: TransmissionSubject, probe: type[Any]
) -> type[TransmissionProbe] | None:
    """Class of a subject's probes on a host that has probes of a class; None if it has none.

    A picture of a solid shows light that enters and leaves it, which no equation of the node has.
    """
    if probe is not PairProbe:
        return None
    return SchlickTransmissionProbe if subject.kind == SCHLICK_TRANSMITTED else TransmissionProbe


TRANSMITTING = tuple(TransmissionSubject(row) for row in TRANSMISSION_NODES)
