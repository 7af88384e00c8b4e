# SPDX-License-Identifier: Apache-2.0
"""Models that can be fitted: one row each, with the ranges of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mxeon.albedo import dielectric_albedo_dir, ggx_albedo_dir
from mxeon.errors import PackageError, install
from mxeon.models import (
    dielectric_brdf,
    eon_brdf,
    fresnel_dielectric_avg,
    fresnel_schlick_avg,
    generalized_schlick_brdf,
)
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_least_0
from mxeon.models.core.namespaces import any_array, array_namespace, library, like
from mxeon.models.microfacet.fresnel_formulas import dielectric
from mxeon.models.microfacet.slopes import slope_nodes

CURVE_NODES = 21  # angles at which albedos of a dielectric are integrated, for a spline
LEAST_ALPHA = 0.02  # below, a lobe is narrower than what is measured


@dataclass(frozen=True)
class FitModel:
    """A model to fit: `value(wo, wi, rho, **scalars)`, shape (N, C).

    Attributes
    ----------
    value : callable
    bounds : dict of str to tuple
        Range of each scalar.
    starts : dict of str to tuple
        Values of each scalar from which the search starts.
    """

    value: Callable[..., Array]
    bounds: Mapping[str, tuple[float, float]]
    starts: Mapping[str, tuple[float, ...]]


def dielectric_over_eon(
    wo: Array, wi: Array, rho: ArrayLike, roughness: float, alpha: float, ior: float
) -> Array:
    """BRDF of an isotropic `dielectric_bsdf` layered over EON, for one material, in 1/sr.

    Parameters
    ----------
    wo, wi : ndarray, shape (N, 3)
        Arrays of NumPy.
    rho : array_like, shape (C,)
    roughness, alpha, ior : float
        These and rho may be arrays of PyTorch or JAX, by which the value then has gradients; it agrees
        with that of NumPy to the accuracy below.

    Returns
    -------
    ndarray, shape (N, C)

    Notes
    -----
    What depends on the viewer alone comes from a spline over its angle. Accuracy: error below 4e-5 of
    the larger of 1 and the value, for alpha of at least 0.05.
    """
    missing, albedo = _at_views(wo, alpha, ior)
    factor = 1.0 + fresnel_dielectric_avg(ior) * missing
    top = dielectric_brdf(wo, wi, 1.0, alpha, ior, compensate=False) * factor
    layered: Array = top + at_least_0(1.0 - albedo * factor) * eon_brdf(wo, wi, rho, roughness)
    return layered


def openpbr_base(
    wo: Array,
    wi: Array,
    rho: ArrayLike,
    roughness: float,
    specular_roughness: float,
    specular_ior: float,
    metalness: float,
) -> Array:
    """BRDF of OpenPBR's base: a metal and a dielectric over EON, mixed, in 1/sr.

    Parameters
    ----------
    wo, wi, rho
        As those of `dielectric_over_eon`; `rho` is `base_color`, of the metal too.
    roughness, specular_roughness, specular_ior, metalness : float
        `base_diffuse_roughness`, `specular_roughness`, `specular_ior` and `base_metalness`; the weights
        and `specular_color` are 1, and nothing is anisotropic or transmits.

    Returns
    -------
    ndarray, shape (N, C)
    """
    alpha = specular_roughness**2
    missing, _ = _at_views(wo, alpha, specular_ior)
    metal = generalized_schlick_brdf(wo, wi, rho, 1.0, 1.0, alpha, 5.0, compensate=False)
    metal = metal * (1.0 + fresnel_schlick_avg(rho, 1.0, 1.0, 5.0) * missing)
    glossy = dielectric_over_eon(wo, wi, rho, roughness, alpha, specular_ior)
    return (1.0 - metalness) * glossy + metalness * metal


def _at_views(wo: Array, alpha: float, ior: float) -> tuple[Array, Array]:
    """(1 - E_ss) / E_ss and the albedo of a dielectric without compensation, (N, 1)."""
    elevation = np.arcsin(np.minimum(wo[:, 2], 1.0))
    place = 1.0 - np.sqrt(elevation / (0.5 * np.pi))
    if library(alpha) or library(ior):
        # A spline is linear in its values at the nodes, so that it is a product with a matrix.
        nodes = np.linspace(0.0, 1.0, CURVE_NODES)
        at_wo = _curves_of_arrays(_spline(nodes, np.eye(CURVE_NODES))(place), alpha, ior)
    else:
        at_wo = _curves(alpha, ior)(place)
    return at_wo[:, :1], at_wo[:, 1:]


@any_array
def _curves_of_arrays(matrix: Array, alpha: float, ior: float) -> Array:
    """Values of both at places, (N, 2), in another library: a matrix (N, CURVE_NODES) times those at nodes."""
    views = like(_views().T, matrix)
    xp, zero = array_namespace(matrix), 0.0 * views[2]
    alphas: Array = zero + alpha
    cosine, weight = slope_nodes(views, xp.stack([alphas, alphas]))
    albedo = xp.sum(dielectric(cosine, zero + ior) * weight, axis=(0, 1))
    missing = 1.0 / xp.sum(weight, axis=(0, 1)) - 1.0
    curves = xp.stack([missing, albedo], axis=-1)
    return xp.tensordot(matrix, curves, axes=1)


@lru_cache(maxsize=8)  # a search changes its other parameters too
def _curves(alpha: float, ior: float) -> Callable[[Array], Array]:
    """Splines of both over 1 - sqrt(1 - theta / (pi / 2)), whose nodes crowd at grazing."""
    views = _views()
    E_ss = ggx_albedo_dir(views[:, 2], alpha)
    E = dielectric_albedo_dir(views, 1.0, [alpha, alpha], ior, compensate=False)[:, 0]
    return _spline(np.linspace(0.0, 1.0, CURVE_NODES), np.stack([1.0 / E_ss - 1.0, E], axis=-1))


def _views() -> Array:
    """Directions at the nodes, (CURVE_NODES, 3)."""
    theta = 0.5 * np.pi * (1.0 - (1.0 - np.linspace(0.0, 1.0, CURVE_NODES)) ** 2)
    return np.stack([np.sin(theta), np.zeros_like(theta), np.abs(np.cos(theta))], axis=-1)


def _spline(place: Array, values: Array) -> Callable[[Array], Array]:
    """Cubic spline through values at places."""
    try:
        from scipy.interpolate import CubicSpline
    except ImportError as error:
        raise PackageError(f"mxeon.fit needs scipy: {install('fit')}") from error
    spline: Callable[[Array], Array] = CubicSpline(place, values)
    return spline


FIT_MODELS = {
    "eon": FitModel(eon_brdf, {"roughness": (0.0, 1.0)}, {"roughness": (0.2, 0.8)}),
    "dielectric_over_eon": FitModel(
        dielectric_over_eon,
        {"roughness": (0.0, 1.0), "alpha": (LEAST_ALPHA, 1.0), "ior": (1.0, 4.0)},
        {"roughness": (0.5,), "alpha": (0.1, 0.4), "ior": (1.5,)},
    ),
    "openpbr_base": FitModel(
        openpbr_base,
        {
            "roughness": (0.0, 1.0),
            "specular_roughness": (np.sqrt(LEAST_ALPHA), 1.0),
            "specular_ior": (1.0, 4.0),
            "metalness": (0.0, 1.0),
        },
        {
            "roughness": (0.5,),
            "specular_roughness": (0.4,),
            "specular_ior": (1.5,),
            "metalness": (0.1, 0.9),
        },
    ),
}
