# SPDX-License-Identifier: Apache-2.0
"""EON below a rough dielectric interface, with its exits and internal reflections: a varnish, isotropic.

The interface reflects f_r and passes T = 1 - E_r, which reaches EON along refracted directions w'. Of what
EON returns, a share R is reflected back to it at each pass. The first pass keeps EON's value f_b; the others
keep its mean, as in the sum of [Saunderson1942], here for a base whose albedo depends on direction:

    f = f_r + T(mu_o) T(mu_i) / n^2 [f_b(wo', wi') + R k(mu_o) k(mu_i) / (pi (1 - R <k>))]       (1)
    w' = (x / n, y / n, mu'),  mu'^2 = mu^2 + (1 - mu^2) (1 - 1 / n^2)
    R = 1 - (1 - <E_r>) / n^2
    E = E_r + T [E_b(mu') - R k (1 - <E_b>_R) / (1 - R <k>)]                                     (2)

n is the index and E_b EON's albedo. k is pi times the mean of f_b, and `<>_R` any mean, over the light that the
interface reflects back: all of it beyond the critical angle, and a share E_r within. R needs no albedo from inside,
since an interface that loses nothing is reciprocal: n^2 (1 - R) = 1 - `<E_r>`. (2) integrates (1), as
T mu dw = n^2 T mu' dw'. At rho = 1 it is 1, and at index 1 (1) is EON to the last bit. With A, D and c1, c2 of
[Portsmouth2025], r its roughness, H of `fon_loss` and the weight W of H H in EON,

    k = rho A (1 + r b + W H(mu') <H>_R),  b(mu) = <s / t>_R,  <k> = rho A (1 + r <b>_R + W <H>_R^2)

Facets reflect onto each other with their mean reflectance F = E_single / E_ss, which makes f reciprocal:

    E_r = E_single + D,  D = F^2 (1 - E_ss),  f_r = f_single + D(mu_o) D(mu_i) / (pi <D>)

Approximate are the mean shape of all passes but the first, D, and directions that refract as at a smooth
surface. Against light that walks (tools/fits/varnish_walk.py: index 1.1 to 2, alpha 0.05 to 0.7, rho 0 to 1, r 0
and 1, cosines 0.05 to 1) the albedo is off by at most 0.012, and at rho 1 by nothing; what EON returns into a twelfth
of the hemisphere is 0.95 to 1.05 of the walk's at r 0, and 0.79 to 1.15 at r 1. (2) is the integral of (1) to 1e-6,
and to 1e-4 at alpha 0.01 and index near 1.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
- `rho` (..., C): Reflectance of EON per channel, in [0, 1]; a number is one channel.
- `roughness` (...): That of EON, in [0, 1].
- `alpha`: GGX roughness of the interface, in [0.01, 1]: one number for all pairs.
- `ior`: Its index of refraction, in [1, 4]: one number for all pairs.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebval

from mxeon.models import diffuse as formulas
from mxeon.models.coat import (
    checked_draws,
    checked_mean,
    coat_of,
    mixed_pdf,
    mixed_sample,
    of_one_coat,
    place,
    unpack_cosine,
)
from mxeon.models.core.arguments import checked_colors
from mxeon.models.core.arrays import (
    Array,
    ArrayLike,
    any_array,
    array_namespace,
    at_least_0,
    at_most,
    library,
    like,
    root,
)
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.evaluation import evaluate
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.diffuse import C1, C2, eon_albedo, fon_loss_mu
from mxeon.models.microfacet import dielectric_brdf
from mxeon.models.sampling import around, cosine_pdf, unpack_uniforms

NODES, SMOOTH = 24, 16  # coefficients of E_single and of the other curves, over `place`
FINE, BELOW = 48, 24  # nodes of integrals over what E_r returns, and beyond the critical angle
KEPT = 64  # interfaces that are kept


@dataclass(frozen=True)
class Varnish:
    """An interface: Chebyshev coefficients of its curves over the outer cosine, and its means.

    - `curves`: E_single, D, and b mu' / S', S' = sqrt(1 - mu'^2).
    - `means`: <D>, 1 - R, <H>_R and <b>_R.
    """

    alpha: float | Array
    ior: float | Array
    curves: Sequence[list[float] | Array]
    means: Sequence[float | Array]

    def at(self, mu: Array) -> list[Array]:
        """E_single, D, and b mu' / S'; the sums that stand for the first two may fall below 0."""
        x = place(mu, self.alpha)
        return [chebyshev_sum(cast(Array, each), x) for each in self.curves]


def cut(curves: Sequence[Array]) -> tuple[Array, Array, Array]:
    """E_single and D, not below 0, and b mu' / S'."""
    single, several, turned = curves
    return at_least_0(single), at_least_0(several), turned


def inner(mu: Array, ior: float | Array) -> Array:
    """mu', which at index 1 is mu to the last bit."""
    return root(mu * mu + (1.0 - mu) * (1.0 + mu) * (1.0 - 1.0 / ior**2))


