# SPDX-License-Identifier: Apache-2.0
"""A dielectric over EON, and OpenPBR's base: a metal and such a dielectric, mixed, with one roughness of facets.

The dielectric reflects E_r of the light, and EON gets the rest, as `layer` of the specification says:

    f = f_r + (1 - E_r(mu_o)) f_EON,  E = E_r + (1 - E_r) E_EON

E_r, with the energy compensation, is at most the albedo of facets that reflect everything, and so at most 1. This is
no varnish: what EON returns passes freely, while below an interface light is reflected and refracted on its way out.
The albedo is up to 2.2 times that of light that walks below the same interface, and 1.04 to 1.84 times at index 1.5 and
rho 0.2: tools/fits/varnish_walk.py. `mxeon.models.varnished` has both in closed form.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `u` (..., 2): Independent uniform random numbers, in [0, 1). The first one chooses the lobe as well.
- `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
- `rho` (..., C): Reflectance of EON per channel, of the metal too, in [0, 1]; a number is one channel.
- `roughness` (...): That of EON, in [0, 1].
- `alpha`, `ior`: GGX roughness of the dielectric, in [0.01, 1], and its index of refraction, in [1, 4]: one number
  each for all pairs.
- `specular_roughness`, `specular_ior`: The same of OpenPBR, root of alpha in [0.1, 1].
- `metalness` (...): `base_metalness`, m below, in [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the shapes do
not broadcast.

Where there is one dielectric, its albedo and energy compensation depend on the viewer's cosine alone: one integral at
some cosines, interpolated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, wraps
from inspect import signature
from typing import ParamSpec, TypeVar, cast

import numpy as np

from mxeon.models.core.arguments import (
    checked,
    checked_color,
    checked_colors,
    checked_directions,
    checked_sphere,
    checked_triples,
    lead_shape,
)
from mxeon.models.core.arrays import (
    Array,
    ArrayLike,
    Numbers,
    any_array,
    array_namespace,
    at_least_0,
    at_most,
    cosine,
    cube_root,
    library,
    like,
    magnitude,
    root,
    with_arguments,
)
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.diffuse import C1, eon_albedo_dir, eon_brdf, fon_loss_mu
from mxeon.models.microfacet import dielectric_brdf, generalized_schlick_brdf
from mxeon.models.microfacet.fresnel import dielectric, dielectric_avg, fresnel_schlick_avg
from mxeon.models.microfacet.slopes import slope_nodes
from mxeon.models.sampling import (
    eon_pdf,
    eon_sample,
    ggx_pdf,
    ggx_sample,
    stretched,
    unpack_uniforms,
)

P = ParamSpec("P")
R = TypeVar("R")

NODES = 40  # of the curves, in the cube root of a logarithmic scale of the cosine
KEPT = 64  # dielectrics whose curves are kept


@dataclass(frozen=True)
class Coat:
    """A dielectric's curves over the viewer's cosine.

    - `alpha`, `average`: GGX roughness, which sets the scale of the cosine, and F_ss.
    - `missing`, `reflected`, `edge`: Coefficients of (1 - E_ss) / E_ss, of E_r, and of the facets'
      mean of (1 - c)^5, which is E of a metal with Schlick's curve that is black along the normal.
    """

    alpha: float | Array
    average: float | Array
    missing: list[float] | Array
    reflected: list[float] | Array
    edge: list[float] | Array

    def at(self, mu: Array) -> tuple[Array, Array]:
        """(1 - E_ss) / E_ss, and E_r, both not below 0."""
        missing, reflected = self._sums(mu, self.missing, self.reflected)
        return missing, at_most(reflected, 1.0)

    def edge_at(self, mu: Array) -> Array:
        """The facets' mean of (1 - c)^5."""
        [edge] = self._sums(mu, self.edge)
        return edge

    def _sums(self, mu: Array, *curves: list[float] | Array) -> list[Array]:
        """Curves at these cosines, not below 0."""
        x = place(mu, self.alpha)
        return [at_least_0(chebyshev_sum(cast(Array, each), x)) for each in curves]


