# SPDX-License-Identifier: Apache-2.0
"""Fresnel reflectances and their averages on valid float64 arrays, which broadcast.

Sections are those of [MaterialX2026].
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.edges import at_most, hypot, magnitude, power, root, trimmed
from mxeon.models.core.namespaces import NUMPY, array_namespace, like

# Hoffman's correction is largest here: [MaterialX2026], Generalized Schlick Equations.
COS_THETA_MAX = 1.0 / 7.0

# Indices below count as this one where 1 / n enters: F_ss is 1 to rounding, and n^3 stays finite.
LEAST = 1e-50

# Double-exponential rule: c = X^2 / (X^2 + 1/X^2), X = exp(pi/4 sinh(t)), |t| < 3.2.
# The weights beyond are below 1e-15.
STEP, STEPS = 0.0625, 51
GROUP = 2**12  # values of the integrand at once

# Gauss-Legendre nodes of curves that have no singularity within the ellipse with foci 0 and 1 and this
# sum of half axes, in halves: what is left falls as its power -56, 1e-13.
NODES, ELLIPSE = 28, 1.7


def dielectric(mu: Array, ior: Array) -> Array:
    """F: [MaterialX2026], Dielectric Fresnel Equations, without a cancellation.

    Printed, with c = mu and g^2 = ior^2 + c^2 - 1:

        F = 1/2 ((g - c) / (g + c))^2 (1 + ((c (g + c) - 1) / (c (g - c) + 1))^2)

    (g - c) (g + c) = ior^2 - 1 takes g - c to (ior^2 - 1) / (g + c), and c (g +- c) -+ 1 is
    c g -+ (1 - c^2). Without an interface (ior 1) F is 0 at grazing too, where 0 / 0 stands.
    """
    xp = array_namespace(mu, ior)
    gap = (ior - 1.0) * (ior + 1.0)
    g2 = gap + mu * mu
    g = root(xp.maximum(g2, 0.0))
    total = xp.where(g2 > 0.0, g + mu, 1.0)
    amplitude = gap / total / total
    plus = mu * g + (1.0 - mu) * (1.0 + mu)
    minus = mu * g - (1.0 - mu) * (1.0 + mu)
    ratio = minus / xp.where(plus > 0.0, plus, 1.0)
    F = 0.5 * amplitude**2 * (1.0 + ratio**2)
    return xp.where((g2 > 0.0) | (gap == 0.0), trimmed(F, 1.0), 1.0)


def conductor(mu: Array, ior: Array, extinction: Array) -> Array:
    """F: [MaterialX2026], Conductor Fresnel Equations."""
    return _conductor(mu, ior, extinction, _gap(ior, extinction))


def _gap(ior: Array, extinction: Array) -> Array:
    """|n^2 - 1|, which does not depend on the direction."""
    return hypot(ior - 1.0, extinction) * hypot(ior + 1.0, extinction)


def _conductor(mu: Array, ior: Array, extinction: Array, gap: Array) -> Array:
    """`conductor` from |n^2 - 1|."""
    Rp, Rs = polarized(mu, ior, extinction, gap)
    return trimmed(0.5 * (Rs + Rp), 1.0)


def polarized(mu: Array, ior: Array, extinction: Array, gap: Array) -> tuple[Array, Array]:
    """R_p and R_s: [MaterialX2026], Conductor Fresnel Equations, without a cancellation; gap is |n^2 - 1|.

    Printed, with c = mu, S2 = sin^2, n = ior + i extinction and w = a + i b = sqrt(n^2 - S2):

        R_s = (a^2 + b^2 - 2 a c + c^2) / (a^2 + b^2 + 2 a c + c^2)  = |w - c|^2 / |w + c|^2
        R_p / R_s = (c^2 (a^2 + b^2) - 2 a c S2 + S2^2) / (... + 2 a c S2 + ...)
                  = |c w - S2|^2 / |c w + S2|^2

    (w - c) (w + c) = n^2 - S2 - c^2 = n^2 - 1, so that R_s = |n^2 - 1|^2 / |w + c|^4. The root: with
    Re = ior^2 - extinction^2 - S2 = a^2 - b^2, the larger of a and b is sqrt((|w^2| + |Re|) / 2), and
    a b = ior extinction gives the smaller. No interface (n = 1) reflects nothing, at grazing too; n = 0
    reflects all, along the normal too.
    """
    xp = array_namespace(mu, ior, extinction)
    S2 = (1.0 - mu) * (1.0 + mu)
    real = (ior - 1.0) * (ior + 1.0) + mu * mu - extinction * extinction
    size = modulus(real, 2.0 * ior * extinction)
    larger = root(0.5 * (size + magnitude(real)))
    smaller = ior * extinction / xp.where(larger > 0.0, larger, 1.0)
    a, b = xp.where(real >= 0.0, larger, smaller), xp.where(real >= 0.0, smaller, larger)
    total = (a + mu) ** 2 + b * b
    Rs = trimmed((gap / xp.where(total > 0.0, total, 1.0)) ** 2, 1.0)
    minus, plus = ((mu * a + sign * S2) ** 2 + (mu * b) ** 2 for sign in (-1.0, 1.0))
    Rp = Rs * xp.where(plus > 0.0, minus / xp.where(plus > 0.0, plus, 1.0), 1.0)
    return Rp, Rs


def modulus(real: Array, imaginary: Array) -> Array:
    """Length of complex numbers: `hypot` where a square overflows, which takes ten times as long."""
    if array_namespace(real, imaginary) is not NUMPY:
        return hypot(real, imaginary)
    with np.errstate(over="ignore"):
        size: Array = np.sqrt(real * real + imaginary * imaginary)
    return size if np.isfinite(size).all() else np.hypot(real, imaginary)


def schlick(mu: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F_theta: [MaterialX2026], Generalized Schlick Equations; 0^0 counts as 1."""
    a = _schlick_a(color0, color82, color90, exponent)
    m = 1.0 - mu
    return color0 + (color90 - color0) * power(m, exponent) - a * mu * m**6


