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
from mxeon.models.coat.mixture import checked_draws, checked_mean, mixed_pdf, mixed_sample
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import array_namespace
from mxeon.models.diffuse.albedo import eon_albedo_dir
from mxeon.models.sampling.eon import eon_pdf, eon_sample


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
    share, mean = _share(wo, rho, roughness, coat_of(alpha, ior)), checked_mean(rho)
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
    share, mean = _share(wo, rho, roughness, coat_of(alpha, ior)), checked_mean(rho)
    return mixed_pdf(wo, wi, alpha, share, lambda wi: eon_pdf(wo, wi, roughness, rho=mean))


def _share(wo: ArrayLike, rho: ArrayLike, roughness: ArrayLike, of: Coat) -> Array:
    """E_r / E at the mean of rho's channels; 0 where nothing is reflected."""
    mu = unpack_cosine(wo)
    xp, reflected = array_namespace(mu), of.at(mu)[1]
    base = eon_albedo_dir(mu, checked_mean(rho)[..., np.newaxis], roughness)[..., 0]
    total = reflected + (1.0 - reflected) * base
    positive = total > 0.0
    return xp.where(positive, reflected, 0.0) / xp.where(positive, total, 1.0)
