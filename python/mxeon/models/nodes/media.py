# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's VDF nodes, for one meter of a medium below a surface.

Inputs have the names of the node's ports, or of paths in the graph if a node combines two media.
The specification has no equation for combined media. Here the coefficients of the media are
combined, because a sum of transmittances would exceed 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.media import transmittance
from mxeon.models.nodes.node import Inputs, Node, Variant, column, linear_nodes

FIRST, SECOND = "first/absorption", "second/absorption"  # absorption of two media
AMOUNT, FACTOR = "medium/mix", "medium/in2"  # weight and factor of the first medium
METER = 1.0  # assumed thickness, since surface shaders define no thickness
Value = Callable[[Inputs], Array]


@dataclass(frozen=True)
class Medium(Node[Value]):
    """A VDF node, represented by the transmittance of the medium.

    - `inputs`: Inputs that affect the transmittance. Anisotropy is left out, because anisotropy
      only affects the light scattered into a ray.
    - `value`: Transmittance over one meter.
    """


def _absorbed(inputs: Inputs) -> Array:
    return transmittance(inputs["absorption"], 0.0, METER)


CLEAR = Variant[Value]("no medium at all", lambda inputs: np.ones_like(inputs["absorption"]))
MEDIA = (
    Medium(
        "absorption", "Beer's law", "absorption_vdf", ("absorption",), _absorbed, variants=(CLEAR,)
    ),
    Medium(
        "anisotropic",
        "extinction",
        "anisotropic_vdf",
        ("absorption", "scattering"),
        lambda inputs: transmittance(inputs["absorption"], inputs["scattering"], METER),
        variants=(
            Variant("absorption alone", _absorbed),
            Variant(
                "scattering alone", lambda inputs: transmittance(0.0, inputs["scattering"], METER)
            ),
            CLEAR,
        ),
    ),
)


def _combined(
    name: str, title: str, category: str, inputs: tuple[str, ...], coefficient: Value
) -> Medium:
    """Row of a node that combines two media. The coefficients of the media are combined."""

    def first(i: Inputs) -> Array:
        return transmittance(i[FIRST], 0.0, METER)

    def linear(i: Inputs) -> Array:
        share, second = column(i, AMOUNT), transmittance(i[SECOND], 0.0, METER)
        return np.asarray(share * first(i) + (1.0 - share) * second)

    def value(i: Inputs) -> Array:
        return transmittance(coefficient(i), 0.0, METER)

    mixed = (Variant("a mix of transmittances", linear),) if category == "mix" else ()
    variants = (*mixed, Variant("the first medium alone", first))
    return Medium(name, title, category, inputs, value, variants=variants)


COMBINED_MEDIA = tuple(
    _combined(*each)
    for each in linear_nodes(
        "medium", "a medium", "media", "two media", (FIRST, SECOND, AMOUNT, FACTOR)
    )
)
