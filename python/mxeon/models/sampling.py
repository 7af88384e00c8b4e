# SPDX-License-Identifier: Apache-2.0
"""Importance sampling by pairs of functions, x_sample and x_pdf.

x_sample(...) returns `wi` and `pdf`. x_pdf(...) returns the `pdf` of a given `wi`.
Arguments have the order `wo`, `wi`, `u`, `roughness`. A function omits arguments that it does not
need.

- `wo` (..., 3): Direction to the viewer, unit vector to 1e-6, normal +z, z >= 0.
- `wi` (..., 3): Direction to the light, a unit vector. A sample with z < 0 is wasted: the weight of
  the sample is 0.
- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `roughness` (...): In [0, 1]; Zeltner's sheen raises a smaller roughness to 0.01. For GGX, alpha
  along tangent +x and bitangent, (..., 2) or ().
- `rho` (...): Gray reflectance for which the sampling of EON is exact, in [0, 1]; one number for
  each direction. Three numbers for three samples of one `wo` are rejected, because three numbers
  might be meant as a color.
- `pdf` (...): Density per solid angle, in 1/sr.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.

**EON** is sampled from two random numbers without tables or iteration. Let `wo` be turned to
azimuth 0, x the component of `wi` along wo's azimuth, x+ = max(x, 0), S = sqrt(1 - mu^2) and
q = r S_o. Then EON's BRDF at unit reflectance is A / pi times the sum of four nonnegative parts,
which can be integrated over the unit disk below the hemisphere:

| part     | value                                   | integral over the disk, divided by pi      |
|----------|-----------------------------------------|--------------------------------------------|
| lower    | q x+ (1 / mu_o - 1), where mu_i < mu_o  | (2 / (3 pi)) q (1 - mu_o) (1 - S_o^3)/mu_o |
| upper    | q x+ (1 / mu_i - 1), where mu_i >= mu_o | (2 / pi) q K(theta_o)                      |
| multiple | r H(mu_i) H(mu_o) / (c1 - c2)           | r H(mu_o)                                  |
| flat     | 1 + q x                                 | 1                                          |

Here K(theta) = (theta - sin(theta) cos(theta))/2 - sin^3(theta)/3. The sum of the four integrals is
1 + c1 r, which is 1 / A (proof in docs/note.md, section 3). Each part is sampled by inverting the
part's distribution. The inverse distributions of `flat` and `lower` are closed forms. The inverse
distributions of `multiple` and `upper` have no parameters and are approximated by polynomials. The
returned density is the exact sum of the parts. The true density of the samples has a relative error
of at most 1.3e-5 for each part, and so for the sum, because the error of the sum is a weighted mean
of the parts' errors.

**Linearly transformed cosines** (LTC) approximate EON. With `wo` turned to azimuth 0, a direction
`wh` sampled from a clamped cosine is mapped by M = [[a, 0, b], [0, c, 0], [d, 0, 1]]:

    wi = M wh / |M wh|,      p(wi) = p(wh) |M wh|^3 / det M

Clipped LTC (CLTC) samples only the part of the cosine that M maps above the horizon, where
d x + z >= 0. The excluded part is a lune. Zeltner's sheen is itself a transformed cosine, with
M = [[1/a, 0, -b/a], [0, 1/a, 0], [0, 0, 1]]. Because this M keeps z, no sample is wasted, and value
times cosine divided by density is color E(mu_o) for every sample.

**GGX** is sampled by visible normals. If space is stretched so that the microfacets form a
hemisphere, a visible normal is the half vector of the stretched `wo` and a direction sampled
uniformly on a spherical cap.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import broadcastable, checked_directions
from mxeon.models.core.arrays import Array, ArrayLike, Numbers, any_array, array_namespace, root
from mxeon.models.diffuse import C1, C2, cosines, eon_multiple_ratio, fon_loss_mu, fon_quotient
from mxeon.models.microfacet import ggx
from mxeon.models.sheen import zeltner_lobe, zeltner_matrix


@any_array
def uniform_sample(u: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a uniform sample of the hemisphere, with z = u[..., 0].

    [Portsmouth2025], Listing 4.

    >>> wi, pdf = uniform_sample([0.8, 0.0])
    >>> wi.round(12), round(float(pdf), 6)
    (array([0.6, 0. , 0.8]), 0.159155)
    """
    u1, u2 = unpack_uniforms(u)
    wi = uniform_direction(u1, 1.0 - u1, u2)
    return wi, 0.5 / np.pi + 0.0 * wi[..., 2]


