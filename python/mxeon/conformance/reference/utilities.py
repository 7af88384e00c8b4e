# SPDX-License-Identifier: Apache-2.0
"""Nodes of pbrlib that compute inputs of lobes, as operations of a graph."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from mxeon.conformance.reference.operations import Operation, Values
from mxeon.models.nodes.utilities import UTILITIES as ROWS
from mxeon.models.nodes.utilities import UtilityNode


def _values(row: UtilityNode, *values: Values) -> Values | Mapping[str, Values]:
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
    return outputs["out"] if set(outputs) == {"out"} else outputs


# Category -> its inputs, and the function of them; of several outputs, a value for each name.
UTILITIES: dict[str, Operation] = {
    row.category: (tuple(row.inputs), partial(_values, row)) for row in ROWS
}
