# SPDX-License-Identifier: Apache-2.0
"""Directional albedos of the BRDFs of `mxeon.models.microfacet`, by quadrature over slopes.

With the half vector along (alpha_x r cos(phi), alpha_y r sin(phi), 1) the albedo is

    integral of F G2 (wo . wh) / (h_z mu_o) r / (pi (1 + r^2)^2) dr dphi,

without a peak at any alpha. wi lies above the horizon from r = 0 up to one limit, so that no kink
remains. An albedo in retroreflective mode is the same: a surface turned by half a turn is the same
surface.
"""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from mxeon.models.arguments import channel_count, checked, checked_directions, checked_pairs
from mxeon.models.arrays import Array, ArrayLike, Numbers
from mxeon.models.evaluation import evaluate_material
from mxeon.models.ggx_formulas import mean_alpha, smith_lambda
from mxeon.models.microfacet_lobe import CONDUCTOR, DIELECTRIC, SCHLICK, WHITE, Curve, missing

# Gauss-Legendre nodes in r per panel, panels, nodes per quadrant of phi, and elements per block.
NODES, PANELS, QUADRANT, BLOCK = 20, 3, 20, 2**3

# Least cosine of wo, and largest r: beyond, less than 1e-12 of the light is left.
LEAST_MU, LARGEST_R = 1e-12, 1e8


def dielectric_albedo_dir(
    wo: ArrayLike, tint: ArrayLike, roughness: ArrayLike, ior: ArrayLike, compensate: bool = True
) -> Array:
    """Directional albedo of `dielectric_brdf`, by quadrature.

    Parameters
    ----------
    wo, tint, roughness, ior, compensate
        As those of `mxeon.models.dielectric_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    Accuracy: see `ggx_albedo_dir_anisotropic`; for `ior` below 1, where F has an infinite slope at
    the critical angle, the error is up to 3e-2. At alpha 0 it is that of the mirror, tint F(mu_o).

    References
    ----------
    [MaterialX2026], Directional Albedo and Energy Conservation.

    Examples
    --------
    >>> dielectric_albedo_dir([0.6, 0.0, 0.8], 1.0, [0.3, 0.3], 1.5).round(6)
    array([0.040169])
    """
    vectors = {"tint": np.atleast_1d(checked("tint", tint))}

    numbers = {"ior": checked("ior", ior)}
    return lobe_albedo(DIELECTRIC, wo, roughness, vectors, numbers, compensate)


