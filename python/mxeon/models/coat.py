# SPDX-License-Identifier: Apache-2.0
"""Two kinds of coats over EON: a dielectric layer and a varnish.

**The dielectric layer** reflects a fraction E_r of the light, and EON receives the remaining light.
This is the `layer` node of the specification:

    f = f_r + (1 - E_r(mu_o)) f_EON,  E = E_r + (1 - E_r) E_EON

E_r includes the energy compensation. E_r is at most the albedo of perfectly reflecting facets, so
E_r is at most 1. A dielectric layer is not a varnish, because light reflected by EON leaves without
loss. A real interface also reflects and refracts the light that leaves EON. Random walks below the
same interface (tools/fits/varnish_walk.py) show that the albedo of the layer is up to 2.2 times too
high. For an index of refraction of 1.5 and rho 0.2, the albedo is 1.04 to 1.84 times too high.
`varnished_brdf` models both effects in closed form.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `u` (..., 2): Independent uniform random numbers, in [0, 1). The first number also chooses the
  lobe.
- `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
- `rho` (..., C): Reflectance of EON per channel, in [0, 1]; a number is one channel.
- `roughness` (...): Roughness of EON, in [0, 1].
- `alpha`: GGX roughness of the interface, in [0.01, 1]; one number for all directions.
- `ior`: Index of refraction of the interface, in [1, 4]; one number for all directions.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.

For constant `alpha` and `ior`, the albedo and the energy compensation depend only on the viewer's
cosine. Both are integrated at Chebyshev nodes and interpolated.

**The varnish** is EON below a rough dielectric interface that also acts on light from EON. The
interface reflects f_r and transmits the fraction T = 1 - E_r of the light, which arrives at EON
along refracted directions w'. Each time light returns from EON, the interface reflects the fraction
R of this light back to EON. EON's first reflection uses the BRDF f_b. Every later reflection uses a
mean of f_b. The sum of all reflections follows [Saunderson1942], for a base whose albedo depends on
the angle:

    f = f_r + T(mu_o) T(mu_i) / n^2 [f_b(wo', wi') + R k(mu_o) k(mu_i) / (pi (1 - R <k>))]       (1)
    w' = (x / n, y / n, mu'),  mu'^2 = mu^2 + (1 - mu^2) (1 - 1 / n^2)
    R = 1 - (1 - <E_r>) / n^2
    E = E_r + T [E_b(mu') - R k (1 - <E_b>_R) / (1 - R <k>)]                                     (2)

n is the index of refraction, and E_b is the albedo of EON. `<>_R` is a mean over the light that the
interface reflects back to EON: all of the light beyond the critical angle, and the fraction E_r of
the light within the critical angle. k is pi times the mean of f_b over the same light. R is
computed from `<E_r>` of light from outside, because n^2 (1 - R) = 1 - `<E_r>` for a lossless,
reciprocal interface. Equation (2) is the integral of (1), since T mu dw = n^2 T mu' dw'. At
rho = 1, (2) is 1. At n = 1, (1) is EON to the last bit. A, c1 and c2 are defined in
[Portsmouth2025]; r is EON's roughness, H is `fon_loss`, and W is the weight of H(mu_o) H(mu_i) in
EON:

    k = rho A (1 + r b + W H(mu') <H>_R),  b(mu) = <s / t>_R,  <k> = rho A (1 + r <b>_R + W <H>_R^2)

Light that is reflected between facets is scaled by the mean reflectance of the facets,
F = E_single / E_ss, in a form that makes f reciprocal:

    E_r = E_single + D,  D = F^2 (1 - E_ss),  f_r = f_single + D(mu_o) D(mu_i) / (pi <D>)

Three parts of the model are approximations: the mean of f_b, the term D, and the directions w',
which are refracted as at a smooth surface. The model was compared with random walks
(tools/fits/varnish_walk.py) for n from 1.1 to 2, alpha from 0.05 to 0.7, rho from 0 to 1, r = 0 and
r = 1, and cosines from 0.05 to 1. The error of the albedo is at most 0.012, and is 0 at rho = 1.
The light that EON reflects into a twelfth of the hemisphere is 0.95 to 1.05 times the light of the
random walks at r = 0, and 0.79 to 1.15 times at r = 1. The difference between (2) and the integral
of (1) is below 1e-6, but up to 1e-4 at alpha 0.01 and n near 1.

k and `<k>` have closed forms for EON, and so for Lambert's BRDF, which is EON at r = 0. If k were
the base's albedo and `<k>` the base's mean albedo, the albedo of varnished EON would change by up
to 0.004 at r = 1/2, and by up to 0.0075 at r = 1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, cast

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebval

from mxeon.models import diffuse as formulas
from mxeon.models import sampling
from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import checked_color, checked_colors, checked_directions
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, like, root
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.evaluation import evaluate
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.diffuse import C1, C2, eon_albedo, eon_albedo_dir, eon_brdf, fon_loss_mu
from mxeon.models.microfacet import dielectric_brdf
from mxeon.models.microfacet.fresnel import dielectric, dielectric_avg
from mxeon.models.microfacet.slopes import slope_nodes
from mxeon.models.sampling import unpack_uniforms

CURVE_NODES = 40  # Chebyshev nodes per curve of a `Coat`
CACHED = 64  # maximum number of cached interfaces


@dataclass(frozen=True)
class Coat:
    """Chebyshev coefficients of two functions of the viewer's cosine, for a dielectric layer.

    - `alpha`, `average`: GGX roughness and average reflectance F_ss.
    - `missing`, `reflected`: Chebyshev coefficients of (1 - E_ss) / E_ss and of E_r.
    """

    alpha: float | Array
    average: float | Array
    missing: list[float] | Array
    reflected: list[float] | Array

    def at(self, mu: Array) -> tuple[Array, Array]:
        """Clamped values of (1 - E_ss) / E_ss and of E_r at a cosine."""
        x = scaled_cosine(mu, self.alpha)
        missing, reflected = (
            arrays.at_least_0(chebyshev_sum(cast(Array, each), x))
            for each in (self.missing, self.reflected)
        )
        return missing, arrays.at_most(reflected, 1.0)


def scaled_cosine(mu: Array, alpha: float | Array) -> Array:
    """Argument of the polynomials, x = (asinh(mu / alpha) / asinh(1 / alpha))^(1/3) in [0, 1].

    Near mu = 0, the cube root makes terms like mu log(mu) smooth enough for polynomials in x.
    """
    extent = array_namespace(alpha).asinh(1.0 / alpha)
    return arrays.power(array_namespace(mu, alpha).asinh(mu / alpha) / extent, 1.0 / 3.0)


def coat_curves(alpha: Array, ior: Array) -> Array:
    """Chebyshev coefficients of (1 - E_ss) / E_ss and of E_r, shape (CURVE_NODES, 2).

    Accuracy: both errors are below 2e-7 for alpha >= 0.01 and ior in [1, 4]. For grazing viewing
    directions, the integral over slopes contributes up to 5e-8.
    """
    xp, x = array_namespace(alpha), like(chebyshev_nodes(CURVE_NODES), alpha)
    mu, _ = cosine_at(alpha, x)
    zero = 0.0 * mu
    wo = xp.stack([root((1.0 - mu) * (1.0 + mu)), zero, mu])
    c, weight = slope_nodes(wo, xp.stack([zero + alpha, zero + alpha]), isotropic=True)
    missing = 1.0 / xp.sum(weight, axis=(0, 1)) - 1.0
    single = xp.sum(dielectric(c, zero + ior) * weight, axis=(0, 1))
    values = xp.stack([missing, single * (1.0 + dielectric_avg(ior) * missing)], axis=-1)
    matrix = like(chebyshev_coefficients(np.eye(CURVE_NODES)), mu)
    return xp.tensordot(matrix, values, axes=1)


@lru_cache(maxsize=CACHED)
def constant_coat(alpha: float, ior: float) -> Coat:
    index = np.asarray(ior)
    return Coat(
        alpha, float(dielectric_avg(index)), *coat_curves(np.asarray(alpha), index).T.tolist()
    )


@any_array
def coat_of(alpha: ArrayLike, ior: ArrayLike) -> Coat:
    """The `Coat` for an alpha and an ior. Results for numbers and NumPy arrays are cached."""
    numbers = {}
    for name, value in (("alpha", alpha), ("ior", ior)):
        number = numbers[name] = arguments.checked(name, value, f"coat_{name}")
        if number.ndim:
            raise ValueError(
                f"{name} must be one number, for all pairs; got shape {tuple(number.shape)}"
            )
    if not arrays.library(numbers["alpha"]):
        return constant_coat(*map(float, numbers.values()))
    rows = coat_curves(**numbers)
    return Coat(numbers["alpha"], dielectric_avg(numbers["ior"]), rows[:, 0], rows[:, 1])


AVERAGED = 32  # quadrature nodes of an average over the viewer's cosine


@any_array
def dielectric_over_eon_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """BRDF of an isotropic `dielectric_bsdf` layered over EON.

        f = f_r + (1 - E_r(mu_o)) f_EON

    Result (..., C): 1/sr. The BRDF is not reciprocal, because the compensation and the layering
    depend on wo only. Accuracy: E_r and the compensation have errors below 2e-7. The first call for
    an `alpha` and `ior` tabulates E_r and the compensation. [MaterialX2026], sections `layer` and
    Energy Compensation; [Portsmouth2025], Eq. (19).

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> dielectric_over_eon_brdf(wo, wi, [0.7, 0.1], 0.5, 0.3, 1.5).round(5)
        array([0.23317, 0.08236])
    """
    coat = coat_of(alpha, ior)
    bare = dielectric_brdf(wo, wi, 1.0, alpha, ior, compensate=False)
    mu = arrays.cosine(checked_directions("wo", wo)[..., 2])
    missing, reflected = (each[..., np.newaxis] for each in coat.at(mu))
    base = eon_brdf(wo, wi, rho, roughness)
    return bare * (1.0 + coat.average * missing) + (1.0 - reflected) * base


@any_array
def dielectric_over_eon_albedo_dir(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Directional albedo of `dielectric_over_eon_brdf`; 1 where rho is 1. The error is below 2e-7.

    E = E_r + (1 - E_r) E_EON

    >>> dielectric_over_eon_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.3, 1.5).round(5)
    array([[0.7426 , 1.     ],
           [0.68356, 1.     ]])
    """
    base = eon_albedo_dir(mu, rho, roughness)
    reflected = coat_of(alpha, ior).at(arguments.checked("mu", mu))[1][..., np.newaxis]
    return reflected + (1.0 - reflected) * base


