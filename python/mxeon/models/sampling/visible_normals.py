# SPDX-License-Identifier: Apache-2.0
"""Importance sampling of GGX reflection by visible normals.

The surface is stretched until its microfacets are a hemisphere; their visible normals are then
half vectors of the stretched `wo` and a direction drawn uniformly on a spherical cap.

- `wo`, `wi` (..., 3): Unit vectors, wo on or above the horizon.
- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_directions, checked_roughness, checked_sphere
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.edges import at_least_0, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import broadcastable, lead_shape
from mxeon.models.microfacet import ggx_formulas as ggx
from mxeon.models.sampling.hemisphere import stack_xyz, unpack_uniforms

UP = 0.0, 0.0, 1.0


@any_array
def ggx_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction reflected by a visible GGX normal, may be below the horizon; and its density.

    `wi` (..., 3): Unit vectors; those with z < 0 are wasted, their weight is 0. `pdf` (...): 1/sr.
    Where an alpha is 0 there is no density, and it counts as 0. Value times cosine over density is
    F G2 / G1(wo). [Dupuy2023], Section 3; [Heitz2014], Eq. (16).

        >>> wi, pdf = ggx_sample([0.6, 0.0, 0.8], [0.25, 0.5], [0.5, 0.25])
        >>> wi.round(6), round(float(pdf), 6)
        (array([-0.835004,  0.      ,  0.550244]), 0.649904)
    """
    u1, u2 = unpack_uniforms(u)
    stacked = array_namespace(u1).stack([u1, u2], axis=-1)
    vectors = {"wo": checked_directions("wo", wo), "u": stacked}
    view, (u1, u2), alpha = _components(vectors | {"roughness": checked_roughness(roughness)})
    wh = visible_normal(view, u1, u2, alpha)
    wi = stack_xyz(*(2.0 * array_namespace(wh).sum(view * wh, axis=0) * wh - view))
    return wi, visible_density(view, wh, alpha)


@any_array
def ggx_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `ggx_sample` at `wi`, on the whole sphere, in solid angle.

        pdf = G1(wo) D(wh) / (4 mu_o), and 0 where wh is below the horizon

    Result (...): 1/sr; its integral over the upper hemisphere is the probability that no sample is
    wasted. [Heitz2014], Eqs. (16), (43).

        >>> round(float(ggx_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], [0.5, 0.25])), 6)
        0.455389
    """
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_sphere("wi", wi)}
    vectors["roughness"] = checked_roughness(roughness)
    view, light, alpha = _components(vectors)
    wh, cosine = ggx.half_vector(view, light)
    below = (wh[2] < 0.0) | ((cosine == 0.0) & (light[2] < 0.0))
    return array_namespace(wh).where(below, 0.0, visible_density(view, wh, alpha))[()]


def _components(vectors: dict[str, Numbers]) -> list[Array]:
    """Vectors, broadcast against each other, as float64 arrays with the components first."""
    lead = lead_shape(vectors, {})
    arrays = broadcastable(vectors, {})
    xp, order = array_namespace(*arrays), (len(lead), *range(len(lead)))
    spread = [xp.broadcast_to(v, (*lead, *v.shape[-1:])) for v in arrays]
    return [xp.permute_dims(vector, order) for vector in spread]


def visible_density(wo: Array, wh: Array, roughness: Array) -> Array:
    """G1(wo) D(wh) / (4 mu_o), components first; G1 / mu_o is finite at grazing."""
    masking = 0.5 * ggx.reciprocal(wo[2] + ggx.stretched_length(wo, roughness))
    density: Array = masking * ggx.ndf(wh, roughness)
    return density


def visible_normal(wo: Array, u1: Array, u2: Array, roughness: Array) -> Array:
    """Visible normal for two random numbers, components first: [Dupuy2023], Listing 3."""
    xp = array_namespace(wo, u1, roughness)
    stretched = xp.stack([roughness[0] * wo[0], roughness[1] * wo[1], wo[2]])
    length = root(xp.sum(stretched * stretched, axis=0))
    # A smooth surface seen at grazing has a length of 0 and one normal, whatever is drawn.
    stretched = stretched / xp.where(length > 0.0, length, 1.0)
    # A point of the cap above -z of the stretched view.
    down = (1.0 + stretched[2]) * u1
    z, phi = 1.0 - down, 2.0 * np.pi * u2
    S = root(down * (1.0 + z))
    x, y, z = S * xp.cos(phi) + stretched[0], S * xp.sin(phi) + stretched[1], z + stretched[2]
    normal = [roughness[0] * x, roughness[1] * y, at_least_0(z)]
    length = root(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2])
    seen = length > 0.0
    size = xp.where(seen, length, 1.0)
    return xp.stack([xp.where(seen, each / size, up) for each, up in zip(normal, UP, strict=True)])
