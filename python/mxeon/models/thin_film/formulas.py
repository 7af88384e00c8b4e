# SPDX-License-Identifier: Apache-2.0
"""Airy reflectance of a thin film by complex amplitudes, on valid float64 arrays, which broadcast.

Sections are those of [MaterialX2026], appendix Thin-Film Iridescence Model. The film is at least as dense as the vacuum
above it, so that the amplitude r12 of its upper interface is real; that of the lower one is r23 = sqrt(R23) e^(i phi_23).
The text prints reflectances and phases, R12, R23 and phi = phi_21 + phi_23, and sums

    I = C_0 + 2 sum of C_m S(m D, m phi),  C_0 = R12 + R_s,  R_s = T121^2 R23 / (1 - R12 R23),
    C_m = (R_s - T121) sqrt(R12 R23)^m,  T121 = 1 - R12

With z = r21 r23 = -r12 r23, whose length is sqrt(R12 R23) and whose
angle is phi, the m-th term is the real part of z^m. Roots and phases have no derivative where a reflectance is 0: for a
film of index 1, at Brewster's angle, over a substrate of its own index. z^m has.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.edges import at_least_0, guarded, magnitude, root
from mxeon.models.core.namespaces import NUMPY, array_namespace, like
from mxeon.models.microfacet import fresnel_formulas as fresnel

Complex: TypeAlias = tuple[Array, Array]  # real and imaginary part

# Gaussians of the sensitivities: tristimulus, v in m, mu in 1/m, sigma^2 in 1/m^2.
GAUSSIANS = (
    (0, 5.4856e-13, 1.6810e6, 4.3278e9),
    (0, 9.7470e-14, 2.2399e6, 4.5282e9),
    (1, 4.4201e-13, 1.7953e6, 9.3046e9),
    (2, 5.2481e-13, 2.2084e6, 6.6121e9),
)
NORMAL = 1.0685e-7
METERS = 1e-9  # in a nanometer
# Their centers, standard deviations, and weights in XYZ, (3, 4).
CENTERS = np.array([mu for _, _, mu, _ in GAUSSIANS])
SPREADS = np.sqrt([variance for *_, variance in GAUSSIANS])
AREAS = [v * np.sqrt(2.0 * np.pi * variance) / NORMAL for _, v, _, variance in GAUSSIANS]
WEIGHTS = np.eye(3)[:, [row for row, *_ in GAUSSIANS]] * AREAS

# All orders are summed one by one where THIN_SPREAD <= 2 pi OPD sigma: what follows DAMPED_ORDERS of
# them is below exp(-(30 * 0.2)^2) = 3e-16. Thinner films are integrated over wavenumbers, by the
# trapezoidal rule over 6.5 standard deviations, 2^-48 of a Gaussian's height, in steps of a fifth of one.
THIN_SPREAD, DAMPED_ORDERS = 0.2, 30
STEP, STEPS = 0.2, 32
SAME = 2.0**-20  # relative distance of indices that are roundings of the same number
# Weights of its nodes from the center on, and of all of them.
HEIGHTS = STEP * np.exp(-0.5 * (STEP * np.arange(STEPS + 1)) ** 2) / np.sqrt(2.0 * np.pi)
HEIGHT = 2.0 * float(HEIGHTS.sum()) - float(HEIGHTS[0])
BLOCK = 2**13  # elements at once


class Interface(NamedTuple):
    """Amplitudes r12 and -r23 of one polarization, seen from the film, and R23."""

    first: Array
    second: Complex
    reflectance: Array


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
    """Film over a dielectric or a conductor, for both polarizations, p before s.

    Printed, with c = film_ior cos theta_t, n = ior + i extinction and W = n cos theta_3 = sqrt(n^2 - sin^2 theta):

        r_s = (c - W) / (c + W),  r_p = (n^2 c - film_ior^2 W) / (n^2 c + film_ior^2 W)

    W^2 - c^2 = n^2 - film_ior^2, so that -r_s = (n^2 - film_ior^2) / (W + c)^2: no difference of roots. And
    n^2 = W^2 + sin^2, film_ior^2 = c^2 + sin^2 make n^2 c -+ film_ior^2 W = (W -+ c) (c W -+ sin^2), so that
    r_p = -r_s (c W - sin^2) / (c W + sin^2).
    """
    xp = array_namespace(mu, film_ior, ior, extinction)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    # W = U + iV, of which U V = ior extinction gives the smaller part without a cancellation.
    Q, A = ior * extinction, (ior - extinction) * (ior + extinction) - S2
    larger = root(0.5 * (fresnel.modulus(A, 2.0 * Q) + magnitude(A)))
    smaller = Q / xp.where(larger > 0.0, larger, 1.0)
    U, V = xp.where(A >= 0.0, larger, smaller), xp.where(A >= 0.0, smaller, larger)
    gap = (ior - film_ior) * (ior + film_ior) - extinction * extinction, 2.0 * Q
    s = _quotient(gap, ((U + c) ** 2 - V * V, 2.0 * (U + c) * V), 0.0)
    p = _product(s, _quotient((c * U - S2, c * V), (c * U + S2, c * V), 1.0))
    first_p, first_s = first_amplitudes(mu, film_ior)
    return Interface(first_p, p, _squared(p)), Interface(first_s, s, _squared(s))


def over_schlick(
    mu: Array, film_ior: Array, F: Array, color0: Array
) -> tuple[Interface, Interface]:
    """Film over a Schlick substrate whose curve is F at cos theta_t, for both polarizations.

    Where a dip turns F negative there is no amplitude, and F counts as 0. The phase jumps where both indices
    are the same: within SAME they count as that, since color0 0.04 below a film of 1.5 is 2e-8 off in float32.
    """
    xp = array_namespace(mu, film_ior, F)
    F = at_least_0(F)
    second = xp.where(index_of(color0) < film_ior * (1.0 - SAME), -1.0, 1.0) * root(F)
    p, s = (Interface(r, (second, 0.0 * second), F) for r in first_amplitudes(mu, film_ior))
    return p, s


def index_of(color0: Array) -> Array:
    """Index of refraction whose reflectance along the normal is color0; unbounded at 1."""
    amplitude = root(color0)
    least = array_namespace(color0).maximum(1.0 - amplitude, fresnel.LEAST)
    return (1.0 + amplitude) / least


def first_amplitudes(mu: Array, film_ior: Array) -> tuple[Array, Array]:
    """r12 of both polarizations, by the forms of `over_index`; its sign is the phase phi_12, 0 or pi."""
    xp = array_namespace(mu, film_ior)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    total = xp.where(c + mu > 0.0, c + mu, 1.0)
    s = -(film_ior - 1.0) * (film_ior + 1.0) / (total * total)
    return s * (mu * c - S2) / (mu * c + S2), s


def tristimulus(interface: Interface, opd: Array, orders: int | None = None) -> Array:
    """Reflected intensity of one polarization in CIE XYZ, shape (3, ...): Airy Summation.

    `orders` is M; None sums all of them.
    """
    (first, (real, imaginary), R23), xp = interface, array_namespace(*interface[::2], opd)
    R12 = first * first
    passed, lost = 1.0 - R12, 1.0 - R12 * R23  # nothing is lost only where nothing passes
    dc = R12 + passed**2 * R23 / xp.where(lost > 0.0, lost, 1.0)
    values = first * real, first * imaginary, 2.0 * np.pi * opd
    shape = np.broadcast_shapes(*(tuple(each.shape) for each in values))
    x, y, phi = (xp.broadcast_to(each, shape) for each in values)
    if xp is NUMPY:
        sums = np.empty((len(GAUSSIANS), x.size))
        for start in range(0, x.size, BLOCK):
            rows = slice(start, start + BLOCK)
            _fill(sums[:, rows], x.ravel()[rows], y.ravel()[rows], phi.ravel()[rows], orders)
        sums = sums.reshape(len(GAUSSIANS), *shape)
    else:
        sums = _orders(x, y, phi, orders or DAMPED_ORDERS)
        if orders is None:
            thick = phi * float(SPREADS.min()) >= THIN_SPREAD
            sums = xp.where(thick, sums, _integrated(x, y, guarded(phi, ~thick, 0.0)))
    return dc + 2.0 * (dc - R12 - passed) * xp.tensordot(like(WEIGHTS, sums), sums, axes=1)


def _fill(sums: Array, x: Array, y: Array, phi: Array, orders: int | None) -> None:
    """Fill the sums of a block with those of thick films and of thin ones."""
    thick = phi * SPREADS.min() >= THIN_SPREAD if orders is None else np.full(len(phi), True)
    if thick.all():
        sums[:] = _orders(x, y, phi, orders or DAMPED_ORDERS)
        return
    sums[:, thick] = _orders(x[thick], y[thick], phi[thick], DAMPED_ORDERS)
    sums[:, ~thick] = _integrated(x[~thick], y[~thick], phi[~thick])


def _column(values: Array, array: Array) -> Array:
    """Numbers of the Gaussians along a first axis before those of an array, in its library."""
    return like(values.reshape(-1, *(1,) * array.ndim), array)


def _orders(x: Array, y: Array, phi: Array, orders: int) -> Array:
    """Real part of the sum of z^m S(m phi) for m from 1 to `orders`, z = x + i y, of each Gaussian, (4, ...).

        S(phi) = exp(i mu phi - sigma^2 phi^2)

    With w = z exp(i mu phi) the real part of w^m is 2 Re(w) that of w^(m-1) less |w|^2 that of w^(m-2).
    """
    xp, angle = array_namespace(phi), _column(CENTERS, phi) * phi
    damping = xp.exp(-((_column(SPREADS, phi) * phi) ** 2))
    twice = damping * damping
    growth = damping * twice
    power, size = x * xp.cos(angle) - y * xp.sin(angle), x * x + y * y
    before, double, total = 0.0 * size + 1.0, 2.0 * power, damping * power
    for _ in range(1, orders):
        before, power = power, double * power - size * before
        damping = damping * growth
        growth = growth * twice
        total += damping * power
    return total


def _integrated(x: Array, y: Array, phi: Array) -> Array:
    """`_orders` of all orders by an integral over wavenumbers.

    The sum of all w^m is ((1 - |w|^2) / |1 - w|^2 - 1) / 2 in its real part. A node of a Gaussian turns w by a
    multiple of one step: no node takes a sine of its own.
    """
    xp, angle = array_namespace(phi), _column(CENTERS, phi) * phi
    step = _column(np.sqrt(2.0) * STEP * SPREADS, phi) * phi
    real = x * xp.cos(angle) - y * xp.sin(angle)
    imaginary = x * xp.sin(angle) + y * xp.cos(angle)
    turn_c, turn_s = xp.cos(step), xp.sin(step)
    kernel = float(HEIGHTS[0]) / _distance(real, imaginary)
    c, s = turn_c, turn_s
    for height in HEIGHTS[1:].tolist():
        # The nodes on both sides of the center, and the angle of the next ones.
        a, b, d, e = real * c, imaginary * s, imaginary * c, real * s
        kernel += height / _distance(a - b, d + e)
        kernel += height / _distance(a + b, d - e)
        c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
    return 0.5 * ((1.0 - x * x - y * y) * kernel - HEIGHT)


def _distance(real: Array, imaginary: Array) -> Array:
    """|1 - w|^2, 0 only where nothing passes and no order counts: it is 1 there."""
    size = (1.0 - real) ** 2 + imaginary * imaginary
    return array_namespace(size).where(size > 0.0, size, 1.0)


def _product(a: Complex, b: Complex) -> Complex:
    """a b."""
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _squared(a: Complex) -> Array:
    """|a|^2."""
    return a[0] * a[0] + a[1] * a[1]


def _quotient(a: Complex, b: Complex, otherwise: float) -> Complex:
    """a / b, and a real number where b is 0."""
    squared = _squared(b)
    xp, valid = array_namespace(squared), squared > 0.0
    size = xp.where(valid, squared, 1.0)
    real, imaginary = _product(a, (b[0] / size, -b[1] / size))
    return xp.where(valid, real, otherwise), imaginary
