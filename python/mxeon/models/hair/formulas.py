# SPDX-License-Identifier: Apache-2.0
"""Formulas of the hair model on valid float64 arrays, which broadcast; directions (3, ...).

Sections are those of [MaterialX2026], Chiang Hair Model. The fiber is +x, and the normal +z is turned
to the viewer. A direction has the inclination theta, sin(theta) = x, and an azimuth about the fiber.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.edges import angle, arcsine, at_most, guarded, hypot, least_normal, root
from mxeon.models.core.namespaces import NUMPY, array_namespace, like
from mxeon.models.microfacet import fresnel_formulas

LOBES = ("R", "TT", "TRT", "TRRT+")
SCALE = np.sqrt(np.pi / 8.0)  # of the logistic distribution: Azimuthal Scattering
LEAST = 1e-300  # of numbers that divide, lest a quotient overflow by itself

# The power series of I_0 has positive terms alone; beyond BESSEL the asymptotic one is as exact, its
# least term being exp(-2 x). Both stop where a term is below 2^-53 of the sum.
BESSEL, TERMS = 20.0, 48


def bessel_scaled(x: Array) -> Array:
    """exp(-x) I_0(x) for x >= 0, of [Olver2010], Eq. 10.25.2 and 10.40.1."""
    xp = array_namespace(x)
    small, large = xp.minimum(x, BESSEL), xp.maximum(x, BESSEL)
    if xp is NUMPY:
        series, tail = _bessel_series(small, large)
    else:
        series, tail = (1.0 + each for each in _bessel_powers(small, large))
    return xp.where(x < BESSEL, xp.exp(-small) * series, tail / xp.sqrt(2.0 * np.pi * large))


def _bessel_series(small: Array, large: Array) -> tuple[Array, Array]:
    """Both series, term by term."""
    series = term = np.ones_like(small)
    tail = rest = np.ones_like(large)
    for k in range(1, TERMS):
        term = term * np.square(0.5 * small / k)
        series = series + term
        if k < 2.0 * BESSEL - 1.0:  # beyond, the terms grow again
            rest = rest * (2 * k - 1) ** 2 / (8.0 * k * large)
            tail = tail + rest
    return series, tail


def _bessel_powers(small: Array, large: Array) -> Iterator[Array]:
    """Both series but for their first term, as few operations, which a library compiles in less time."""
    xp = array_namespace(small)
    k = np.arange(1, TERMS)
    terms = np.cumprod((0.5 * BESSEL / k) ** 2)
    rest = np.cumprod(np.where(k < 2.0 * BESSEL - 1.0, (2 * k - 1) ** 2 / (8.0 * k * BESSEL), 0.0))
    for x, powers, coefficients in ((small / BESSEL, 2 * k, terms), (BESSEL / large, k, rest)):
        factors = x[..., np.newaxis] ** like(powers, x)
        yield xp.sum(factors * like(coefficients, x), axis=-1)


def longitudinal(sin_i: Array, cos_i: Array, sin_o: Array, cos_o: Array, v: Array) -> Array:
    """M_p: Longitudinal Scattering, in a form that neither overflows nor cancels.

    Printed, with x = cos_i cos_o / v: M = exp(-sin_i sin_o / v) I_0(x) / (2 v sinh(1 / v)). I_0 is even, so that
    |cos_i| serves for a tilted inclination beyond [-pi/2, pi/2]. Take e^x out of I_0 and e^(1/v) out of 2 sinh:

        M = exp(-(1 + sin_i sin_o - |cos_i| cos_o) / v) (exp(-x) I_0(x)) / (v (1 - exp(-2 / v)))

    The bracket is d^2 / 2, d the distance of the points (|cos_i|, sin_i) and (cos_o, -sin_o) of the unit circle.
    """
    xp = array_namespace(sin_i, sin_o, v)
    cos_i = xp.abs(cos_i)
    d2 = xp.square(cos_i - cos_o) + xp.square(sin_i + sin_o)
    norm = -v * xp.expm1(-2.0 / v)
    return xp.exp(-0.5 * d2 / v) * bessel_scaled(cos_i * cos_o / v) / norm


def azimuthal(phi: Array, s: Array) -> Array:
    """N_p of an angle x = phi - Phi_p, which is wrapped into [-pi, pi]: Azimuthal Scattering.

    Printed: l(x, s) / (L(pi, s) - L(-pi, s)) of the logistic density l and its integral L = 1 / (1 + e^(-x/s)), s
    scaled by sqrt(pi / 8). l is even, so that with f = e^(-|x|/s) it is f / (s (1 + f)^2) and never overflows;
    L(pi) - L(-pi) = (1 - e^(-pi/s)) / (1 + e^(-pi/s)) = tanh(pi / (2 s)).
    """
    xp, scale = array_namespace(phi, s), SCALE * s
    wrapped = xp.remainder(phi + np.pi, 2.0 * np.pi) - np.pi
    fall = xp.exp(-xp.abs(wrapped) / scale)
    value: Array = fall / (scale * xp.square(1.0 + fall)) / xp.tanh(0.5 * np.pi / scale)
    return value


def attenuation(F: Array, T: Array) -> Array:
    """A_p, (4, ...): Attenuation Factors. Where F = T = 1, that of TRRT+ has the limit 0."""
    xp = array_namespace(F, T)
    pass_through = xp.square(1.0 - F)
    rest = 1.0 - F * T
    last = pass_through * F**2 * T**3 / xp.where(rest > 0.0, rest, 1.0)
    return xp.stack([F + 0.0 * T, pass_through * T, pass_through * F * T**2, last])


@dataclass(frozen=True)
class HairForm:
    """The model in the text's form, or in one that a shader may have in its place.

    - `tilts_light`: Whether the cuticle's tilt turns the light's inclination, and not the viewer's.
    - `effective`: Whether F has the effective index, and the angle gamma_o of the cross-section.
    """

    longitudinal: Callable[[Array, Array, Array, Array, Array], Array] = longitudinal  # M_p
    uniform: float = 0.5 / np.pi  # N of the lobe TRRT+
    limits: tuple[float, float] = (0.0, np.inf)  # least and largest value of every roughness
    tilts_light: bool = True
    effective: bool = False
    factor: float = 1.0 / np.pi  # factor of the sum over the lobes


TEXT = HairForm()


@dataclass(frozen=True)
class Section:
    """A view of the cross-section of a fiber.

    - `sin_o`, `cos_o`: Of the viewer's inclination.
    - `gamma_o`, `gamma_t`: Azimuth of the view from the normal, and that of the refracted ray.
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
    xp, least = array_namespace(wo, ior), max(LEAST, least_normal(wo))
    sin_o, cos_o = wo[0], hypot(wo[1], wo[2])
    inside = root(xp.maximum(xp.square(ior) - xp.square(sin_o), 0.0))
    effective = inside / xp.maximum(guarded(cos_o, cos_o > least, 1.0), LEAST)
    gamma_o = angle(-wo[1], xp.where(cos_o > 0.0, wo[2], 1.0))
    sin_t = -wo[1] / xp.maximum(guarded(inside, inside > least, 1.0), LEAST)
    return Section(sin_o, cos_o, gamma_o, arcsine(sin_t)), effective


