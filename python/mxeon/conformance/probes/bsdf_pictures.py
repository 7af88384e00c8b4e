# SPDX-License-Identifier: Apache-2.0
"""Probes of pbrlib's BSDF nodes on hosts that make pictures."""

from collections.abc import Sequence
from typing import ClassVar

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.probes.pictures import PictureProbe
from mxeon.conformance.samples.batch import Values

SIZE = 64  # of pictures


class BsdfPictureProbe(PictureProbe):
    """A node of pbrlib on a sphere."""

    shown: ClassVar[str] = kinds.BSDF_PICTURE
    size: ClassVar[int] = SIZE

    subject: BsdfSubject

    @property
    def _inputs(self) -> Sequence[Values]:
        return self.subject.materials