def dielectric_avg(ior: Array) -> Array:
    """F_ss of a dielectric: closed form for ior >= 1, and by reciprocity below.

    [Walsh1926] with n = e^t: every difference of large terms is taken out, and so is 1 - e^t.
    ior^2 (1 - F_ss(1 / ior)) = 1 - F_ss(ior) for the same interface from its other side.
    """
    xp = array_namespace(ior)
    inside = ior < 1.0
    gap = xp.where(inside, (1.0 - ior) / xp.maximum(ior, LEAST), ior - 1.0)
    F = _external_avg(xp.maximum(gap, 0.0))
    return xp.where(inside, (1.0 - ior) * (1.0 + ior) + ior * ior * F, F)


def conductor_avg(ior: Array, extinction: Array) -> Array:
    """F_ss of a conductor, by a rule of Gauss where F is smooth in the cosine c, and one that is split.

    F has square roots at c^2 = 1 - n^2, next to the real axis for weakly absorbing media, and, for
    strong ones, a pole as near to grazing as 1 / |n|.
    """
    # Take the split rule for all arrays that cannot be written into.
    if array_namespace(ior, extinction) is not NUMPY:
        return _split_avg_of_arrays(ior, extinction)
    ior, extinction = np.broadcast_arrays(ior, extinction)
    n2 = (ior + 1j * extinction) ** 2
    smooth = _is_smooth(n2)
    total = np.empty(smooth.shape)
    n, k = ior[smooth], extinction[smooth]
    groups = (slice(start, start + GROUP) for start in range(0, len(n), GROUP))
    total[smooth] = np.concatenate([np.empty(0), *(_smooth_avg(n[g], k[g]) for g in groups)])
    rest = np.logical_not(smooth)
    total[rest] = _split_avg(ior[rest], extinction[rest], n2[rest])
    return np.minimum(total, 1.0)


def _is_smooth(n2: Array) -> Array:
    """Whether the singularities of F in c, at sqrt(1 - n^2) and -1 / sqrt(1 + n^2), are far from [0, 1]."""
    far = np.full(n2.shape, True)
    with np.errstate(divide="ignore", invalid="ignore"):  # n^2 = -1 has its pole at infinity
        pole = -1.0 / np.sqrt(1.0 + n2)
    for c in (np.sqrt(1.0 - n2), pole):
        far &= np.abs(c) + np.abs(c - 1.0) > 0.5 * (ELLIPSE + 1.0 / ELLIPSE)
    return far


def _smooth_avg(ior: Array, extinction: Array) -> Array:
    """F_ss of materials (N,) whose F is smooth in the cosine.

    With x = c^2, m = |w|^2 and u = 2 c a of `polarized`, B = x m + (1 - x)^2:
    F = (x + m - u) B / ((x + m + u) (B + u (1 - x)))
    """
    real, squared = (ior - 1.0) * (ior + 1.0) - extinction**2, (2.0 * ior * extinction) ** 2
    total = np.zeros(len(ior))
    for c, weight in zip(*_gauss(), strict=True):
        x = c * c
        part = real + x
        m = np.sqrt(part * part + squared)
        u = np.sqrt(2.0) * c * np.sqrt(m + part)
        A, B = m + x, m * x + (1.0 - x) ** 2
        total += (2.0 * c * weight) * ((A - u) * B / ((A + u) * (B + u * (1.0 - x))))
    return total


@lru_cache(maxsize=1)
def _gauss() -> tuple[Array, Array]:
    """Nodes and weights of Gauss-Legendre on [0, 1]."""
    x, weight = np.polynomial.legendre.leggauss(NODES)
    return 0.5 + 0.5 * x, 0.5 * weight


