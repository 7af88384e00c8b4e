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


def missing_light(mu: Array, alpha: Array) -> Array:
    """(1 - E_ss) / E_ss on valid float64 arrays, which broadcast.

    Notes
    -----
    Accuracy: absolute error below 1e-10 for every mu and alpha in [0, 1], against the quadrature of
    `mxeon.albedo.ggx_albedo_dir` with twice its panels. One alpha for all cosines costs the least.
    """
    numbers = {"mu": mu, "alpha": alpha}
    return evaluate_material(
        lambda mu, alpha: _interpolated(mu, alpha)[np.newaxis], {}, numbers, 1, BLOCK
    )[..., 0]


def _interpolated(mu: Array, alpha: Array) -> Array:
    """Sum of the table's polynomials, those of alpha first."""
    xp = array_namespace(mu, alpha)
    powers, table = chebyshev_polynomials(root(alpha), NODES_ALPHA), _table()
    if xp is NUMPY:
        rows = np.einsum("ij,j...->i...", table, powers)
    else:
        rows = xp.tensordot(like(table, powers), powers, axes=1)
    rough = alpha > 0.0
    s = mu / xp.where(rough, mu + alpha, 1.0) * (1.0 + alpha)
    value = chebyshev_sum(rows, cube_root(at_most(s, 1.0)))
    return xp.where(rough, xp.maximum(value, 0.0), 0.0)  # a mirror misses nothing


@lru_cache(maxsize=1)
def _table() -> Array:
    """Coefficients of both polynomials, shape (NODES_S, NODES_ALPHA)."""
    alpha = chebyshev_nodes(NODES_ALPHA) ** 2
    s = chebyshev_nodes(NODES_S)[:, np.newaxis] ** 3
    E_ss = quadrature(s * alpha / (1.0 + alpha - s), alpha, REFINED)
    return chebyshev_coefficients(chebyshev_coefficients((1.0 - E_ss) / E_ss).T).T
