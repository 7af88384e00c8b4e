# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's EDF nodes and of the nodes that combine EDFs.

Inputs have the names of the node's ports. Inputs of nodes that combine emissions, and the color
that `generalized_schlick_edf` scales, are named by their paths in the graph. If the emission that a
Schlick curve scales is already evaluated, the input `base` has the radiance (N, 3) of that
emission.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from mxeon.models import media
from mxeon.models.core.arrays import Array
from mxeon.models.nodes.node import Inputs, Node, Variant, linear_nodes

BASE = "base/color"  # color of the uniform emission that a Schlick curve scales
FIRST, SECOND = "first/color", "second/color"  # colors of two uniform emissions
AMOUNT, FACTOR = "emission/mix", "emission/in2"  # weight and factor of the first emission
Value = Callable[[Array, Inputs], Array]


@dataclass(frozen=True)
class Emission(Node[Value]):
    """An EDF node. `value` is the radiance toward `wo`; a `wo` below the horizon sees the back."""


def front_only(value: Value) -> Value:
    """The emission `value`, limited to the front of the surface."""
    return lambda wo, inputs: np.where(wo[:, 2:] < 0.0, 0.0, value(wo, inputs))


def _radiance(inputs: Inputs) -> Array:
    """Radiance that a Schlick curve scales: the input `base` if present, or else a uniform color."""
    return inputs["base"] if "base" in inputs else inputs[BASE]


def _schlick(wo: Array, inputs: Inputs) -> Array:
    curve = inputs["color0"], inputs["color90"], inputs["exponent"]
    return media.generalized_schlick_edf(wo, _radiance(inputs), *curve)


def _uniform(wo: Array, inputs: Inputs) -> Array:
    return media.uniform_edf(wo, inputs["color"])


def _halves(wo: Array, inputs: Inputs) -> Array:
    """Conical emission if the angle inputs are taken as half angles, measured from the axis."""
    names = "inner_angle", "outer_angle"
    angles = (np.minimum(2.0 * np.asarray(inputs[name]), 360.0) for name in names)
    return media.conical_edf(wo, inputs["color"], *angles)


ONE_SIDE = "emission from the front alone"
EMISSIONS = (
    Emission(
        "uniform",
        "uniform emission",
        "uniform_edf",
        ("color",),
        _uniform,
        variants=(
            Variant(ONE_SIDE, front_only(_uniform), permitted=True),
            Variant("the color as an exitance, over pi", lambda wo, i: _uniform(wo, i) / np.pi),
        ),
    ),
    Emission(
        "conical",
        "conical emission",
        "conical_edf",
        ("color", "inner_angle", "outer_angle"),
        lambda wo, i: media.conical_edf(wo, i["color"], i["inner_angle"], i["outer_angle"]),
        variants=(
            Variant("a cone whose angles count from its axis", _halves),
            Variant("uniform emission from the front", front_only(_uniform)),
        ),
    ),
    Emission(
        "schlick_emission",
        "generalized Schlick emission",
        "generalized_schlick_edf",
        ("color0", "color90", "exponent", BASE),
        _schlick,
        variants=(
            Variant(ONE_SIDE, front_only(_schlick), permitted=True),
            Variant("the base without its curve", lambda wo, i: _radiance(i)),
            Variant(
                "the curve with exponent 5",
                lambda wo, i: _schlick(wo, {**i, "exponent": np.full(len(wo), 5.0)}),
            ),
        ),
    ),
)


def _combined(color: Callable[[Inputs], Array], wo: Array, inputs: Inputs) -> Array:
    return media.uniform_edf(wo, color(inputs))


COMBINED_EMISSIONS = tuple(
    Emission(name, title, category, inputs, partial(_combined, color))
    for name, title, category, inputs, color in linear_nodes(
        "emission",
        "an emission",
        "emissions",
        "a sum of emissions",
        (FIRST, SECOND, AMOUNT, FACTOR),
    )
)