@any_array
def uniform_pdf(wi: ArrayLike) -> Array:
    """Density 1/(2 pi) of `uniform_sample` at `wi`.

    >>> round(float(uniform_pdf([0.0, 0.6, 0.8])), 6)
    0.159155
    """
    return 0.5 / np.pi + 0.0 * checked_directions("wi", wi)[..., 2]


@any_array
def cosine_sample(u: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a sample in proportion to z, for z > 0: [Portsmouth2025], Eq. (21).

    >>> wi, pdf = cosine_sample([0.36, 0.0])
    >>> wi.round(12), round(float(pdf), 6)
    (array([0.6, 0. , 0.8]), 0.254648)
    """
    u1, u2 = unpack_uniforms(u)
    wi = around(root(1.0 - u1), root(u1), u2)
    return wi, wi[..., 2] / np.pi


@any_array
def cosine_pdf(wi: ArrayLike) -> Array:
    """Density z / pi of `cosine_sample` at `wi`.

    >>> round(float(cosine_pdf([0.6, 0.0, 0.8])), 6)
    0.254648
    """
    return checked_directions("wi", wi)[..., 2] / np.pi


def checked_draw(wo: ArrayLike, u: ArrayLike, **numbers: ArrayLike) -> list[Array]:
    """Validated arguments of a sampler as float64 arrays whose shapes broadcast."""
    vectors = {"wo": checked_directions("wo", wo), "u": arguments.checked_pairs("u", u)}
    return broadcastable(vectors, arguments.checked_all(numbers))


def checked_pdf(wo: ArrayLike, wi: ArrayLike, **numbers: ArrayLike) -> list[Array]:
    """Validated arguments of a density as float64 arrays whose shapes broadcast."""
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    return broadcastable(vectors, arguments.checked_all(numbers))


def unpack_uniforms(u: ArrayLike) -> tuple[Array, Array]:
    """Both random numbers, validated, as float64 arrays of shape (...)."""
    u = arguments.checked_pairs("u", u)
    return u[..., 0], u[..., 1]


def uniform_direction(u1: Array, rest: Array, u2: Array) -> Array:
    """Direction of `uniform_sample`, where `rest` is 1 - u1."""
    return around(u1, root(rest * (1.0 + u1)), u2)


def around(mu: Array, S: Array, u2: Array) -> Array:
    """Direction whose polar angle has the cosine `mu` and the sine `S`, at the azimuth 2 pi u2."""
    xp, phi = array_namespace(u2), 2.0 * np.pi * u2
    return stack_xyz(S * xp.cos(phi), S * xp.sin(phi), mu)


def stack_xyz(x: Array, y: Array, z: Array) -> Array:
    """Vectors with the components x, y, z on the last axis; the components broadcast."""
    xp = array_namespace(x, y, z)
    shape = np.broadcast_shapes(*(tuple(each.shape) for each in (x, y, z)))
    return xp.stack([xp.broadcast_to(each, shape) for each in (x, y, z)], axis=-1)


def azimuth_frame(wo: Array) -> tuple[Array, Array, Array]:
    """Cosine and sine of wo's azimuth, and sine of wo's polar angle.

    If wo is the normal, the azimuth is 0.
    """
    xp, sine = array_namespace(wo), arrays.hypot(wo[..., 0], wo[..., 1])
    tilted = sine > 0.0
    length = xp.where(tilted, sine, 1.0)
    return xp.where(tilted, wo[..., 0] / length, 1.0), wo[..., 1] / length, sine


def rotate_z(w: Array, cosine: Array, sine: Array) -> Array:
    """Vectors rotated about the normal by the angle with the given cosine and sine."""
    x, y = w[..., 0], w[..., 1]
    return stack_xyz(cosine * x - sine * y, sine * x + cosine * y, w[..., 2])


LEAST_COSINE = 2.0**-53  # smallest cosine that `eon_sample` returns

# Coefficients of polynomials in random numbers in [0, 1], from tools/fits/eon_sampling.py. The
# relative error of the density is at most 1.27e-5 for MULTIPLE and 5.7e-6 for UPPER.
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
    """Direction and density of a sample in proportion to EON times the cosine.

    `wi` (..., 3): Unit vectors, z >= 2^-53. `pdf` (...): `eon_pdf` of `wi`, in 1/sr. Accuracy: the
    relative difference between the true density of `wi` and `pdf` is below 1.3e-5. So a sample
    weight computed with the true density would be within 1.3e-5 of the albedo, and the relative
    variance of the weight would be below 1.7e-10. docs/sampling.md explains the method; EON is
    defined in [Portsmouth2025], Eqs. (16) and (19).

        >>> wi, pdf = eon_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.0)
        >>> wi.round(6), round(float(pdf), 6)
        (array([0.      , 0.707107, 0.707107]), 0.225079)
    """
    wo, u, roughness, rho = checked_draw(wo, u, roughness=roughness, rho=rho)
    if wo.ndim == 1 and tuple(u.shape) == (3, 2) and tuple(rho.shape) == (3,):
        raise ValueError(
            "rho of shape (3,) with 3 samples is ambiguous: write rho.mean() for a color, or "
            "repeat wo for a number for each sample"
        )
    u1, u2 = unpack_uniforms(u)
    cosine, sine, S_o = azimuth_frame(wo)
    mu_o, S_o = arrays.at_most(wo[..., 2], 1.0), arrays.at_most(S_o, 1.0)
    wi = rotate_z(eon_draw(mu_o, S_o, u1, u2, rho, roughness), cosine, sine)
    # A sample exactly on the horizon would have density 0 and weight 0/0, so z is raised.
    wi = stack_xyz(wi[..., 0], wi[..., 1], array_namespace(wi).maximum(wi[..., 2], LEAST_COSINE))
    return wi, eon_density_mu(*cosines(wo, wi), rho, roughness)


@any_array
def eon_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike, *, rho: ArrayLike = 1.0) -> Array:
    """Density of `eon_sample` at `wi`: f cos(theta_i) / E(theta_o), with f and E of EON.

    Result (...): 1/sr. At rho = 1, E is 1, so the density is `eon_brdf` times the cosine of `wi`.
    At rho = 0, where f and E are 0, the density is the limit for rho -> 0, which is FON's density.
    Accuracy: the relative error is below 1e-14. [Portsmouth2025], Eqs. (16), (19) and (28).

        >>> round(float(eon_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 1.0)), 6)
        0.332784
    """
    wo, wi, roughness, rho = checked_pdf(wo, wi, roughness=roughness, rho=rho)
    return eon_density_mu(*cosines(wo, wi), rho, roughness)


def eon_density_mu(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
    """`eon_pdf` as a function of mu_o, mu_i and s, the results of `diffuse.cosines`."""
    weight, loss_o = eon_multiple_ratio(rho, roughness), fon_loss_mu(mu_o)
    parts = 1.0 + roughness * fon_quotient(mu_o, mu_i, s) + weight * loss_o * fon_loss_mu(mu_i)
    total = 1.0 + C1 * roughness + (weight * (C1 - C2) - roughness) * loss_o
    return mu_i * parts / (np.pi * total)


def eon_draw(mu_o: Array, S_o: Array, u1: Array, u2: Array, rho: Array, roughness: Array) -> Array:
    """Direction sampled from one of EON's four parts; `wo` has azimuth 0."""
    # Choose a part by u1, then rescale u1 to [0, 1) within that part.
    parts = eon_integrals(mu_o, S_o, rho, roughness)
    xp = array_namespace(*parts)
    ends = [parts[0]]
    for part in parts[1:]:
        ends.append(ends[-1] + part)
    ends = [end / ends[-1] for end in ends]
    starts = [0.0 * ends[0], *ends[:-1]]
    v = [stretched(u1, start, end) for start, end in zip(starts, ends, strict=True)]
    # `rest` is 1 - v[3], computed without cancellation.
    rest = xp.minimum(1.0 - u1, 1.0 - starts[3]) / (1.0 - starts[3])
    # Sample a cosine for the parts lower, upper and multiple, and keep the chosen part's cosine.
    x = v[0] * mu_o * eon_cube_gap(mu_o, S_o)
    lower = eon_lower_cosine(x, arrays.power(1.0 - x, 1.0 / 3.0))
    upper = eon_upper_cosine(arrays.power(v[1], 0.4), mu_o, eon_upper_limit(mu_o, S_o))
    multiple = eon_multiple_cosine(arrays.power(v[2], 1.0 / 3.0))
    mu = xp.where(u1 < ends[0], lower, xp.where(u1 < ends[1], upper, multiple))
    S = root((1.0 - mu) * (1.0 + mu))
    towards, flat = (u1 < ends[1])[..., np.newaxis], (u1 >= ends[2])[..., np.newaxis]
    wi = xp.where(towards, eon_towards(mu, S, u2), around(mu, S, u2))
    return xp.where(flat, eon_flat_draw(v[3], u2, roughness * S_o, rest), wi)


