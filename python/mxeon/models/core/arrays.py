# SPDX-License-Identifier: Apache-2.0
"""Types of arrays in the signatures of the models."""

from __future__ import annotations

from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Array", "ArrayLike", "Number", "Numbers"]

# Results: float64. A function of numbers alone returns NumPy's scalar, which behaves as one.
Array: TypeAlias = NDArray[np.float64]

# An array or a number, and a result of the same kind.
Number = TypeVar("Number", Array, float)

# Arguments after validation, in the precision in which they came.
Numbers: TypeAlias = NDArray[Any]
