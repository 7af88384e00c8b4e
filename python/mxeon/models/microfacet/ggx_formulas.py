# SPDX-License-Identifier: Apache-2.0
"""GGX microfacets on valid float64 arrays: distribution, masking and shadowing.

Directions and pairs have their components on the first axis; sections are those of
[MaterialX2026], Microfacet Model.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.edges import at_most, hypot, least_normal, root
from mxeon.models.core.namespaces import array_namespace

# Sums of cosines below count as 0: D alone is at most 1e162.
LEAST = 1e-140


def ndf(wh: Array, roughness: Array) -> Array:
    """D: GGX Normal Distribution Function; no division by alpha; 0 where an alpha is 0.

    Printed, with a = alpha_x alpha_y and B = (h_x / alpha_x)^2 + (h_y / alpha_y)^2 + h_z^2: D = 1 / (pi a B^2).
    a^2 B = (alpha_y h_x)^2 + (alpha_x h_y)^2 + (a h_z)^2 has no quotient, and D = a^3 / (pi (a^2 B)^2).
    """
    xp = array_namespace(wh, roughness)
    (alpha_x, alpha_y), (x, y, z) = roughness, wh
    area = alpha_x * alpha_y
    squared = (alpha_y * x) ** 2 + (alpha_x * y) ** 2 + (area * z) ** 2
    # Squares of alpha below 1e-100 underflow: such a surface is a mirror.
    positive = squared > 0.0
    scale = area / xp.where(positive, squared, 1.0)
    return xp.where(positive, area * scale * scale / np.pi, 0.0)


def smith_lambda(mu: Array, alpha: Array) -> Array:
    """lambda(cos theta): Height-Correlated Smith Masking-Shadowing."""
    return root(alpha * alpha + (1.0 - alpha) * (1.0 + alpha) * mu * mu)


def mean_alpha(roughness: Array) -> Array:
    """alpha = sqrt(alpha_x alpha_y): Height-Correlated Smith Masking-Shadowing."""
    return root(roughness[0]) * root(roughness[1])


def visibility(mu_o: Array, mu_i: Array, alpha: Array) -> Array:
    """G2 / (4 mu_o mu_i) = 1 / (2 (lambda_o mu_i + lambda_i mu_o)), since G2 = 2 mu_o mu_i over that bracket.

    There is no limit where both directions graze: 0 there.
    """
    return reciprocal(2.0 * (smith_lambda(mu_o, alpha) * mu_i + smith_lambda(mu_i, alpha) * mu_o))


def stretched_length(w: Array, roughness: Array) -> Array:
    """Length of (alpha_x x, alpha_y y, z)."""
    return hypot(hypot(roughness[0] * w[0], roughness[1] * w[1]), w[2])


def visibility_anisotropic(wo: Array, wi: Array, roughness: Array) -> Array:
    """G2 / (4 mu_o mu_i) of [Heitz2014], Eqs. (86) and (99): mu Lambda from stretched lengths."""
    length_o, length_i = stretched_length(wo, roughness), stretched_length(wi, roughness)
    return reciprocal(2.0 * (length_o * wi[2] + length_i * wo[2]))


def half_vector(wo: Array, wi: Array) -> tuple[Array, Array]:
    """Unit half vector, and its cosine with either direction; (0, 0, 1) of opposite directions."""
    xp = array_namespace(wo, wi)
    total = wo + wi
    size = root(xp.sum(total * total, axis=0))
    opposite = size == 0.0
    wh = total / xp.where(opposite, 1.0, size)
    z = xp.where(opposite, 1.0, wh[2])
    return xp.stack([wh[0], wh[1], z]), at_most(0.5 * size, 1.0)


def reciprocal(x: Array) -> Array:
    """1 / x, and 0 where x is so small that a product with D could overflow."""
    xp = array_namespace(x)
    large = x > max(LEAST, least_normal(x))  # that of float32 is larger
    return xp.where(large, 1.0 / xp.where(large, x, 1.0), 0.0)
