# SPDX-License-Identifier: Apache-2.0
"""Directional albedo of GGX microfacets that reflect everything: E_ss of the specification."""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import arcsine, trimmed
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import NUMPY, any_array, array_namespace, like
from mxeon.models.microfacet.ggx_formulas import smith_lambda

# Gauss-Legendre nodes per panel, panels between wo and the normal, and elements per block.
NODES, PANELS, BLOCK = 28, 3, 2**10
RULE = np.polynomial.legendre.leggauss(NODES)

# Least scale of the nodes and least elevation of wo, in radian: nothing changes by more than 1e-10.
LEAST_SCALE, LEAST_ELEVATION = 1e-8, 1e-200
LEAST_SQUARED = 1e-15  # of arrays whose derivatives square it, which float32 holds

ALIKE = 2.0**44  # by this part of themselves, cosines that count as one may differ

# Cosines nearer to 1 take the line through two others; its error is below the square of this.
ALONG = 1e-8

# Below this alpha, E_ss(mu, alpha) counts as E_ss(mu LEAST_ALPHA / alpha, LEAST_ALPHA).
LEAST_ALPHA = 1e-9


@any_array
def ggx_albedo_dir(mu: ArrayLike, alpha: ArrayLike) -> Array:
    """Directional albedo E_ss of isotropic GGX at unit Fresnel reflectance, by quadrature.

        E_ss(mu) = integral of D G2 / (4 mu mu_i) mu_i over the hemisphere of wi

    - `mu`: Cosine of the polar angle, in [0, 1].
    - `alpha`: GGX roughness, in [0, 1]: the input `roughness` of the nodes, of
      anisotropic ones sqrt(alpha_x alpha_y).

    Result: in [1 - log(2), 1] up to 1e-10. Accuracy: absolute error below 1e-10 for alpha >= 1e-4
    and every mu, 2e-8 below. At alpha 0, the mirror, it is 1, the limit at every mu > 0. Form: with
    u = |wo + wi|^2 = a + b cos(phi) and h_z^2 = (mu + mu_i)^2 / u, the azimuth integral of (u /
    (u - k))^2, k = (1 - alpha^2) (mu + mu_i)^2, is elementary. In half sums and half differences of
    the elevations all its terms are products of sums of positive numbers. The integral over the
    elevation of wi is split at wo and graded by hyperbolic sines. Raises `ValueError` if an
    argument leaves its range. [MaterialX2026], Energy Compensation.

        >>> ggx_albedo_dir([1.0, 0.1], [1.0, 0.01]).round(9)
        array([0.30685282, 0.99412395])
    """
    return _in_blocks(checked("mu", mu), checked("alpha", alpha))[()]


def albedo(mu: Array, alpha: Array) -> Array:
    """E_ss on valid float64 arrays; cosines that are alike, as those of pictures, count once.

    Those of a picture's symmetric points differ in their last bits, which E_ss changes by as little.
    """
    if array_namespace(mu, alpha) is NUMPY and alpha.size == 1 < mu.size:
        mantissa, exponent = np.frexp(mu)
        alike = np.ldexp(np.round(mantissa * ALIKE), exponent) / ALIKE
        each, indices = np.unique(alike, return_inverse=True)
        found: Array = _in_blocks(each, alpha.reshape(1))[indices]
        return found.reshape(np.broadcast_shapes(mu.shape, alpha.shape))
    return _in_blocks(mu, alpha)


def _in_blocks(mu: Array, alpha: Array) -> Array:
    """E_ss on valid float64 arrays, block by block."""
    numbers = {"mu": mu, "alpha": alpha}
    formula = quadrature if array_namespace(mu, alpha) is NUMPY else _extrapolated
    return evaluate_material(
        lambda mu, alpha: formula(mu, alpha)[np.newaxis], {}, numbers, 1, BLOCK
    )[..., 0]


def _extrapolated(mu: Array, alpha: Array) -> Array:
    """`quadrature`, along the normal by a line through two cosines, for derivatives.

    It is smooth in the cosine, but made of elevations, which have no derivative there.
    """
    xp = array_namespace(mu, alpha)
    step = xp.where(mu > 1.0 - ALONG, ALONG, 0.0)
    near, far = quadrature(xp.stack([mu - step, mu - 2.0 * step]), alpha)
    total: Array = 2.0 * near - far
    return total


