# SPDX-License-Identifier: Apache-2.0
"""Fits of the cosine at which a Fresnel curve equals its average over the visible facets of GGX.

The directional albedo of GGX with a Fresnel reflectance F is E_ss F(c) for some cosine c, which
depends on mu, on alpha, and slightly on the curve. The fit has the exact limit c = mu at alpha = 0:

    c = mu + alpha^2 / (mu + alpha) N / D,

where N and D are polynomials in x = mu / (mu + alpha), in a root y of alpha, and in a number s that
identifies the Fresnel curve. The coefficients minimize the largest error of the albedo E_ss F(c).
Among Schlick's curves (1 - c)^q, exponent 5 has twice the weight of other exponents.

Hoffman's dip c (1 - c)^6 is not monotone, so the average of the dip is fitted instead of a cosine.
If c is the cosine for Schlick's curve of exponent 5, the fitted average is
c (1 - c)^6 + alpha^2 / (mu + alpha) N / D, where N and D are polynomials in mu and sqrt(alpha).

The quadrature only uses sums, products, quotients and square roots, as in `ggx_albedo.py`.

    python -m tools.fits.ggx_cosine
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from tools.fits import ggx_albedo
from tools.fits.ggx_albedo import LEAST, incident, legendre
from tools.fits.minimax import Form, mp, numerator, printed

BLOCK = 20
BISECTIONS = 50
FLAT = 0.01  # lower limit of a curve's slope in the weights
DEGREE, OUTER = 8, 12  # number of quadrature nodes in each panel and outside the panels


def dielectric(c, ior):
    """Fresnel reflectance of a dielectric with an IOR above 1."""
    g = np.sqrt(ior * ior - 1.0 + c * c)
    s, p = (c - g) / (c + g), (ior * ior * c - g) / (ior * ior * c + g)
    return 0.5 * (s * s + p * p)


def schlick(c, exponent):
    m, power = 1.0 - c, 1.0
    for _ in range(exponent):
        power = power * m
    return power


def dip(c):
    return c * schlick(c, 6)


@dataclass(frozen=True)
class Curves:
    """A family of Fresnel curves, and the fit of the cosine c for the family."""

    function: str  # name of the shader function that computes c
    reflectance: Callable
    parameters: tuple
    shapes: tuple  # number s that identifies each curve in the fit
    counts: tuple  # weight of each curve in the fit
    roots: int  # the fit's variable y is alpha to the power 2^-roots
    form: Form
    below: tuple  # coefficients of the denominator, found by a search

    @property
    def functions(self):
        return [lambda c, n=n: self.reflectance(c, n) for n in self.parameters]


def below(total, count):
    """Exponents of all monomials in `count` variables up to the degree `total`."""
    return tuple(m for m in product(range(total + 1), repeat=count) if sum(m) <= total)


FORM = Form(above=below(3, 3), below=tuple(sorted((*below(2, 3)[1:], (1, 2, 0), (2, 1, 0)))))
IORS = (1.03, 1.05, 1.08, 1.12, 1.2, 1.3, 1.45, 1.7, 2.0, 2.5, 3.0)
EXPONENTS = (1, 2, 3, 4, 5, 6, 8, 10)

DIELECTRIC = Curves(
    function="ggx_cosine_dielectric",
    reflectance=dielectric,
    parameters=IORS,
    shapes=tuple(float(mp.sqrt((mp.mpf(n) - 1) / (mp.mpf(n) + 1))) for n in IORS),
    counts=tuple(1.0 if 1.05 <= n <= 2.5 else 0.5 for n in IORS),
    roots=2,
    form=FORM,
    below=(
        *(57.90553, -67.41115, 181.8611, -7.478896, -50.38694, 3.325208),
        *(0.0942464, -261.2011, -6.590822, -4.144666, 107.1744),
    ),
)
SCHLICK = Curves(
    function="ggx_cosine_schlick",
    reflectance=schlick,
    parameters=EXPONENTS,
    shapes=tuple(4.0 / (3.0 + q) for q in EXPONENTS),
    counts=tuple(1.0 if q == 5 else 0.5 for q in EXPONENTS),
    roots=1,
    form=FORM,
    below=(
        *(5.765519, -1.515595, 42.67342, -0.008712644, -2.671278, -2.909114),
        *(-3.69908, -69.11994, -6.01911, 1.541857, 28.88318),
    ),
)
DIP_FORM = Form(above=below(4, 2), below=below(3, 2)[1:])
DIP_BELOW = (
    *(-0.6779946, 31.30452, -13.03859, 40.59569, -261.7102),
    *(996.3608, 110.6571, -565.9562, 358.4267),
)


def points(across=43, along=25):
    return ggx_albedo.points(across, along, 0.5, 2 * LEAST)


def averages(mu, alpha, functions):
    """E_ss, and the average of each function of the cosine over the visible facets."""
    blocks = [
        integrals(mu[i : i + BLOCK], alpha[i : i + BLOCK], functions)
        for i in range(0, len(mu), BLOCK)
    ]
    total = np.concatenate(blocks, axis=1)
    return total[0], total[1:] / total[0]


def azimuths(scale):
    """Quadrature nodes and weights on [0, 1], which is divided into panels at scale^(k / 8).

    In all panels after the first, the values 1 / x of the nodes are Gauss nodes, because integrands
    have a peak with a long tail at x = 0.
    """
    x, w = (each[None, :, None] for each in legendre(DEGREE))
    root = np.sqrt(np.sqrt(np.sqrt(scale)))
    ends = [np.ones_like(scale)]
    for _ in range(8):
        ends.append(ends[-1] * root)
    nodes, weights = [ends[8] * x], [ends[8] * w]
    for b, a in pairwise(ends):
        divisor = b - (b - a) * x
        nodes.append(a * b / divisor)
        weights.append(a * b * (b - a) / (divisor * divisor) * w)
    return np.concatenate(nodes, axis=1), np.concatenate(weights, axis=1)


def integrals(mu, alpha, functions):
    """E_ss, and the integral of each function of the cosine over the visible facets."""
    k, low, high, pre = (each[:, None] for each in incident(mu, alpha))
    tangent, width = azimuths(np.sqrt(low / high))
    shape = (len(low), OUTER, low.shape[-1])
    cotangent, rest = (np.broadcast_to(each[None, :, None], shape) for each in legendre(OUTER))
    # `sine2` is the squared sine of half the azimuth relative to the mirror direction.
    near, far = 1.0 + tangent * tangent, 1.0 + cotangent * cotangent
    sine2 = np.concatenate([tangent * tangent / near, 1.0 / far], axis=1)
    step = np.concatenate([width / near, rest / far], axis=1) * (4.0 / np.pi)
    w = low * (1.0 - sine2) + high * sine2
    density = step * pre * (1.0 + k / w) * (1.0 + k / w)
    c = np.minimum(0.5 * np.sqrt(w + k), 1.0)
    values = [density] + [density * function(c) for function in functions]
    return np.stack([np.add.reduce(np.add.reduce(each, axis=1), axis=0) for each in values])


def inverse(values, reflectance):
    low, high = np.zeros_like(values), np.ones_like(values)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        above = reflectance(middle) > values
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return 0.5 * (low + high)


def variables(curves, mu, alpha, shape):
    """The variables (x, y, s) and the factor alpha^2 / (mu + alpha) of the fit."""
    y = alpha
    for _ in range(curves.roots):
        y = np.sqrt(y)
    return (mu / (mu + alpha), y, shape + 0.0 * mu), alpha * alpha / (mu + alpha)


def cosine(curves, mu, alpha, shape, coefficients):
    arguments, factor = variables(curves, mu, alpha, shape)
    return mu + factor * curves.form.value(arguments, coefficients)


def sample(curves, mu, alpha):
    """Variables, values and weights of the fit of c. Each point uses every third curve.

    More curves would make the minimax fit singular, because N is a cubic in s at fixed x and y.
    """
    functions = curves.functions
    albedo, means = averages(mu, alpha, functions)
    columns, rows = [], zip(functions, curves.shapes, curves.counts, strict=True)
    for j, (function, shape, count) in enumerate(rows):
        selected = (np.arange(len(mu)) + j) % 3 == 0
        c = inverse(means[j][selected], function)
        low, high = np.maximum(c - 1e-5, 0.0), np.minimum(c + 1e-5, 1.0)
        slope = (function(low) - function(high)) / (high - low)
        arguments, factor = variables(curves, mu[selected], alpha[selected], shape)
        # Without a minimum weight, the fit would ignore flat parts of a curve, so that the fitted c
        # could drift from a flat part to a steep part.
        weight = np.maximum(count * slope, FLAT) * albedo[selected] * factor
        columns.append((*arguments, (c - mu[selected]) / factor, weight))
    *arguments, value, weight = (np.concatenate(each) for each in zip(*columns, strict=True))
    return arguments, value, weight


def fit(curves):
    """Rounded coefficients of N, then of D."""
    return numerator(curves.form, *sample(curves, *points()), curves.below)


def errors(curves, coefficients, mu, alpha):
    """Largest absolute error of the albedo E_ss F(c) for each curve."""
    functions = curves.functions
    albedo, means = averages(mu, alpha, functions)
    found = []
    for function, mean, shape in zip(functions, means, curves.shapes, strict=True):
        c = cosine(curves, mu, alpha, shape, coefficients)
        found.append(float(np.max(albedo * np.abs(function(c) - mean))))
    return found


def dip_sample(mu, alpha, schlick_coefficients):
    """Variables, values and weights of the fit of the dip's average.

    The weights omit E_ss, because energy compensation divides the albedo by E_ss.
    """
    _, (mean,) = averages(mu, alpha, [dip])
    c = cosine(SCHLICK, mu, alpha, 0.5, schlick_coefficients)
    factor = alpha * alpha / (mu + alpha)
    return (mu, np.sqrt(alpha)), (mean - dip(c)) / factor, factor


if __name__ == "__main__":
    for curves in (DIELECTRIC, SCHLICK):
        found = fit(curves)
        print(curves.function, *printed(found))
        largest = errors(curves, found, *points(49, 33))
        for n, error in zip(curves.parameters, largest, strict=True):
            print(f"largest absolute error at {n}: {error:.3g}")
    # The fit of the dip needs the coefficients for Schlick's curves, so it comes last.
    dip_found = numerator(DIP_FORM, *dip_sample(*points(41, 29), found), DIP_BELOW)
    print("ggx_dip", *printed(dip_found))
    arguments, value, weight = dip_sample(*points(49, 33), found)
    error = np.max(weight * np.abs(DIP_FORM.value(arguments, dip_found) - value))
    print(f"largest absolute error, for a dip to 0: {error / dip(1.0 / 7.0):.3g}")
