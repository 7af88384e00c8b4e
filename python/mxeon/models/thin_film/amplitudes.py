# SPDX-License-Identifier: Apache-2.0
"""The Airy sum of `formulas` by complex amplitudes, for arrays of libraries that differentiate.

The root of a reflectance and its phase have no derivatives where the reflectance is 0: for a film of
index 1, at Brewster's angle, over a substrate of its own index. An amplitude is smooth there. That of
the first interface is real, since the film is at least as dense as the vacuum.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from mxeon.models.core.arrays import Array, Numbers
from mxeon.models.core.edges import at_least_0, hypot, magnitude, root
from mxeon.models.core.namespaces import array_namespace, like
from mxeon.models.thin_film.formulas import (
    DAMPED_ORDERS,
    GAUSSIANS,
    HEIGHT,
    HEIGHTS,
    NORMAL,
    SAME,
    STEP,
    THIN_SPREAD,
    index_of,
    refracted,
)

Complex: TypeAlias = tuple[Array, Array]  # real and imaginary part

# Centers and standard deviations of the Gaussians, their weights in XYZ, and the nodes of each.
CENTERS = tuple(mu for _, _, mu, _ in GAUSSIANS)
SPREADS = tuple(float(np.sqrt(variance)) for *_, variance in GAUSSIANS)
AREAS = [v * np.sqrt(2.0 * np.pi * variance) / NORMAL for _, v, _, variance in GAUSSIANS]
WEIGHTS = np.eye(3)[:, [row for row, *_ in GAUSSIANS]] * AREAS
NODES = STEP * np.arange(1 - len(HEIGHTS), len(HEIGHTS))
NODE_HEIGHTS: Array = np.concatenate([HEIGHTS[:0:-1], HEIGHTS])


class Amplitudes(NamedTuple):
    """Amplitudes of both interfaces of one polarization, seen from the film, and R23."""

    first: Array
    second: Complex
    reflectance: Array

    def tristimulus(self, opd: Array, orders: int | None = None) -> Array:
        """`formulas.tristimulus` of this interface, shape (3, ...)."""
        xp = array_namespace(self.first)
        values = self.first, *self.second, self.reflectance, 2.0 * np.pi * opd
        shape = np.broadcast_shapes(*(tuple(each.shape) for each in values))
        first, real, imaginary, R23, phi = (xp.broadcast_to(each, shape) for each in values)
        R12 = first * first
        passed, lost = 1.0 - R12, 1.0 - R12 * R23  # nothing is lost only where nothing passes
        dc = R12 + passed**2 * R23 / xp.where(lost > 0.0, lost, 1.0)
        z = first * real, first * imaginary
        sums = _orders(z, phi, orders or DAMPED_ORDERS)
        if orders is None:
            sums = xp.where(phi * min(SPREADS) >= THIN_SPREAD, sums, _integrated(z, phi))
        series = xp.tensordot(like(WEIGHTS, sums), sums, axes=1)
        return dc + 2.0 * (dc - R12 - passed) * series


def over_index(
    mu: Array, film_ior: Array, ior: Array, extinction: Array
) -> tuple[Amplitudes, Amplitudes]:
    """Film over a dielectric or a conductor, for both polarizations, p before s.

    With c = film_ior cos theta_t and W^2 = n^2 - sin^2 theta, n = ior + i extinction, the second amplitude
    is (n^2 - film_ior^2) / (W + c)^2 of s, times (c W - sin^2 theta) / (c W + sin^2 theta) of p.
    """
    xp = array_namespace(mu, film_ior, ior, extinction)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    # Find W = U + iV, whose smaller part does not cancel.
    Q, A = ior * extinction, (ior - extinction) * (ior + extinction) - S2
    larger = root(0.5 * (hypot(A, 2.0 * Q) + magnitude(A)))
    smaller = Q / xp.where(larger > 0.0, larger, 1.0)
    U, V = xp.where(A >= 0.0, larger, smaller), xp.where(A >= 0.0, smaller, larger)
    gap = (ior - film_ior) * (ior + film_ior) - extinction * extinction, 2.0 * Q
    s = _quotient(gap, ((U + c) ** 2 - V * V, 2.0 * (U + c) * V), 0.0)
    p = _product(s, _quotient((c * U - S2, c * V), (c * U + S2, c * V), 1.0))
    first_p, first_s = first_amplitudes(mu, film_ior)
    return Amplitudes(first_p, p, _squared(p)), Amplitudes(first_s, s, _squared(s))


def over_schlick(
    mu: Array, film_ior: Array, F: Array, color0: Array
) -> tuple[Amplitudes, Amplitudes]:
    """Film over a Schlick substrate whose curve is F at cos theta_t, for both polarizations."""
    xp = array_namespace(mu, film_ior, F)
    F = at_least_0(F)
    second = xp.where(index_of(color0) < film_ior * (1.0 - SAME), -1.0, 1.0) * root(F)
    both = first_amplitudes(mu, film_ior)
    p, s = (Amplitudes(first, (second, 0.0 * second), F) for first in both)
    return p, s


def first_amplitudes(mu: Array, film_ior: Array) -> tuple[Array, Array]:
    """Amplitudes of the first interface, of both polarizations."""
    xp = array_namespace(mu, film_ior)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    total = xp.where(c + mu > 0.0, c + mu, 1.0)
    s = -(film_ior - 1.0) * (film_ior + 1.0) / (total * total)
    return s * (mu * c - S2) / (mu * c + S2), s


def _orders(z: Complex, phi: Array, orders: int) -> Array:
    """Sum of z^m S(m phi) for m from 1 to `orders`, of each Gaussian, shape (4, ...).

    S(phi) is exp(i mu phi - sigma^2 phi^2), of which the real part counts.
    """
    xp = array_namespace(phi)
    powers: Complex = xp.stack([z[0]]), xp.stack([z[1]])
    while len(powers[0]) < orders:
        later = _product(powers, (powers[0][-1:, ...], powers[1][-1:, ...]))
        powers = xp.concat([powers[0], later[0]]), xp.concat([powers[1], later[1]])
    real, imaginary = (each[:orders, ...] for each in powers)
    phases, sums = _column(np.arange(1.0, orders + 1.0), phi) * phi, []
    for center, spread in zip(CENTERS, SPREADS, strict=True):
        angle, damping = center * phases, xp.exp(-((spread * phases) ** 2))
        sums.append(xp.sum(damping * (real * xp.cos(angle) - imaginary * xp.sin(angle)), axis=0))
    return xp.stack(sums)


def _integrated(z: Complex, phi: Array) -> Array:
    """The sum of all orders by an integral over wavenumbers, of each Gaussian, shape (4, ...).

    The sum of all z^m e^(i m x) is ((1 - |z|^2) / |1 - z e^(ix)|^2 - 1) / 2 in its real part.
    """
    xp, (real, imaginary) = array_namespace(phi), z
    steps, heights, sums = _column(NODES, phi), _column(NODE_HEIGHTS, phi), []
    kept = 1.0 - _squared(z)
    for center, spread in zip(CENTERS, SPREADS, strict=True):
        x = (center + np.sqrt(2.0) * spread * steps) * phi
        cosine, sine = xp.cos(x), xp.sin(x)
        size = (1.0 - real * cosine + imaginary * sine) ** 2
        size = size + (real * sine + imaginary * cosine) ** 2  # 0 only where nothing passes
        kernel = xp.sum(heights / xp.where(size > 0.0, size, 1.0), axis=0)
        sums.append(0.5 * (kept * kernel - HEIGHT))
    return xp.stack(sums)


def _column(values: Numbers, array: Array) -> Array:
    """Numbers of NumPy along a first axis before those of an array, in its library."""
    return like(values.reshape(-1, *(1,) * array.ndim), array)


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