def eon_integrals(
    mu_o: Array, S_o: Array, rho: Array, roughness: Array
) -> tuple[Array, Array, Array, float]:
    """Integrals of the parts lower, upper, multiple and flat over the disk, divided by pi."""
    towards = (2.0 / np.pi) * roughness * S_o
    lower = towards * (1.0 - mu_o) * eon_cube_gap(mu_o, S_o) / 3.0
    multiple = (C1 - C2) * eon_multiple_ratio(rho, roughness) * fon_loss_mu(mu_o)
    return lower, towards * eon_segment(mu_o, S_o), multiple, 1.0


def eon_cube_gap(mu: Array, S: Array) -> Array:
    """Quotient (1 - S^3) / mu, computed without division by mu and without cancellation."""
    return mu * (1.0 + S + S * S) / (1.0 + S)


def eon_segment(mu: Array, S: Array) -> Array:
    """K(theta), the integral of sin^2 (1 - cos) from 0 to theta.

    Near the normal, the terms cancel, so a negative difference is clamped to 0.
    """
    xp = array_namespace(mu, S)
    return xp.maximum(0.5 * (xp.atan2(S, mu) - S * mu) - S**3 / 3.0, 0.0)


def stretched(u: Array, start: Array, end: Array) -> Array:
    """`u` clamped to [start, end], so that no quotient overflows, and then mapped to [0, 1)."""
    xp = array_namespace(u, start, end)
    length = xp.where(end > start, end - start, 1.0)
    clamped = xp.minimum(xp.maximum(u, start), end)
    return xp.minimum((clamped - start) / length, arrays.below_1(length))


