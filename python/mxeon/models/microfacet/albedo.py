# SPDX-License-Identifier: Apache-2.0
"""Directional albedos of the BRDFs of `mxeon.models.microfacet`, by quadrature over slopes.

An albedo in retroreflective mode is the same: a surface turned by half a turn is the same surface.

- `wo` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x,
  z >= 0.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
- `compensate`: Whether the energy compensation enters.

Result (..., C). Accuracy: see `ggx_albedo_dir_anisotropic`. At alpha 0 it is that of the mirror,
F(mu_o). Raises `ValueError`, which names the first bad element, if an argument leaves its range or
the shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mxeon.models.core.arguments import (
    checked,
    checked_directions,
    checked_roughness,
    checked_switch,
    checked_vector,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.edges import at_least_0
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, array_namespace, library, like
from mxeon.models.core.shapes import channel_count, lead_shape
from mxeon.models.microfacet.ggx_albedo import albedo
from mxeon.models.microfacet.ggx_formulas import mean_alpha
from mxeon.models.microfacet.lobe import CONDUCTOR, DIELECTRIC, SCHLICK, WHITE, Curve
from mxeon.models.microfacet.slopes import slope_nodes, transmitting_nodes

BLOCK = 2**3  # elements at once


@any_array
def dielectric_albedo_dir(
    wo: ArrayLike, tint: ArrayLike, roughness: ArrayLike, ior: ArrayLike, compensate: bool = True
) -> Array:
    """Directional albedo of `dielectric_brdf`, by quadrature.

    - `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
    - `ior` (...): Index of refraction relative to the exterior medium, in [0, 1e50].

    For `ior` below 1, where F has an infinite slope at
    the critical angle, the quadrature is split there, and the error of isotropic lobes is below
    1e-10. At alpha 0 it is that of the mirror, tint F(mu_o). [MaterialX2026], Directional Albedo
    and Energy Conservation.

        >>> dielectric_albedo_dir([0.6, 0.0, 0.8], 1.0, [0.3, 0.3], 1.5).round(6)
        array([0.040169])
    """
    vectors = {"tint": checked_vector("tint", tint)}

    numbers = {"ior": checked("ior", ior)}
    return lobe_albedo(DIELECTRIC, wo, roughness, vectors, numbers, compensate)


@any_array
def conductor_albedo_dir(
    wo: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `conductor_brdf`, by quadrature.

    - `ior`, `extinction` (..., C): Complex index of refraction per channel, in [0, 1e50]; a number
      is one channel.

    [MaterialX2026], Directional Albedo and Energy Conservation.

        >>> gold = [0.183, 1.373], [3.424, 1.770]
        >>> conductor_albedo_dir([0.6, 0.0, 0.8], [0.3, 0.3], *gold).round(6)
        array([0.935317, 0.347053])
    """
    vectors = {
        "ior": checked_vector("ior", ior),
        "extinction": checked_vector("extinction", extinction),
    }
    return lobe_albedo(CONDUCTOR, wo, roughness, vectors, {}, compensate)


@any_array
def generalized_schlick_albedo_dir(
    wo: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    roughness: ArrayLike,
    exponent: ArrayLike,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `generalized_schlick_brdf`, by quadrature.

    - `color0`, `color82`, `color90` (..., C): Reflectance along the normal, multiplier at
      acos(1/7), and reflectance at grazing, per channel, in [0, 1]; a number is one channel.
    - `exponent` (...): Exponent of the Schlick curve, in [0, 1e50].

    [MaterialX2026], Directional Albedo and Energy Conservation.

        >>> wo, roughness = [0.6, 0.0, 0.8], [0.3, 0.3]
        >>> generalized_schlick_albedo_dir(wo, [1.0, 0.2], 1.0, 1.0, roughness, 5.0).round(6)
        array([1.      , 0.179402])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    vectors = {name: checked_vector(name, value) for name, value in colors.items()}
    numbers = {"exponent": checked("exponent", exponent)}
    return lobe_albedo(SCHLICK, wo, roughness, vectors, numbers, compensate)


@any_array
def ggx_albedo_dir_anisotropic(wo: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of anisotropic GGX at unit Fresnel reflectance, by quadrature.

    Result (...): above 0; exceeds 1 where alpha_x and alpha_y differ. The masking of the
    specification takes sqrt(alpha_x alpha_y), which does not belong to the anisotropic
    distribution: the albedo at grazing falls far below 1 along the smoother direction and exceeds 1
    along the rougher one, 30 at mu_o = 0.001 for roughness (0.001, 1). The energy compensation of
    the BRDFs takes `ggx_albedo_dir` at sqrt(alpha_x alpha_y). Accuracy: error below 5e-6 of the
    larger of 1 and the albedo for mu_o >= 1e-4 and roughness >= 1e-4. Cosines below 1e-12 count as
    1e-12. [MaterialX2026], Energy Compensation; Height-Correlated Smith Masking-Shadowing.

        >>> ggx_albedo_dir_anisotropic([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]], [0.1, 0.5]).round(6)
        array([0.837774, 0.874089])
    """
    wo, roughness = checked_directions("wo", wo), checked_roughness(roughness)
    lead_shape({"wo": wo, "roughness": roughness}, {})
    return lobe_albedo(WHITE, wo, roughness, {"tint": like(np.ones(1), wo)}, {}, False)[..., 0][()]


def lobe_albedo(
    curve: Curve,
    wo: ArrayLike,
    roughness: ArrayLike,
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    compensate: bool,
) -> Array:
    """Albedo of a lobe with this Fresnel curve, whose checked inputs `vectors` and `numbers` are."""
    wo, roughness = checked_directions("wo", wo), checked_roughness(roughness)
    checked_switch("compensate", compensate)

    def value(
        wo: Array, roughness: Array, unseen: Array, average: Array, **material: Array
    ) -> Array:
        c, weight = slope_nodes(wo, roughness)
        spread = {
            k: v[:, np.newaxis, np.newaxis] if k in vectors else v for k, v in material.items()
        }
        xp = array_namespace(c)
        E = xp.sum(curve.at(c, **spread) * weight, axis=(1, 2))
        squared = curve.critical(**material)
        if library(squared) or np.any(squared > 0.0):
            # All light, but what passes above the critical angle.
            alpha, isotropic = 0.5 * (roughness[0] + roughness[1]), roughness[0] == roughness[1]
            lossless = xp.where(isotropic, albedo(wo[2], alpha), xp.sum(weight, axis=(0, 1)))
            c, weight = transmitting_nodes(wo, roughness, at_least_0(squared))
            lost = xp.sum((1.0 - curve.at(c, **spread)) * weight, axis=(1, 2))
            E = xp.where(squared > 0.0, lossless - lost, E)
        if compensate:
            E = E * (1.0 + average * unseen)
        total: Array = E * material["tint"] if "tint" in material else E
        return total

    arguments = {"wo": wo, "roughness": roughness, **vectors}
    lead_shape(arguments, numbers)  # refuses what does not broadcast, by the names of the arguments
    # Light that is scattered more than once, for all elements before their many slopes.
    channels = channel_count(vectors)
    unseen, average = np.zeros(()), np.zeros(1)
    if compensate:
        unseen = _unseen(wo, roughness)
        average = evaluate_material(curve.average, vectors, numbers, channels)
    arguments["average"] = average
    return evaluate_material(value, arguments, {"unseen": unseen, **numbers}, channels, BLOCK)


def _unseen(wo: Numbers, roughness: Numbers) -> Array:
    """(1 - E_ss) / E_ss of checked arguments by quadrature, shape (...)."""
    E_ss = evaluate_material(
        lambda mu, roughness: albedo(mu, mean_alpha(roughness))[np.newaxis],
        {"roughness": roughness},
        {"mu": wo[..., 2]},
        1,
    )[..., 0]
    return (1.0 - E_ss) / E_ss
