# SPDX-License-Identifier: Apache-2.0
"""Participating media: the VDF nodes of [MaterialX2026].

Coefficients are per channel, in 1/m. Directions point away from the position where light is
scattered, so that light that goes straight on has wi = -wo.

- `absorption`, `scattering`: Coefficients in 1/m, in [0, 1e50].
- `g`: Mean cosine of the deflection, in (-1, 1); at either end all light goes one way, and the
  function has no value.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mxeon.models.core.arguments import checked_numbers, checked_pairs, checked_sphere
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_least_0, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import broadcastable, lead_shape


@any_array
def extinction(absorption: ArrayLike, scattering: ArrayLike) -> Array:
    """Extinction coefficient, sigma_t = sigma_a + sigma_s.

    Result: in 1/m. [MaterialX2026], section `anisotropic_vdf`, Extinction.

        >>> float(extinction(0.5, 1.5))
        2.0
    """
    sigma_a, sigma_s = checked_numbers(absorption=absorption, scattering=scattering)
    return (sigma_a + sigma_s)[()]


@any_array
def transmittance(absorption: ArrayLike, scattering: ArrayLike, distance: ArrayLike) -> Array:
    """Share of the radiance that passes a homogeneous medium, T = exp(-sigma_t t).

    - `absorption`, `scattering`: Coefficients in 1/m, in [0, 1e50]. `absorption_vdf` has a
      scattering of 0.
    - `distance`: t in m, in [0, 1e50].

    Result: in [0, 1]. Light that is scattered into the ray is left out. [MaterialX2026], sections
    `absorption_vdf`, Beer-Lambert Absorption, and `anisotropic_vdf`, Extinction.

        >>> round(float(transmittance(0.5, 0.5, 2.0)), 6)
        0.135335
    """
    values = {"absorption": absorption, "scattering": scattering, "distance": distance}
    sigma_a, sigma_s, t = checked_numbers(**values)
    xp = array_namespace(sigma_a, sigma_s, t)
    return xp.exp(-(sigma_a + sigma_s) * t)[()]


@any_array
def single_scattering_albedo(absorption: ArrayLike, scattering: ArrayLike) -> Array:
    """Share of the light that leaves a ray by being scattered, sigma_s / sigma_t.

    Result: in [0, 1]; 0 where no light leaves the ray. [MaterialX2026], section `anisotropic_vdf`,
    Extinction.

        >>> float(single_scattering_albedo(0.5, 1.5))
        0.75
    """
    sigma_a, sigma_s = checked_numbers(absorption=absorption, scattering=scattering)
    sigma_t = sigma_a + sigma_s
    xp = array_namespace(sigma_t)
    return (sigma_s / xp.where(sigma_t > 0.0, sigma_t, 1.0))[()]


@any_array
def hg_phase(cos_theta: ArrayLike, g: ArrayLike) -> Array:
    """Phase function of Henyey and Greenstein.

        f_p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))

    - `cos_theta`: Cosine of the angle of deflection, in [-1, 1]: 1 is straight on.

    Result: density in solid angle, 1/sr. Its integral over all directions is 1. The denominator is
    (1 - |g|)^2 + 2 |g| (1 - cos), with the sign of g on the cosine, and 1 - g^2 a product: neither
    cancels near g = 1 or -1. [MaterialX2026], section `anisotropic_vdf`, Henyey-Greenstein Phase
    Function.

        >>> hg_phase([1.0, -1.0], 0.5).round(6)
        array([0.477465, 0.017684])
    """
    cosine, mean = checked_numbers(cos_theta=cos_theta, g=g)
    xp = array_namespace(cosine, mean)
    return _phase(1.0 - xp.where(mean < 0.0, -cosine, cosine), mean)[()]


@any_array
def hg_sample(wo: ArrayLike, u: ArrayLike, g: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled by the phase function of Henyey and Greenstein, and its density.

    With x = 2 u_1 - 1, the inverse of its distribution is written

        1 - cos = (1 - g)^2 (1 - x) (2 + g (1 + x)) / (2 (1 + g x)^2),

    which is 1 - x at g = 0 and does not cancel for any g.

    - `wo` (..., 3): Direction from which the light leaves, any unit vector to 1e-6.
    - `u` (..., 2): Independent uniform random numbers, in [0, 1).

    `wi` (..., 3): Unit vectors towards the light. `pdf` (...): Density at `wi`, `hg_pdf`, in 1/sr.
    [MaterialX2026], section `anisotropic_vdf`; the form of the inverse is our own.

        >>> wi, pdf = hg_sample([0.0, 0.0, 1.0], [0.5, 0.0], 0.0)
        >>> wi.round(12) + 0.0, round(float(pdf), 6)
        (array([0., 1., 0.]), 0.079577)
    """
    views, pairs, (mean,) = checked_sphere("wo", wo), checked_pairs("u", u), checked_numbers(g=g)
    shape = lead_shape({"wo": views, "u": pairs}, {"g": mean})
    views, pairs, mean = broadcastable({"wo": views, "u": pairs}, {"g": mean})
    xp = array_namespace(views, pairs, mean)
    x, azimuth = 2.0 * pairs[..., 0] - 1.0, 2.0 * np.pi * pairs[..., 1]
    # Invert the distribution, as 1 - cos and 1 + cos, which do not cancel.
    square = 2.0 * (1.0 + mean * x) ** 2
    less = (1.0 - mean) ** 2 * (1.0 - x) * (2.0 + mean * (1.0 + x)) / square  # 1 - cos
    more = (1.0 + mean) ** 2 * (1.0 + x) * (2.0 - mean * (1.0 - x)) / square  # 1 + cos
    sine = root(at_least_0(less * more))
    local = sine * xp.cos(azimuth), sine * xp.sin(azimuth), 0.5 * (more - less)
    parts = _around([-views[..., k] for k in range(3)], local)
    wi = xp.stack([xp.broadcast_to(each, shape) for each in parts], axis=-1)
    density = _phase(xp.where(mean < 0.0, more, less), mean)
    return wi, (0.0 * wi[..., 0] + density)[()]


