# SPDX-License-Identifier: Apache-2.0
"""The subject `chiang_hair_bsdf`: its inputs, its values and what may stand in their place."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.rows import Port, broadcast_inputs, color
from mxeon.conformance.samples.batch import Array, Batch, Values
from mxeon.conformance.samples.uneven_environment import sky
from mxeon.models.hair import ROUGHNESSES, TINTS, chiang_hair_attenuation
from mxeon.models.nodes.hair import HAIR_NODE
from mxeon.models.nodes.node import Scattering

LEAST_VARIANCE, LEAST_SCALE = 1e-4, 0.01  # of random pairs
WIDE_VARIANCE, WIDE_SCALE = 0.05, 0.3  # least ones of values that are integrated
MOST_VARIANCE, MOST_SCALE = 100.0, 10.0  # which the node of artistic roughness reaches
# Share of R, TT, TRT and TRRT+ that takes light from the viewer's side.
FRONT = np.array([1.0, 0.0, 1.0, 0.5])
PORTS = (
    *(color(name, edges=()) for name in TINTS),
    Port("ior", low=1.1, high=2.5, edges=(1.0, 1.55), change=1.3),
    *(
        Port(
            name,
            "vector2",
            (LEAST_VARIANCE, LEAST_SCALE),
            (MOST_VARIANCE, MOST_SCALE),
            (0.0, 1e-3, 1.0, 100.0),
            (0.3, 0.7),
            logarithmic=True,
        )
        for name in ROUGHNESSES
    ),
    Port("cuticle_angle", change=0.55, often=0.5),
    Port("absorption_coefficient", "vector3", 0.0, 4.0, (0.0,), (0.9, 0.1, 0.6)),
    Port("normal", "vector3", change=(0.0, 0.6, 0.8)),
    # The variable of its default is the surface's tangent.
    Port("curve_direction", "vector3", change=(0.6, 0.8, 0.0), variable="tangent"),
)


@dataclass(frozen=True)
class HairSubject(BsdfSubject):
    """The hair node. Light comes from the whole sphere, and its values take no cosine."""

    @property
    def kind(self) -> str:
        return kinds.HAIR

    @property
    def ports(self) -> tuple[Port, ...]:
        return PORTS

    @property
    def black(self) -> Values:
        return dict.fromkeys(TINTS, (0.0, 0.0, 0.0))

    def values(self, function: Scattering, batch: Batch) -> Array:
        """pi f with occlusion, (N, 3)."""
        occlusion = np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
        return np.asarray(np.pi * function(batch.wo, batch.wi, broadcast_inputs(batch)) * occlusion)

    def sky(self, batch: Batch) -> Array:
        """Mean of the uneven sky that it scatters, (N, 3).

        R and TRT leave on the side where light comes in, TT on the other one, and what is beyond
        spreads over both.
        """
        inputs = broadcast_inputs(batch)
        A = chiang_hair_attenuation(batch.wo, inputs["ior"], inputs["absorption_coefficient"])
        shares = A * np.stack([inputs[name] for name in (*TINTS, TINTS[-1])], axis=-1)
        front = shares @ FRONT / shares.sum(axis=-1)
        return np.asarray(front * sky(batch.normal) + (1.0 - front) * sky(-batch.normal))


HAIRS = (HairSubject(HAIR_NODE),)
