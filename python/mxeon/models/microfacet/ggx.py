# SPDX-License-Identifier: Apache-2.0
"""Distribution, masking, shadowing, roughness and the albedo E_ss of GGX microfacets.

E_ss is the albedo of facets that absorb nothing, without multiple scattering. Section names refer
to the chapter Microfacet Model of [MaterialX2026]. Functions that validate no arguments expect the
components of a vector on the first axis.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x, z >= 0; `wh` is the normal of a microfacet.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
  Functions that compute alpha take the artist's inputs `roughness`, `anisotropy` and `glossiness`
  (...), in [0, 1].

Accuracy: the relative error is below 2e-14, except for E_ss.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.

(1 - E_ss) / E_ss is the energy lost by single scattering divided by the energy reflected by single
scattering. This quotient comes from a table that is computed once. The table has Chebyshev
polynomials in sqrt(alpha) and in the cube root of s = mu (1 + alpha) / (mu + alpha), which lies in
[0, 1]. E_ss is a smooth function of sqrt(alpha) and s, except for terms like s log(s). As functions
of the cube root of s, these terms are smooth enough for polynomials.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mxeon.models.core import arguments, arrays, chebyshev
from mxeon.models.core.arguments import checked_directions, checked_roughness
from mxeon.models.core.arrays import NUMPY, Array, ArrayLike, any_array, array_namespace, like, root
from mxeon.models.core.evaluation import evaluate_number

# Where a sum of cosines is below this limit, the reciprocal of the sum is replaced by 0, because
# the reciprocal times D could overflow. D is up to 1e162.
LEAST_DIVISOR = 1e-140


def ndf(wh: Array, roughness: Array) -> Array:
    """D by the section GGX Normal Distribution Function. D is 0 at alpha 0.

    The published form is D = 1 / (pi a B^2), where a = alpha_x alpha_y and
    B = (h_x / alpha_x)^2 + (h_y / alpha_y)^2 + h_z^2. To avoid a division by alpha, D is computed
    as a^3 / (pi (a^2 B)^2), where a^2 B = (alpha_y h_x)^2 + (alpha_x h_y)^2 + (a h_z)^2.
    """
    xp = array_namespace(wh, roughness)
    (alpha_x, alpha_y), (x, y, z) = roughness, wh
    area = alpha_x * alpha_y
    squared = (alpha_y * x) ** 2 + (alpha_x * y) ** 2 + (area * z) ** 2
    # For alpha below about 1e-81, alpha^4 underflows to 0, and the surface counts as a mirror.
    positive = squared > 0.0
    scale = area / xp.where(positive, squared, 1.0)
    return xp.where(positive, area * scale * scale / np.pi, 0.0)


def smith_lambda(mu: Array, alpha: Array) -> Array:
    """lambda(cos theta) by the section Height-Correlated Smith Masking-Shadowing."""
    return root(alpha * alpha + (1.0 - alpha) * (1.0 + alpha) * mu * mu)


def mean_alpha(roughness: Array) -> Array:
    """alpha = sqrt(alpha_x alpha_y), as in the June 2026 specification and MaterialX's shaders."""
    return root(roughness[0]) * root(roughness[1])


def visibility(mu_o: Array, mu_i: Array, alpha: Array) -> Array:
    """G2 / (4 mu_o mu_i) = 1 / (2 (lambda_o mu_i + lambda_i mu_o)); 0 if both directions graze."""
    return reciprocal(2.0 * (smith_lambda(mu_o, alpha) * mu_i + smith_lambda(mu_i, alpha) * mu_o))


def stretched_length(w: Array, roughness: Array) -> Array:
    """Length of (alpha_x x, alpha_y y, z)."""
    return arrays.hypot(arrays.hypot(roughness[0] * w[0], roughness[1] * w[1]), w[2])


def visibility_anisotropic(wo: Array, wi: Array, roughness: Array) -> Array:
    """G2 / (4 mu_o mu_i) of anisotropic GGX: [Heitz2014], Eqs. (86) and (99)."""
    length_o, length_i = stretched_length(wo, roughness), stretched_length(wi, roughness)
    return reciprocal(2.0 * (length_o * wi[2] + length_i * wo[2]))


def half_vector(wo: Array, wi: Array) -> tuple[Array, Array]:
    """Unit half vector wh and the cosine wo . wh = wi . wh; wh is +z if wo and wi are opposite."""
    xp = array_namespace(wo, wi)
    total = wo + wi
    size = root(xp.sum(total * total, axis=0))
    opposite = size == 0.0
    wh = total / xp.where(opposite, 1.0, size)
    z = xp.where(opposite, 1.0, wh[2])
    return xp.stack([wh[0], wh[1], z]), arrays.at_most(0.5 * size, 1.0)


