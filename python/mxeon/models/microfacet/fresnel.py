# SPDX-License-Identifier: Apache-2.0
"""Fresnel reflectances of pbrlib's microfacet nodes, averages of F, and the node artistic_ior.

F_ss, the cosine-weighted average of F over the hemisphere, is twice the integral of F(mu) mu from
mu = 0 to 1. Section names refer to [MaterialX2026].

- `mu` (...): Cosine of the angle between a direction and a microfacet normal, in [0, 1].
- `ior`, `extinction` (..., C): Complex index of refraction per channel, in [0, 1e50]; a number is
  one channel.
- `color0`, `color82`, `color90` (..., C): Reflectance r0 along the normal, multiplier at the angle
  acos(1/7), and reflectance r90 at grazing incidence, per channel, in [0, 1]; a number is one
  channel.
- `exponent` (...): Exponent q of the Schlick curve, in [0, 1e50].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mxeon.models.core import arrays
from mxeon.models.core.arguments import channel_count, checked_all, checked_numbers, checked_vectors
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, hypot, root
from mxeon.models.core.evaluation import evaluate_material, evaluate_number
from mxeon.models.core.quadrature import unit_rule

# Cosine at which Hoffman's correction is largest: [MaterialX2026], Generalized Schlick Equations.
COS_THETA_MAX = 1.0 / 7.0

# An index of refraction n below LEAST_IOR counts as LEAST_IOR in 1 / n, because F_ss is then 1 up
# to rounding. 1 / LEAST_IOR^3 is finite in float64.
LEAST_IOR = 1e-50

# Double-exponential quadrature substitutes c = X / (1 + X), where X = exp(pi sinh(t)). The nodes
# have |t| < 3.2, because weights at larger |t| are below 1e-15.
STEP, STEPS = 0.0625, 51
GROUP = 2**12  # values of the integrand per block

# Number of Gauss-Legendre nodes for a curve without singularities in an ellipse of the complex
# plane. The foci of the ellipse are 0 and 1, and the sum of its half axes is ELLIPSE / 2. The error
# is about ELLIPSE to the power -56, which is 1e-13.
AVERAGE_NODES, ELLIPSE = 28, 1.7


def dielectric(mu: Array, ior: Array) -> Array:
    """F of [MaterialX2026], Dielectric Fresnel Equations, rearranged so that nothing cancels.

    The published form, where c = mu and g^2 = ior^2 + c^2 - 1, is

        F = 1/2 ((g - c) / (g + c))^2 (1 + ((c (g + c) - 1) / (c (g - c) + 1))^2)

    Because (g - c) (g + c) = ior^2 - 1, g - c is computed as (ior^2 - 1) / (g + c). The terms c (g
    + c) - 1 and c (g - c) + 1 are computed as c g - (1 - c^2) and c g + (1 - c^2). If `ior` is 1,
    there is no interface, and F is 0 even at grazing incidence, where the published form is 0 / 0.
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
    return xp.where((g2 > 0.0) | (gap == 0.0), arrays.trimmed(F, 1.0), 1.0)