def eon_towards(mu: Array, S: Array, u2: Array) -> Array:
    """Direction with cosine `mu` and sine `S` of the polar angle, at an azimuth in [-pi/2, pi/2].

    The sine of the azimuth is uniformly distributed.
    """
    return stack_xyz(2.0 * S * root(u2 * (1.0 - u2)), S * (2.0 * u2 - 1.0), mu)


def eon_lower_cosine(x: Array, S: Array) -> Array:
    """Cosine below mu_o with a density proportional to S mu, which makes x = 1 - S^3 uniform."""
    return root(x * (1.0 + S) / (1.0 + S + S * S))


def eon_upper_limit(mu: Array, S: Array) -> Array:
    """y = (K(theta) / K(pi / 2))^(2/5) for the theta with the cosine `mu` and the sine `S`."""
    return arrays.power(eon_segment(mu, S) / (0.25 * np.pi - 1.0 / 3.0), 0.4)


def eon_upper_quotient(y: Array) -> Array:
    """Polynomial Q(y) that `eon_upper_cosine` uses, with Q(1) = 1."""
    a, b, c, d, e, f = UPPER
    even, odd = a + y * y * (c + y * y * e), b + y * y * (d + y * y * f)
    return 1.0 + (1.0 - y) * (even + y * odd)


def eon_upper_cosine(y: Array, mu_o: Array, y_o: Array) -> Array:
    """Cosine above mu_o with a density proportional to S (1 - mu), which makes K uniform.

        1 - mu = m(v K_o) (1 - mu_o) / m(K_o)

    `y` is v^(2/5) for a uniform v, and `y_o` is (K_o / K(pi / 2))^(2/5), where K_o = K(theta_o).
    m(K) = z Q(z), where z = (K / K(pi / 2))^(2/5), approximates 1 - mu as a function of K. Because
    of the division by m(K_o), every sample is above mu_o despite the error of m.
    """
    m = (1.0 - mu_o) / eon_upper_quotient(y_o) * (y * eon_upper_quotient(y_o * y))
    return 1.0 - m