def shape(mu: Array, turned: Array, ior: float | Array, r: Array) -> tuple[Array, Array, Array]:
    """mu', 1 + r b and H(mu'): k = rho A (1 + r b + W <H>_R H)."""
    m = inner(mu, ior)
    return m, 1.0 + r * turned * root((1.0 - m) * (1.0 + m)) / nonzero(m), fon_loss_mu(m)


def absorbed(means: Sequence[float | Array], rho: Array, r: Array) -> Array:
    """1 - R `<k>`, as 1 - R + R (1 - `<k>`) without ones that cancel: (1 + c1 r) A is 1."""
    _, exits, loss, turn = means
    weight = formulas.eon_multiple_weight(rho, r)
    lost = 1.0 - rho + rho * formulas.fon_a(r) * (r * (C1 - turn) - weight * loss**2)
    return exits + (1.0 - exits) * lost


def under(
    mu: tuple[Array, Array],
    s: Array,
    turned: tuple[Array, Array],
    ior: float | Array,
    means: Sequence[float | Array],
    rho: Array,
    r: Array,
) -> Array:
    """The brackets of (1): EON itself at index 1, to the last bit.

    k k is expanded into powers of W, so that products with channels are few where the material is one.
    """
    (m_o, p_o, H_o), (m_i, p_i, H_i) = (
        shape(*each, ior, r) for each in zip(mu, turned, strict=True)
    )
    single = 1.0 + r * formulas.fon_quotient(m_o, m_i, s / ior**2)
    weight = formulas.eon_multiple_weight(rho, r)
    again = rho * formulas.fon_a(r) * (1.0 - means[1]) / absorbed(means, rho, r)
    mixed = again * weight * means[2]
    several = (weight + mixed * weight * means[2]) * (H_o * H_i)
    several = several + mixed * (p_o * H_i + p_i * H_o) + again * (p_o * p_i)
    return formulas.fon_scale(rho, r) * (single + several)


def albedo(
    mu: Array,
    curves: Sequence[Array],
    ior: float | Array,
    means: Sequence[float | Array],
    rho: Array,
    r: Array,
) -> Array:
    """(2)."""
    (single, several, turned), (_, exits, loss, _) = curves, means
    _, p, H = shape(mu, turned, ior, r)
    k = rho * formulas.fon_a(r) * (p + formulas.eon_multiple_weight(rho, r) * (loss * H))
    kept = (1.0 - exits) * (1.0 - eon_albedo(loss, rho, r)) / absorbed(means, rho, r)
    return single + several + (1.0 - single - several) * (eon_albedo(H, rho, r) - k * kept)


def nonzero(x: float | Array) -> Array:
    """x, or 1 where it is 0 and what it divides is too."""
    xp, zero = array_namespace(x), cast(Array, x) == 0.0
    return xp.where(zero, 1.0, x)


def nodes(alpha: Array, x: Array) -> tuple[Array, Array]:
    """Cosine at these places, and its derivative by them."""
    xp = array_namespace(alpha)
    extent = xp.asinh(1.0 / alpha)
    mu = at_most(alpha * xp.sinh(extent * x**3), 1.0)
    return mu, alpha * xp.cosh(extent * x**3) * (3.0 * x * x * extent)


@lru_cache(maxsize=1)
def running() -> tuple[Array, Array, Array, Array]:
    """Places of the nodes of integrals, dx/dy there, and integrals of what has given values there.

    The places are x = 1 - (1 - y)^2, so that sqrt(1 - mu^2) is smooth in y, whose Chebyshev nodes they have.
    The integrals go from 0 to the nodes of the curves, (NODES, FINE), and to these and 1, (FINE + 1, FINE).
    """
    y = chebyshev_nodes(FINE)
    integral = chebint(chebyshev_coefficients(np.eye(FINE)), lbnd=-1.0, scl=0.5)
    ends = 1.0 - np.sqrt(1.0 - chebyshev_nodes(NODES)), np.append(y, 1.0)
    to_curves, to_nodes = (chebval(2.0 * end - 1.0, integral).T for end in ends)
    return y * (2.0 - y), 2.0 - 2.0 * y, cast(Array, to_curves), cast(Array, to_nodes)


