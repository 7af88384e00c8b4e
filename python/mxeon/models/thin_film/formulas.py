# SPDX-License-Identifier: Apache-2.0
"""Airy reflectance of a thin film on valid float64 arrays, which broadcast.

Sections are those of [MaterialX2026], appendix Thin-Film Iridescence Model. Each function is of one
polarization unless it returns both, p before s. The film is at least as dense as the vacuum above it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.edges import root
from mxeon.models.core.namespaces import NUMPY, array_namespace
from mxeon.models.microfacet import fresnel_formulas as fresnel

# Gaussians of the sensitivities: tristimulus, v in m, mu in 1/m, sigma^2 in 1/m^2.
GAUSSIANS = (
    (0, 5.4856e-13, 1.6810e6, 4.3278e9),
    (0, 9.7470e-14, 2.2399e6, 4.5282e9),
    (1, 4.4201e-13, 1.7953e6, 9.3046e9),
    (2, 5.2481e-13, 2.2084e6, 6.6121e9),
)
NORMAL = 1.0685e-7
METERS = 1e-9  # in a nanometer

# All orders are summed one by one where THIN_SPREAD <= 2 pi OPD sigma: what follows DAMPED_ORDERS of
# them is below exp(-(30 * 0.2)^2) = 3e-16. Thinner films are integrated over wavenumbers, by the
# trapezoidal rule over 6.5 standard deviations, 2^-48 of a Gaussian's height, in steps of a fifth of one.
THIN_SPREAD, DAMPED_ORDERS = 0.2, 30
STEP, STEPS = 0.2, 32
SAME = 2.0**-20  # relative distance of indices that are roundings of the same number
# Weights of its nodes from the center on, and of all of them.
HEIGHTS = STEP * np.exp(-0.5 * (STEP * np.arange(STEPS + 1)) ** 2) / np.sqrt(2.0 * np.pi)
HEIGHT = 2.0 * float(HEIGHTS.sum()) - float(HEIGHTS[0])
BLOCK = 2**12  # elements at once, of which a dozen arrays stay in a cache


class Interface(NamedTuple):
    """Reflectances R12 and R23 of both interfaces, and phi_21 + phi_23, in radian."""

    first: Array
    second: Array
    phase: Array

    def tristimulus(self, opd: Array, orders: int | None = None) -> Array:
        """Reflected intensity in CIE XYZ, shape (3, ...): `tristimulus`."""
        return tristimulus(self, opd, orders)


def refracted(mu: Array, film_ior: Array) -> Array:
    """cos theta_t: Three-Layer Geometry."""
    xp = array_namespace(mu, film_ior)
    squared = xp.maximum(1.0 - (1.0 - mu) * (1.0 + mu) / film_ior**2, 0.0)
    # Through a film of index 1 it is mu, which has a derivative at grazing.
    return xp.sqrt(squared) if xp is NUMPY else xp.where(squared > 0.0, root(squared), mu)


def path_difference(mu: Array, thickness: Array, film_ior: Array) -> Array:
    """Optical path difference in m: Optical Path Difference."""
    return 2.0 * film_ior * refracted(mu, film_ior) * thickness * METERS


def over_index(
    mu: Array, film_ior: Array, ior: Array, extinction: Array
) -> tuple[Interface, Interface]:
    """Film over a dielectric or a conductor, for both polarizations."""
    mu_t = refracted(mu, film_ior)
    first = fresnel.polarized(mu, film_ior, np.zeros_like(film_ior))
    second = fresnel.polarized(mu_t, ior / film_ior, extinction / film_ior)
    below = second_phases(mu_t, film_ior, ior, extinction)
    phases = zip(first_phases(mu, film_ior), below, strict=True)
    p, s = (
        Interface(R12, R23, phi_21 + phi_23)
        for R12, R23, (phi_21, phi_23) in zip(first, second, phases, strict=True)
    )
    return p, s


def over_schlick(
    mu: Array, film_ior: Array, F: Array, color0: Array
) -> tuple[Interface, Interface]:
    """Film over a Schlick substrate whose curve is F at cos theta_t, for both polarizations.

    Where a dip turns F negative there is no amplitude, and F counts as 0. The phase jumps where both indices
    are the same: within SAME they count as that, since color0 0.04 below a film of 1.5 is 2e-8 off in float32.
    """
    F = np.maximum(F, 0.0)
    phi_23 = np.where(index_of(color0) < film_ior * (1.0 - SAME), np.pi, 0.0)
    p, s = (
        Interface(R12, F, phi_21 + phi_23)
        for R12, phi_21 in zip(
            fresnel.polarized(mu, film_ior, np.zeros_like(film_ior)),
            first_phases(mu, film_ior),
            strict=True,
        )
    )
    return p, s


def index_of(color0: Array) -> Array:
    """Index of refraction whose reflectance along the normal is color0; unbounded at 1."""
    amplitude = root(color0)
    least = array_namespace(color0).maximum(1.0 - amplitude, fresnel.LEAST)
    return (1.0 + amplitude) / least


def first_phases(mu: Array, film_ior: Array) -> tuple[Array, Array]:
    """phi_21 of both polarizations: First Interface Phase.

    The angle is below arctan(film_ior) where mu sqrt(1 + film_ior^2) > 1.
    """
    steep = mu * np.hypot(1.0, film_ior) > 1.0
    return np.where(steep, np.pi, 0.0), np.full_like(mu, np.pi)


def second_phases(
    mu_t: Array, film_ior: Array, ior: Array, extinction: Array
) -> tuple[Array, Array]:
    """phi_23 of both polarizations: Second Interface Phase (Dielectric and Conductor Substrates).

    With n = ior + i extinction, n^2 = P + 2 i Q and |n|^2 = N: ior^2 (1 - k^2) = P, ior^2 k = Q, so that
    nothing is divided by the index, and U V = Q, so that the smaller one does not cancel.
    """
    c = film_ior * mu_t
    P, Q, N = ior**2 - extinction**2, ior * extinction, ior**2 + extinction**2
    A = P - film_ior**2 * (1.0 - mu_t) * (1.0 + mu_t)
    B = fresnel.modulus(A, 2.0 * Q)
    larger = np.sqrt(0.5 * (B + np.abs(A)))
    smaller = Q / np.where(larger > 0.0, larger, 1.0)
    U, V = np.where(A >= 0.0, larger, smaller), np.where(A >= 0.0, smaller, larger)
    phi_s = np.arctan2(2.0 * c * V, B - c * c)
    phi_p = np.arctan2(2.0 * c * (2.0 * Q * U - P * V), (N * mu_t) ** 2 - film_ior**2 * B)
    return phi_p, phi_s


def tristimulus(interface: Interface, opd: Array, orders: int | None = None) -> Array:
    """Reflected intensity of one polarization in CIE XYZ, shape (3, ...): Airy Summation.

    `orders` is M; None sums all of them.
    """
    first, second, phase = interface
    passed = 1.0 - first
    lost = 1.0 - first * second  # 0 only where nothing passes
    dc = first + passed**2 * second / np.where(lost > 0.0, lost, 1.0)
    amplitude = dc - first - passed
    r = np.sqrt(first * second)
    series = _all_orders if orders is None else _orders
    return np.asarray(dc + 2.0 * amplitude * series(r, phase, opd, orders or 0))


def _orders(r: Array, phase: Array, opd: Array, orders: int) -> Array:
    """Sum of r^m S(m opd, m phase) for m from 1 to `orders`, shape (3, ...)."""
    r, phase, opd = np.broadcast_arrays(r, phase, opd)
    total = np.zeros((3, r.size))
    for start in range(0, r.size, BLOCK):
        rows = slice(start, start + BLOCK)
        block = r.ravel()[rows], phase.ravel()[rows], opd.ravel()[rows]
        total[:, rows] = damped_orders(*block, orders)
    return total.reshape(3, *r.shape)


def damped_orders(r: Array, phase: Array, opd: Array, orders: int) -> Array:
    """Sum of r^m S(m opd, m phase) for m from 1 to `orders` of arrays (N,), shape (3, N).

    S is the normalized sensitivity, which a sum over Gaussians gives with phi = 2 pi opd:

        v sqrt(2 pi sigma^2) cos(mu phi + phase) exp(-sigma^2 phi^2)

    Each order is made of the one before it, by the cosine of a multiple angle.
    """
    phi = 2.0 * np.pi * opd
    total = np.zeros((3, len(r)))
    for k, v, mu, var in GAUSSIANS:
        damping = np.exp(-var * phi * phi)
        height, twice = r * damping, damping * damping
        growth = height * twice
        cosine = np.cos(mu * phi + phase)
        double, before = 2.0 * cosine, np.ones_like(cosine)
        summed = height * cosine
        for _ in range(1, orders):
            before, cosine = cosine, double * cosine - before
            height = height * growth
            growth = growth * twice
            summed += height * cosine
        total[k] += v * np.sqrt(2.0 * np.pi * var) / NORMAL * summed
    return total


def _all_orders(r: Array, phase: Array, opd: Array, _: int) -> Array:
    """Sum of r^m S(m opd, m phase) for all m from 1 on, shape (3, ...).

    S is the mean of cos(m (2 pi opd nu + phase)) over Gaussians of wavenumbers nu, and the sum of
    r^m cos(m x) is (r cos x - r^2) / (1 - 2 r cos x + r^2).
    """
    r, phase, opd = np.broadcast_arrays(r, phase, opd)
    total = np.zeros((3, *r.shape))
    least = min(variance for *_, variance in GAUSSIANS)
    thick = 2.0 * np.pi * opd * np.sqrt(least) >= THIN_SPREAD
    total[:, thick] = _orders(r[thick], phase[thick], opd[thick], DAMPED_ORDERS)
    total[:, ~thick] = _integrated(r[~thick], phase[~thick], opd[~thick])
    return total


def _integrated(r: Array, phase: Array, opd: Array) -> Array:
    """The sum of all orders by an integral over wavenumbers, shape (3, N).

    The sum of r^m cos(m x) is ((1 - r^2) / (1 - 2 r cos x + r^2) - 1) / 2, and the angle of a node is
    that of a Gaussian's center plus or minus a multiple of one step: no node takes a sine of its own.
    """
    total = np.zeros((3, len(r)))
    for start in range(0, len(r), BLOCK):
        rows = slice(start, start + BLOCK)
        for k, v, mu, var in GAUSSIANS:
            x = 2.0 * np.pi * mu * opd[rows] + phase[rows]
            step = 2.0 * np.pi * np.sqrt(2.0 * var) * STEP * opd[rows]
            kernel = _mean_inverse(r[rows], 0.5 * x, 0.5 * step)
            weight = v * np.sqrt(2.0 * np.pi * var) / NORMAL
            total[k, rows] += 0.5 * weight * ((1.0 - r[rows]) * (1.0 + r[rows]) * kernel - HEIGHT)
    return total


def _mean_inverse(r: Array, half: Array, step: Array) -> Array:
    """Mean of 1 / ((1 - r)^2 + 4 r sin(half + k step)^2) over the nodes k of a Gaussian.

    It is large but finite where r is 1, where nothing passes and no order counts.
    """
    # The node at the center.
    sine, cosine = np.sin(half), np.cos(half)
    turn_s, turn_c = np.sin(step), np.cos(step)
    square, quadruple = np.maximum((1.0 - r) ** 2, 1e-300), 4.0 * r
    total = HEIGHTS[0] / (square + quadruple * sine * sine)
    s, c = turn_s, turn_c
    for height in HEIGHTS[1:]:
        # The nodes on both sides of the center, and the angle of the next ones.
        forth, back = sine * c, cosine * s
        above, below = forth + back, forth - back
        total += height / (square + quadruple * above * above)
        total += height / (square + quadruple * below * below)
        s, c = s * turn_c + c * turn_s, c * turn_c - s * turn_s
    return np.asarray(total)