def conductor(mu: Array, ior: Array, extinction: Array) -> Array:
    """F of [MaterialX2026], Conductor Fresnel Equations, rearranged so that nothing cancels.

    The published form, where c = mu, S2 = 1 - mu^2, n = ior + i extinction and
    w = a + i b = sqrt(n^2 - S2), is

        R_s = (a^2 + b^2 - 2 a c + c^2) / (a^2 + b^2 + 2 a c + c^2)  = |w - c|^2 / |w + c|^2
        R_p / R_s = (c^2 (a^2 + b^2) - 2 a c S2 + S2^2) / (... + 2 a c S2 + ...)
                  = |c w - S2|^2 / |c w + S2|^2

    Because (w - c) (w + c) = n^2 - S2 - c^2 = n^2 - 1, R_s is |n^2 - 1|^2 / |w + c|^4. To compute
    w, let Re = ior^2 - extinction^2 - S2 = a^2 - b^2. The larger of a and b is sqrt((|w^2| + |Re|)
    / 2). The smaller of a and b follows from a b = ior extinction. F is 0 for n = 1 even at grazing
    incidence, and 1 for n = 0 even along the normal.
    """
    xp = array_namespace(mu, ior, extinction)
    S2 = (1.0 - mu) * (1.0 + mu)
    real = (ior - 1.0) * (ior + 1.0) + mu * mu - extinction * extinction
    size = modulus(real, 2.0 * ior * extinction)
    larger = root(0.5 * (size + arrays.magnitude(real)))
    smaller = ior * extinction / xp.where(larger > 0.0, larger, 1.0)
    a, b = xp.where(real >= 0.0, larger, smaller), xp.where(real >= 0.0, smaller, larger)
    gap = hypot(ior - 1.0, extinction) * hypot(ior + 1.0, extinction)  # |n^2 - 1|
    total = (a + mu) ** 2 + b * b
    Rs = arrays.trimmed((gap / xp.where(total > 0.0, total, 1.0)) ** 2, 1.0)
    minus, plus = ((mu * a + sign * S2) ** 2 + (mu * b) ** 2 for sign in (-1.0, 1.0))
    Rp = Rs * xp.where(plus > 0.0, minus / xp.where(plus > 0.0, plus, 1.0), 1.0)
    return arrays.trimmed(0.5 * (Rs + Rp), 1.0)


def modulus(real: Array, imaginary: Array) -> Array:
    """Absolute value of complex numbers.

    If a square overflows, the result comes from `hypot`, which is ten times slower.
    """
    if array_namespace(real, imaginary) is not arrays.NUMPY:
        return hypot(real, imaginary)
    with np.errstate(over="ignore"):
        size: Array = np.sqrt(real * real + imaginary * imaginary)
    return size if np.isfinite(size).all() else np.hypot(real, imaginary)


