# SPDX-License-Identifier: Apache-2.0
"""Light that the facets' own lobe misses, (1 - E_ss) / E_ss, from a table that is computed once.

E_ss changes on the scale mu = alpha. In s = mu (1 + alpha) / (mu + alpha), which is in [0, 1], it is
smooth but for terms like s log(s), and in sqrt(alpha) throughout; a cube root spreads the former over
the nodes of Chebyshev polynomials.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.chebyshev import (
    cell_cubics,
    chebyshev_coefficients,
    chebyshev_nodes,
    chebyshev_polynomials,
    chebyshev_sum,
)
from mxeon.models.core.edges import at_most, cube_root, root
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import NUMPY, array_namespace, like
from mxeon.models.microfacet.ggx_albedo import quadrature

# Nodes in the cube root of s and in the square root of alpha, panels for one of the quadrature that
# fills the table, and elements at once.
NODES_S, NODES_ALPHA, REFINED, BLOCK = 80, 28, 2, 2**12

# Cosines of one alpha from which on cubics take the place of the polynomials, the number of their cells,
# and the alphas that are kept. The cubics are within 3e-14 of the polynomials.
MANY, CELLS, KEPT = 2**14, 2**12, 8


def missing_light(mu: Array, alpha: Array) -> Array:
    """(1 - E_ss) / E_ss on valid float64 arrays, which broadcast.

    Accuracy: absolute error below 1e-10 for every mu and alpha in [0, 1], against the quadrature of
    `mxeon.albedo.ggx_albedo_dir` with twice its panels. One alpha for all cosines costs the least:
    many of them share cubics in its place.
    """
    if array_namespace(mu, alpha) is NUMPY and alpha.size == 1 and mu.size >= MANY:
        return _of_one_alpha(mu, float(alpha.item()))
    numbers = {"mu": mu, "alpha": alpha}
    return evaluate_material(
        lambda mu, alpha: _interpolated(mu, alpha)[np.newaxis], {}, numbers, 1, BLOCK
    )[..., 0]


def _interpolated(mu: Array, alpha: Array) -> Array:
    """Sum of the table's polynomials, those of alpha first."""
    xp = array_namespace(mu, alpha)
    table = _table()
    powers = chebyshev_polynomials(root(alpha), table.shape[1])
    if xp is NUMPY:
        rows = np.einsum("ij,j...->i...", table, powers)
    else:
        rows = xp.tensordot(like(table, powers), powers, axes=1)
    rough = alpha > 0.0
    s = mu / xp.where(rough, mu + alpha, 1.0) * (1.0 + alpha)
    value = chebyshev_sum(rows, cube_root(at_most(s, 1.0)))
    return xp.where(rough, xp.maximum(value, 0.0), 0.0)  # a mirror misses nothing


def _of_one_alpha(mu: Array, alpha: float) -> Array:
    """`missing_light` of one alpha, by a cubic in each cell of the cube root of s."""
    if alpha <= 0.0:
        return np.zeros(mu.shape)  # a mirror misses nothing
    s = np.minimum(mu * (1.0 + alpha) / (mu + alpha), 1.0)
    place = np.cbrt(s)
    place *= CELLS
    cell = np.fmin(place, CELLS).astype(np.int32)  # any cell for NaN, whose place keeps it
    place -= cell
    *lower, highest = _cubics(alpha)
    value: Array = highest.take(cell, mode="clip")
    for coefficients in reversed(lower):
        value *= place
        value += coefficients.take(cell, mode="clip")
    return np.maximum(value, 0.0, out=value)


@lru_cache(maxsize=KEPT)
def _cubics(alpha: float) -> Array:
    """Coefficients of the cubics through four points of each cell, shape (4, CELLS + 1)."""
    powers = chebyshev_polynomials(np.sqrt(alpha), NODES_ALPHA)
    rows = np.einsum("ij,j->i", _table(), powers)
    cubics = cell_cubics(rows, CELLS)
    # The end of the last cell is a cell of its own, of which only the beginning counts.
    end = [chebyshev_sum(rows, np.ones(1))[0], 0.0, 0.0, 0.0]
    return np.concatenate([cubics, np.reshape(end, (4, 1))], axis=1)


@lru_cache(maxsize=1)
def _table() -> Array:
    """Coefficients of both polynomials, shape (NODES_S, NODES_ALPHA)."""
    alpha = chebyshev_nodes(NODES_ALPHA) ** 2
    s = chebyshev_nodes(NODES_S)[:, np.newaxis] ** 3
    E_ss = quadrature(s * alpha / (1.0 + alpha - s), alpha, REFINED)
    return chebyshev_coefficients(chebyshev_coefficients((1.0 - E_ss) / E_ss).T).T
