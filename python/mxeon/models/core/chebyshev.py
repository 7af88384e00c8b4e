# SPDX-License-Identifier: Apache-2.0
"""Interpolation by Chebyshev polynomials on [0, 1]: nodes, coefficients and evaluation."""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array, array_namespace


def chebyshev_nodes(count: int) -> Array:
    """Interpolation nodes in (0, 1) for the polynomial of degree `count` - 1."""
    return 0.5 + 0.5 * np.cos(_angles(count))


def chebyshev_coefficients(values: Array) -> Array:
    """Coefficients, in the shape of `values`, for values at `chebyshev_nodes` on axis 0."""
    count = len(values)
    cosines = np.cos(np.outer(np.arange(count), _angles(count)))
    cosines[0] *= 0.5
    return np.asarray(2.0 / count * np.einsum("kn,n...->k...", cosines, values))


def chebyshev_polynomials(x: Array, count: int) -> Array:
    """Chebyshev polynomials T_0 to T_(count - 1) at 2 x - 1, shape (count, ...)."""
    y = 2.0 * x - 1.0
    rows = [0.0 * y + 1.0, y]
    while len(rows) < count:
        rows.append(2.0 * y * rows[-1] - rows[-2])
    return array_namespace(x).stack(rows[:count])


def chebyshev_sum(coefficients: Array, x: Array) -> Array:
    """Chebyshev series at 2 x - 1, by Clenshaw's rule. `coefficients` has shape (count, ...)."""
    y = 2.0 * x - 1.0
    twice = 2.0 * y
    last = later = 0.0 * y
    for k in range(len(coefficients) - 1, 0, -1):
        last, later = twice * last + (coefficients[k] - later), last
    total: Array = y * last - later + coefficients[0]
    return total


def _angles(count: int) -> Array:
    return np.asarray(np.pi * (np.arange(count) + 0.5) / count)