def place(mu: Array, alpha: float | Array) -> Array:
    """Cosine on the scale of the curves, in [0, 1]: the cube root spreads terms like mu log(mu) at 0."""
    extent = array_namespace(alpha).asinh(1.0 / alpha)
    return cube_root(array_namespace(mu, alpha).asinh(mu / alpha) / extent)


def curves(alpha: Array, ior: Array) -> Array:
    """Coefficients of the curves of a `Coat`, shape (NODES, 3).

    Accuracy: error of the curves below 2e-7 for alpha >= 0.01 and ior in [1, 4], 5e-8 of it that of
    the slopes at grazing.
    """
    xp, x = array_namespace(alpha), like(chebyshev_nodes(NODES), alpha)
    mu = at_most(alpha * xp.sinh(xp.asinh(1.0 / alpha) * x**3), 1.0)
    zero = 0.0 * mu
    wo = xp.stack([root((1.0 - mu) * (1.0 + mu)), zero, mu])
    c, weight = slope_nodes(wo, xp.stack([zero + alpha, zero + alpha]), isotropic=True)
    missing = 1.0 / xp.sum(weight, axis=(0, 1)) - 1.0
    single = xp.sum(dielectric(c, zero + ior) * weight, axis=(0, 1))
    edge = xp.sum((1.0 - c) ** 5 * weight, axis=(0, 1))
    values = xp.stack([missing, single * (1.0 + dielectric_avg(ior) * missing), edge], axis=-1)
    matrix = like(chebyshev_coefficients(np.eye(NODES)), mu)
    return xp.tensordot(matrix, values, axes=1)


@lru_cache(maxsize=KEPT)
def constant_coat(alpha: float, ior: float) -> Coat:
    """Curves of a dielectric that does not change."""
    index = np.asarray(ior)
    return Coat(alpha, float(dielectric_avg(index)), *curves(np.asarray(alpha), index).T.tolist())


@any_array
def coat_of(alpha: float, ior: float) -> Coat:
    """Curves of a dielectric, checked; for arrays of other libraries with gradients, and anew each time."""
    numbers = checked_scalar("alpha", alpha, "coat_alpha"), checked_scalar("ior", ior, "coat_ior")
    if not library(numbers[0]):
        return constant_coat(*map(float, numbers))
    rows = curves(*numbers)
    return Coat(numbers[0], dielectric_avg(numbers[1]), rows[:, 0], rows[:, 1], rows[:, 2])


def checked_scalar(name: str, value: ArrayLike, quantity: str = "") -> Numbers:
    """Argument that is one number for all pairs, checked."""
    number = checked(name, value, quantity)
    if number.ndim:
        raise ValueError(
            f"{name} must be one number, for all pairs; got shape {tuple(number.shape)}"
        )
    return number


@any_array
def _brought(*arguments: ArrayLike) -> tuple[ArrayLike, ...]:
    """Arguments in one library."""
    return arguments


def of_one_coat(function: Callable[P, R]) -> Callable[P, R]:
    """Function of arrays of any library, which are brought to one.

    Parameters annotated as `float` are the numbers of the coat, which stay as they are where they are plain.
    """
    parameters = signature(function)
    types = {each.name: each.annotation for each in parameters.parameters.values()}
    own = [name for name, kind in types.items() if kind in (float, "float")]

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        call = parameters.bind(*args, **kwargs).arguments
        plain = {name: call.pop(name) for name in own if not library(call[name])}
        brought = dict(zip(call, _brought(*call.values()), strict=True))
        return cast(Callable[..., R], function)(**brought, **plain)

    wrapper.__doc__ = with_arguments(function.__doc__, function.__module__, list(types))
    return wrapper


@any_array
def unpack_cosine(wo: ArrayLike) -> Array:
    """Cosine of directions to the viewer, checked."""
    return clipped(checked_directions("wo", wo)[..., 2])


def clipped(z: Array) -> Array:
    """Height as a cosine."""
    return cosine(at_least_0(z))


AVERAGED = 32  # nodes of the average over the viewer's cosine


