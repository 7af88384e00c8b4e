# SPDX-License-Identifier: Apache-2.0
"""Light that surfaces emit towards the viewer, as operations of a graph."""

from __future__ import annotations

from functools import partial

import numpy as np

from mxeon.conformance.reference.operations import Operation, Values
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.errors import OutsideModel
from mxeon.models.nodes.emissions import BASE, Emission
from mxeon.models.nodes.emissions import EMISSIONS as ROWS

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
    return {row.category: (_ports(row), partial(_radiance, row, points)) for row in ROWS}