def quadrature(mu: Array, alpha: Array, refined: int = 1) -> Array:
    """E_ss by quadrature, with so many panels for each one."""
    xp = array_namespace(mu, alpha)
    rough = xp.maximum(alpha, LEAST_ALPHA)
    least, lowest = (1e-300, LEAST_ELEVATION) if xp is NUMPY else (LEAST_SQUARED, LEAST_SQUARED)
    scaled = xp.minimum(mu * (rough / xp.maximum(alpha, least)), 1.0)
    elevation = xp.maximum(arcsine(scaled), lowest)
    graded = 2.0 * xp.minimum(rough, xp.maximum(elevation, LEAST_SCALE))
    total = like(np.zeros(np.broadcast_shapes(tuple(mu.shape), tuple(rough.shape))), rough)
    # From wo to the normal, from wo to half its elevation, and from there to the horizon.
    for d, weight in _graded(graded, 0.5 * np.pi - elevation, refined * PANELS):
        total = total + xp.sum(weight * _density(elevation, elevation + d, -d, rough), axis=0)
    for d, weight in _graded(2.0 * rough, 0.5 * elevation, refined):
        total = total + xp.sum(weight * _density(elevation, elevation - d, d, rough), axis=0)
    for e, weight in _graded(rough, 0.5 * elevation, refined):
        total = total + xp.sum(weight * _density(elevation, e, elevation - e, rough), axis=0)
    return xp.where(alpha > 0.0, trimmed(total, 1.0), 1.0)


def _graded(scale: Array, length: Array, panels: int) -> list[tuple[Array, Array]]:
    """Nodes and weights on [0, length], denser towards 0 from `scale` on, axis of nodes first."""
    xp, ratio = array_namespace(scale, length), length / scale
    x, weight = (like(v.reshape(-1, *(1,) * ratio.ndim), ratio) for v in RULE)
    extent = xp.asinh(ratio)
    step = extent / panels
    y = [step * (k + 0.5 + 0.5 * x) for k in range(panels)]
    return [(scale * xp.sinh(v), 0.5 * weight * step * scale * xp.cosh(v)) for v in y]


def _density(e_o: Array, e_i: Array, d: Array, alpha: Array) -> Array:
    """Integrand of E_ss over the elevation e_i of wi, d = e_o - e_i.

    alpha^2 mu_i cos(e_i) (1 + 2 k/q + k^2 p/q^3) / (lambda_o mu_i + lambda_i mu_o),
    k/q = (1 - alpha^2) sqrt(c C / (X Y)),  p/q = (r + 1/r) / 2,  r = sqrt(c X / (C Y)),
    X = S_d + alpha^2 C,  Y = S + alpha^2 c;  C, S_d, c, S: squared cosines and sines of half
    the difference and half the sum of the polar angles;  p = a - k,  q^2 = p^2 - b^2
    """
    xp, alpha2 = array_namespace(e_o, alpha), alpha * alpha
    sin_d, cos_d = xp.sin(0.5 * d), xp.cos(0.5 * d)
    half = 0.5 * (e_o + e_i)
    sin_s, cos_s = xp.cos(half), xp.sin(half)
    X = xp.sqrt(sin_d * sin_d + alpha2 * cos_d * cos_d)
    Y = xp.sqrt(sin_s * sin_s + alpha2 * cos_s * cos_s)
    kq = (1.0 - alpha) * (1.0 + alpha) * cos_s * cos_d / (X * Y)
    r = cos_s * X / (cos_d * Y)
    azimuth = 1.0 + kq * (2.0 + 0.5 * kq * (r + 1.0 / r))
    mu_o, mu_i = xp.sin(e_o), xp.sin(e_i)
    smith = smith_lambda(mu_o, alpha) * mu_i + smith_lambda(mu_i, alpha) * mu_o
    density: Array = alpha2 * mu_i * xp.cos(e_i) * azimuth / smith
    return density