def integrated(alpha: Array, ior: Array) -> tuple[list[Array], Array]:
    """Coefficients of the curves of a `Varnish`, and its means, shape (4,)."""
    xp, coat = array_namespace(alpha, ior), coat_of(cast(float, alpha), cast(float, ior))
    places, slope, to_curves, to_nodes = (like(each, alpha) for each in running())
    matrix = like(chebyshev_coefficients(np.eye(NODES)), alpha)

    # The facets: E_single, and D.
    mu, _ = nodes(alpha, like(chebyshev_nodes(NODES), alpha))
    missing, reflected = coat.at(mu)
    single = reflected / (1.0 + coat.average * missing)
    several = single * single * missing * (1.0 + missing)
    facets = xp.tensordot(matrix, single, axes=1), xp.tensordot(matrix, several, axes=1)[:SMOOTH]

    # What they return: E_r 2 mu' dmu' at the nodes of integrals, and the part beyond the critical angle.
    fine, step = nodes(alpha, places)
    single, several = (at_least_0(chebyshev_sum(each, places)) for each in facets)
    area = 2.0 * fine * step * slope
    share, m = (single + several) * area / ior**2, inner(fine, ior)
    total = to_nodes[-1]
    squared = 1.0 - 1.0 / ior**2
    x, weight = (like(each, alpha) for each in unit_rule(BELOW))
    beyond, weight = root(squared) * x, 2.0 * squared * weight * x
    R = squared + xp.sum(total * share)
    loss = xp.sum(weight * fon_loss_mu(beyond)) + xp.sum(total * share * fon_loss_mu(m))

    # s / t has the integral 2 S S' (1 / max(mu, mu') - 1) over azimuths; with R(m) the share that returns,
    #   b mu' / S' = 2 / (pi R) [(1 - mu') int_0^mu' R(m) S m dm + mu' int_mu'^1 R(m) S (1 - m) dm],
    #   <b>_R = 8 / (pi R^2) int R(m) S (1 - m) [int_0^m R(x) S x dx] dm.
    S = root((1.0 - fine) * (1.0 + fine)) / ior
    sine = root((1.0 - beyond) * (1.0 + beyond))
    below = (1.0 - ior**-3) / 3.0
    near, far = 0.5 * share * S, 0.5 * share * S * (1.0 / nonzero(m) - 1.0)
    m_curve = inner(mu, ior)
    turned = (1.0 - m_curve) * (below + xp.tensordot(to_curves, near, axes=1))
    turned = turned + m_curve * (xp.sum(total * far) - xp.tensordot(to_curves, far, axes=1))
    turn = xp.sum(weight * sine * (1.0 / nonzero(beyond) - 1.0) * (1.0 - sine**3)) / 6.0
    turn = turn + xp.sum(total * far * (below + xp.tensordot(to_nodes[:-1], near, axes=1)))

    divisor = nonzero(R)
    turned = xp.tensordot(matrix, 2.0 / np.pi * turned / divisor, axes=1)[:SMOOTH]
    means = [
        xp.sum(total * several * area),
        1.0 - R,
        loss / divisor,
        8.0 / np.pi * turn / divisor**2,
    ]
    return [*facets, turned], xp.stack(means)


@lru_cache(maxsize=KEPT)
def constant_varnish(alpha: float, ior: float) -> Varnish:
    """An interface that does not change."""
    curves, means = integrated(np.asarray(alpha), np.asarray(ior))
    return Varnish(alpha, ior, [each.tolist() for each in curves], means.tolist())


@any_array
def varnish_of(alpha: float, ior: float) -> Varnish:
    """An interface, checked; for arrays of other libraries with gradients, and anew each time."""
    coat_of(alpha, ior)
    if not library(alpha):
        return constant_varnish(float(alpha), float(ior))
    curves, means = integrated(cast(Array, alpha), cast(Array, ior))
    return Varnish(alpha, ior, curves, list(means))


@of_one_coat
def varnished_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """BRDF of EON below a rough dielectric interface.

        f = f_r + T(mu_o) T(mu_i) / n^2 [f_b(wo', wi') + R k(mu_o) k(mu_i) / (pi (1 - R <k>))]

    Result (..., C): 1/sr. It is reciprocal, and EON to the last bit at `ior` 1. Accuracy: the albedo is off
    by at most 0.012 from that of light that walks between facets and EON. [Saunderson1942].

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> varnished_brdf(wo, wi, [0.7, 0.1], 0.5, 0.3, 1.5).round(5)
        array([0.19812, 0.07051])
    """
    varnish = varnish_of(alpha, ior)
    n, means = varnish.ior, varnish.means

    def base(wo: Array, wi: Array, color: Array, r: Array) -> Array:
        mu_o, mu_i, s = formulas.cosines(wo, wi)
        single_o, several_o, turned_o = cut(varnish.at(mu_o))
        single_i, several_i, turned_i = cut(varnish.at(mu_i))
        passed = (1.0 - single_o - several_o) * (1.0 - single_i - several_i) / n**2
        several = several_o * several_i / (np.pi * nonzero(means[0]))
        return several + passed * under((mu_o, mu_i), s, (turned_o, turned_i), n, means, color, r)

    facets = dielectric_brdf(wo, wi, 1.0, alpha, ior, compensate=False)
    return facets + any_array(evaluate)(base, wo, wi, rho, roughness=roughness)


