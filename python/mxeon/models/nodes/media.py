# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's VDF nodes below a surface, over one meter of the medium.

Inputs go by the names of the node's ports; those of nodes that combine two media go by their paths. The
text gives no equation for the combination of media: here it is that of their coefficients. A sum of
transmittances would exceed 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.media import transmittance
from mxeon.models.nodes.node import Inputs, Node, Variant

FIRST, SECOND = "first/absorption", "second/absorption"  # of two media that absorb
AMOUNT, FACTOR = "medium/mix", "medium/in2"  # share of the first, and factor of it
METER = 1.0  # a shader of a surface knows no thickness
Value = Callable[[Inputs], Array]


@dataclass(frozen=True)
class Medium(Node[Value]):
    """A VDF node, by its transmittance.

    - `inputs`: Names of the inputs that the transmittance depends on. The anisotropy enters the
      light that is scattered into a ray alone.
    - `value`: Transmittance of METER.
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


def _column(inputs: Inputs, name: str) -> Array:
    """A number or a color of each view, (N, 1 or 3)."""
    return np.reshape(inputs[name], (len(inputs[name]), -1))


def _first(inputs: Inputs) -> Array:
    """Transmittance of the first medium."""
    return transmittance(inputs[FIRST], 0.0, METER)


def _linear(inputs: Inputs) -> Array:
    """A mix of transmittances."""
    share, second = _column(inputs, AMOUNT), transmittance(inputs[SECOND], 0.0, METER)
    return np.asarray(share * _first(inputs) + (1.0 - share) * second)


def _combined(
    name: str,
    title: str,
    category: str,
    inputs: tuple[str, ...],
    coefficient: Value,
    *others: Variant[Value],
) -> Medium:
    """Row of a node that combines media, whose result absorbs with other coefficients."""

    def value(inputs: Inputs) -> Array:
        return transmittance(coefficient(inputs), 0.0, METER)

    first = Variant("the first medium alone", _first)
    return Medium(name, title, category, inputs, value, variants=(*others, first))


def _multiple(inputs: Inputs) -> Array:
    return np.asarray(inputs[FIRST] * _column(inputs, FACTOR))


COMBINED_MEDIA = (
    _combined(
        "medium_mix",
        "a mix of media",
        "mix",
        (FIRST, SECOND, AMOUNT),
        lambda i: np.asarray(
            _column(i, AMOUNT) * i[FIRST] + (1.0 - _column(i, AMOUNT)) * i[SECOND]
        ),
        Variant("a mix of transmittances", _linear),
    ),
    _combined(
        "medium_add",
        "two media",
        "add",
        (FIRST, SECOND),
        lambda i: np.asarray(i[FIRST] + i[SECOND]),
    ),
    _combined("medium_multiply_float", "a scaled medium", "multiply", (FIRST, FACTOR), _multiple),
    _combined(
        "medium_multiply_color3",
        "a medium scaled by a color",
        "multiply",
        (FIRST, FACTOR),
        _multiple,
    ),
)
