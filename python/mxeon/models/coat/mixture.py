# SPDX-License-Identifier: Apache-2.0
"""Samples of an interface and what lies below it: one of both lobes, by a given probability."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

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
from mxeon.models.sampling.eon import stretched
from mxeon.models.sampling.hemisphere import unpack_uniforms
from mxeon.models.sampling.visible_normals import ggx_pdf, ggx_sample


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
