# SPDX-License-Identifier: Apache-2.0
"""Samples of a dielectric over EON: one of both lobes, by their albedos.

- `wo`, `wi` (..., 3): Unit vectors, wo on or above the horizon.
- `u` (..., 2): Independent uniform random numbers, in [0, 1). The first one chooses the lobe as well.
- `rho` (..., C): Reflectance of EON per channel, in [0, 1]; a number is one channel.
- `roughness` (...): That of EON, in [0, 1].
- `alpha`: GGX roughness of the dielectric, in [0.01, 1]: one number for all pairs.
- `ior`: Its index of refraction, in [1, 4]: one number for all pairs.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.coat.curves import Coat, coat_of, of_one_coat, unpack_cosine
from mxeon.models.core.arguments import (
    checked,
    checked_color,
    checked_directions,
    checked_sphere,
    checked_triples,
)
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import magnitude
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import lead_shape
from mxeon.models.diffuse.albedo import eon_albedo_dir
from mxeon.models.sampling.eon import eon_pdf, eon_sample, stretched
from mxeon.models.sampling.hemisphere import unpack_uniforms
from mxeon.models.sampling.visible_normals import ggx_pdf, ggx_sample


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
    # Choose a lobe by u1, and stretch what is left of u1 over [0, 1).
    _check(wo, rho, roughness, u=u)
    share = _share(wo, rho, roughness, coat_of(alpha, ior))
    xp = array_namespace(share)
    u1, first, second = _split(u, share)
    wi = xp.where(
        (u1 < share)[..., np.newaxis],
        ggx_sample(wo, first, alpha)[0],
        eon_sample(wo, second, roughness, rho=_mean(rho))[0],
    )
    return wi, _mixed(wo, wi, rho, roughness, alpha, share)


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
    _check(wo, rho, roughness, wi=wi)
    share = _share(wo, rho, roughness, coat_of(alpha, ior))
    return _mixed(wo, wi, rho, roughness, alpha, share)


@any_array
def _mixed(
    wo: ArrayLike,
    wi: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    alpha: float,
    share: Array,
) -> Array:
    """Density of both lobes, the dielectric's with this share."""
    light = checked_triples("wi", wi)
    xp, z = array_namespace(light), light[..., 2]
    upper = xp.stack([light[..., 0], light[..., 1], magnitude(z)], axis=-1)
    base = eon_pdf(wo, upper, roughness, rho=_mean(rho))
    mixed = share * ggx_pdf(wo, wi, alpha) + xp.where(z < 0.0, 0.0, (1.0 - share) * base)
    return mixed[()]


def _share(wo: ArrayLike, rho: ArrayLike, roughness: ArrayLike, of: Coat) -> Array:
    """E_r / E at the mean of rho's channels; 0 where nothing is reflected."""
    mu = unpack_cosine(wo)
    xp, reflected = array_namespace(mu), of.at(mu)[1]
    base = eon_albedo_dir(mu, _mean(rho)[..., np.newaxis], roughness)[..., 0]
    total = reflected + (1.0 - reflected) * base
    positive = total > 0.0
    return xp.where(positive, reflected, 0.0) / xp.where(positive, total, 1.0)


@any_array
def _split(u: ArrayLike, share: Array) -> tuple[Array, Array, Array]:
    """The first random number, and the pairs of either lobe, (..., 2): the first one's below the share."""
    u1, u2 = unpack_uniforms(u)
    xp, zero = array_namespace(u1, share), 0.0 * share
    first, second = stretched(u1, zero, share), stretched(u1, share, zero + 1.0)
    pairs = [xp.stack([each, u2 + 0.0 * each], axis=-1) for each in (first, second)]
    return u1, pairs[0], pairs[1]


@any_array
def _check(
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
def _mean(rho: ArrayLike) -> Array:
    """Mean of the channels, checked."""
    color = checked_color("rho", rho)
    mean: Array = array_namespace(color).sum(color, axis=-1) / color.shape[-1]
    return mean
