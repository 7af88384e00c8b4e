# SPDX-License-Identifier: Apache-2.0
"""Types of arrays in the signatures of the models."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Array", "ArrayLike", "Numbers"]

# Results: float64. A function of numbers alone returns NumPy's scalar, which behaves as one.
Array: TypeAlias = NDArray[np.float64]

# Arguments after validation, in the precision in which they came.
Numbers: TypeAlias = NDArray[Any]
