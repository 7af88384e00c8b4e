# SPDX-License-Identifier: Apache-2.0
"""Exact importance sampling of EON: two random numbers, no table, no iteration.

On the unit disk below the hemisphere, with `wo` turned to azimuth 0, S = sqrt(1 - mu^2) and
q = r S_o, the value of EON at unit reflectance is A / pi times the sum of four parts, none of
which is ever negative:

| part     | value                                   | integral over the disk, over pi            |
|----------|-----------------------------------------|--------------------------------------------|
| lower    | q x+ (1 / mu_o - 1), where mu_i < mu_o  | (2 / (3 pi)) q (1 - mu_o) (1 - S_o^3)/mu_o |
| upper    | q x+ (1 / mu_i - 1), where mu_i >= mu_o | (2 / pi) q K(theta_o)                      |
| multiple | r H(mu_i) H(mu_o) / (c1 - c2)           | r H(mu_o)                                  |
| flat     | 1 + q x                                 | 1                                          |

with K(theta) = (theta - sin(theta) cos(theta))/2 - sin^3(theta)/3. The integrals sum to 1 + c1 r,
which is 1 / A: docs/sampling.md has the proof.

Each part is drawn by its inverse distribution. Those of `flat` and `lower` are closed forms; those
of `multiple` and `upper` depend on no parameter, and are fitted. The density returned is that of
the four parts. Directions follow it with a relative error of at most 1.3e-5 of the part: a mean of
the parts' errors under non-negative weights, so that the sum has no larger error anywhere.

- `wo`, `wi` (..., 3): Unit vectors on or above the horizon.
- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `roughness` (...): In [0, 1].
- `rho` (...): Gray reflectance for which the sampling is exact, in [0, 1]: one number for each
  direction. Three of them for three samples of one `wo` might be a color, and are refused.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_most, below_1, cube_root, fractional_power, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.diffuse.formulas import (
    C1,
    C2,
    cosines,
    eon_multiple_weight,
    fon_loss,
    fon_quotient,
)
from mxeon.models.sampling.hemisphere import (
    around,
    azimuth_frame,
    checked_draw,
    checked_pdf,
    rotate_z,
    stack_xyz,
    unpack_uniforms,
)

LEAST_COSINE = 2.0**-53  # of a sample

# Our fits, tools/fits/eon_sampling.py. Random number and fitted root of it in [0, 1]; largest relative
# error of the density 1.27e-5 and 5.7e-6.
MULTIPLE = (
    -0.1221923217,
    0.3674909842,
    -0.5228247070,
    0.4013565309,
    -0.1292139302,
    0.0102229681,
)
UPPER = (
    -0.0857788216,
    -0.0262131579,
    -0.0086607754,
    -0.0096479330,
    0.0067351199,
    -0.0065900984,
)


@any_array
def eon_sample(
    wo: ArrayLike, u: ArrayLike, roughness: ArrayLike, *, rho: ArrayLike = 1.0
) -> tuple[Array, Array]:
    """Direction sampled proportionally to EON times its cosine, and its density.

    `wi` (..., 3): Unit vectors, z >= 2^-53. `pdf` (...): `eon_pdf` of `wi`, in 1/sr. Accuracy: `wi`
    follows `pdf` with a relative error below 1.3e-5 everywhere. The weight over the density that
    `wi` really has is thus within 1.3e-5 of the albedo, relatively, and its relative variance is
    below 1.7e-10. docs/sampling.md; the model is [Portsmouth2025], Eqs. (16) and (19).

        >>> wi, pdf = eon_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.0)
        >>> wi.round(6), round(float(pdf), 6)
        (array([0.      , 0.707107, 0.707107]), 0.225079)
    """
    wo, u, roughness, rho = checked_draw(wo, u, roughness=roughness, rho=rho)
    if wo.ndim == 1 and tuple(u.shape) == (3, 2) and tuple(rho.shape) == (3,):
        raise ValueError(
            "rho of shape (3,) beside 3 samples has two meanings: write rho.mean() for a color, or "
            "repeat wo for a number for each sample"
        )
    u1, u2 = unpack_uniforms(u)
    cosine, sine, S_o = azimuth_frame(wo)
    mu_o, S_o = at_most(wo[..., 2], 1.0), at_most(S_o, 1.0)
    wi = rotate_z(eon_draw(mu_o, S_o, u1, u2, rho, roughness), cosine, sine)
    # The end of a part may reach the horizon, where the density is 0 and a weight 0/0.
    wi = stack_xyz(wi[..., 0], wi[..., 1], array_namespace(wi).maximum(wi[..., 2], LEAST_COSINE))
    return wi, _density(wo, wi, rho, roughness)


@any_array
def eon_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike, *, rho: ArrayLike = 1.0) -> Array:
    """Density of `eon_sample` at `wi`: EON times the cosine, divided by its integral.

    Result (...): 1/sr. At rho = 1 it is `eon_brdf` at reflectance 1, times the cosine of `wi`.
    Accuracy: relative error below 1e-14 of the quotient f cos(theta_i) / E(theta_o). It has a limit
    at rho = 0, where both f and E vanish; that limit is FON's. [Portsmouth2025], Eqs. (16), (19)
    and (28).

        >>> round(float(eon_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 1.0)), 6)
        0.332784
    """
    wo, wi, roughness, rho = checked_pdf(wo, wi, roughness=roughness, rho=rho)
    return _density(wo, wi, rho, roughness)


def _density(wo: Array, wi: Array, rho: Array, roughness: Array) -> Array:
    """The four parts together, with the weight of `multiple` for `rho`, over their integral."""
    return eon_density_mu(*cosines(wo, wi), rho, roughness)


def eon_density_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """Density from the cosines, and from s of `cosines`."""
    weight, loss_o = eon_multiple_weight(rho, roughness), fon_loss(mu_o)
    parts = 1.0 + roughness * fon_quotient(mu_o, mu_i, s) + weight * loss_o * fon_loss(mu_i)
    total = 1.0 + C1 * roughness + (weight * (C1 - C2) - roughness) * loss_o
    return mu_i * parts / (np.pi * total)


def eon_draw(mu_o: Array, S_o: Array, u1: Array, u2: Array, rho: Array, roughness: Array) -> Array:
    """Direction drawn from one of the four parts; `wo` has azimuth 0."""
    # Choose a part by u1, and stretch what is left of u1 over [0, 1).
    parts = eon_integrals(mu_o, S_o, rho, roughness)
    xp = array_namespace(*parts)
    ends = [parts[0]]
    for part in parts[1:]:
        ends.append(ends[-1] + part)
    ends = [end / ends[-1] for end in ends]
    starts = [0.0 * ends[0], *ends[:-1]]
    v = [stretched(u1, start, end) for start, end in zip(starts, ends, strict=True)]
    rest = xp.minimum(1.0 - u1, 1.0 - starts[3]) / (1.0 - starts[3])  # 1 - v of the flat part
    # Draw a cosine from each part, and keep the one chosen; the flat part has no cosine first.
    x = v[0] * mu_o * eon_cube_gap(mu_o, S_o)
    lower = eon_lower_cosine(x, cube_root(1.0 - x))
    upper = eon_upper_cosine(fractional_power(v[1], 0.4), mu_o, eon_upper_limit(mu_o, S_o))
    multiple = eon_multiple_cosine(cube_root(v[2]))
    mu = xp.where(u1 < ends[0], lower, xp.where(u1 < ends[1], upper, multiple))
    S = root((1.0 - mu) * (1.0 + mu))
    is_towards, is_flat = (u1 < ends[1])[..., np.newaxis], (u1 >= ends[2])[..., np.newaxis]
    wi = xp.where(is_towards, eon_towards(mu, S, u2), around(mu, S, u2))
    return xp.where(is_flat, eon_flat_draw(v[3], u2, roughness * S_o, rest), wi)


def eon_integrals(
    mu_o: Array, S_o: Array, rho: Array, roughness: Array
) -> tuple[Array, Array, Array, float]:
    """Integrals over the disk of lower, upper, multiple and flat, over pi."""
    towards = (2.0 / np.pi) * roughness * S_o
    lower = towards * (1.0 - mu_o) * eon_cube_gap(mu_o, S_o) / 3.0
    upper = towards * eon_segment(mu_o, S_o)
    multiple = (C1 - C2) * eon_multiple_weight(rho, roughness) * fon_loss(mu_o)
    return lower, upper, multiple, 1.0


def eon_cube_gap(mu: Array, S: Array) -> Array:
    """(1 - S^3) / mu, with neither a division by mu nor a cancellation."""
    return mu * (1.0 + S + S * S) / (1.0 + S)


def eon_segment(mu: Array, S: Array) -> Array:
    """K(theta), integral of sin^2 (1 - cos); near the normal its terms cancel, perhaps below 0."""
    xp = array_namespace(mu, S)
    return xp.maximum(0.5 * (xp.atan2(S, mu) - S * mu) - S**3 / 3.0, 0.0)


def stretched(u: Array, start: Array, end: Array) -> Array:
    """`u` mapped from [start, end) to [0, 1); what lies outside goes to the nearer end.

    It goes there before the division, which would overflow for the shortest intervals.
    """
    xp = array_namespace(u, start, end)
    length = xp.where(end > start, end - start, 1.0)
    inside = xp.minimum(xp.maximum(u, start), end)
    return xp.minimum((inside - start) / length, below_1(length))


def eon_towards(mu: Array, S: Array, u2: Array) -> Array:
    """Direction with cosine `mu` and sine `S` at an azimuth whose sine is uniform, towards wo."""
    return stack_xyz(2.0 * S * root(u2 * (1.0 - u2)), S * (2.0 * u2 - 1.0), mu)


def eon_lower_cosine(x: Array, S: Array) -> Array:
    """Cosine drawn in proportion to S mu below mu_o: x = 1 - S^3 is uniform."""
    return root(x * (1.0 + S) / (1.0 + S + S * S))


def eon_upper_limit(mu: Array, S: Array) -> Array:
    """y = (K / K(pi / 2))^(2/5) of the angle with this cosine and sine."""
    return fractional_power(eon_segment(mu, S) / (0.25 * np.pi - 1.0 / 3.0), 0.4)


def eon_upper_quotient(y: Array) -> Array:
    """Q(y) of `eon_upper_cosine`, 1 at y = 1."""
    a, b, c, d, e, f = UPPER
    y2 = y * y
    even, odd = a + y2 * (c + y2 * e), b + y2 * (d + y2 * f)
    return 1.0 + (1.0 - y) * (even + y * odd)


def eon_upper_cosine(y: Array, mu_o: Array, y_o: Array) -> Array:
    """Cosine drawn in proportion to S (1 - mu) / mu above mu_o: K is uniform, y = v^(2/5).

        1 - mu = m(v K_o) (1 - mu_o) / m(K_o),  m(K) = y Q(y)

    The quotient, instead of m(v K_o) alone, keeps every sample above mu_o.
    """
    m = (1.0 - mu_o) / eon_upper_quotient(y_o) * (y * eon_upper_quotient(y_o * y))
    return 1.0 - m


def eon_multiple_cosine(t: Array) -> Array:
    """Cosine drawn in proportion to H(mu) mu, a function of t = v^(1/3)."""
    a, b, c, d, e, f = MULTIPLE
    m = 1.0 - t
    w = root(m)
    even, odd = a + m * (b + m * d), c + m * (e + m * m * f)
    return t * (1.0 + m * (even + m * w * odd))


def eon_flat_draw(v: Array, u2: Array, q: Array, rest: Array | None = None) -> Array:
    """Direction drawn in proportion to (1 + q x) on the disk; `rest` is 1 - v, where it has more digits.

    Along each chord of the disk, x is drawn by its inverse distribution from the uniform point
    (x, y). z is the square root of 1 - x^2 - y^2 without a cancellation.
    """
    rest = 1.0 - v if rest is None else rest
    wh = around(root(rest), root(v), u2)
    return stack_xyz(*eon_flat_direction(v, wh[..., 0], wh[..., 1], q, rest))


def eon_flat_direction(
    v: Array, x: Array, y: Array, q: Array, rest: Array | None = None
) -> tuple[Array, Array, Array]:
    """Components of the direction that `eon_flat_draw` makes of a point of the disk, v = x^2 + y^2."""
    rest = 1.0 - v if rest is None else rest
    ahead = 1.0 + q * x
    length = root(ahead * ahead + q * q * rest)
    z = root(2.0 * rest / (ahead + length))
    return (q * (1.0 - y * y) + 2.0 * x) / (1.0 + length), y, z