@any_array
def dielectric_over_eon_albedo_avg(
    rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Cosine-weighted average of `dielectric_over_eon_albedo_dir` over all viewing directions.

    Result (..., C). Accuracy: the error is below 2e-7. EON's albedo is a linear function of FON's
    loss H, so only H is integrated over the transmitted light.

        >>> dielectric_over_eon_albedo_avg([0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([0.69645, 1.     ])
    """
    coat = coat_of(alpha, ior)
    number = cast(Array, coat.alpha)
    xp, (x, weight) = array_namespace(number), (like(each, number) for each in unit_rule(AVERAGED))
    mu, step = cosine_at(number, x)
    weight = weight * 2.0 * mu * step
    reflected = coat.at(mu)[1]
    passed = xp.sum(weight * (1.0 - reflected))
    share = xp.sum(weight * (1.0 - reflected) * fon_loss_mu(mu)) / (passed * C1)
    grazing, upright = (eon_albedo_dir(each, rho, roughness) for each in (0.0, 1.0))
    return (1.0 - passed) + passed * (grazing + share * (upright - grazing))


@any_array
def mixed_sample(
    wo: ArrayLike, u: ArrayLike, alpha: float, share: Array, base: Callable[[Array], Array]
) -> Array:
    """Direction sampled from the facets with probability `share`, otherwise from `base`.

    The first random number chooses between facets and `base`, and is then rescaled to [0, 1).
    """
    xp = array_namespace(share)
    u1, u2 = unpack_uniforms(u)
    zero = 0.0 * share
    stretches = sampling.stretched(u1, zero, share), sampling.stretched(u1, share, zero + 1.0)
    first, second = (xp.stack([each, u2 + zero * each], axis=-1) for each in stretches)
    reflected = sampling.ggx_sample(wo, first, alpha)[0]
    return xp.where((u1 < share)[..., np.newaxis], reflected, base(second))


@any_array
def mixed_pdf(
    wo: ArrayLike, wi: ArrayLike, alpha: float, share: Array, base_pdf: Callable[[Array], Array]
) -> Array:
    light = arguments.checked_triples("wi", wi)
    xp, z = array_namespace(light), light[..., 2]
    upper = xp.stack([light[..., 0], light[..., 1], arrays.magnitude(z)], axis=-1)
    base = base_pdf(upper)
    mixed = share * sampling.ggx_pdf(wo, wi, alpha) + xp.where(z < 0.0, 0.0, (1.0 - share) * base)
    return mixed[()]


@any_array
def checked_draws(
    wo: ArrayLike, rho: ArrayLike, roughness: ArrayLike, **pair: arrays.Numbers
) -> tuple[Array, Array]:
    """Cosine of wo's polar angle, and mean of rho's channels.

    - `pair`: The validated `u` of a sampler, or the validated `wi` of a density.

    Raises ValueError unless all arguments broadcast.
    """
    view, color = checked_directions("wo", wo), checked_color("rho", rho)
    numbers = {"roughness": arguments.checked("roughness", roughness)}
    arguments.lead_shape({"wo": view, "rho": color, **pair}, numbers)
    return arrays.cosine(view[..., 2]), array_namespace(color).mean(color, axis=-1)


@any_array
def dielectric_over_eon_sample(
    wo: ArrayLike,
    u: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    alpha: float,
    ior: float,
) -> tuple[Array, Array]:
    """Direction and density of a sample of the visible facets or of EON.

    `wi` (..., 3): Unit vectors; a vector with z < 0 is a wasted sample of weight 0. `pdf` (...): p
    pdf_GGX + (1 - p) pdf_EON, in 1/sr. The facets are chosen with the probability p = E_r / E for
    the mean of rho's channels. The weight f mu_i / pdf of a sample lies between f_r mu_i / (p
    pdf_GGX) and (1 - E_r) f_EON mu_i / ((1 - p) pdf_EON). The second quotient is E for a gray rho.
    [Dupuy2023].

        >>> wi, pdf = dielectric_over_eon_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.7, 0.5, 0.3, 1.5)
        >>> wi.round(5), round(float(pdf), 5)
        (array([0.08667, 0.64394, 0.76015]), 0.23917)
    """
    mu, mean = checked_draws(wo, rho, roughness, u=arguments.checked_pairs("u", u))
    share = _facet_share(mu, mean, roughness, coat_of(alpha, ior))
    wi = mixed_sample(
        wo, u, alpha, share, lambda u: sampling.eon_sample(wo, u, roughness, rho=mean)[0]
    )
    return wi, mixed_pdf(
        wo, wi, alpha, share, lambda wi: sampling.eon_pdf(wo, wi, roughness, rho=mean)
    )


@any_array
def dielectric_over_eon_pdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Density of `dielectric_over_eon_sample` at `wi`, per solid angle; `wi` may have any z.

        pdf = p pdf_GGX + (1 - p) pdf_EON,  p = E_r / (E_r + (1 - E_r) E_EON)

    The integral of the density over the upper hemisphere is the probability that a sample is not
    wasted.

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> round(float(dielectric_over_eon_pdf(wo, wi, 0.7, 0.5, 0.3, 1.5)), 5)
        0.26516
    """
    mu, mean = checked_draws(wo, rho, roughness, wi=arguments.checked_sphere("wi", wi))
    share = _facet_share(mu, mean, roughness, coat_of(alpha, ior))
    return mixed_pdf(wo, wi, alpha, share, lambda wi: sampling.eon_pdf(wo, wi, roughness, rho=mean))


def _facet_share(mu: Array, rho: Array, roughness: ArrayLike, coat: Coat) -> Array:
    """Probability of sampling the facets if rho is gray: E_r / E, or 0 if E is 0."""
    reflected = coat.at(mu)[1]
    base = eon_albedo_dir(mu, rho[..., np.newaxis], roughness)[..., 0]
    return reflected / nonzero(reflected + (1.0 - reflected) * base)


TERMS, SMOOTH = 24, 16  # TERMS Chebyshev coefficients for E_single, SMOOTH for D and b
FINE, BELOW = 48, 24  # quadrature nodes within and beyond the critical angle


class Curves(NamedTuple):
    """Functions of the cosine mu outside the interface. `b` is b(mu) mu' / sqrt(1 - mu'^2)."""

    E_single: Array
    D: Array
    b: Array


class Means(NamedTuple):
    """Means <D>, <H>_R and <b>_R of an interface. The field `passed` is 1 - R."""

    D: float | Array
    passed: float | Array
    H: float | Array
    b: float | Array


@dataclass(frozen=True)
class Varnish:
    """Chebyshev coefficients of `Curves`, and the `Means` of the same interface."""

    alpha: float | Array
    ior: float | Array
    curves: Sequence[list[float] | Array]
    means: Means

    def at(self, mu: Array) -> Curves:
        """Values of the polynomials at a cosine; E_single and D may be slightly below 0."""
        x = scaled_cosine(mu, self.alpha)
        return Curves(*(chebyshev_sum(cast(Array, each), x) for each in self.curves))


def nonnegative(curves: Iterable[Array]) -> Curves:
    """Result of `Varnish.at` with E_single and D clamped to at least 0."""
    E_single, D, b = curves
    return Curves(arrays.at_least_0(E_single), arrays.at_least_0(D), b)


def refracted_cosine(mu: Array, ior: float | Array) -> Array:
    """Cosine mu' of the refracted direction; at `ior` 1, mu' equals mu to the last bit."""
    return root(mu * mu + (1.0 - mu) * (1.0 + mu) * (1.0 - 1.0 / ior**2))


def mean_parts(mu: Array, b: Array, ior: float | Array, r: Array) -> tuple[Array, Array, Array]:
    """Returns mu', 1 + r b(mu) and H(mu'), from which k is computed.

    - `b`: The field `b` of `Curves`, which is b(mu) mu' / S'.
    """
    m = refracted_cosine(mu, ior)
    return m, 1.0 + r * b * root((1.0 - m) * (1.0 + m)) / nonzero(m), fon_loss_mu(m)


def absorbed_share(means: Means, rho: Array, r: Array) -> Array:
    """Fraction 1 - R <k> of the light from EON that EON does not reflect a second time.

        1 - R <k> = (1 - R) + R (1 - <k>)
        1 - <k> = 1 - rho + rho A (r (c1 - <b>_R) - W <H>_R^2)

    Here, (1 + c1 r) A = 1 is used to avoid cancellation.
    """
    A, W = formulas.fon_af(r), formulas.eon_multiple_ratio(rho, r)
    lost = 1.0 - rho + rho * A * (r * (C1 - means.b) - W * means.H**2)
    return means.passed + (1.0 - means.passed) * lost


def base_under_varnish(
    mu: tuple[Array, Array],
    s: Array,
    b: tuple[Array, Array],
    ior: float | Array,
    means: Means,
    rho: Array,
    r: Array,
) -> Array:
    """The bracket in equation (1). If `ior` is 1, the bracket is exactly the BRDF of EON.

    To save multiplications for a single material, k(mu_o) k(mu_i) is expanded in powers of W.
    """
    (m_o, p_o, H_o), (m_i, p_i, H_i) = (
        mean_parts(*each, ior, r) for each in zip(mu, b, strict=True)
    )
    first = 1.0 + r * formulas.fon_quotient(m_o, m_i, s / ior**2)
    A, W = formulas.fon_af(r), formulas.eon_multiple_ratio(rho, r)
    again = rho * A * (1.0 - means.passed) / absorbed_share(means, rho, r)
    mixed = again * W * means.H
    multiple = (W + mixed * W * means.H) * (H_o * H_i)
    multiple = multiple + mixed * (p_o * H_i + p_i * H_o) + again * (p_o * p_i)
    return formulas.fon_lambert(rho, r) * (first + multiple)


def varnish_albedo(
    mu: Array, curves: Curves, ior: float | Array, means: Means, rho: Array, r: Array
) -> Array:
    """Directional albedo of EON under a varnish by equation (2)."""
    E_single, D, b = curves
    _, p, H = mean_parts(mu, b, ior, r)
    A, W = formulas.fon_af(r), formulas.eon_multiple_ratio(rho, r)
    k = rho * A * (p + W * (means.H * H))
    R, E_R = 1.0 - means.passed, eon_albedo(means.H, rho, r)
    kept = R * (1.0 - E_R) / absorbed_share(means, rho, r)
    return E_single + D + (1.0 - E_single - D) * (eon_albedo(H, rho, r) - k * kept)


def nonzero(x: float | Array) -> Array:
    """x with zeros replaced by 1, for use as a divisor."""
    return array_namespace(x).where(cast(Array, x) == 0.0, 1.0, x)


def cosine_at(alpha: Array, x: Array) -> tuple[Array, Array]:
    """Returns mu = alpha sinh(x^3 asinh(1 / alpha)), the inverse of `scaled_cosine`, and dmu/dx."""
    xp = array_namespace(alpha)
    extent = xp.asinh(1.0 / alpha)
    mu = arrays.at_most(alpha * xp.sinh(extent * x**3), 1.0)
    return mu, alpha * xp.cosh(extent * x**3) * (3.0 * x * x * extent)


@lru_cache(maxsize=1)
def integral_matrices() -> tuple[Array, Array, Array, Array]:
    """Points x, the derivatives dx/dy at these points, and two matrices of integrals over y.

    The points are x = 1 - (1 - y)^2 at Chebyshev nodes y, so that sqrt(1 - mu^2) is smooth in y. A
    matrix times the values of a function at the points yields integrals that begin at y = 0. For
    the first matrix, (TERMS, FINE), the integrals end at the nodes of `Curves`. For the second
    matrix, (FINE + 1, FINE), the integrals end at all nodes y and at y = 1.
    """
    y = chebyshev_nodes(FINE)
    integral = chebint(chebyshev_coefficients(np.eye(FINE)), lbnd=-1.0, scl=0.5)
    ends = 1.0 - np.sqrt(1.0 - chebyshev_nodes(TERMS)), np.append(y, 1.0)
    to_curves, to_nodes = (chebval(2.0 * end - 1.0, integral).T for end in ends)
    return y * (2.0 - y), 2.0 - 2.0 * y, cast(Array, to_curves), cast(Array, to_nodes)


def varnish_curves(alpha: Array, ior: Array) -> tuple[list[Array], Array]:
    """Chebyshev coefficients of a `Varnish`, and an array with the four fields of `Means`."""
    xp, coat = array_namespace(alpha, ior), coat_of(cast(float, alpha), cast(float, ior))
    places, slope, to_curves, to_nodes = (like(each, alpha) for each in integral_matrices())
    matrix = like(chebyshev_coefficients(np.eye(TERMS)), alpha)

    mu, _ = cosine_at(alpha, like(chebyshev_nodes(TERMS), alpha))
    missing, E_r = coat.at(mu)
    E_single = E_r / (1.0 + coat.average * missing)
    D = E_single * E_single * missing * (1.0 + missing)
    facets = xp.tensordot(matrix, E_single, axes=1), xp.tensordot(matrix, D, axes=1)[:SMOOTH]

    # The cosine mu' of light from EON has the probability density 2 mu'. The interface reflects the
    # fraction E_r of the light within the critical angle, and all light beyond the critical angle.
    fine, step = cosine_at(alpha, places)
    E_single, D = (arrays.at_least_0(chebyshev_sum(each, places)) for each in facets)
    area = 2.0 * fine * step * slope
    share, m = (E_single + D) * area / ior**2, refracted_cosine(fine, ior)
    total = to_nodes[-1]
    squared = 1.0 - 1.0 / ior**2
    x, weight = (like(each, alpha) for each in unit_rule(BELOW))
    beyond, weight = root(squared) * x, 2.0 * squared * weight * x
    R = squared + xp.sum(total * share)
    H = xp.sum(weight * fon_loss_mu(beyond)) + xp.sum(total * share * fon_loss_mu(m))

    # The integral of s / t over all azimuths is 2 S S' (1 / max(mu, mu') - 1). If R(m) is the
    # fraction of the light with the cosine m that is reflected back to EON, then
    #   b mu' / S' = 2 / (pi R) [(1 - mu') int_0^mu' R(m) S m dm + mu' int_mu'^1 R(m) S (1 - m) dm],
    #   <b>_R = 8 / (pi R^2) int R(m) S (1 - m) [int_0^m R(x) S x dx] dm.
    S = root((1.0 - fine) * (1.0 + fine)) / ior
    sine = root((1.0 - beyond) * (1.0 + beyond))
    below = (1.0 - ior**-3) / 3.0
    near, far = 0.5 * share * S, 0.5 * share * S * (1.0 / nonzero(m) - 1.0)
    m_curve = refracted_cosine(mu, ior)
    b = (1.0 - m_curve) * (below + xp.tensordot(to_curves, near, axes=1))
    b = b + m_curve * (xp.sum(total * far) - xp.tensordot(to_curves, far, axes=1))
    b_R = xp.sum(weight * sine * (1.0 / nonzero(beyond) - 1.0) * (1.0 - sine**3)) / 6.0
    b_R = b_R + xp.sum(total * far * (below + xp.tensordot(to_nodes[:-1], near, axes=1)))

    divisor = nonzero(R)
    b = xp.tensordot(matrix, 2.0 / np.pi * b / divisor, axes=1)[:SMOOTH]
    D_avg, b_avg = xp.sum(total * D * area), 8.0 / np.pi * b_R / divisor**2
    return [*facets, b], xp.stack([D_avg, 1.0 - R, H / divisor, b_avg])


@lru_cache(maxsize=CACHED)
def constant_varnish(alpha: float, ior: float) -> Varnish:
    curves, means = varnish_curves(np.asarray(alpha), np.asarray(ior))
    return Varnish(alpha, ior, [each.tolist() for each in curves], Means(*means.tolist()))


@any_array
def varnish_of(alpha: ArrayLike, ior: ArrayLike) -> Varnish:
    """The `Varnish` for an alpha and an ior. Results for numbers and NumPy arrays are cached."""
    coat_of(alpha, ior)
    if not arrays.library(alpha):
        return constant_varnish(float(cast(float, alpha)), float(cast(float, ior)))
    numbers = cast(Array, alpha), cast(Array, ior)
    curves, means = varnish_curves(*numbers)
    return Varnish(*numbers, curves, Means(*means))


@any_array
def varnished_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """BRDF of EON below a rough dielectric interface.

        f = f_r + T(mu_o) T(mu_i) / n^2 [f_b(wo', wi') + R k(mu_o) k(mu_i) / (pi (1 - R <k>))]

    Result (..., C): 1/sr. The BRDF is reciprocal. At `ior` 1, the BRDF equals EON to the last bit.
    Accuracy: the albedo differs by at most 0.012 from the albedo of random walks between facets and
    EON. A call takes 1.4 times as long as a call of `dielectric_over_eon_brdf`. [Saunderson1942].

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> varnished_brdf(wo, wi, [0.7, 0.1], 0.5, 0.3, 1.5).round(5)
        array([0.19812, 0.07051])
    """
    varnish = varnish_of(alpha, ior)
    n, means = varnish.ior, varnish.means

    def base(wo: Array, wi: Array, color: Array, r: Array) -> Array:
        mu_o, mu_i, s = formulas.cosines(wo, wi)
        E_o, D_o, b_o = nonnegative(varnish.at(mu_o))
        E_i, D_i, b_i = nonnegative(varnish.at(mu_i))
        T_T = (1.0 - E_o - D_o) * (1.0 - E_i - D_i)
        below = base_under_varnish((mu_o, mu_i), s, (b_o, b_i), n, means, color, r)
        return D_o * D_i / (np.pi * nonzero(means.D)) + T_T / n**2 * below

    facets = dielectric_brdf(wo, wi, 1.0, alpha, ior, compensate=False)
    return facets + any_array(evaluate)(base, wo, wi, rho, roughness=roughness)


@any_array
def varnished_albedo_dir(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Directional albedo of `varnished_brdf`; 1 where rho is 1.

    E = E_r + T [E_b(mu') - R k (1 - <E_b>_R) / (1 - R <k>)]

    >>> varnished_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.3, 1.5).round(5)
    array([[0.54965, 1.     ],
           [0.48698, 1.     ]])
    """
    return _albedo(mu, rho, roughness, alpha, ior)[1]


@any_array
def varnished_albedo_avg(rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float) -> Array:
    """Cosine-weighted average of `varnished_albedo_dir` over all viewing directions.

    <E> = <E_r> + n^2 [<E_b> - R <E_b>_R - R (<E_b>_R - R <k>) (1 - <E_b>_R) / (1 - R <k>)]
    <E_r> = 1 - n^2 (1 - R)

    >>> varnished_albedo_avg([0.7, 1.0], 0.5, 0.3, 1.5).round(5)
    array([0.49762, 1.     ])
    """
    (color,), (r,) = any_array(checked_colors)({"rho": rho}, roughness=roughness)
    varnish = varnish_of(alpha, ior)
    passed, lost = varnish.means.passed, absorbed_share(varnish.means, color, r)
    E_b, E_R = eon_albedo(C1 - C2, color, r), eon_albedo(varnish.means.H, color, r)
    again = (1.0 - passed) * (E_R - 1.0 + lost) * (1.0 - E_R) / lost
    return 1.0 - varnish.ior**2 * (passed - E_b + (1.0 - passed) * E_R + again)


@any_array
def varnished_sample(
    wo: ArrayLike, u: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> tuple[Array, Array]:
    """Direction and density of a sample of the visible facets or of a cosine lobe.

    `wi` (..., 3): Unit vectors; a vector with z < 0 is a wasted sample of weight 0. `pdf` (...):
    1/sr. The facets are chosen with the probability E_single / E for the mean of rho's channels.
    [Dupuy2023].

        >>> wi, pdf = varnished_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.7, 0.5, 0.3, 1.5)
        >>> wi.round(5), round(float(pdf), 5)
        (array([0.     , 0.6753 , 0.73755]), 0.22262)
    """
    mu, mean = checked_draws(wo, rho, roughness, u=arguments.checked_pairs("u", u))
    share = _share(mu, mean, roughness, alpha, ior)
    wi = mixed_sample(wo, u, alpha, share, lambda _: _by_cosine(u, share))
    return wi, mixed_pdf(wo, wi, alpha, share, sampling.cosine_pdf)


@any_array
def varnished_pdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Density of `varnished_sample` at `wi`, per solid angle; `wi` may have any z.

    pdf = p pdf_GGX + (1 - p) mu_i / pi,  p = E_single / E

    >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
    >>> round(float(varnished_pdf(wo, wi, 0.7, 0.5, 0.3, 1.5)), 5)
    0.32231
    """
    mu, mean = checked_draws(wo, rho, roughness, wi=arguments.checked_sphere("wi", wi))
    share = _share(mu, mean, roughness, alpha, ior)
    return mixed_pdf(wo, wi, alpha, share, sampling.cosine_pdf)


@any_array
def _by_cosine(u: ArrayLike, share: Array) -> Array:
    """Cosine-weighted direction for u1 in [share, 1).

    1 - u1 is rescaled instead of u1, to keep all digits near u1 = 1.
    """
    u1, u2 = unpack_uniforms(u)
    rest = arrays.at_most((1.0 - u1) / nonzero(1.0 - share), 1.0)
    return sampling.around(root(rest), root(1.0 - rest), u2)


@any_array
def _albedo(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> tuple[Array, Array]:
    """Albedo E_single of the facets, (..., 1), and albedo E of facets and EON, (..., C)."""
    (color,), (r, height) = checked_colors({"rho": rho}, roughness=roughness, mu=mu)
    varnish = varnish_of(alpha, ior)
    curves = nonnegative(varnish.at(height))
    return curves.E_single, varnish_albedo(height, curves, varnish.ior, varnish.means, color, r)


def _share(mu: Array, rho: Array, roughness: ArrayLike, alpha: float, ior: float) -> Array:
    """Probability of sampling the facets if rho is gray: E_single / E, or 0 if E is 0."""
    single, total = _albedo(mu, rho[..., np.newaxis], roughness, alpha, ior)
    return (single / nonzero(total))[..., 0]
