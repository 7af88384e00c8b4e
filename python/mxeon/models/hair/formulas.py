# SPDX-License-Identifier: Apache-2.0
"""Formulas of the hair model on valid float64 arrays, which broadcast; directions (3, ...).

Sections are those of [MaterialX2026], Chiang Hair Model. The fiber is +x, and the normal +z is turned
to the viewer. A direction has the inclination theta, sin(theta) = x, and an azimuth about the fiber.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet import fresnel_formulas

LOBES = ("R", "TT", "TRT", "TRRT+")
SCALE = np.sqrt(np.pi / 8.0)  # of the logistic distribution: Azimuthal Scattering
LEAST = 1e-300  # of numbers that divide, lest a quotient overflow by itself

# The power series of I_0 has positive terms alone; beyond BESSEL the asymptotic one is as exact, its
# least term being exp(-2 x). Both stop where a term is below 2^-53 of the sum.
BESSEL, TERMS = 20.0, 48


def bessel_scaled(x: Array) -> Array:
    """exp(-x) I_0(x) for x >= 0, of [Olver2010], Eq. 10.25.2 and 10.40.1."""
    small, large = np.minimum(x, BESSEL), np.maximum(x, BESSEL)
    series = term = np.ones_like(small)
    tail = rest = np.ones_like(large)
    for k in range(1, TERMS):
        term = term * np.square(0.5 * small / k)
        series = series + term
        if k < 2.0 * BESSEL - 1.0:  # beyond, the terms grow again
            rest = rest * np.square(2 * k - 1) / (8.0 * k * large)
            tail = tail + rest
    return np.where(x < BESSEL, np.exp(-small) * series, tail / np.sqrt(2.0 * np.pi * large))


def longitudinal(sin_i: Array, cos_i: Array, sin_o: Array, cos_o: Array, v: Array) -> Array:
    """M_p: Longitudinal Scattering, in a form that neither overflows nor cancels.

        M = exp(-d^2 / (2 v)) (exp(-x) I_0(x)) / (v (1 - exp(-2 / v))),  x = |cos_i| cos_o / v

    d is the distance of the points (|cos_i|, sin_i) and (cos_o, -sin_o) of the unit circle. A tilted
    inclination may leave [-pi/2, pi/2]; I_0 is even, so the sign of its cosine has no effect.
    """
    cos_i = np.abs(cos_i)
    d2 = np.square(cos_i - cos_o) + np.square(sin_i + sin_o)
    norm = -v * np.expm1(-2.0 / v)
    value: Array = np.exp(-0.5 * d2 / v) * bessel_scaled(cos_i * cos_o / v) / norm
    return value


def azimuthal(angle: Array, s: Array) -> Array:
    """N_p of the angle phi - Phi_p, which is wrapped into [-pi, pi]: Azimuthal Scattering."""
    scale = SCALE * s
    wrapped = np.remainder(angle + np.pi, 2.0 * np.pi) - np.pi
    fall = np.exp(-np.abs(wrapped) / scale)
    value: Array = fall / (scale * np.square(1.0 + fall)) / np.tanh(0.5 * np.pi / scale)
    return value


def attenuation(F: Array, T: Array) -> Array:
    """A_p, (4, ...): Attenuation Factors. Where F = T = 1, that of TRRT+ has the limit 0."""
    pass_through = np.square(1.0 - F)
    rest = 1.0 - F * T
    last = pass_through * F**2 * T**3 / np.where(rest > 0.0, rest, 1.0)
    return np.stack(
        np.broadcast_arrays(F + 0.0 * T, pass_through * T, pass_through * F * T**2, last)
    )


@dataclass(frozen=True)
class HairForm:
    """The model in the text's form, or in one that a shader may have in its place.

    Attributes
    ----------
    longitudinal : callable (sin_i, cos_i, sin_o, cos_o, v) -> ndarray
        M_p.
    uniform : float
        N of the lobe TRRT+.
    limits : (float, float)
        Least and largest value of every roughness.
    tilts_light : bool
        Whether the cuticle's tilt turns the light's inclination, and not the viewer's.
    effective : bool
        Whether F has the effective index, and the angle gamma_o of the cross-section.
    factor : float
        Factor of the sum over the lobes.
    """

    longitudinal: Callable[[Array, Array, Array, Array, Array], Array] = longitudinal
    uniform: float = 0.5 / np.pi
    limits: tuple[float, float] = (0.0, np.inf)
    tilts_light: bool = True
    effective: bool = False
    factor: float = 1.0 / np.pi


TEXT = HairForm()


@dataclass(frozen=True)
class Section:
    """A view of the cross-section of a fiber.

    Attributes
    ----------
    sin_o, cos_o : ndarray
        Of the viewer's inclination.
    gamma_o, gamma_t : ndarray
        Azimuth of the view from the normal, and that of the refracted ray.
    """

    sin_o: Array
    cos_o: Array
    gamma_o: Array
    gamma_t: Array


def section(wo: Array, ior: Array) -> tuple[Section, Array]:
    """The cross-section that a view meets, and its effective index: Hair Fiber Geometry.

    The text leaves the offset h = sin(gamma_o) to the renderer. As in MaterialX's shaders it is that
    of the point whose normal is +z. A view along the fiber has none, and counts as h = 0. Below
    index 1, where no ray enters, F is 1 and gamma_t has no effect.
    """
    sin_o, cos_o = wo[0], np.hypot(wo[1], wo[2])
    inside = np.sqrt(np.maximum(np.square(ior) - np.square(sin_o), 0.0))
    effective = inside / np.maximum(cos_o, LEAST)
    gamma_o = np.arctan2(-wo[1], np.where(cos_o > 0.0, wo[2], 1.0))
    sin_t = -wo[1] / np.maximum(inside, LEAST)
    return Section(sin_o, cos_o, gamma_o, np.arcsin(np.clip(sin_t, -1.0, 1.0))), effective


def attenuations(
    view: Section, effective: Array, ior: Array, absorption: Array, form: HairForm
) -> Array:
    """A_p of a view, (4, C, ...), of absorptions (C, ...)."""
    cos_gamma = np.cos(view.gamma_o)
    if form.effective:
        F = fresnel_formulas.dielectric(cos_gamma, np.minimum(effective, 1e50))
    else:
        F = fresnel_formulas.dielectric(view.cos_o * cos_gamma, ior)
    sin_t = np.minimum(np.abs(view.sin_o) / np.maximum(ior, LEAST), 1.0)
    cos_t = np.sqrt((1.0 - sin_t) * (1.0 + sin_t))
    T = np.exp(-absorption * (2.0 * np.cos(view.gamma_t) / np.maximum(cos_t, LEAST)))
    return attenuation(F, T)


def distribution(
    view: Section,
    wo: Array,
    wi: Array,
    roughness: tuple[Array, Array],
    alpha: Array,
    lobe: int,
    form: HairForm,
) -> Array:
    """M_p N_p of a lobe: Cuticle Tilt, Longitudinal Scattering, Azimuthal Scattering."""
    # Limit the roughness.
    v, s = (np.clip(each, *form.limits) for each in roughness)
    # Tilt the light, or the view, by the angle of the cuticle.
    inclined = [(wi[0], np.hypot(wi[1], wi[2])), (view.sin_o, view.cos_o)]
    if lobe < 3:
        tilt = (2.0 - 3.0 * lobe) * alpha
        sine, cosine = inclined[not form.tilts_light]
        turned = (
            sine * np.cos(tilt) + cosine * np.sin(tilt),
            cosine * np.cos(tilt) - sine * np.sin(tilt),
        )
        inclined[not form.tilts_light] = turned
    # Scatter longitudinally.
    (sin_i, cos_i), (sin_o, cos_o) = inclined
    M = form.longitudinal(sin_i, cos_i, sin_o, np.abs(cos_o), v)
    # Scatter in azimuth about the exit angle of the lobe.
    if lobe == 3:
        return M * form.uniform
    exit_angle = 2.0 * lobe * view.gamma_t - 2.0 * view.gamma_o + lobe * np.pi
    phi = np.arctan2(wi[2] * wo[1] - wo[2] * wi[1], wi[1] * wo[1] + wi[2] * wo[2])
    return M * azimuthal(phi - exit_angle, s)
