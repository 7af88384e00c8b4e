# SPDX-License-Identifier: Apache-2.0
"""The type of a tolerance, and how its number is rounded."""

import math
from dataclasses import dataclass

import numpy as np

from mxeon.conformance.samples.batch import Array
from mxeon.conformance.samples.measurement import Metric, scaled

SCALED = "pi f cos, relative above 1"
ROUNDING = 2.0**-24  # unit roundoff of float32


@dataclass(frozen=True)
class Tolerance:
    """The largest error that passes."""

    value: float
    unit: str  # unit of the error
    metric: Metric  # error of each row, for checks that compare values
    derivation: str

    def scale(self, expected: Array) -> Array:
        """Numbers that errors are divided by, which are 1 but for large scaled values, (N, 1)."""
        if self.metric is not scaled:
            return np.ones((len(expected), 1))
        largest: Array = np.abs(expected).max(axis=-1, keepdims=True)
        return np.maximum(1.0, largest)


def rounded_up(value: float) -> float:
    """The next number with one digit.

    >>> rounded_up(1.94e-6)
    2e-06
    """
    exponent = math.floor(math.log10(value))
    return float(f"{math.ceil(value / 10.0**exponent)}e{exponent}")