def _split_avg(ior: Array, extinction: Array, n2: Array) -> Array:
    """F_ss of materials (N,), by a double-exponential rule on either side of the critical angle.

    The nodes crowd at the ends of both parts, where the singularities are.
    """
    split = np.clip(np.sqrt(1.0 - n2).real, 0.0, 1.0)
    total = np.zeros(split.shape)
    terms = ior, extinction, _gap(ior, extinction)
    for low, length in ((np.zeros(split.shape), split), (split, 1.0 - split)):
        rows = length > 0.0
        total[rows] += _part(low[rows], length[rows], *(array[rows] for array in terms))
    return 2.0 * total


def _split_avg_of_arrays(ior: Array, extinction: Array) -> Array:
    """`_split_avg` for arrays of another library, all nodes at once.

    The critical angle counts as a constant of the integral, which does not depend on where it is split.
    """
    # Find the critical angle, the real part of sqrt(1 - n^2).
    xp = array_namespace(ior, extinction)
    real = extinction * extinction - (ior - 1.0) * (ior + 1.0)
    size = hypot(real, 2.0 * ior * extinction)
    split = at_most(root(xp.maximum(0.5 * (size + real), 0.0)), 1.0)
    t = STEP * np.arange(-STEPS, STEPS + 1)
    X = np.exp(np.pi * np.sinh(t))
    shape = (-1, *(1,) * split.ndim)
    x = like((X / (1.0 + X)).reshape(shape), ior)
    weight = like((STEP * np.pi * np.cosh(t) * X / (1.0 + X) ** 2).reshape(shape), ior)
    gap = _gap(ior, extinction)
    total = 0.0 * split
    for low, length in ((0.0, split), (split, 1.0 - split)):
        mu = at_most(low + length * x, 1.0)
        total = total + length * xp.sum(weight * mu * _conductor(mu, ior, extinction, gap), axis=0)
    return trimmed(2.0 * total, 1.0)


def _part(low: Array, length: Array, ior: Array, extinction: Array, gap: Array) -> Array:
    """Integral of c F over [low, low + length] of the cosine c, of materials (N,)."""
    total = np.zeros(len(low))
    t = STEP * np.arange(-STEPS, STEPS + 1)
    X = np.exp(np.pi * np.sinh(t))
    rule = X / (1.0 + X), STEP * np.pi * np.cosh(t) * X / (1.0 + X) ** 2
    count = max(1, GROUP // max(len(low), 1))  # nodes at once
    for start in range(0, len(t), count):
        x, weight = (values[start : start + count, np.newaxis] for values in rule)
        mu = low + length * x
        part = weight * length * mu * _conductor(mu, ior, extinction, gap)
        total += np.sum(part, axis=0)
    return total


def schlick_avg(color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F_ss of the generalized Schlick curve: two Beta functions, B(2, q + 1) and B(3, 7).

    2 B(2, q + 1) = 2 / ((q + 1) (q + 2)),  2 B(3, 7) = 1 / 126
    """
    a = _schlick_a(color0, color82, color90, exponent)
    return color0 + (color90 - color0) * 2.0 / ((exponent + 1.0) * (exponent + 2.0)) - a / 126.0


def _schlick_a(color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """a: [MaterialX2026], Generalized Schlick Equations."""
    m = 1.0 - COS_THETA_MAX
    return (color0 + (color90 - color0) * m**exponent) * (1.0 - color82) / (COS_THETA_MAX * m**6)


def _external_avg(gap: Array) -> Array:
    """F_ss for n = 1 + gap >= 1.

    F_ss = (sinh^2 t - (n - 1)) / (2 cosh^2 t) + tanh(t/2) (3 n + 1) / (6 (n + 1))
           + n sinh^2 t log(tanh(t/2)) / (2 cosh^3 t) + n (2 t coth(2 t) - 1) / (cosh t sinh 2 t)
    """
    xp = array_namespace(gap)
    n = 1.0 + gap
    t = xp.log1p(gap)
    sinh, cosh = 0.5 * gap * (n + 1.0) / n, 0.5 * (n + 1.0 / n)
    half = gap / (n + 1.0)
    double = 2.0 * sinh * cosh
    log = xp.log(xp.where(gap > 0.0, half, 1.0))
    excess = _x_coth_x_minus_1(2.0 * t, double, cosh * cosh + sinh * sinh)
    return (
        0.5 * (sinh * sinh - gap) / cosh**2
        + half * (3.0 * n + 1.0) / (6.0 * (n + 1.0))
        + 0.5 * n * sinh * sinh * log / cosh**3
        + n * excess / xp.where(gap > 0.0, cosh * double, 1.0)
    )


def _x_coth_x_minus_1(x: Array, sinh: Array, cosh: Array) -> Array:
    """x coth(x) - 1, below 1 by its continued fraction of positive terms."""
    xp = array_namespace(x)
    fraction: Array | float = 19.0
    y = xp.minimum(x, 1.0) ** 2
    for odd in range(17, 1, -2):
        fraction = odd + y / fraction
    return xp.where(x < 1.0, y / fraction, x * cosh / xp.where(sinh > 0.0, sinh, 1.0) - 1.0)