@of_one_coat
def dielectric_over_eon_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """BRDF of an isotropic `dielectric_bsdf` layered over EON.

        f = f_r + (1 - E_r(mu_o)) f_EON

    Result (..., C): 1/sr; not reciprocal, as neither of both is. Accuracy: E_r and the energy compensation,
    which the first call for a dielectric tabulates, have an error below 2e-7. [MaterialX2026], sections
    `layer` and Energy Compensation; [Portsmouth2025], Eq. (19).

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> dielectric_over_eon_brdf(wo, wi, [0.7, 0.1], 0.5, 0.3, 1.5).round(5)
        array([0.23317, 0.08236])
    """
    coat = coat_of(alpha, ior)
    bare = dielectric_brdf(wo, wi, 1.0, alpha, ior, compensate=False)
    missing, reflected = (each[..., np.newaxis] for each in coat.at(unpack_cosine(wo)))
    base = eon_brdf(wo, wi, rho, roughness)
    return bare * (1.0 + coat.average * missing) + (1.0 - reflected) * base


@of_one_coat
def dielectric_over_eon_albedo_dir(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Directional albedo of `dielectric_over_eon_brdf`.

        E = E_r + (1 - E_r) E_EON

    Result (..., C): 1 where rho is 1. Accuracy: error below 2e-7.

        >>> dielectric_over_eon_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([[0.7426 , 1.     ],
               [0.68356, 1.     ]])
    """
    base = eon_albedo_dir(mu, rho, roughness)
    height = cast(Array, mu) if library(mu) else np.asarray(mu, np.float64)
    reflected = coat_of(alpha, ior).at(clipped(height))[1][..., np.newaxis]
    return reflected + (1.0 - reflected) * base


@of_one_coat
def dielectric_over_eon_albedo_avg(
    rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Average of `dielectric_over_eon_albedo_dir` over the viewer's directions, weighted by the cosine.

    Result (..., C). Accuracy: error below 2e-7. EON's albedo falls from its value at grazing by
    what FON loses: of the light that the dielectric passes, the mean loss counts.

        >>> dielectric_over_eon_albedo_avg([0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([0.69645, 1.     ])
    """
    coat = coat_of(alpha, ior)
    number = coat.alpha
    xp, (x, weight) = array_namespace(number), unit_rule(AVERAGED)
    if library(number):
        x, weight = like(x, cast(Array, number)), like(weight, cast(Array, number))
    extent = xp.asinh(1.0 / number)
    mu = at_most(number * xp.sinh(extent * x**3), 1.0)
    weight = weight * 2.0 * mu * number * xp.cosh(extent * x**3) * extent * 3.0 * x * x
    reflected = coat.at(mu)[1]
    passed = xp.sum(weight * (1.0 - reflected))
    share = xp.sum(weight * (1.0 - reflected) * fon_loss_mu(mu)) / (passed * C1)
    grazing, upright = (eon_albedo_dir(each, rho, roughness) for each in (0.0, 1.0))
    return (1.0 - passed) + passed * (grazing + share * (upright - grazing))


EDGE = 1.0, 1.0, 5.0  # color82, color90 and exponent of the metal's curve


@of_one_coat
def openpbr_base_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    specular_roughness: float,
    specular_ior: float,
    metalness: ArrayLike,
) -> Array:
    """BRDF of OpenPBR's base: a metal and a dielectric over EON, mixed.

        f = (1 - m) f_dielectric_over_eon + m f_metal

    Result (..., C): 1/sr. The weights and `specular_color` are 1, and nothing is anisotropic, transmits or
    scatters below the surface. The metal's curve is Schlick's. [MaterialX2026], section `mix`.

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> openpbr_base_brdf(wo, wi, [0.7, 0.1], 0.5, 0.5, 1.5, 0.25).round(5)
        array([0.56487, 0.13156])
    """
    share = _metal_share(wo, wi, rho, roughness, metalness)
    alpha = _alpha(specular_roughness, specular_ior)
    missing = coat_of(alpha, specular_ior).at(unpack_cosine(wo))[0][..., np.newaxis]
    metal = generalized_schlick_brdf(wo, wi, rho, *EDGE[:2], alpha, EDGE[2], compensate=False)
    metal = metal * (1.0 + fresnel_schlick_avg(rho, *EDGE) * missing)
    glossy = dielectric_over_eon_brdf(wo, wi, rho, roughness, alpha, specular_ior)
    return (1.0 - share) * glossy + share * metal


