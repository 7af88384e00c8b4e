# SPDX-License-Identifier: Apache-2.0
"""Subjects: pbrlib's BSDF nodes, each mode of a row, and the inputs of each node with their ranges: `PORTS`.

The rough diffuse nodes, hair, and nodes that combine lobes are in `diffuse`, `hair` and `combinations`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.rows import ZERO, Port, RowSubject, broadcast_inputs, color, materials
from mxeon.conformance.samples.batch import Array, Batch, Candidate, Values
from mxeon.conformance.samples.edge_cases import LEAST_SHEEN
from mxeon.conformance.samples.uneven_environment import sky
from mxeon.models import nodes as pbrlib
from mxeon.models.nodes.node import Inputs, PbrNode, Scattering
from mxeon.shaders.nodes import input_types, material_text

# Inputs that are 0 where nothing is scattered.
BLACK_INPUTS = ("color", "tint", "color0", "color90")

LEAST_ALPHA = 1e-3  # of random pairs
FILM = {"thinfilm_thickness": 400.0}
# Weights and normals are not drawn from their ports: `node_inputs` and `turned` have them for every node.
WEIGHT = Port("weight", change=0.5, materials=(1.0, 0.5))
COLOR = color("color", (0.2, 0.5, 0.8), (0.8, 0.4, 0.1))
NORMAL = Port("normal", "vector3", change=(0.0, 0.6, 0.8))
ROUGHNESS = Port(
    "roughness", low=LEAST_SHEEN, edges=(0.01, 0.05, 1.0), change=0.3, materials=(0.8, 0.4)
)
INDEX = Port("ior", low=0.5, high=3.0, edges=(1.0, 1.5, 3.0), change=1.6, materials=(1.5, 1.2))
MICROFACETS = (
    Port(
        "roughness",
        "vector2",
        LEAST_ALPHA,
        1.0,
        (1e-4, 0.01, 1.0),
        (0.3, 0.3),
        logarithmic=True,
        equal=True,
        materials=((0.8, 0.8), (0.4, 0.4)),
    ),
    Port("retroreflective", "boolean", change=True),
    Port("thinfilm_thickness", high=1000.0, edges=(0.0, 1.0, 100.0), change=400.0),
    Port("thinfilm_ior", low=1.0, high=2.5, edges=(1.0, 1.5), change=2.0, needs=FILM),
    NORMAL,
    Port("tangent", "vector3", change=(0.6, 0.8, 0.0), needs={"roughness": (0.1, 0.4)}),
)
# The inputs of each node, by category, but those that select a mode.
PORTS: dict[str, tuple[Port, ...]] = {
    "burley_diffuse_bsdf": (WEIGHT, COLOR, ROUGHNESS, NORMAL),
    "translucent_bsdf": (WEIGHT, COLOR, NORMAL),
    "sheen_bsdf": (WEIGHT, COLOR, ROUGHNESS, NORMAL),
    "subsurface_bsdf": (WEIGHT, COLOR, Port("radius", "color3", high=2.0), NORMAL),
    "dielectric_bsdf": (
        WEIGHT,
        color("tint", (0.2, 0.5, 0.8), (0.9, 0.6, 0.3)),
        INDEX,
        *MICROFACETS,
    ),
    "conductor_bsdf": (
        WEIGHT,
        replace(
            INDEX,
            kind="color3",
            change=(0.9, 1.1, 1.6),
            materials=((0.2, 0.9, 1.1), (1.5, 0.6, 2.0)),
        ),
        Port(
            "extinction",
            "color3",
            0.2,
            6.0,
            (0.2, 3.0),
            (0.9, 2.1, 3.6),
            materials=((3.9, 2.5, 1.8), (0.5, 1.0, 4.0)),
        ),
        *MICROFACETS,
    ),
    "generalized_schlick_bsdf": (
        WEIGHT,
        color("color0", (0.1, 0.4, 0.9), (0.8, 0.5, 0.2)),
        color("color82", (0.5, 0.7, 0.8), (1.0, 1.0, 1.0)),
        color("color90", (0.9, 0.8, 0.6), (1.0, 1.0, 1.0)),
        Port("exponent", low=1.0, high=8.0, edges=(1.0, 5.0), change=2.5, materials=(5.0, 3.0)),
        *MICROFACETS,
    ),
}


@dataclass(frozen=True)
class BsdfSubject(RowSubject[Scattering]):
    """A mode of a node of `mxeon.models.nodes`."""

    row: PbrNode

    @property
    def title(self) -> str:
        words = [f"{name} {value}" for name, value in self.row.fixed.items()]
        return ", ".join([self.row.category, *words])

    @property
    def ports(self) -> tuple[Port, ...]:
        return PORTS[self.node]

    @property
    def drawn(self) -> tuple[Port, ...]:
        ports = {port.name: port for port in self.ports}
        return tuple(ports[name] for name in self.row.inputs)

    @property
    def materials(self) -> tuple[Values, ...]:
        return materials((WEIGHT, *self.drawn))

    @property
    def kind(self) -> str:
        if self.anisotropic:
            return kinds.SCHLICK if "color82" in self.row.inputs else kinds.MICROFACET
        if self.row.fitted:
            return kinds.FITTED
        return kinds.SHEEN if self.row.category == "sheen_bsdf" else kinds.CLOSED

    @property
    def black(self) -> Values:
        return {name: (0.0, 0.0, 0.0) for name in BLACK_INPUTS if name in self.row.inputs}

    @property
    def anisotropic(self) -> bool:
        """Whether the roughness has a direction."""
        return any(port.name == "roughness" and port.kind == "vector2" for port in self.ports)

    @property
    def types(self) -> dict[str, str]:
        return {**input_types(self.node), **{port.name: port.kind for port in self.ports}}

    def document(self, inputs: Values | None = None) -> str:
        values = {**(inputs or {}), **self.row.fixed}
        return material_text(self.node, values, self.node, self.types)

    def values(self, function: Scattering, batch: Batch) -> Array:
        """pi f |cos(theta_i)| with weight and occlusion, (N, 3); 0 on the other side."""
        side = np.where(batch.wi[:, 2:] < 0.0, -1.0, 1.0) * (-1.0 if self.row.transmits else 1.0)
        wi = batch.wi * np.concatenate([np.ones((len(side), 2)), side], axis=1)
        occlusion = np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
        factor = batch.strength * (1.0 if self.row.transmits else occlusion)
        lit = np.where(side < 0.0, 0.0, np.clip(np.abs(wi[:, 2:]), 0.0, 1.0))
        return np.asarray(np.pi * function(batch.wo, wi, broadcast_inputs(batch)) * lit * factor)

    def albedo(self, batch: Batch) -> Array:
        return _albedo(self.row.albedo, batch)

    def integral(self, batch: Batch) -> Array:
        """Integral of the values with weight, (N, 3)."""
        return _albedo(self.row.integral or self.row.albedo, batch)

    def sky(self, batch: Batch) -> Array:
        """Mean of the uneven sky that it scatters, (N, 3): of the side from which light comes."""
        return sky(-batch.normal if self.row.transmits else batch.normal)

    @property
    def others(self) -> tuple[Candidate, ...]:
        """A lobe that transmits, taken for one that reflects; and zero."""
        if not self.row.transmits:
            return (ZERO,)
        opaque = replace(self, row=replace(self.row, transmits=False))

        def mirrored(wo: Array, wi: Array, inputs: Inputs) -> Array:
            return self.row.value(wo, wi * [1.0, 1.0, -1.0], inputs)

        def reflection(batch: Batch) -> Array:
            return opaque.values(mirrored, batch.altered(occlusion=1.0))  # light through the base

        return Candidate("a reflection instead", reflection), ZERO

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        """The row's own albedo, and its variants."""
        own = Candidate(self.row.title, self.albedo)
        variants = (
            Candidate(each.title, partial(_albedo, each.albedo), each.permitted)
            for each in self.row.variants
            if each.albedo
        )
        return (own, *variants, ZERO)


def _albedo(albedo: Callable[[Array, Inputs], Array], batch: Batch) -> Array:
    """A directional albedo with weight, (N, 3)."""
    return batch.strength * albedo(batch.wo, broadcast_inputs(batch))


BSDFS = tuple(BsdfSubject(row) for row in pbrlib.NODES)
