# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the nodes that transmit through microfacets, scatter modes T and RT."""

from dataclasses import dataclass, replace

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.models.nodes.transmissions import TRANSMISSION_NODES, TRANSMISSIONS, Transmission


@dataclass(frozen=True)
class TransmissionSubject(BsdfSubject):
    """A node of `mxeon.models.nodes.transmissions`."""

    @property
    def kind(self) -> str:
        schlick = super().kind == kinds.SCHLICK
        return kinds.SCHLICK_TRANSMISSION if schlick else kinds.TRANSMISSION

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
        return BsdfSubject(replace(self.row, fixed={"scatter_mode": "R"}))


TRANSMITTING = tuple(TransmissionSubject(row) for row in TRANSMISSION_NODES)