def attenuations(
    view: Section, effective: Array, ior: Array, absorption: Array, form: HairForm
) -> Array:
    """A_p of a view, (4, C, ...), of absorptions (C, ...)."""
    xp, least = array_namespace(view.sin_o, ior, absorption), max(LEAST, least_normal(ior))
    cos_gamma = xp.cos(view.gamma_o)
    if form.effective:
        F = fresnel_formulas.dielectric(cos_gamma, xp.minimum(effective, 1e50))
    else:
        F = fresnel_formulas.dielectric(view.cos_o * cos_gamma, ior)
    bends = ior > least
    sin_t = at_most(xp.abs(view.sin_o) / xp.maximum(guarded(ior, bends, least), LEAST), 1.0)
    cos_t = root((1.0 - sin_t) * (1.0 + sin_t))
    cos_t = xp.maximum(guarded(cos_t, cos_t > least, least), LEAST)
    return attenuation(F, xp.exp(-absorption * (2.0 * xp.cos(view.gamma_t) / cos_t)))


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
    xp, (low, high) = array_namespace(wo, wi, alpha), form.limits
    v, s = (xp.minimum(xp.maximum(each, low), high) for each in roughness)
    inclined = [(wi[0], hypot(wi[1], wi[2])), (view.sin_o, view.cos_o)]
    if lobe < 3:
        tilt = (2.0 - 3.0 * lobe) * alpha
        sine, cosine = inclined[not form.tilts_light]
        turned = (
            sine * xp.cos(tilt) + cosine * xp.sin(tilt),
            cosine * xp.cos(tilt) - sine * xp.sin(tilt),
        )
        inclined[not form.tilts_light] = turned
    (sin_i, cos_i), (sin_o, cos_o) = inclined
    M = form.longitudinal(sin_i, cos_i, sin_o, xp.abs(cos_o), v)
    if lobe == 3:
        return M * form.uniform
    exit_angle = 2.0 * lobe * view.gamma_t - 2.0 * view.gamma_o + lobe * np.pi
    phi = angle(wi[2] * wo[1] - wo[2] * wi[1], wi[1] * wo[1] + wi[2] * wo[2])
    return M * azimuthal(phi - exit_angle, s)