def schlick(mu: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F_theta of [MaterialX2026], section Generalized Schlick Equations; 0^0 counts as 1."""
    a = _schlick_a(color0, color82, color90, exponent)
    m = 1.0 - mu
    return color0 + (color90 - color0) * arrays.power(m, exponent) - a * mu * m**6


def least_ior(x: Array) -> float:
    """Smallest index of refraction n used as a divisor in the precision of x; 1 / n^3 is finite."""
    return max(LEAST_IOR, float(np.cbrt(arrays.least_normal(x))))


def dielectric_avg(ior: Array) -> Array:
    xp = array_namespace(ior)
    inside = ior < 1.0
    gap = xp.where(inside, (1.0 - ior) / xp.maximum(ior, least_ior(ior)), ior - 1.0)
    F = _external_avg(xp.maximum(gap, 0.0))
    return xp.where(inside, (1.0 - ior) * (1.0 + ior) + ior * ior * F, F)


def conductor_avg(ior: Array, extinction: Array) -> Array:
    """F_ss of a conductor, by `_smooth_avg` if F is smooth in the cosine c, else by `_split_avg`.

    The square root in F is singular at c^2 = 1 - n^2. For weakly absorbing media, this c is close
    to the real axis. For strongly absorbing media, F has a pole near c = 0, at |c| of about 1 /
    |n|.
    """
    # Some libraries do not support assignment to the elements of an array.
    if array_namespace(ior, extinction) is not arrays.NUMPY:
        return _split_avg(ior, extinction)
    ior, extinction = np.broadcast_arrays(ior, extinction)
    smooth = _is_smooth((ior + 1j * extinction) ** 2)
    total = np.empty(smooth.shape)
    for rows, average, size in (
        (smooth, _smooth_avg, GROUP),
        (np.logical_not(smooth), _split_avg, GROUP // 128),
    ):
        n, k = ior[rows], extinction[rows]
        groups = (slice(start, start + size) for start in range(0, len(n), size))
        total[rows] = np.concatenate([np.empty(0), *(average(n[g], k[g]) for g in groups)])
    return np.minimum(total, 1.0)


def _is_smooth(n2: Array) -> Array:
    """Whether F(c) is smooth: no singularity of F lies near the interval [0, 1] of cosines c."""
    # F(c) is singular at sqrt(1 - n^2) and at -1 / sqrt(1 + n^2). Both points may be infinite.
    with np.errstate(divide="ignore", invalid="ignore"):
        points = np.stack([np.sqrt(1.0 - n2), -1.0 / np.sqrt(1.0 + n2)])
    far = np.abs(points) + np.abs(points - 1.0) > 0.5 * (ELLIPSE + 1.0 / ELLIPSE)
    return np.asarray(far.all(axis=0))


def _smooth_avg(ior: Array, extinction: Array) -> Array:
    """F_ss by Gauss-Legendre, for materials (N,) whose F is smooth in the cosine c.

    For these materials, cancellation is negligible, so F is computed in a form that takes a quarter
    of the time of `conductor`. With a and w of `conductor`, x = c^2, m = |w|^2, u = 2 c a and B = x
    m + (1 - x)^2, the form is F = (x + m - u) B / ((x + m + u) (B + u (1 - x)))
    """
    real, squared = (ior - 1.0) * (ior + 1.0) - extinction**2, (2.0 * ior * extinction) ** 2
    total = np.zeros(len(ior))
    for c, weight in zip(*unit_rule(AVERAGE_NODES), strict=True):
        x = c * c
        part = real + x
        m = np.sqrt(part * part + squared)
        u = np.sqrt(2.0) * c * np.sqrt(m + part)
        A, B = m + x, m * x + (1.0 - x) ** 2
        total += (2.0 * c * weight) * ((A - u) * B / ((A + u) * (B + u * (1.0 - x))))
    return total


def _split_avg(ior: Array, extinction: Array) -> Array:
    """F_ss by a double-exponential rule on either side of the critical angle.

    The nodes of this rule are densest at the ends of both intervals, where F is singular. Moving
    the split does not change the integral, so derivatives treat the split as a constant.
    """
    # The cosine of the critical angle is the real part of sqrt(1 - n^2).
    xp = array_namespace(ior, extinction)
    real = extinction * extinction - (ior - 1.0) * (ior + 1.0)
    size = hypot(real, 2.0 * ior * extinction)
    split = arrays.at_most(root(xp.maximum(0.5 * (size + real), 0.0)), 1.0)
    t = STEP * np.arange(-STEPS, STEPS + 1)
    X = np.exp(np.pi * np.sinh(t))
    shape = (-1, *(1,) * split.ndim)
    x = arrays.like((X / (1.0 + X)).reshape(shape), ior)
    weight = arrays.like((STEP * np.pi * np.cosh(t) * X / (1.0 + X) ** 2).reshape(shape), ior)
    total = 0.0 * split
    for low, length in ((0.0, split), (split, 1.0 - split)):
        mu = arrays.at_most(low + length * x, 1.0)
        total = total + length * xp.sum(weight * mu * conductor(mu, ior, extinction), axis=0)
    return arrays.trimmed(2.0 * total, 1.0)


def schlick_avg(color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F_ss of the generalized Schlick curve, by the Beta functions B(2, q + 1) and B(3, 7).

    2 B(2, q + 1) = 2 / ((q + 1) (q + 2)),  2 B(3, 7) = 1 / 126
    """
    a = _schlick_a(color0, color82, color90, exponent)
    return color0 + (color90 - color0) * 2.0 / ((exponent + 1.0) * (exponent + 2.0)) - a / 126.0


def _schlick_a(color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """Coefficient a of [MaterialX2026], section Generalized Schlick Equations."""
    m = 1.0 - COS_THETA_MAX
    return (color0 + (color90 - color0) * m**exponent) * (1.0 - color82) / (COS_THETA_MAX * m**6)


def _external_avg(gap: Array) -> Array:
    """F_ss of a dielectric for n = 1 + gap >= 1.

    The form of F_ss in [Walsh1926] is

        F_ss = 1/2 + (n - 1) (3 n + 1) / (6 (n + 1)^2) + n^2 (n^2 - 1)^2 / (n^2 + 1)^3 log((n - 1) / (n + 1))
               - 2 n^3 (n^2 + 2 n - 1) / ((n^2 + 1) (n^4 - 1)) + 8 n^4 (n^4 + 1) / ((n^2 + 1) (n^4 - 1)^2) log(n)

    If n = e^t, then n^2 + 1 = 2 n cosh t, n^2 - 1 = 2 n sinh t, n^4 - 1 = 2 n^2 sinh 2t,
    n^4 + 1 = 2 n^2 cosh 2t and (n - 1) / (n + 1) = tanh(t/2). So the same terms, in the same order,
    are

        1/2 + tanh(t/2) (3 n + 1) / (6 (n + 1)) + n sinh^2 t log(tanh(t/2)) / (2 cosh^3 t)
        - (n^2 + 2 n - 1) / (2 cosh t sinh 2t) + 2 n t cosh 2t / (cosh t sinh^2 2t)

    The fourth and fifth terms are infinite at t = 0. Because n^2 + 2 n - 1 = 2 n + 2 n sinh t, the
    fourth term is a sum of two parts. The sum of the part with 2 n and the fifth term is
    n (2 t coth 2t - 1) / (cosh t sinh 2t). The part with 2 n sinh t is -n / (2 cosh^2 t). The sum
    of this second part and 1/2 = cosh^2 t / (2 cosh^2 t) is (sinh^2 t - (n - 1)) / (2 cosh^2 t).
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
    """x coth(x) - 1. For x < 1, a continued fraction of positive terms avoids cancellation."""
    xp = array_namespace(x)
    fraction: Array | float = 19.0
    y = xp.minimum(x, 1.0) ** 2
    for odd in range(17, 1, -2):
        fraction = odd + y / fraction
    return xp.where(x < 1.0, y / fraction, x * cosh / xp.where(sinh > 0.0, sinh, 1.0) - 1.0)


@any_array
def fresnel_dielectric(mu: ArrayLike, ior: ArrayLike) -> Array:
    """Fresnel reflectance of a dielectric for unpolarized light.

    - `ior`: Index of refraction relative to the exterior medium, in [0, 1e50].

    With `ior` 0, which disables the Fresnel curve of the node, the result is 1. For `ior` < 1,
    light comes from the denser medium, and F is 1 beyond the critical angle. For `ior` 1, there is
    no interface, and F is 0 even at grazing incidence. Accuracy: the relative error is below
    2.2e-14 for `ior` >= 1. For `ior` < 1, the slope of F is infinite at the critical angle, so
    rounding of an argument can change F by more. [MaterialX2026], sections Dielectric Fresnel
    Equations and dielectric_bsdf.

        >>> fresnel_dielectric([1.0, 0.5, 0.0], 1.5).round(6)
        array([0.04    , 0.089187, 1.      ])
    """
    return evaluate_number(dielectric, {}, checked_all({"mu": mu, "ior": ior}))


@any_array
def fresnel_dielectric_avg(ior: ArrayLike) -> Array:
    """Average Fresnel reflectance F_ss of a dielectric, in closed form, for `ior` in [0, 1e50].

    Accuracy: the relative error is below 2.2e-14. Walsh's result is rewritten as a function of
    log(ior), so that nothing cancels near `ior` 1. For `ior` < 1, F_ss follows from F_ss on the
    other side of the interface, since ior^2 (1 - F_ss(1 / ior)) = 1 - F_ss(ior). [Walsh1926];
    [MaterialX2026], section Energy Compensation.

        >>> fresnel_dielectric_avg([0.0, 1.0, 1.5]).round(6)
        array([1.      , 0.      , 0.091778])
    """
    return evaluate_number(dielectric_avg, {}, checked_all({"ior": ior}))


@any_array
def fresnel_conductor(mu: ArrayLike, ior: ArrayLike, extinction: ArrayLike) -> Array:
    """Fresnel reflectance of a conductor for unpolarized light.

    Result (..., C): in [0, 1]. Without extinction, the result equals `fresnel_dielectric`.
    Accuracy: the absolute error is below 1e-12, except at the critical angle of a dielectric that
    absorbs almost nothing. [MaterialX2026], section Conductor Fresnel Equations.

        >>> fresnel_conductor(0.5, [0.183, 1.373], [3.424, 1.770]).round(6)
        array([0.93869 , 0.412954])
    """
    return _colors(conductor, {"ior": ior, "extinction": extinction}, mu=mu)


@any_array
def fresnel_conductor_avg(ior: ArrayLike, extinction: ArrayLike) -> Array:
    """Average Fresnel reflectance F_ss of a conductor, by quadrature, with an error below 1e-12.

    [MaterialX2026], sections Energy Compensation and Conductor Fresnel Equations.

        >>> fresnel_conductor_avg([0.183, 1.373], [3.424, 1.770]).round(6)
        array([0.942313, 0.411657])
    """
    return _colors(conductor_avg, {"ior": ior, "extinction": extinction})


@any_array
def fresnel_schlick(
    mu: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    exponent: ArrayLike,
) -> Array:
    """Fresnel reflectance by the generalized Schlick curve with Hoffman's dip; at most 1.

        F = r0 + (r90 - r0) (1 - mu)^q - a mu (1 - mu)^6

    As in the specification, F is not clamped. F is negative if `color0` is dark, `color82` is small
    and `color90` is bright; for example, F is -0.127 at mu = 0.26 for the colors 0, 0, 1 and
    exponent 5. With exponent 0, F is r90 even along the normal. [MaterialX2026], section
    Generalized Schlick Equations.

        >>> fresnel_schlick(0.5, [0.9, 0.2], [0.5, 1.0], 1.0, 5.0).round(6)
        array([0.837879, 0.225   ])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    return _colors(schlick, colors, mu=mu, exponent=exponent)


@any_array
def fresnel_schlick_avg(
    color0: ArrayLike, color82: ArrayLike, color90: ArrayLike, exponent: ArrayLike
) -> Array:
    """Average F_ss of the generalized Schlick curve in closed form, not clamped.

        F_ss = r0 + 2 (r90 - r0) / ((q + 1) (q + 2)) - a / 126

    Accuracy: the absolute error is below 2.2e-14. [MaterialX2026], sections Energy Compensation and
    Generalized Schlick Equations.

        >>> fresnel_schlick_avg([0.9, 0.2], [0.5, 1.0], 1.0, 5.0).round(6)
        array([0.838481, 0.238095])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    return _colors(schlick_avg, colors, exponent=exponent)


def _colors(
    formula: Callable[..., Array], colors: dict[str, ArrayLike], **numbers: ArrayLike
) -> Array:
    vectors = checked_vectors(colors)
    return evaluate_material(formula, vectors, checked_all(numbers), channel_count(vectors))


@any_array
def artistic_ior(reflectivity: ArrayLike, edge_color: ArrayLike) -> tuple[Array, Array]:
    """Complex index of refraction n + i k from a reflectance at normal incidence and an edge color.

        n = edge_color n_min + (1 - edge_color) n_max,
        n_min = (1 - r) / (1 + r),  n_max = (1 + sqrt(r)) / (1 - sqrt(r)),
        k^2 = (n_max - n) (n - 1 / n_max)

    - `reflectivity` (...): Reflectance r at normal incidence, per channel, in [0, 1).
    - `edge_color` (...): Weight of n_min, per channel, in [0, 1]. With weight 0, n is largest and
      there is no extinction; with weight 1, n is smallest.

    In the paper, k^2 is (r (n + 1)^2 - (n - 1)^2) / (1 - r), a difference of large numbers. Because
    this difference is 0 for n = n_max and n = 1 / n_max, k^2 is computed as the product above.
    1 - sqrt(r) is computed as (1 - r) / (1 + sqrt(r)). [Gulbrandsen2014]; [MaterialX2026], section
    artistic_ior.

        >>> ior, extinction = artistic_ior(0.944, 0.998)
        >>> round(float(ior), 4), round(float(extinction), 4)
        (0.1676, 3.2568)
    """
    r, g = checked_numbers(reflectivity=reflectivity, edge_color=edge_color)
    n_min, n_max = (1.0 - r) / (1.0 + r), (1.0 + root(r)) ** 2 / (1.0 - r)
    ior = g * n_min + (1.0 - g) * n_max
    square = g * (n_max - n_min) * ((ior - n_min) + (n_min - 1.0 / n_max))
    return ior, root(arrays.at_least_0(square))