def eon_multiple_cosine(t: Array) -> Array:
    """Cosine with a density nearly proportional to H(mu) mu, from t = v^(1/3) for a uniform v."""
    a, b, c, d, e, f = MULTIPLE
    m = 1.0 - t
    w = root(m)
    even, odd = a + m * (b + m * d), c + m * (e + m * m * f)
    return t * (1.0 + m * (even + m * w * odd))


def eon_flat_draw(v: Array, u2: Array, q: Array, rest: Array | None = None) -> Array:
    """Direction whose projection on the unit disk has a density proportional to 1 + q x.

    A uniform point (x, y) of the disk is moved along the chord at y by the inverse distribution.
    z = sqrt(1 - x^2 - y^2) is computed without a cancellation. `rest` is 1 - v without a loss of
    digits.
    """
    rest = 1.0 - v if rest is None else rest
    wh = around(root(rest), root(v), u2)
    return stack_xyz(*eon_flat_direction(v, wh[..., 0], wh[..., 1], q, rest))


def eon_flat_direction(
    v: Array, x: Array, y: Array, q: Array, rest: Array | None = None
) -> tuple[Array, Array, Array]:
    """Direction of `eon_flat_draw` from a uniform point (x, y) of the disk, with v = x^2 + y^2."""
    rest = 1.0 - v if rest is None else rest
    linear = 1.0 + q * x
    length = root(linear * linear + q * q * rest)
    z = root(2.0 * rest / (linear + length))
    return (q * (1.0 - y * y) + 2.0 * x) / (1.0 + length), y, z


@any_array
def ltc_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a sample of the transformed cosine, possibly below the horizon.

    `wi` (..., 3): Unit vectors; a vector with z < 0 is a wasted sample of weight 0. `pdf` (...):
    1/sr. The probability of a wasted sample, (1 - 1/sqrt(1 + d^2))/2, is at most 0.0534, for a
    grazing wo and roughness 1. [Portsmouth2025], Section 4, Eqs. (22) to (25), Listing 2.

        >>> wi, pdf = ltc_sample([1.0, 0.0, 0.0], [0.95, 0.0], 1.0)
        >>> float(wi[2]) < 0.0
        True
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    return ltc_transformed(wo, cosine_sample(u)[0], roughness, ltc_md(wo[..., 2], roughness))


