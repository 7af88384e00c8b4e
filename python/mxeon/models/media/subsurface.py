# SPDX-License-Identifier: Apache-2.0
"""Subsurface scattering, as in [MaterialX2026], section `subsurface_bsdf` and its appendix.

The albedo inversion is that of van de Hulst's fit for a half space: `subsurface_reflectance`.

- `rho`: Diffuse reflectance, in [0, 1]: the node's color.
- `scatter_anisotropy`: Mean cosine g of a scattering, in [-1, 1].
- `separation`: Distance r, a length, in [1e-150, 1e150].
- `radius`: Mean free path l, a length, in [1e-150, 1e150].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from mxeon.models.core.arguments import checked, checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import arccosine, at_least_0, root
from mxeon.models.core.namespaces import any_array, array_namespace, like
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.core.shapes import broadcastable

# Of the text's inversion, with its digits: the quotients of van de Hulst's fit, rounded.
LINEAR = (4.09712, 4.20863)
SQUARED = (9.59217, 41.6808, 17.7126)
NODES, PANELS = 50, 40  # of the quadrature of the blur, whose integrand has a kink
LOSS, GAIN = 0.139, 1.17  # of van de Hulst's fit
FAR = 3.0  # length of the profile's second exponential over that of the first


@any_array
def subsurface_albedo(rho: ArrayLike, scatter_anisotropy: ArrayLike = 0.0) -> Array:
    """Single-scattering albedo of a medium that has a diffuse reflectance.

        d = 4.09712 + 4.20863 rho - sqrt(9.59217 + 41.6808 rho + 17.7126 rho^2)
        w0 = 1 - d^2,  w = w0 / (1 - g (1 - w0))

    Result: in (0, 1]. It rises with rho but for the last 1.2e-5 of its range. The printed digits
    leave d = -5e-6 at rho = 1, and 0 at rho = 1 - 1.2e-5; w is 1 - 3e-11 at 1. At rho = 0 they
    leave w0 = 6e-6 instead of 0. Accuracy: a half space of this albedo reflects rho within 0.0021
    for g = 0, by its H function. [MaterialX2026], Subsurface Scattering Model, Albedo Inversion.

        >>> subsurface_albedo([0.2, 0.5, 0.8]).round(6)
        array([0.613357, 0.911709, 0.990589])
    """
    return _single_scatter(*checked_numbers(rho=rho, scatter_anisotropy=scatter_anisotropy))


def _single_scatter(color: Array, g: Array) -> Array:
    """`subsurface_albedo` on valid arrays."""
    polynomial = SQUARED[0] + SQUARED[1] * color + SQUARED[2] * color**2
    d = LINEAR[0] + LINEAR[1] * color - array_namespace(color).sqrt(polynomial)
    isotropic = 1.0 - d * d
    return isotropic / (1.0 - g * d * d)


@any_array
def subsurface_reflectance(single_scatter: ArrayLike, scatter_anisotropy: ArrayLike = 0.0) -> Array:
    """Diffuse reflectance of a half space, by van de Hulst's fit.

        s^2 = (1 - w) / (1 - g w),  rho = (1 - s) (1 - 0.139 s) / (1 + 1.17 s)

    - `single_scatter`: Single-scattering albedo w, in [0, 1].
    - `scatter_anisotropy`: Mean cosine g of a scattering, in [-1, 1).

    Result: in [0, 1]. The half space has no surface, and is lit by a uniform sky. Accuracy: within
    0.0021 of the exact reflectance for g = 0. The inverse of `subsurface_albedo` within 1.3e-5.
    [vandeHulst1974].

        >>> subsurface_reflectance(0.911709).round(4).item()
        0.5
    """
    w, g = checked_numbers(single_scatter=single_scatter, scatter_anisotropy=scatter_anisotropy)
    xp, lost = array_namespace(w, g), w < 1.0
    s = root(xp.where(lost, (1.0 - w) / xp.where(lost, 1.0 - g * w, 1.0), 0.0))
    return (1.0 - s) * (1.0 - LOSS * s) / (1.0 + GAIN * s)


@any_array
def subsurface_coefficients(
    rho: ArrayLike, radius: ArrayLike, scatter_anisotropy: ArrayLike = 0.0
) -> tuple[Array, Array]:
    """Coefficients of scattering and of absorption, each over a length.

        sigma_s = w / l,  sigma_a = (1 - w) / l

    - `radius`: Mean free path l, a length, in [1e-150, 1e150].

    Result: per unit of length. Their sum is 1 / l. [MaterialX2026], Subsurface Scattering Model,
    Albedo Inversion.

        >>> [round(float(each), 4) for each in subsurface_coefficients(0.5, 0.1)]
        [9.1171, 0.8829]
    """
    values = {"rho": rho, "radius": radius, "scatter_anisotropy": scatter_anisotropy}
    color, length, g = checked_numbers(**values)
    albedo = _single_scatter(color, g)
    return albedo / length, (1.0 - albedo) / length


@any_array
def diffusion_profile(separation: ArrayLike, radius: ArrayLike) -> Array:
    """Share of the light that leaves at a distance from where it enters, per area.

        R(r) = (exp(-r / l) + exp(-r / (3 l))) / (8 pi l r)

    Result: per unit of area. Its integral over a plane is 1; the mean distance is 5 l / 2.
    [MaterialX2026], Normalized Diffusion Profile; [Christensen2015], where l is divided by s(rho).

        >>> diffusion_profile(1.0, 1.0).round(6).item()
        0.043147
    """
    r, length = checked_numbers(separation=separation, radius=radius)
    exp = array_namespace(r, length).exp
    return (exp(-r / length) + exp(-r / (3.0 * length))) / (8.0 * np.pi * length * r)


@any_array
def diffusion_cdf(separation: ArrayLike, radius: ArrayLike) -> Array:
    """Share of the light that leaves a plane within a distance of where it enters.

        C(r) = 1 - exp(-r / l) / 4 - 3 exp(-r / (3 l)) / 4

    Result: in (0, 1].

        >>> diffusion_cdf(2.5, 1.0).round(6).item()
        0.65353
    """
    r, length = checked_numbers(separation=separation, radius=radius)
    expm1, x = array_namespace(r, length).expm1, r / length
    return -0.25 * expm1(-x) - 0.75 * expm1(-x / 3.0)


@any_array
def diffusion_sample(u: ArrayLike, radius: ArrayLike) -> Array:
    """Distance within which the share u of the light leaves: the inverse of `diffusion_cdf`.

    - `u`: In [0, 1).
    - `radius`: Mean free path l, a length, in [1e-150, 1e150].

    Result: A length. Form: t = exp(-r / (3 l)) solves t^3 + 3 t = 4 (1 - u), so t = 2 sinh(asinh(2
    (1 - u)) / 3).

        >>> diffusion_sample(0.65353, 1.0).round(4).item()
        2.5
    """
    share, length = checked_numbers(u=u, radius=radius)
    xp = array_namespace(share, length)
    logarithm = xp.log(2.0 * xp.sinh(xp.asinh(2.0 * (1.0 - share)) / 3.0))
    return 3.0 * length * at_least_0(-logarithm)


@any_array
def diffusion_blur(mu: ArrayLike, reach: ArrayLike) -> Array:
    """Cosine of a distant light, blurred over a unit sphere by the normalized diffusion profile.

        W(mu) = int C'(r) c(mu, r) dr / C(2),  c = mean of max(cos(theta), 0) at the distance r

    - `mu`: Cosine of the light with the normal, in [-1, 1].
    - `reach`: Mean free path over the radius of the sphere, in [1e-150, 1e150]; its limit 0 is
      max(mu, 0).

    Result: in [0, 1]. Its mean over the sphere is 1/4, that of max(mu, 0). Distances are those of
    the text, through the body; light whose distance has no point on the sphere leaves as the rest
    does, since a body of no absorption keeps none. Accuracy: absolute error below 1e-6.

        >>> diffusion_blur([-0.5, 0.0, 1.0], 0.1).round(4)
        array([0.0097, 0.074 , 0.9344])
    """
    numbers = {"mu": checked("mu", mu, "cos_theta"), "reach": checked("reach", reach)}
    cosine, length = broadcastable({}, numbers)
    return blur_to(cosine, length, FAR)


def blur_to(mu: Array, reach: Array, far: float) -> Array:
    """`diffusion_blur` of valid arrays, whose second exponential is so many times as long as the first."""
    reach = reach[..., np.newaxis]
    (near, share), (rest, other) = _exponential(mu, reach), _exponential(mu, far * reach)
    total = 0.25 * share + 0.75 * other
    return (0.25 * share * near + 0.75 * other * rest) / total


def _exponential(mu: Array, reach: Array) -> tuple[Array, Array]:
    """Mean over the circles of one exponential of the profile, and its share on the sphere."""
    xp, (u, weights) = array_namespace(mu, reach), (like(each, reach) for each in _rule())
    share = -xp.expm1(-2.0 / reach)
    distance = xp.minimum(-reach * xp.log1p(-u * share), 2.0)
    return xp.sum(weights * _circle(mu[..., np.newaxis], distance), axis=-1), share[..., 0]


@cache
def _rule() -> tuple[Array, Array]:
    """Nodes in [0, 1] and weights of Gauss-Legendre in PANELS of equal width."""
    x, w = unit_rule(NODES)
    u = (np.arange(PANELS)[:, np.newaxis] + x).ravel() / PANELS
    return u, np.tile(w / PANELS, PANELS)


def _circle(mu: Array, distance: Array) -> Array:
    """Mean of max(cos(theta), 0) over the circle at a distance from a point of the unit sphere."""
    squared = distance * distance
    along = mu * (1.0 - 0.5 * squared)
    across = root(at_least_0((1.0 - mu * mu) * squared * (1.0 - 0.25 * squared)))
    lit = arccosine(-along / array_namespace(across).maximum(across, 1e-300))
    return (along * lit + root(at_least_0(across**2 - along**2))) / np.pi
