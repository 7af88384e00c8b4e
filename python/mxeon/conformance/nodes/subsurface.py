# SPDX-License-Identifier: Apache-2.0
"""The node `subsurface_bsdf` on a host that evaluates pairs of directions: on a plane, and on a sphere."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.rows import ZERO, broadcast_inputs
from mxeon.conformance.samples.batch import Array, Batch, Candidate
from mxeon.models.nodes.subsurface import SUBSURFACE_NODE, circle_blur

LEAST_COSINE = 1e-6  # M_FLOAT_EPS of MaterialX


@dataclass(frozen=True)
class SubsurfaceSubject(BsdfSubject):
    """The node of subsurface scattering. Its radius and its anisotropy are not seen on a plane."""

    @property
    def kind(self) -> str:
        return kinds.SUBSURFACE

    @property
    def others(self) -> tuple[Candidate, ...]:
        """Zero, and what MaterialX has in its place."""
        return ZERO, Candidate("MaterialX's blur along a circle of radius 100", _blurred)


def _blurred(batch: Batch) -> Array:
    """What MaterialX has on a plane: light below the horizon and in shadow.

    It has none where a cosine is rounded above 1, of which the arc cosine is not a number.
    """
    mu = batch.wi[:, 2]
    shadow = 1.0 - np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
    lit = 1.0 - shadow * np.clip(mu, LEAST_COSINE, 1.0)[:, np.newaxis]
    inputs = broadcast_inputs(batch)
    light = np.where(mu[:, np.newaxis] > 1.0, 0.0, circle_blur(mu, inputs["radius"]))
    return np.asarray(batch.strength * inputs["color"] * light * lit)


SUBSURFACES = (SubsurfaceSubject(SUBSURFACE_NODE),)