@of_one_coat
def openpbr_base_albedo_dir(
    mu: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    specular_roughness: float,
    specular_ior: float,
    metalness: ArrayLike,
) -> Array:
    """Directional albedo of `openpbr_base_brdf`.

        E = (1 - m) E_dielectric_over_eon + m (rho E_ss + (1 - rho) W) (1 + F_ss (1 - E_ss) / E_ss)

    W is the facets' mean of (1 - c)^5.

    Result (..., C): 1 where rho is 1. Accuracy: error below 2e-7.

        >>> openpbr_base_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.5, 1.5, 0.25).round(5)
        array([[0.74305, 1.     ],
               [0.68378, 1.     ]])
    """
    cosine, color, share = _albedo_inputs(mu, rho, roughness, metalness)
    alpha = _alpha(specular_roughness, specular_ior)
    glossy = dielectric_over_eon_albedo_dir(mu, rho, roughness, alpha, specular_ior)
    coat = coat_of(alpha, specular_ior)
    missing, edge = coat.at(cosine)[0], coat.edge_at(cosine)
    metal = color / (1.0 + missing) + (1.0 - color) * edge
    metal = metal * (1.0 + fresnel_schlick_avg(rho, *EDGE) * missing)
    return (1.0 - share) * glossy + share * metal


@any_array
def _alpha(specular_roughness: ArrayLike, specular_ior: ArrayLike) -> float:
    """alpha of the facets; raise ValueError unless both numbers are in their ranges."""
    checked_scalar("specular_ior", specular_ior)
    return cast(float, checked_scalar("specular_roughness", specular_roughness) ** 2)


@any_array
def _metal_share(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, metalness: ArrayLike
) -> Array:
    """Share of the metal, (..., 1); raise ValueError unless all arguments broadcast."""
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    numbers = {
        "roughness": checked("roughness", roughness),
        "metalness": checked("metalness", metalness),
    }
    lead_shape(vectors | {"rho": checked_color("rho", rho)}, numbers)
    return numbers["metalness"][..., np.newaxis]


@any_array
def _albedo_inputs(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, metalness: ArrayLike
) -> tuple[Array, Array, Array]:
    """The viewer's cosine, the color, and the share of the metal, checked, with an axis for channels."""
    numbers = {"mu": mu, "roughness": roughness, "metalness": metalness}
    (color,), (cosine, _, share) = checked_colors({"rho": rho}, **numbers)
    return clipped(cosine), color, share


@any_array
def mixed_sample(
    wo: ArrayLike, u: ArrayLike, alpha: float, share: Array, base: Callable[[Array], Array]
) -> Array:
    """Direction reflected by a facet with probability `share`, or drawn by `base`.

    What is left of u1, which chooses, is stretched over [0, 1).
    """
    xp = array_namespace(share)
    u1, first, second = _split(u, share)
    reflected = ggx_sample(wo, first, alpha)[0]
    return xp.where((u1 < share)[..., np.newaxis], reflected, base(second))


@any_array
def mixed_pdf(
    wo: ArrayLike, wi: ArrayLike, alpha: float, share: Array, base_pdf: Callable[[Array], Array]
) -> Array:
    """Density of `mixed_sample`."""
    light = checked_triples("wi", wi)
    xp, z = array_namespace(light), light[..., 2]
    upper = xp.stack([light[..., 0], light[..., 1], magnitude(z)], axis=-1)
    base = base_pdf(upper)
    mixed = share * ggx_pdf(wo, wi, alpha) + xp.where(z < 0.0, 0.0, (1.0 - share) * base)
    return mixed[()]


