# SPDX-License-Identifier: Apache-2.0
"""Clipped linearly transformed cosines, and the paper's importance sampling of EON with them.

Of the clamped cosine, CLTC keeps only what its matrix maps above the horizon, d x + z >= 0. The
rest has the shape of a lune. See `mxeon.models.sampling.ltc` for the matrix and its density.

- `wo`, `wi` (..., 3): Unit vectors on or above the horizon.
- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `roughness` (...): In [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_least_0, below_1, fractional_power, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.sampling.hemisphere import (
    around,
    checked_draw,
    checked_pdf,
    stack_xyz,
    uniform_direction,
    unpack_uniforms,
)
from mxeon.models.sampling.ltc import ltc_d, ltc_density, ltc_transformed


@any_array
def cltc_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled by the clipped transformed cosine, and its density.

    `wi` (..., 3): Unit vectors on or above the horizon. `pdf` (...): 1/sr. As a sampler of EON it
    is biased: `wh` is cut at its own horizon, so directions remain that it never draws and that EON
    reflects into. Side of the cut: the lune d x + z < 0 lies at x > 0 where d < 0, as in Listing 3,
    and at x < 0 where d > 0. The fitted d is positive for mu_o > 0.99991, and there the listing
    keeps the wrong side; this function keeps the right one. [Portsmouth2025], Eqs. (26) and (27),
    Listing 3.

        >>> wi, pdf = cltc_sample([0.6, 0.0, 0.8], [0.25, 0.5], 1.0)
        >>> bool(np.isclose(pdf, cltc_pdf([0.6, 0.0, 0.8], wi, 1.0), rtol=1e-14))
        True
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    u1, u2 = unpack_uniforms(u)
    return _draw(wo, u1, 1.0 - u1, u2, roughness)


@any_array
def cltc_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `cltc_sample` at `wi`, in solid angle.

    Result (...): 1/sr; 0 for the directions that it never draws. [Portsmouth2025], Eqs. (23), (24)
    and (27), Listing 3.

        >>> round(float(cltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
        0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    d = ltc_d(wo[..., 2], roughness)
    return ltc_density(wo, wi, roughness, d) / cltc_kept_fraction(d)


@any_array
def eon_cltc_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled by the paper's mixture of `cltc` and `uniform`, and its density.

    `wi` (..., 3): Unit vectors on or above the horizon. `pdf` (...): Of the mixture, in 1/sr.
    Listing 4 takes the uniform lobe for u1 <= P_u and divides u1 by P_u: 0/0 at roughness 0 and
    u1 = 0. Here the uniform lobe has u1 < P_u, which a zero P_u never meets. [Portsmouth2025],
    Section 4, Listing 4.

        >>> wi, pdf = eon_cltc_sample([0.0, 0.0, 1.0], [0.0, 0.0], 0.0)
        >>> wi, round(float(pdf), 6)
        (array([0., 0., 1.]), 0.31831)
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    u1, u2 = unpack_uniforms(u)
    P_u = eon_cltc_probability(wo[..., 2], roughness)
    is_uniform = u1 < P_u
    # Stretch each side of P_u over [0, 1); rounding may reach 1, which is not in there.
    xp = array_namespace(u1, P_u)
    length = xp.where(is_uniform, P_u, 1.0 - P_u)
    v = xp.where(is_uniform, u1, u1 - P_u) / length
    rest = xp.where(is_uniform, P_u - u1, 1.0 - u1) / length
    v = xp.minimum(v, below_1(v))
    clipped, _ = _draw(wo, v, rest, u2, roughness)
    wi = xp.where(is_uniform[..., np.newaxis], uniform_direction(v, rest, u2), clipped)
    return wi, eon_cltc_pdf(wo, wi, roughness)


@any_array
def eon_cltc_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `eon_cltc_sample` at `wi`, in solid angle.

    Result (...): 1/sr. [Portsmouth2025], Section 4, Listing 4.

        >>> round(float(eon_cltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
        0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    P_u = eon_cltc_probability(wo[..., 2], roughness)
    return P_u * (0.5 / np.pi) + (1.0 - P_u) * cltc_pdf(wo, wi, roughness)


# [Portsmouth2025], Listing 4: mu and roughness in [0, 1]; the paper states no error.
def eon_cltc_probability(mu: Array, roughness: Array) -> Array:
    """Probability P_u of the uniform lobe."""
    P_u = 0.162925 + (-0.372058 + (0.538233 - 0.290822 * mu) * mu) * mu
    return fractional_power(roughness, 0.1) * P_u


def cltc_kept_fraction(d: Array) -> Array:
    """Fraction of the clamped cosine above d x + z = 0: [Portsmouth2025], below Eq. (26)."""
    return 0.5 * (1.0 + 1.0 / root(1.0 + d * d))


def _cut_fraction(d: Array) -> Array:
    """1 - `cltc_kept_fraction`, which is small."""
    length = root(1.0 + d * d)
    return 0.5 * d * d / (length * (1.0 + length))


def cltc_clipped(u1: Array, u2: Array, d: Array) -> Array:
    """Direction under the clamped cosine with d x + z >= 0: [Portsmouth2025], Listing 3."""
    return _clipped(u1, 1.0 - u1, u2, d)


def _draw(wo: Array, u1: Array, rest: Array, u2: Array, roughness: Array) -> tuple[Array, Array]:
    """`cltc_sample` of two random numbers; `rest` is 1 - u1, to all of its digits."""
    d = ltc_d(wo[..., 2], roughness)
    wi, pdf = ltc_transformed(wo, _clipped(u1, rest, u2, d), roughness, d)
    # On the edge of the lune d x + z is zero up to rounding, of either sign.
    wi = stack_xyz(wi[..., 0], wi[..., 1], at_least_0(wi[..., 2]))
    return wi, pdf / cltc_kept_fraction(d)


def _clipped(u1: Array, rest: Array, u2: Array, d: Array) -> Array:
    """`cltc_clipped` where `rest` is 1 - u1.

    The chord at y has the half length c, c^2 = 1 - u1 + x^2, and x becomes c (1 - k) + k x. Then

        z^2 = 1 - x'^2 - y^2 = k (c - x) (2 c (1 - k) + k (c + x)),

    where of c - x and c + x the smaller one is (1 - u1) over the other: nothing cancels on the rim.
    """
    wh = around(root(rest), root(u1), u2)
    x, y = wh[..., 0], wh[..., 1]
    xp, kept, cut = array_namespace(x, d), cltc_kept_fraction(d), _cut_fraction(d)
    half = root(rest + x * x)
    behind = x < 0.0
    far = half + xp.where(behind, -x, x)
    near = rest / far
    ahead, back = xp.where(behind, far, near), xp.where(behind, near, far)
    z = root(kept * ahead * (2.0 * half * cut + kept * back))
    x = half * cut + x * kept
    return stack_xyz(xp.where(d > 0.0, x, -x), y, z)