def reciprocal(x: Array) -> Array:
    """1 / x, or 0 if x is so small that a product with D could overflow."""
    xp = array_namespace(x)
    # In float32, LEAST_DIVISOR is 0, so the smallest normal number is the limit.
    large = x > max(LEAST_DIVISOR, arrays.least_normal(x))
    return xp.where(large, 1.0 / xp.where(large, x, 1.0), 0.0)


@any_array
def smith_g1(wo: ArrayLike, roughness: ArrayLike) -> Array:
    """Masking function G1 of anisotropic GGX: the fraction of the microfacets that is visible.

        G1 = 2 mu_o / (mu_o + |(alpha_x x, alpha_y y, z)|)

    Result (...): in [0, 1]. G1 is 0 if wo grazes the surface, but 1 for any wo if alpha is 0.
    [Heitz2014], Eqs. (43), (86).

        >>> smith_g1([0.6, 0.0, 0.8], [[0.5, 0.25], [0.0, 0.0]]).round(6)
        array([0.967118, 1.      ])
    """
    vectors = {"wo": checked_directions("wo", wo), "roughness": checked_roughness(roughness)}

    def value(wo: Array, roughness: Array) -> Array:
        length = stretched_length(wo, roughness)
        masking = 2.0 * wo[2] * reciprocal(wo[2] + length)
        return array_namespace(wo).where(length > 0.0, masking, 1.0)

    return evaluate_number(value, vectors, {})


@any_array
def smith_g2(mu_o: ArrayLike, mu_i: ArrayLike, alpha: ArrayLike) -> Array:
    """Height-correlated Smith masking-shadowing function G2 of isotropic GGX.

        G2 = 2 mu_o mu_i / (lambda_o mu_i + lambda_i mu_o),
        lambda = sqrt(alpha^2 + (1 - alpha^2) mu^2)

    - `mu_o`, `mu_i`: Cosines of the polar angles, in [0, 1].
    - `alpha`: GGX roughness, in [0, 1]. The specification of June 2026 uses sqrt(alpha_x alpha_y)
      for anisotropic surfaces.

    G2 is 0 if mu_o or mu_i is 0. [MaterialX2026], section Height-Correlated Smith
    Masking-Shadowing.

        >>> smith_g2(0.8, [0.6, 0.0], 0.5).round(6)
        array([0.881115, 0.      ])
    """
    numbers = arguments.checked_all({"mu_o": mu_o, "mu_i": mu_i, "alpha": alpha})
    return evaluate_number(
        lambda mu_o, mu_i, alpha: 4.0 * mu_o * mu_i * visibility(mu_o, mu_i, alpha), {}, numbers
    )