def conductor_albedo_dir(
    wo: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `conductor_brdf`, by quadrature.

    Parameters
    ----------
    wo, roughness, ior, extinction, compensate
        As those of `mxeon.models.conductor_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    Accuracy: see `ggx_albedo_dir_anisotropic`. At alpha 0 it is that of the mirror, F(mu_o).

    References
    ----------
    [MaterialX2026], Directional Albedo and Energy Conservation.

    Examples
    --------
    >>> gold = [0.183, 1.373], [3.424, 1.770]
    >>> conductor_albedo_dir([0.6, 0.0, 0.8], [0.3, 0.3], *gold).round(6)
    array([0.935317, 0.347053])
    """
    vectors = {
        "ior": np.atleast_1d(checked("ior", ior)),
        "extinction": np.atleast_1d(checked("extinction", extinction)),
    }
    return lobe_albedo(CONDUCTOR, wo, roughness, vectors, {}, compensate)


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

    Parameters
    ----------
    wo, color0, color82, color90, roughness, exponent, compensate
        As those of `mxeon.models.generalized_schlick_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    Accuracy: see `ggx_albedo_dir_anisotropic`. At alpha 0 it is that of the mirror, F(mu_o).

    References
    ----------
    [MaterialX2026], Directional Albedo and Energy Conservation.

    Examples
    --------
    >>> wo, roughness = [0.6, 0.0, 0.8], [0.3, 0.3]
    >>> generalized_schlick_albedo_dir(wo, [1.0, 0.2], 1.0, 1.0, roughness, 5.0).round(6)
    array([1.      , 0.179402])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    vectors = {name: np.atleast_1d(checked(name, value)) for name, value in colors.items()}
    numbers = {"exponent": checked("exponent", exponent)}
    return lobe_albedo(SCHLICK, wo, roughness, vectors, numbers, compensate)


def ggx_albedo_dir_anisotropic(wo: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of anisotropic GGX at unit Fresnel reflectance, by quadrature.

    Parameters
    ----------
    wo : array_like, shape (..., 3)
        Direction that leaves the surface, unit vector to 1e-6, normal +z, tangent +x, z >= 0.
    roughness : array_like, shape (..., 2)
        alpha along tangent and bitangent, dimensionless, in [0, 1].

    Returns
    -------
    ndarray, shape (...), float64
        Dimensionless, above 0; exceeds 1 where alpha_x and alpha_y differ.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    The masking of the specification takes sqrt(alpha_x alpha_y), which does not belong to the
    anisotropic distribution: the albedo at grazing falls far below 1 along the smoother direction
    and exceeds 1 along the rougher one, 30 at mu_o = 0.001 for roughness (0.001, 1).
    The energy compensation of the BRDFs takes `ggx_albedo_dir` at sqrt(alpha_x alpha_y).
    Accuracy: error below 5e-6 of the larger of 1 and the albedo for mu_o >= 1e-4 and roughness
    >= 1e-4. Cosines below 1e-12 count as 1e-12.

    References
    ----------
    [MaterialX2026], Energy Compensation; Height-Correlated Smith Masking-Shadowing.

    Examples
    --------
    >>> ggx_albedo_dir_anisotropic([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]], [0.1, 0.5]).round(6)
    array([0.837774, 0.874089])
    """

    return lobe_albedo(WHITE, wo, roughness, {"tint": np.ones(1)}, {}, False)[..., 0][()]


def lobe_albedo(
    curve: Curve,
    wo: ArrayLike,
    roughness: ArrayLike,
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    compensate: bool,
) -> Array:
    """Albedo of a lobe with this Fresnel curve, whose checked inputs `vectors` and `numbers` are."""
    wo, roughness = checked_directions("wo", wo), checked_pairs("roughness", roughness)

    def value(wo: Array, roughness: Array, **material: Array) -> Array:
        c, weight = _slope_nodes(wo, roughness)
        spread = {
            k: v[:, np.newaxis, np.newaxis] if k in vectors else v for k, v in material.items()
        }
        E: Array = np.sum(curve.at(c, **spread) * weight, axis=(1, 2))
        if compensate:
            E = E * (1.0 + curve.average(**material) * missing(wo[2], roughness))
        return E * material["tint"] if "tint" in material else E

    arguments = {"wo": wo, "roughness": roughness, **vectors}
    return evaluate_material(value, arguments, numbers, channel_count(vectors), BLOCK)


def _slope_nodes(wo: Array, roughness: Array) -> tuple[Array, Array]:
    """Cosine wo . h and weight of every node, shape (nodes of r, nodes of phi, ...)."""
    (x, y, _), (alpha_x, alpha_y) = wo, roughness
    mu_o = np.clip(wo[2], LEAST_MU, 1.0)
    # wo . h / h_z = mu_o + r A cos(omega), and its slope has the squared length g r^2.
    A = np.hypot(x * alpha_x, y * alpha_y)
    tilted = A > 0.0
    scale = mu_o / np.maximum(A, mu_o)
    omega, weight_omega = _quadrants(scale, bool(np.all(alpha_x == alpha_y)))
    cos_0 = np.where(tilted, x * alpha_x, 1.0) / np.where(tilted, A, 1.0)
    sin_0 = y * alpha_y / np.where(tilted, A, 1.0)
    cosine, sine = np.cos(omega), np.sin(omega)
    g = (alpha_x * (cos_0 * cosine - sin_0 * sine)) ** 2
    g = g + (alpha_y * (sin_0 * cosine + cos_0 * sine)) ** 2
    # wi lies above the horizon where mu_o g r^2 <= 2 A cos(omega) r + mu_o.
    B = A * cosine
    ahead = np.abs(B) + np.sqrt(B * B + mu_o * mu_o * g)
    ahead = np.maximum(ahead, mu_o / LARGEST_R)
    limit = np.where(B < 0.0, mu_o / ahead, ahead / np.maximum(mu_o * g, ahead / LARGEST_R))
    r, weight = _graded(scale, limit)
    lean = np.maximum(B * r + mu_o, 0.0)
    stretch = 1.0 + g * r * r
    mu_i = np.clip(2.0 * lean / stretch - mu_o, 0.0, 1.0)
    alpha = mean_alpha(roughness)
    smith = smith_lambda(mu_o, alpha) * mu_i + smith_lambda(mu_i, alpha) * mu_o
    density = r / (np.pi * (1.0 + r * r) ** 2)
    return (
        np.minimum(lean / np.sqrt(stretch), 1.0),
        weight * weight_omega * density * 2.0 * mu_i * lean / smith,
    )


def _quadrants(scale: Array, isotropic: bool) -> tuple[Array, Array]:
    """Nodes and weights of phi from that of wo on, denser towards right angles, shape (1, n, ...).

    Halves of an isotropic surface are alike.
    """
    x, weight = (v.reshape(-1, *(1,) * np.ndim(scale)) for v in _rule(QUADRANT))
    extent = np.arcsinh(0.5 * np.pi / scale)
    omega = 0.5 * np.pi - scale * np.sinh(extent * x)
    weight = weight * extent * scale * np.cosh(extent * x)
    if isotropic:
        omega, weight = np.concatenate([omega, np.pi - omega]), np.concatenate([2.0 * weight] * 2)
    else:
        omega = np.concatenate([omega, np.pi - omega, -omega, np.pi + omega])
        weight = np.concatenate([weight] * 4)
    return omega[np.newaxis], weight[np.newaxis]


def _graded(scale: Array, length: Array) -> tuple[Array, Array]:
    """Nodes and weights of [0, length], denser towards 0 from `scale` on, along the first axis."""
    x, weight = (v.reshape(-1, *(1,) * (np.ndim(length) - 1)) for v in _rule(NODES))
    x = np.concatenate([k + x for k in range(PANELS)]) / PANELS
    weight = np.concatenate([weight] * PANELS) / PANELS
    extent = np.arcsinh(length / scale)
    rise = np.exp(extent * x)
    fall = 1.0 / rise
    half = 0.5 * scale
    # sinh and cosh of one exponential, which takes a third of the time.
    return half * (rise - fall), weight * extent * half * (rise + fall)


@lru_cache(maxsize=2)
def _rule(nodes: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss-Legendre on [0, 1]."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    return 0.5 * (1.0 + x), 0.5 * weight
