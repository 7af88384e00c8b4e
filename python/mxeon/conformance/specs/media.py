# SPDX-License-Identifier: Apache-2.0
"""The VDF nodes: a medium below a surface that lets light through."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from mxeon.conformance.engine import COUNT, EXPONENTIAL, beside_rounding
from mxeon.conformance.samples import (
    SEED,
    Array,
    Batch,
    Counts,
    Values,
    directions,
    float32,
)
from mxeon.conformance.spec import (
    COMPONENTS,
    Input,
    RowSpec,
    broadcast_inputs,
    color,
    draw,
)
from mxeon.conformance.specs.emission import power_error
from mxeon.conformance.tolerance import Term, roundings, sum_of
from mxeon.hosts.base import Host
from mxeon.models.nodes.media import AMOUNT, COMBINED_MEDIA, FACTOR, MEDIA, Medium, Value
from mxeon.shaders.nodes import (
    SURFACE,
    connection_text,
    document_text,
    input_text,
    lobe_text,
    node_text,
)

# Of the exponential of a rounded sum, of a product and of the quotient of two such values.
TRANSMITTANCE = sum_of(roundings(12), unit="transmittance")
LEAST, LARGEST = 1e-3, 16.0  # coefficients, 1/m: of 1e-3 and 1 - 1e-7 of the light
LARGEST_FACTOR = 3.0  # of a multiple
INTERFACE = lobe_text(
    "dielectric_bsdf",
    {"weight": 1.0, "scatter_mode": "T"},
    "top",
    {"weight": "float", "scatter_mode": "string"},
)
SOURCES = {  # names of the media that a node takes, by its port
    "mix": {"fg": "first", "bg": "second"},
    "add": {"in1": "first", "in2": "second"},
    "multiply": {"in1": "first"},
}
PORTS = connection_text("top", "BSDF", "top") + connection_text("base", "VDF", "medium")


@dataclass(frozen=True, eq=False, kw_only=True)
class MediumSpec(RowSpec):
    """A row of `mxeon.models.nodes.media`."""

    row: Medium

    @property
    def combined(self) -> bool:
        """Whether it combines media."""
        return self.row in COMBINED_MEDIA

    def document(self, inputs: Values | None = None) -> str:
        sources = SOURCES.get(self.node, {})
        ports = {name: "" for name in ("medium", *sources.values())}
        for each in self.inputs:
            node, _, name = each.name.rpartition("/")
            value = np.full(COMPONENTS[each.type], 0.5)
            ports[node or "medium"] += input_text(name, each.type, value)
        ports["medium"] += "".join(
            connection_text(port, "VDF", name) for port, name in sources.items()
        )
        media = [
            node_text("anisotropic_vdf", "VDF", name, ports[name]) for name in sources.values()
        ]
        media.append(node_text(self.node, "VDF", "medium", ports["medium"]))
        layer = node_text("layer", "BSDF", "lobe", PORTS)
        return document_text(INTERFACE + "".join(media) + layer + SURFACE)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views, and random inputs of the node."""
        rng, count = np.random.default_rng(SEED), counts.pairs
        wo = directions(rng, count)
        return (Batch(wo, wo * [1.0, 1.0, -1.0], self.random_inputs(rng, count)),)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random coefficients, an eighth of them 0, shares and factors.

        The text gives the anisotropy of a medium no part in what passes.
        """
        inputs = draw(rng, count, self.inputs)
        for each in self.inputs:
            if each.type == "vector3":
                inputs[each.name][::8] = 0.0
        if not self.combined and len(self.inputs) > 1:
            inputs |= draw(rng, count, [Input("anisotropy", low=-0.9, high=0.9)])
        return inputs

    def values(self, function: Value, batch: Batch) -> Array:
        return np.asarray(function(broadcast_inputs(batch)))

    def engine(self, quantity: str, host: Host) -> tuple[Term, ...]:
        if quantity != "value":
            return ()
        error = 2.0 * exponential_error(host) + self.combined * 2.0 * power_error(host)
        return (Term(error, "the engine's exp() and pow(), twice"),)


@lru_cache(maxsize=16)
def exponential_error(host: Host) -> float:
    """Error of the engine's own exp(-x) for x in [0, 8], beside its rounding."""
    return beside_rounding(EXPONENTIAL.errors(host, float32(np.linspace(0.0, 8.0, COUNT))))


def _inputs(row: Medium) -> tuple[Input, ...]:
    """The inputs that its transmittance depends on, by path."""
    factor = (
        replace(color(FACTOR, edges=()), high=LARGEST_FACTOR)
        if row.name.endswith("_color3")
        else Input(FACTOR, high=LARGEST_FACTOR, change=0.3)
    )
    others = {AMOUNT: Input(AMOUNT, change=0.3), FACTOR: factor}
    # A coefficient: from one that hardly shows to one that hides nearly all.
    usual = Input("", "vector3", LEAST, LARGEST, change=(0.9, 0.1, 0.6), logarithmic=True)
    return tuple(others.get(name, replace(usual, name=name)) for name in row.inputs)


def _spec(row: Medium) -> MediumSpec:
    inputs = _inputs(row)
    scaled = f", in2 {inputs[-1].type}" if FACTOR in row.inputs else ""
    return MediumSpec(
        title=f"{row.category}, VDF{scaled}" if row in COMBINED_MEDIA else row.category,
        node=row.category,
        model=row.name,
        row=row,
        inputs=inputs,
        errors={"value": TRANSMITTANCE},
        counts=Counts(1 << 8),
        fixed={"top/weight": 0.0},
        asked=("transmission", "throughput", 1.0),
        optional=True,
    )


MEDIUM_SPECS = tuple(map(_spec, (*MEDIA, *COMBINED_MEDIA)))