@any_array
def smith_g2_anisotropic(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Height-correlated Smith masking-shadowing function G2 of anisotropic GGX.

        G2 = 2 mu_o mu_i / (l_o mu_i + l_i mu_o),  l = |(alpha_x x, alpha_y y, z)|

    Result (...): in [0, 1]; 0 if wo or wi grazes the surface. The specification has used this
    equation since July 2026 (pull request 3015 of MaterialX). For alpha_x = alpha_y, the result
    equals `smith_g2`. [Heitz2014], Eqs. (86), (99).

        >>> smith_g2_anisotropic([0.6, 0.0, 0.8], [[0.0, 0.8, 0.6], [1.0, 0.0, 0.0]], [0.5, 0.25]).round(6)
        array([0.942466, 0.      ])
    """
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    return evaluate_number(
        lambda wo, wi, roughness: 4.0 * wo[2] * wi[2] * visibility_anisotropic(wo, wi, roughness),
        vectors | {"roughness": checked_roughness(roughness)},
        {},
    )


# Largest anisotropy, because anisotropy 1 would lead to a division by 0.
LARGEST_ANISOTROPY = 0.98


@any_array
def roughness_anisotropy(roughness: ArrayLike, anisotropy: ArrayLike) -> Array:
    """Pair of alphas (..., 2) from a roughness and an anisotropy along the tangent.

        alpha_x = min(roughness^2 / aspect, 1),  alpha_y = roughness^2 aspect,
        aspect = sqrt(1 - min(anisotropy, 0.98))

    The specification has no equation for this node. The aspect is from MaterialX's implementations.
    Burley's aspect multiplies the anisotropy by 0.9. [MaterialX2026], section roughness_anisotropy;
    [Burley2012], Section 5.4.

        >>> roughness_anisotropy(0.5, [0.0, 0.75])
        array([[0.25 , 0.25 ],
               [0.5  , 0.125]])
    """
    r, a = arguments.checked_numbers(roughness=roughness, anisotropy=anisotropy)
    xp = array_namespace(r, a)
    aspect = xp.sqrt(1.0 - arrays.at_most(a, LARGEST_ANISOTROPY))
    return xp.stack([arrays.at_most(r * r / aspect, 1.0), r * r * aspect], axis=-1)


@any_array
def roughness_dual(roughness: ArrayLike) -> Array:
    """Pair of alphas: the squares of two roughnesses.

    - `roughness` (..., 2): Roughness along the tangent and along the bitangent, in [0, 1].

    [MaterialX2026], section roughness_dual.

        >>> roughness_dual([0.5, 1.0])
        array([0.25, 1.  ])
    """
    pairs: Array = arguments.checked_pairs("roughness", roughness)
    return pairs * pairs


@any_array
def glossiness_anisotropy(glossiness: ArrayLike, anisotropy: ArrayLike) -> Array:
    """Pair of alphas of `roughness_anisotropy` for the roughness 1 - glossiness.

    [MaterialX2026], section glossiness_anisotropy.

        >>> glossiness_anisotropy(0.5, 0.75)
        array([0.5  , 0.125])
    """
    g, a = arguments.checked_numbers(glossiness=glossiness, anisotropy=anisotropy)
    return roughness_anisotropy(1.0 - g, a)


# Quadratures use PANELS panels of RULE_NODES nodes from wo to the normal.
RULE_NODES, PANELS, ALBEDO_BLOCK = 28, 3, 2**10
RULE = np.polynomial.legendre.leggauss(RULE_NODES)

# Smallest scale of the nodes near wo, and smallest elevation of wo, in radians. Both limits change
# E_ss by less than 1e-10.
LEAST_SCALE, LEAST_ELEVATION = 1e-8, 1e-200
# Lower limit of elevations and alphas for libraries that compute derivatives. Derivatives contain
# the square of the limit, which must not underflow in float32.
LEAST_SQUARED = 1e-15

# Mantissas of cosines are rounded to multiples of 1 / MANTISSA_STEPS, so that more cosines are
# equal.
MANTISSA_STEPS = 2.0**44

# Where the cosine differs from 1 by less than ALONG, E_ss is extrapolated linearly. The error is
# below ALONG^2.
ALONG = 1e-8

# For alpha below LEAST_ALPHA, E_ss(mu, alpha) is computed as
# E_ss(mu LEAST_ALPHA / alpha, LEAST_ALPHA).
LEAST_ALPHA = 1e-9


@any_array
def ggx_albedo_dir(mu: ArrayLike, alpha: ArrayLike) -> Array:
    """Directional albedo E_ss of isotropic GGX at unit Fresnel reflectance, by quadrature.

        E_ss(mu) = integral of D G2 / (4 mu mu_i) mu_i over the hemisphere of wi

    - `mu`, `alpha`: Cosine of the polar angle and GGX roughness, in [0, 1].

    Accuracy: the absolute error is below 1e-10 for alpha >= 1e-4, and below 2e-8 for smaller alpha.
    A surface with alpha 0 is a mirror, for which E_ss is 1, the limit for mu > 0.

    Let u = |wo + wi|^2 = a + b cos(phi) and k = (1 - alpha^2) (mu + mu_i)^2. Then h_z^2 = (mu +
    mu_i)^2 / u, and the integral of (u / (u - k))^2 over the azimuth phi is elementary. Written
    with half the sum and half the difference of the elevations of wo and wi, the result contains
    only sums of positive numbers. The integral over the elevation of wi is computed by quadrature.
    The quadrature is split at the elevation of wo, where the nodes are denser. [MaterialX2026],
    section Energy Compensation.

        >>> ggx_albedo_dir([1.0, 0.1], [1.0, 0.01]).round(9)
        array([0.30685282, 0.99412395])
    """
    return _in_blocks(arguments.checked("mu", mu), arguments.checked("alpha", alpha))


def albedo(mu: Array, alpha: Array) -> Array:
    """E_ss for valid float64 arrays. Cosines that are equal after rounding share one E_ss."""
    if array_namespace(mu, alpha) is NUMPY and alpha.size == 1 < mu.size:
        mantissa, exponent = np.frexp(mu)
        rounded = np.ldexp(np.round(mantissa * MANTISSA_STEPS), exponent) / MANTISSA_STEPS
        cosines, indices = np.unique(rounded, return_inverse=True)
        E_ss = _in_blocks(cosines, alpha.reshape(1))[indices]
        return np.reshape(E_ss, np.broadcast_shapes(mu.shape, alpha.shape))
    return _in_blocks(mu, alpha)


def _in_blocks(mu: Array, alpha: Array) -> Array:
    formula = quadrature if array_namespace(mu, alpha) is NUMPY else _extrapolated
    return evaluate_number(formula, {}, {"mu": mu, "alpha": alpha}, ALBEDO_BLOCK)


def _extrapolated(mu: Array, alpha: Array) -> Array:
    """E_ss by `quadrature`, extrapolated near cosine 1, where the arcsine has no derivative."""
    xp = array_namespace(mu, alpha)
    step = xp.where(mu > 1.0 - ALONG, ALONG, 0.0)
    near, far = quadrature(xp.stack([mu - step, mu - 2.0 * step]), alpha)
    total: Array = 2.0 * near - far
    return total


def quadrature(mu: Array, alpha: Array, refined: int = 1) -> Array:
    """E_ss by quadrature.

    - `refined`: Number of panels into which each panel is divided.
    """
    xp = array_namespace(mu, alpha)
    rough = xp.maximum(alpha, LEAST_ALPHA)
    least, lowest = (1e-300, LEAST_ELEVATION) if xp is NUMPY else (LEAST_SQUARED, LEAST_SQUARED)
    scaled = xp.minimum(mu * (rough / xp.maximum(alpha, least)), 1.0)
    elevation = xp.maximum(arrays.arcsine(scaled), lowest)
    graded = 2.0 * xp.minimum(rough, xp.maximum(elevation, LEAST_SCALE))
    total = like(np.zeros(np.broadcast_shapes(tuple(mu.shape), tuple(rough.shape))), rough)
    # The elevation of wi has three ranges, where e_o is the elevation of wo: from e_o up to the
    # normal, from e_o down to e_o / 2, and from the horizon up to e_o / 2.
    for d, weight in _graded(graded, 0.5 * np.pi - elevation, refined * PANELS):
        total = total + xp.sum(weight * _density(elevation, elevation + d, -d, rough), axis=0)
    for d, weight in _graded(2.0 * rough, 0.5 * elevation, refined):
        total = total + xp.sum(weight * _density(elevation, elevation - d, d, rough), axis=0)
    for e, weight in _graded(rough, 0.5 * elevation, refined):
        total = total + xp.sum(weight * _density(elevation, e, elevation - e, rough), axis=0)
    return xp.where(alpha > 0.0, arrays.trimmed(total, 1.0), 1.0)


def _graded(scale: Array, length: Array, panels: int) -> list[tuple[Array, Array]]:
    """Nodes and weights for [0, length] on the first axis.

    The spacing at x is proportional to sqrt(x^2 + scale^2).
    """
    xp, ratio = array_namespace(scale, length), length / scale
    x, weight = (like(v.reshape(-1, *(1,) * ratio.ndim), ratio) for v in RULE)
    extent = xp.asinh(ratio)
    step = extent / panels
    y = [step * (k + 0.5 + 0.5 * x) for k in range(panels)]
    return [(scale * xp.sinh(v), 0.5 * weight * step * scale * xp.cosh(v)) for v in y]


def _density(e_o: Array, e_i: Array, d: Array, alpha: Array) -> Array:
    """Integrand of E_ss at the elevations e_o of wo and e_i of wi, where d = e_o - e_i.

    C and S_d are the squared cosine and sine of half the difference of the polar angles. c and S
    are the squared cosine and sine of half the sum of the polar angles. With k, a and b as in
    `ggx_albedo_dir`, p = a - k and q^2 = p^2 - b^2, the integrand is

        alpha^2 mu_i cos(e_i) (1 + 2 k/q + k^2 p/q^3) / (lambda_o mu_i + lambda_i mu_o)
        k/q = (1 - alpha^2) sqrt(c C / (X Y)),  p/q = (r + 1/r) / 2,  r = sqrt(c X / (C Y)),
        X = S_d + alpha^2 C,  Y = S + alpha^2 c
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
    return alpha2 * mu_i * xp.cos(e_i) * azimuth / smith


# The table has NODES_S Chebyshev nodes in the cube root of s, and NODES_ALPHA nodes in the square
# root of alpha. The quadrature for the table divides each panel into REFINED panels.
NODES_S, NODES_ALPHA, REFINED, TABLE_BLOCK = 80, 28, 2, 2**12

# For at least MANY cosines and a single alpha, cubics on CELLS intervals replace the polynomials.
# The cubics differ from the polynomials by less than 3e-14. The cubics of CACHED alphas are cached.
MANY, CELLS, CACHED = 2**14, 2**12, 8


def missing_light(mu: Array, alpha: Array) -> Array:
    """(1 - E_ss) / E_ss for valid float64 arrays, which broadcast.

    Accuracy: for all mu and alpha in [0, 1], the absolute error is below 1e-10, compared with the
    quadrature of `mxeon.models.ggx_albedo_dir` with twice as many panels. Many cosines with a
    single alpha are fastest, because one set of cubics serves all cosines.
    """
    if array_namespace(mu, alpha) is NUMPY and alpha.size == 1 and mu.size >= MANY:
        return _by_cubics(mu, float(alpha.item()))
    return evaluate_number(_interpolated, {}, {"mu": mu, "alpha": alpha}, TABLE_BLOCK)


def _interpolated(mu: Array, alpha: Array) -> Array:
    """`missing_light` from the table, by polynomials in sqrt(alpha) and then in cbrt(s)."""
    xp = array_namespace(mu, alpha)
    table = _table()
    powers = chebyshev.chebyshev_polynomials(root(alpha), table.shape[1])
    if xp is NUMPY:
        rows = np.einsum("ij,j...->i...", table, powers)
    else:
        rows = xp.tensordot(like(table, powers), powers, axes=1)
    rough = alpha > 0.0
    s = mu / xp.where(rough, mu + alpha, 1.0) * (1.0 + alpha)
    value = chebyshev.chebyshev_sum(rows, arrays.power(arrays.at_most(s, 1.0), 1.0 / 3.0))
    return xp.where(rough, xp.maximum(value, 0.0), 0.0)  # a mirror loses no light


def _by_cubics(mu: Array, alpha: float) -> Array:
    """`missing_light` for a single alpha, by piecewise cubic polynomials in the cube root of s."""
    if alpha <= 0.0:
        return np.zeros(mu.shape)  # a mirror loses no light
    s = np.minimum(mu * (1.0 + alpha) / (mu + alpha), 1.0)
    place = np.cbrt(s)
    place *= CELLS
    # The index for a NaN in `place` is arbitrary, because the result is NaN.
    cell = np.fmin(place, CELLS).astype(np.int32)
    place -= cell
    *lower, highest = _cubics(alpha)
    value: Array = highest.take(cell, mode="clip")
    for coefficients in reversed(lower):
        value *= place
        value += coefficients.take(cell, mode="clip")
    return np.maximum(value, 0.0, out=value)


@lru_cache(maxsize=CACHED)
def _cubics(alpha: float) -> Array:
    """Coefficients of one cubic per interval, through four points, shape (4, CELLS + 1)."""
    powers = chebyshev.chebyshev_polynomials(np.sqrt(alpha), NODES_ALPHA)
    rows = np.einsum("ij,j->i", _table(), powers)
    x = np.sort(chebyshev.chebyshev_nodes(4))
    values = chebyshev.chebyshev_sum(rows, (np.arange(CELLS)[:, np.newaxis] + x) / CELLS)
    cubics = np.linalg.inv(np.vander(x, increasing=True)) @ values.T
    # The right end of the last interval belongs to an extra interval with a constant value.
    end = [chebyshev.chebyshev_sum(rows, np.ones(1))[0], 0.0, 0.0, 0.0]
    return np.concatenate([cubics, np.reshape(end, (4, 1))], axis=1)


@lru_cache(maxsize=1)
def _table() -> Array:
    """Chebyshev coefficients of (1 - E_ss) / E_ss, shape (NODES_S, NODES_ALPHA)."""
    alpha = chebyshev.chebyshev_nodes(NODES_ALPHA) ** 2
    s = chebyshev.chebyshev_nodes(NODES_S)[:, np.newaxis] ** 3
    E_ss = quadrature(s * alpha / (1.0 + alpha - s), alpha, REFINED)
    return chebyshev.chebyshev_coefficients(
        chebyshev.chebyshev_coefficients((1.0 - E_ss) / E_ss).T
    ).T