@any_array
def hg_pdf(wo: ArrayLike, wi: ArrayLike, g: ArrayLike) -> Array:
    """Density of `hg_sample` at `wi`, in solid angle: the phase function itself.

    - `wo`, `wi` (..., 3): Directions away from the position, unit vectors to 1e-6; cos =
      -dot(wo, wi).

    Result (...): in 1/sr. [MaterialX2026], section `anisotropic_vdf`, Henyey-Greenstein Phase
    Function.

        >>> round(float(hg_pdf([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 0.5)), 6)
        0.477465
    """
    views, lights, (mean,) = (
        checked_sphere("wo", wo),
        checked_sphere("wi", wi),
        checked_numbers(g=g),
    )
    lead_shape({"wo": views, "wi": lights}, {"g": mean})
    xp = array_namespace(views, lights, mean)
    side = xp.where(mean < 0.0, -1.0, 1.0)[..., np.newaxis]
    difference = 1.0 * views + side * lights  # 0 where the deflection is likeliest
    return _phase(0.5 * xp.sum(difference**2, axis=-1), mean)[()]


def _around(axis: Sequence[Array], local: Sequence[Array]) -> list[Array]:
    """Components of directions, of a frame with the normal +z, in one with the normal `axis`."""
    where, aside = array_namespace(*axis).where, abs(axis[0]) < 0.5
    tangent = _unit(_cross((where(aside, 1.0, 0.0), where(aside, 0.0, 1.0), 0.0 * axis[2]), axis))
    frame = tangent, _cross(axis, tangent), axis
    x, y, z = local
    return _unit([x * t + y * b + z * n for t, b, n in zip(*frame, strict=True)])


def _cross(a: Sequence[Array], b: Sequence[Array]) -> list[Array]:
    """Cross product of components."""
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def _unit(w: Sequence[Array]) -> list[Array]:
    """Components of a vector over its length."""
    length = root(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    return [each / length for each in w]


def _phase(less: Array, g: Array) -> Array:
    """The phase function at 1 - cos for g >= 0, and at 1 + cos for g < 0."""
    xp = array_namespace(less, g)
    size = xp.abs(g)
    square = (1.0 - size) ** 2 + 2.0 * size * less
    return (1.0 - size) * (1.0 + size) / (4.0 * np.pi * square * xp.sqrt(square))
