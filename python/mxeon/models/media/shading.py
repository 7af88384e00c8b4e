# SPDX-License-Identifier: Apache-2.0
"""Radiance of surfaces, lights and media by the shader nodes of [MaterialX2026]."""

from __future__ import annotations

from mxeon.models.core.arguments import checked_colors
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import any_array, array_namespace


@any_array
def light_radiance(emission: ArrayLike, intensity: ArrayLike, exposure: ArrayLike) -> Array:
    """Radiance of a light source: that of its EDF, scaled in linear units and in stops.

        L_e = I 2^E L_edf

    - `emission` (..., C): Radiance of the EDF per channel, in [0, 1e50].
    - `intensity` (...): I, in [0, 1e50].
    - `exposure` (...): E, in stops, in [-1000, 1000].

    Result (..., C): in the unit of `emission`. [MaterialX2026], section `light`, Light Emission
    Equation.

        >>> light_radiance([0.5, 1.0], 3.0, 2.0)
        array([ 6., 12.])
    """
    numbers = {"intensity": intensity, "exposure": exposure}
    (c,), (scale, stops) = checked_colors({"emission": emission}, **numbers)
    return c * (scale * 2.0**stops)


@any_array
def surface_radiance(emission: ArrayLike, scattered: ArrayLike, opacity: ArrayLike) -> Array:
    """Radiance of a surface: what it emits and what it scatters, times its opacity.

        L_o = O (L_e + L_s)

    - `emission`, `scattered` (..., C): L_e of its EDF, and L_s, the integral of its BSDF over the
      light, per channel, in [0, 1e50].
    - `opacity` (...): O, the share of the footprint that the material covers, in [0, 1].

    Result (..., C): Without the light from behind, of which 1 - O passes. [MaterialX2026], section
    `surface`, Surface Shading Equation; its integral is that of section The Light Transport
    Equation.

        >>> surface_radiance([1.0], [0.5], 0.5)
        array([0.75])
    """
    colors = {"emission": emission, "scattered": scattered}
    (emitted, light), (covered,) = checked_colors(colors, opacity=opacity)
    return covered * (emitted + light)


@any_array
def volume_radiance(
    behind: ArrayLike,
    emission: ArrayLike,
    absorption: ArrayLike,
    scattering: ArrayLike,
    distance: ArrayLike,
) -> Array:
    """Radiance of a ray through a homogeneous medium, without the light that is scattered into it.

        L = L_0 T + L_e t (1 - T) / (sigma_t t)

    - `behind` (..., C): L_0, the radiance that enters the medium, per channel, in [0, 1e50].
    - `emission` (..., C): L_e, radiance per meter that the medium emits, the same in all
      directions, in [0, 1e50].
    - `absorption`, `scattering` (..., C): Coefficients in 1/m, in [0, 1e50].
    - `distance` (...): t in m, in [0, 1e50].

    Result (..., C): The solution of the equation of transfer whose integral over directions is left
    out: that needs a renderer. [MaterialX2026], section `volume`, and section The Equation of
    Transfer.

        >>> volume_radiance([1.0], [3.0], [0.0], [0.0], 2.0)
        array([7.])
    """
    media = {"absorption": absorption, "scattering": scattering}
    (light, emitted, sigma_a, sigma_s), (t,) = checked_colors(
        {"behind": behind, "emission": emission} | media, distance=distance
    )
    depth = (sigma_a + sigma_s) * t
    xp = array_namespace(depth)
    share = xp.where(depth > 0.0, -xp.expm1(-depth) / xp.where(depth > 0.0, depth, 1.0), 1.0)
    return light * xp.exp(-depth) + emitted * t * share