@any_array
def _split(u: ArrayLike, share: Array) -> tuple[Array, Array, Array]:
    """The first random number, and the pairs of either lobe, (..., 2): the first one's below the share."""
    u1, u2 = unpack_uniforms(u)
    xp, zero = array_namespace(u1, share), 0.0 * share
    first, second = stretched(u1, zero, share), stretched(u1, share, zero + 1.0)
    pairs = [xp.stack([each, u2 + 0.0 * each], axis=-1) for each in (first, second)]
    return u1, pairs[0], pairs[1]


@any_array
def checked_draws(
    wo: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    u: ArrayLike | None = None,
    wi: ArrayLike | None = None,
) -> None:
    """Raise ValueError unless the arguments broadcast."""
    vectors = {"wo": checked_directions("wo", wo)}
    if wi is not None:
        vectors["wi"] = checked_sphere("wi", wi)
    if u is not None:
        u1, u2 = unpack_uniforms(u)
        vectors["u"] = array_namespace(u1).stack([u1, u2], axis=-1)
    lead_shape(
        vectors | {"rho": checked_color("rho", rho)}, {"roughness": checked("roughness", roughness)}
    )


@any_array
def checked_mean(rho: ArrayLike) -> Array:
    """Mean of the channels, checked."""
    color = checked_color("rho", rho)
    mean: Array = array_namespace(color).sum(color, axis=-1) / color.shape[-1]
    return mean


@of_one_coat
def dielectric_over_eon_sample(
    wo: ArrayLike,
    u: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    alpha: float,
    ior: float,
) -> tuple[Array, Array]:
    """Direction reflected by a visible facet or drawn for EON, by their albedos; and its density.

    `wi` (..., 3): Unit vectors; those with z < 0 are wasted, their weight is 0. `pdf` (...): 1/sr:
    the density of both lobes together, each times the probability of its choice. The dielectric is
    chosen with probability E_r / E at the mean of the channels. The weight of a sample is the mean
    of those of both lobes alone, of which EON's is E for gray. [Dupuy2023]; docs/sampling.md.

        >>> wi, pdf = dielectric_over_eon_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.7, 0.5, 0.3, 1.5)
        >>> wi.round(5), round(float(pdf), 5)
        (array([0.08667, 0.64394, 0.76015]), 0.23917)
    """
    checked_draws(wo, rho, roughness, u=u)
    share, mean = _facet_share(wo, rho, roughness, coat_of(alpha, ior)), checked_mean(rho)
    wi = mixed_sample(wo, u, alpha, share, lambda u: eon_sample(wo, u, roughness, rho=mean)[0])
    return wi, mixed_pdf(wo, wi, alpha, share, lambda wi: eon_pdf(wo, wi, roughness, rho=mean))


@of_one_coat
def dielectric_over_eon_pdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Density of `dielectric_over_eon_sample` at `wi`, on the whole sphere, in solid angle.

        pdf = p pdf_GGX + (1 - p) pdf_EON,  p = E_r / (E_r + (1 - E_r) E_EON)

    Result (...): 1/sr; its integral over the upper hemisphere is the probability that no sample is
    wasted.

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> round(float(dielectric_over_eon_pdf(wo, wi, 0.7, 0.5, 0.3, 1.5)), 5)
        0.26516
    """
    checked_draws(wo, rho, roughness, wi=wi)
    share, mean = _facet_share(wo, rho, roughness, coat_of(alpha, ior)), checked_mean(rho)
    return mixed_pdf(wo, wi, alpha, share, lambda wi: eon_pdf(wo, wi, roughness, rho=mean))


def _facet_share(wo: ArrayLike, rho: ArrayLike, roughness: ArrayLike, of: Coat) -> Array:
    """E_r / E at the mean of rho's channels; 0 where nothing is reflected."""
    mu = unpack_cosine(wo)
    xp, reflected = array_namespace(mu), of.at(mu)[1]
    base = eon_albedo_dir(mu, checked_mean(rho)[..., np.newaxis], roughness)[..., 0]
    total = reflected + (1.0 - reflected) * base
    positive = total > 0.0
    return xp.where(positive, reflected, 0.0) / xp.where(positive, total, 1.0)
