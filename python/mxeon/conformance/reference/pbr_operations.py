# SPDX-License-Identifier: Apache-2.0
"""Nodes of pbrlib beside the lobes, as operations of a graph: emissions, surfaces, and what computes inputs of lobes."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from mxeon.conformance.reference.operations import Operation, Values, same
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.errors import OutsideModel
from mxeon.models.nodes import utilities
from mxeon.models.nodes.emissions import BASE, EMISSIONS, Emission

COLORS = ("color", "color0", "color90", "base")


def _radiance(row: Emission, points: ShadingPoints, *values: Values) -> Values:
    wo = points.view
    inputs = {
        name: np.broadcast_to(value, wo.shape)
        if name in COLORS
        else np.broadcast_to(np.ravel(value), len(wo))
        for name, value in zip(_ports(row), values, strict=True)
    }
    try:
        return row.value(wo, inputs)
    except ValueError as error:
        raise OutsideModel(f"reference: node {row.category!r}: {error}") from None


def _ports(row: Emission) -> tuple[str, ...]:
    return tuple("base" if name == BASE else name for name in row.inputs)


def emissions(points: ShadingPoints) -> dict[str, Operation]:
    """Category -> its inputs, and the radiance at points by them."""
    return {row.category: (_ports(row), partial(_radiance, row, points)) for row in EMISSIONS}


def _values(row: utilities.UtilityNode, *values: Values) -> Values | Mapping[str, Values]:
    """The one output of a node, or all by name, from values as `operations` has them."""
    columns = [
        np.atleast_2d(np.asarray(value, np.float64).reshape(-1, np.size(default)))
        for value, default in zip(values, row.inputs.values(), strict=True)
    ]
    count = max(map(len, columns))
    inputs = {
        name: np.broadcast_to(column, (count, column.shape[1]))
        for name, column in zip(row.inputs, columns, strict=True)
    }
    numbers = {name: each[:, 0] if each.shape[1] == 1 else each for name, each in inputs.items()}
    outputs = row.value(numbers)
    return next(iter(outputs.values())) if len(outputs) == 1 else outputs


# Category -> its inputs, and the function of them; of several outputs, a value for each name.
UTILITIES: dict[str, Operation] = {
    row.category: (tuple(row.inputs), partial(_values, row)) for row in utilities.UTILITIES
}


def surfaces(emits: bool, behind: bool) -> dict[str, Operation]:
    """Category -> its inputs, and the radiance of a surface by them."""
    shown: dict[str, Operation] = {
        "surface": (("bsdf",), lambda bsdf: bsdf.value),
        "surface_unlit": (
            ("emission", "emission_color", "opacity"),
            lambda emission, color, opacity: emission * color * opacity,
        ),
        "surfacematerial": (("surfaceshader",), same),
    }
    if behind:
        shown["surface"] = (("bsdf", "opacity"), lambda bsdf, opacity: bsdf.value * opacity)
        shown["surface_unlit"] = ((), lambda: np.zeros(3))
    elif emits:
        shown["surface"] = (
            ("bsdf", "edf", "opacity"),
            lambda bsdf, edf, opacity: (bsdf.value + edf) * opacity,
        )
    return shown
