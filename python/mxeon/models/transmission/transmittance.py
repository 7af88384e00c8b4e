# SPDX-License-Identifier: Apache-2.0
"""Share of the light that microfacets transmit, by quadrature over the normals that are seen.

With the normals drawn as they are seen, the transmitted share of the light from wo is the mean of
(1 - F) G2 / G1(wo). The specification has no compensation for what transmission loses between facets.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from mxeon.models.core.arguments import (
    checked,
    checked_directions,
    checked_roughness,
    checked_switch,
    checked_vector,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.edges import within
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, array_namespace, library, like
from mxeon.models.core.shapes import channel_count
from mxeon.models.microfacet import ggx_formulas as ggx
from mxeon.models.microfacet.lobe import DIELECTRIC
from mxeon.models.microfacet.slopes import refracting_nodes
from mxeon.models.sampling.visible_normals import visible_normal
from mxeon.models.transmission.refraction import refracted

NODES, BLOCK = 48, 2**4  # nodes in height and in azimuth of the cap of normals; views per block
MOST_SQUARED = 1.0 - 1e-15  # of a sine: below an index of 3e-8 next to nothing passes

Nodes: TypeAlias = tuple[Array, Array, Array]  # cosines wo . h and of wi, and weights


@any_array
def dielectric_transmittance_dir(
    wo: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    shadow: bool = True,
) -> Array:
    """Transmitted share of the light from `wo`, by quadrature.

        T(wo) = ior^2 integral of dielectric_btdf |mu_i| over the hemisphere of wi

    - `wo` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x;
      wo has z >= 0, wi has z <= 0.
    - `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
    - `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is
      isotropic.
    - `ior` (...): Index of refraction of the side of wi relative to that of wo, in [0, 1e50].
    - `shadow`: Whether light is lost to other facets on the far side, as in the BTDF; without, it
      is the mean of 1 - F over the normals that wo sees.

    Result (..., C): in [0, 1] where alpha_x and alpha_y are the same. Accuracy: absolute error
    below 2e-4 for `ior` >= 1; for less below 1e-8, since the quadrature is split at the critical
    angle, where F has an infinite slope. At alpha 0 it is that of a plane, tint (1 - F(mu_o)). The
    albedo over all lights of one view, of the radiance, is this divided by ior^2. Raises
    `ValueError` if an argument leaves its range. [MaterialX2026], Directional Albedo and Energy
    Conservation; [Walter2007], Eq. (21).

        >>> dielectric_transmittance_dir([0.6, 0.0, 0.8], 1.0, [0.3, 0.3], [1.5, 0.75]).round(3)
        array([[0.939],
               [0.732]])
    """
    vectors = {"tint": checked_vector("tint", tint)}
    numbers = {"ior": checked("ior", ior)}

    return evaluate_transmittance(DIELECTRIC.at, wo, roughness, vectors, numbers, shadow)


def evaluate_transmittance(
    at: Callable[..., Array],
    wo: ArrayLike,
    roughness: ArrayLike,
    vectors: dict[str, Numbers],
    numbers: dict[str, Numbers],
    shadow: bool,
) -> Array:
    """Transmittance, shape (..., C), of checked inputs; `numbers` has the index."""
    directions = {"wo": checked_directions("wo", wo)}
    pairs = {"roughness": checked_roughness(roughness)}
    checked_switch("shadow", shadow)

    def total(
        wo: Array, roughness: Array, material: dict[str, Array], nodes: Nodes, axes: int
    ) -> Array:
        cosine, mu_i, weight = nodes
        new = (slice(None), *(np.newaxis,) * axes)
        spread = {k: v[new] if k in vectors else v for k, v in material.items()}
        passed = (1.0 - at(cosine, **spread)) * weight
        if shadow:
            passed = passed * _shadow(wo, mu_i, roughness)
        T: Array = array_namespace(passed).sum(passed, axis=tuple(range(1, 1 + axes)))
        return T

    def value(wo: Array, roughness: Array, **material: Array) -> Array:
        wo, roughness = wo + 0.0 * roughness[:1], roughness + 0.0 * wo[:1]
        ior = material["ior"]
        T = total(wo, roughness, material, _visible(wo, roughness, ior), 1)
        if library(ior) or np.any(ior < 1.0):
            squared = within((1.0 - ior) * (1.0 + ior), 0.0, MOST_SQUARED)
            split = refracting_nodes(wo, roughness, squared)
            T = array_namespace(T).where(ior < 1.0, total(wo, roughness, material, split, 2), T)
        return T * material["tint"] if "tint" in material else T

    arguments = {**directions, **pairs, **vectors}
    return evaluate_material(value, arguments, numbers, channel_count(vectors), BLOCK)


def _shadow(wo: Array, mu_i: Array, roughness: Array) -> Array:
    """G2 / G1(wo), whose limits at grazing are finite; 1 at alpha 0."""
    length = ggx.stretched_length(wo, roughness)
    visibility = ggx.visibility(wo[2], within(mu_i), ggx.mean_alpha(roughness))
    share: Array = 2.0 * mu_i * visibility * (wo[2] + length)
    return share


def _visible(wo: Array, roughness: Array, ior: Array) -> Nodes:
    """Nodes of visible facets, drawn; those whose light does not reach the far side weigh nothing."""
    xp, (height, turn, weight) = array_namespace(wo), (like(each, wo) for each in _nodes(wo.ndim))
    view = wo[:, np.newaxis]
    wh = visible_normal(view, height, turn, roughness[:, np.newaxis])
    mu_i = -refracted(view, wh, ior)[2]
    return within(xp.sum(view * wh, axis=0)), mu_i, weight * xp.where(mu_i > 0.0, 1.0, 0.0)


@lru_cache(maxsize=2)
def _nodes(axes: int) -> Nodes:
    """Random numbers of the visible normals, and weights, along an axis before those of the views."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    around = (np.arange(NODES) + 0.5) / NODES
    height, turn = np.meshgrid(0.5 * (x + 1.0), around, indexing="ij")
    weight = np.repeat(0.5 * w / NODES, NODES)
    shape = (-1, *(1,) * (axes - 1))
    return height.reshape(shape), turn.reshape(shape), weight.reshape(shape)