@any_array
def ltc_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `ltc_sample` at a `wi` above the horizon.

    The integral of the density is the probability that a sample is not wasted. [Portsmouth2025],
    Eqs. (23), (24).

        >>> round(float(ltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
        0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    return ltc_density(wo, wi, roughness, ltc_md(wo[..., 2], roughness))


# Entries a, b, c, d of the matrix M in [Portsmouth2025], Listing 2, as functions of the roughness
# and of wo's cosine `mu`. The paper does not state how well M approximates EON.
def ltc_ma(mu: Array, roughness: Array) -> Array:
    a = 0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * roughness
    return 1.0 + roughness * a


def ltc_mb(mu: Array, roughness: Array) -> Array:
    b = -1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * roughness
    return roughness * b / (mu**3 - 1.43545)


def ltc_mc(mu: Array, roughness: Array) -> Array:
    return 1.0 + roughness * (0.20013 + (-0.506373 + 0.261777 * mu) * mu)


def ltc_md(mu: Array, roughness: Array | float) -> Array:
    d = 0.540852 + (-1.01625 + 0.475392 * mu) * mu
    return roughness * d / (-1.0743 + (0.0725628 + mu) * mu)


def ltc_transformed(wo: Array, wh: Array, roughness: Array, d: Array) -> tuple[Array, Array]:
    """Direction of M wh in the surface's frame, and density of this direction.

    - `wh`: Cosine-weighted direction in the frame in which wo has azimuth 0.
    """
    a, b, c = (entry(wo[..., 2], roughness) for entry in (ltc_ma, ltc_mb, ltc_mc))
    x, y, z = wh[..., 0], wh[..., 1], wh[..., 2]
    wi, pdf = _normalized(wo, stack_xyz(a * x + b * z, c * y, d * x + z), z / np.pi)
    return wi, pdf / (c * (a - b * d))


def _normalized(wo: Array, w: Array, pdf: Array) -> tuple[Array, Array]:
    """Returns w / |w|, rotated to wo's azimuth, and the density pdf |w|^3."""
    length = root(array_namespace(w).sum(w * w, axis=-1))
    cosine, sine, _ = azimuth_frame(wo)
    return rotate_z(w / length[..., np.newaxis], cosine, sine), pdf * length**3


def ltc_density(wo: Array, wi: Array, roughness: Array, d: Array) -> Array:
    """Density at `wi` of the direction M wh / |M wh|, where wh is cosine-weighted."""
    a, b, c = (entry(wo[..., 2], roughness) for entry in (ltc_ma, ltc_mb, ltc_mc))
    cosine, sine, _ = azimuth_frame(wo)
    wi = rotate_z(wi, cosine, -sine)
    x, y, z = wi[..., 0], wi[..., 1], wi[..., 2]
    det = c * (a - b * d)
    # adj(M) wi is parallel to wh, where adj(M) is the adjugate matrix of M.
    wh_z = c * (a * z - d * x)
    squared = (c * (x - b * z)) ** 2 + ((a - b * d) * y) ** 2 + wh_z**2
    return (det / squared) ** 2 * arrays.at_least_0(wh_z) / np.pi


@any_array
def cltc_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a sample of the clipped transformed cosine.

    As a sampler of EON, CLTC is biased, because some directions into which EON reflects are never
    sampled. The lune d x + z < 0 lies at x > 0 for d < 0, which Listing 3 assumes, and at x < 0 for
    d > 0. The approximation of d is positive for mu_o > 0.99991, where Listing 3 keeps the wrong
    side. This function always keeps the correct side. [Portsmouth2025], Eqs. (26) and (27), Listing
    3.

        >>> wi, pdf = cltc_sample([0.6, 0.0, 0.8], [0.25, 0.5], 1.0)
        >>> bool(np.isclose(pdf, cltc_pdf([0.6, 0.0, 0.8], wi, 1.0), rtol=1e-14))
        True
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    u1, u2 = unpack_uniforms(u)
    return _cltc_draw(wo, u1, 1.0 - u1, u2, roughness)


@any_array
def cltc_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `cltc_sample` at `wi`.

    The density is 0 for directions that are never sampled. [Portsmouth2025], Eqs. (23), (24), (27),
    Listing 3.

        >>> round(float(cltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
        0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    d = ltc_md(wo[..., 2], roughness)
    return ltc_density(wo, wi, roughness, d) / cltc_kept_fraction(d)


@any_array
def eon_cltc_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a sample of the paper's mixture of CLTC and a uniform lobe.

    `wi` (..., 3): Unit vectors on or above the horizon. `pdf` (...): Density of the mixture, in
    1/sr. Listing 4 of the paper selects the uniform lobe for u1 <= P_u and divides u1 by P_u. The
    quotient is 0/0 at roughness 0 and u1 = 0. This function selects the uniform lobe for u1 < P_u,
    which is never true for P_u = 0. [Portsmouth2025], Section 4, Listing 4.

        >>> wi, pdf = eon_cltc_sample([0.0, 0.0, 1.0], [0.0, 0.0], 0.0)
        >>> wi, round(float(pdf), 6)
        (array([0., 0., 1.]), 0.31831)
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    u1, u2 = unpack_uniforms(u)
    P_u = eon_cltc_probability(wo[..., 2], roughness)
    is_uniform = u1 < P_u
    # u1 is rescaled from [0, P_u) or [P_u, 1) to [0, 1).
    xp = array_namespace(u1, P_u)
    length = xp.where(is_uniform, P_u, 1.0 - P_u)
    v = xp.where(is_uniform, u1, u1 - P_u) / length
    rest = xp.where(is_uniform, P_u - u1, 1.0 - u1) / length
    v = xp.minimum(v, arrays.below_1(v))
    clipped, _ = _cltc_draw(wo, v, rest, u2, roughness)
    wi = xp.where(is_uniform[..., np.newaxis], uniform_direction(v, rest, u2), clipped)
    return wi, eon_cltc_pdf(wo, wi, roughness)


@any_array
def eon_cltc_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `eon_cltc_sample` at `wi`: [Portsmouth2025], Section 4, Listing 4.

    >>> round(float(eon_cltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
    0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    P_u = eon_cltc_probability(wo[..., 2], roughness)
    return P_u * (0.5 / np.pi) + (1.0 - P_u) * cltc_pdf(wo, wi, roughness)


def eon_cltc_probability(mu: Array, roughness: Array) -> Array:
    """Probability P_u of the uniform lobe: [Portsmouth2025], Listing 4."""
    P_u = 0.162925 + (-0.372058 + (0.538233 - 0.290822 * mu) * mu) * mu
    return arrays.power(roughness, 0.1) * P_u


def cltc_kept_fraction(d: Array) -> Array:
    """Fraction of the clamped cosine with d x + z >= 0: [Portsmouth2025], below Eq. (26)."""
    return 0.5 * (1.0 + 1.0 / root(1.0 + d * d))


def _cltc_draw(
    wo: Array, u1: Array, rest: Array, u2: Array, roughness: Array
) -> tuple[Array, Array]:
    """`cltc_sample` for valid arguments; `rest` is 1 - u1 without a loss of digits."""
    d = ltc_md(wo[..., 2], roughness)
    wi, pdf = ltc_transformed(wo, cltc_clipped(u1, u2, d, rest), roughness, d)
    # On the edge of the lune, where d x + z is 0, rounding may make d x + z negative.
    wi = stack_xyz(wi[..., 0], wi[..., 1], arrays.at_least_0(wi[..., 2]))
    return wi, pdf / cltc_kept_fraction(d)


def cltc_clipped(u1: Array, u2: Array, d: Array, rest: Array | None = None) -> Array:
    """Cosine-weighted direction with d x + z >= 0: [Portsmouth2025], Listing 3.

    `rest` is 1 - u1 without a loss of digits. The chord of the unit disk at y has the half length
    c, where c^2 = 1 - u1 + x^2. x is mapped to x' = c (1 - k) + k x, where k is the kept fraction.
    Then

        z^2 = 1 - x'^2 - y^2 = k (c - x) (2 c (1 - k) + k (c + x))

    The smaller of c - x and c + x is computed as 1 - u1 divided by the larger, so that nothing
    cancels near the rim of the disk.
    """
    rest = 1.0 - u1 if rest is None else rest
    wh = around(root(rest), root(u1), u2)
    x, y = wh[..., 0], wh[..., 1]
    xp, kept, length = array_namespace(x, d), cltc_kept_fraction(d), root(1.0 + d * d)
    lost = 0.5 * d * d / (length * (1.0 + length))  # `1 - kept` without cancellation
    half, negative = root(rest + x * x), x < 0.0
    larger = half + xp.where(negative, -x, x)
    smaller = rest / larger
    minus, plus = xp.where(negative, larger, smaller), xp.where(negative, smaller, larger)
    z = root(kept * minus * (2.0 * half * lost + kept * plus))
    x = half * lost + x * kept
    return stack_xyz(xp.where(d > 0.0, x, -x), y, z)


@any_array
def ggx_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a reflection by visible GGX normals, possibly below the horizon.

    `wi` (..., 3): Unit vectors; a vector with z < 0 is a wasted sample of weight 0. `pdf` (...):
    1/sr. If an alpha is 0, no density exists, and `pdf` is 0. The weight of a sample, value times
    cosine divided by density, is F G2 / G1(wo). [Dupuy2023], Section 3; [Heitz2014], Eq. (16).

        >>> wi, pdf = ggx_sample([0.6, 0.0, 0.8], [0.25, 0.5], [0.5, 0.25])
        >>> wi.round(6), round(float(pdf), 6)
        (array([-0.835004,  0.      ,  0.550244]), 0.649904)
    """
    vectors = {"wo": checked_directions("wo", wo), "u": arguments.checked_pairs("u", u)}
    vectors["roughness"] = arguments.checked_roughness(roughness)
    view, (u1, u2), alpha = _components(vectors)
    wh = visible_normal(view, u1, u2, alpha)
    wi = stack_xyz(*(2.0 * array_namespace(wh).sum(view * wh, axis=0) * wh - view))
    return wi, visible_density(view, wh, alpha)


@any_array
def ggx_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `ggx_sample` at a `wi` with any z: [Heitz2014], Eqs. (16), (43).

        pdf = G1(wo) D(wh) / (4 mu_o), and 0 where wh is below the horizon

    The integral of the density over the upper hemisphere is the probability that a sample is not
    wasted.

        >>> round(float(ggx_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], [0.5, 0.25])), 6)
        0.455389
    """
    vectors = {"wo": checked_directions("wo", wo), "wi": arguments.checked_sphere("wi", wi)}
    vectors["roughness"] = arguments.checked_roughness(roughness)
    view, light, alpha = _components(vectors)
    wh, cosine = ggx.half_vector(view, light)
    below = (wh[2] < 0.0) | ((cosine == 0.0) & (light[2] < 0.0))
    return array_namespace(wh).where(below, 0.0, visible_density(view, wh, alpha))[()]


def _components(vectors: dict[str, Numbers]) -> list[Array]:
    """Vectors, broadcast against each other, with the components on the first axis."""
    lead, xp = arguments.lead_shape(vectors, {}), array_namespace(*vectors.values())
    spread = [xp.broadcast_to(v, (*lead, *v.shape[-1:])) for v in vectors.values()]
    return [xp.permute_dims(vector, (len(lead), *range(len(lead)))) for vector in spread]


def visible_density(wo: Array, wh: Array, roughness: Array) -> Array:
    """Density G1(wo) D(wh) / (4 mu_o), computed without a division by mu_o.

    The components of the vectors are on the first axis.
    """
    masking = 0.5 * ggx.reciprocal(wo[2] + ggx.stretched_length(wo, roughness))
    return masking * ggx.ndf(wh, roughness)


def visible_normal(wo: Array, u1: Array, u2: Array, roughness: Array) -> Array:
    """Visible normal sampled from two random numbers: [Dupuy2023], Listing 3.

    The components of the vectors are on the first axis.
    """
    xp = array_namespace(wo, u1, roughness)
    stretched = xp.stack([roughness[0] * wo[0], roughness[1] * wo[1], wo[2]])
    length = root(xp.sum(stretched * stretched, axis=0))
    # For alpha 0 and a grazing wo, `length` is 0, and the normal does not depend on u1 and u2.
    stretched = stretched / xp.where(length > 0.0, length, 1.0)
    # Sample a uniform point on the part of the unit sphere with z > -stretched[2].
    down = (1.0 + stretched[2]) * u1
    z, phi = 1.0 - down, 2.0 * np.pi * u2
    S = root(down * (1.0 + z))
    x, y, z = S * xp.cos(phi) + stretched[0], S * xp.sin(phi) + stretched[1], z + stretched[2]
    normal = [roughness[0] * x, roughness[1] * y, arrays.at_least_0(z)]
    length = root(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2])
    tilted = length > 0.0
    x, y, z = (each / xp.where(tilted, length, 1.0) for each in normal)
    return xp.stack([xp.where(tilted, x, 0.0), xp.where(tilted, y, 0.0), xp.where(tilted, z, 1.0)])


@any_array
def zeltner_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction and density of a sample in proportion to the Zeltner lobe times the cosine.

    The direction is always above the horizon. [MaterialX2026], Zeltner Sheen Model, section LTC
    Inverse Matrix.

        >>> wi, pdf = zeltner_sample([0.6, 0.0, 0.8], [0.25, 0.5], 1.0)
        >>> wi.round(6), round(float(pdf), 6)
        (array([-0.550347,  0.      ,  0.834936]), 0.236007)
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    wh = cosine_sample(u)[0]
    a, b = zeltner_matrix(arrays.at_most(wo[..., 2], 1.0), roughness)
    x, y, z = (wh[..., 0] - b * wh[..., 2]) / a, wh[..., 1] / a, wh[..., 2]
    wi, pdf = _normalized(wo, stack_xyz(x, y, z), z / np.pi)
    return wi, pdf * (a * a)


@any_array
def zeltner_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `zeltner_sample` at `wi`.

    [MaterialX2026], Zeltner Sheen Model, section Cosine-Weighted BRDF.

    >>> round(float(zeltner_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 1.0)), 6)
    0.24421
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    return wi[..., 2] / np.pi * zeltner_lobe(wo, wi, roughness)