@of_one_coat
def varnished_albedo_dir(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Directional albedo of `varnished_brdf`.

        E = E_r + T [E_b(mu') - R k (1 - <E_b>_R) / (1 - R <k>)]

    Result (..., C): 1 where rho is 1.

        >>> varnished_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([[0.54965, 1.     ],
               [0.48698, 1.     ]])
    """
    return _albedo(mu, rho, roughness, alpha, ior)[1]


@of_one_coat
def varnished_albedo_avg(rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float) -> Array:
    """Average of `varnished_albedo_dir` over the viewer's directions, weighted by the cosine.

        <E> = <E_r> + n^2 [<E_b> - R <E_b>_R - R (<E_b>_R - R <k>) (1 - <E_b>_R) / (1 - R <k>)]

    Result (..., C); <E_r> = 1 - n^2 (1 - R).

        >>> varnished_albedo_avg([0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([0.49762, 1.     ])
    """
    (color,), (r,) = any_array(checked_colors)({"rho": rho}, roughness=roughness)
    varnish = varnish_of(alpha, ior)
    _, exits, loss, _ = varnish.means
    lost = absorbed(varnish.means, color, r)
    mean, within = eon_albedo(C1 - C2, color, r), eon_albedo(loss, color, r)
    again = (1.0 - exits) * (within - 1.0 + lost) * (1.0 - within) / lost
    return 1.0 - varnish.ior**2 * (exits - mean + (1.0 - exits) * within + again)


@of_one_coat
def varnished_sample(
    wo: ArrayLike, u: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> tuple[Array, Array]:
    """Direction reflected by a visible facet, or drawn by the cosine; and its density.

    `wi` (..., 3): Unit vectors; those with z < 0 are wasted, their weight is 0. `pdf` (...): 1/sr.
    The facets are chosen with probability E_single / E at the mean of the channels. [Dupuy2023].

        >>> wi, pdf = varnished_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.7, 0.5, 0.3, 1.5)
        >>> wi.round(5), round(float(pdf), 5)
        (array([0.     , 0.6753 , 0.73755]), 0.22262)
    """
    checked_draws(wo, rho, roughness, u=u)
    share = _share(wo, rho, roughness, alpha, ior)
    wi = mixed_sample(wo, u, alpha, share, lambda _: _by_cosine(u, share))
    return wi, mixed_pdf(wo, wi, alpha, share, cosine_pdf)


@of_one_coat
def varnished_pdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Density of `varnished_sample` at `wi`, on the whole sphere, in solid angle.

    pdf = p pdf_GGX + (1 - p) mu_i / pi,  p = E_single / E

    >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
    >>> round(float(varnished_pdf(wo, wi, 0.7, 0.5, 0.3, 1.5)), 5)
    0.32231
    """
    checked_draws(wo, rho, roughness, wi=wi)
    return mixed_pdf(wo, wi, alpha, _share(wo, rho, roughness, alpha, ior), cosine_pdf)


@any_array
def _by_cosine(u: ArrayLike, share: Array) -> Array:
    """Direction drawn by the cosine with what u1 leaves: 1 - u1 over 1 - share has all digits at u1 near 1."""
    u1, u2 = unpack_uniforms(u)
    rest = at_most((1.0 - u1) / nonzero(1.0 - share), 1.0)
    return around(root(rest), root(1.0 - rest), u2)


@any_array
def _albedo(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> tuple[Array, Array]:
    """E_single and E, (..., C)."""
    (color,), (r, height) = checked_colors({"rho": rho}, roughness=roughness, mu=mu)
    varnish = varnish_of(alpha, ior)
    curves = cut(varnish.at(height))
    return curves[0], albedo(height, curves, varnish.ior, varnish.means, color, r)


def _share(wo: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float) -> Array:
    """E_single / E at the mean of rho's channels; 0 where nothing is reflected."""
    mean = checked_mean(rho)[..., np.newaxis]
    single, total = _albedo(unpack_cosine(wo), mean, roughness, alpha, ior)
    return (single / nonzero(total))[..., 0]
