# SPDX-License-Identifier: Apache-2.0
"""The shaders' fit of E_ss, the directional albedo of GGX at unit Fresnel reflectance.

    E_ss(mu, alpha) = 1 - z^2 N / D,  z = sqrt(mu / (mu + alpha)),

where N and D are polynomials in z and alpha. At small alpha, E_ss only depends on mu / alpha, and
hence on z. Near mu = 0, 1 - E_ss vanishes like mu log(mu), so polynomials in z approximate 1 - E_ss
better than polynomials in mu. The fit minimizes the largest absolute error. The quadrature only
uses sums, products, quotients and square roots in float64, because every processor computes the
same results for these operations.

    python -m tools.fits.ggx_albedo
"""

from itertools import pairwise

import numpy as np

from tools.fits.minimax import Form, extrema, mp, printed, refined

FORM = Form(
    above=(
        *((0, 0), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0)),
        *((2, 1), (2, 2), (3, 0), (3, 1), (3, 2)),
    ),
    below=((0, 2), (0, 3), (1, 0), (1, 1), (1, 3), (2, 0), (2, 1), (2, 2), (3, 0)),
)
START = (
    *(0.129206, 8.7067, 1.32179, 0.740364, -16.0591, -3.05397),
    *(-1.49084, 5.82249, 1.60299, 0.74937, 1.79916),
    *(0.225562, -0.0983618, 4.00769, 1.57355, 0.538882, -12.0367, -1.69065, -1.00164, 7.53262),
)
DEGREE, PANELS = 12, 10  # quadrature nodes per panel, and number of panels
NEWTON = 6  # Newton steps that refine an asymptotic root to 40 digits
LEAST = 1e-4  # smallest alpha and cosine of the fit


def legendre(count):
    """Gauss-Legendre nodes and weights on [0, 1], rounded from 40 digits."""

    def slope(x):
        return count * (mp.legendre(count - 1, x) - x * mp.legendre(count, x)) / (1 - x * x)

    nodes, weights = [], []
    for k in range(count):
        x = mp.cos(mp.pi * (k + mp.mpf(3) / 4) / (count + mp.mpf(1) / 2))
        for _ in range(NEWTON):
            x -= mp.legendre(count, x) / slope(x)
        nodes.append(float((1 + x) / 2))
        weights.append(float(1 / ((1 - x * x) * slope(x) ** 2)))
    return np.array(nodes), np.array(weights)


def graded():
    """Quadrature nodes and weights on [0, 1], in panels whose ends are 0 and powers of 1/4."""
    x, w = legendre(DEGREE)
    pairs = list(pairwise([0.0] + [4.0 ** (k - PANELS + 1) for k in range(PANELS)]))
    nodes = np.concatenate([a + (b - a) * x for a, b in pairs])
    return nodes, np.concatenate([(b - a) * w for a, b in pairs])


def incident(mu, alpha):
    """Returns k, `low`, `high` and `pre` for each node of tan((theta_o - theta_i) / 2).

    The node's weight times pi D G2 sin(theta_i) / (4 mu_o) equals pre (u / (u - k))^2, where
    u = |wo + wi|^2. From the azimuth of the mirror direction to the opposite azimuth, u - k rises
    from `low` to `high`. The nodes are the first axis.
    """
    node, weight = (each.reshape(-1, *(1,) * np.ndim(mu)) for each in graded())
    s = np.sqrt((1.0 - mu) * (1.0 + mu))
    ends = s / (1.0 + mu), -mu / (1.0 + s)
    t = np.concatenate([node * end for end in ends])
    step = np.concatenate([weight * np.abs(end) for end in ends])
    secant2, alpha2 = 1.0 + t * t, alpha * alpha
    cos_d, sin_d = (1.0 - t * t) / secant2, 2.0 * t / secant2
    mu_i = np.maximum(mu * cos_d + s * sin_d, 0.0)
    s_i = np.maximum(s * cos_d - mu * sin_d, 0.0)
    M = mu + mu_i
    rest = (1.0 - alpha) * (1.0 + alpha)
    lambdas = [np.sqrt(alpha2 + rest * each * each) for each in (mu, mu_i)]
    smith = lambdas[0] * mu_i + lambdas[1] * mu
    pre = step * 2.0 / secant2 * s_i * mu_i / (2.0 * smith) * alpha2
    return rest * M * M, M * M * (t * t + alpha2), (s + s_i) * (s + s_i) + alpha2 * M * M, pre


def albedo(mu, alpha):
    """E_ss by quadrature, with an error below 1e-7 for mu and alpha above `LEAST`."""
    k, low, high, pre = incident(mu, alpha)
    ratio = k / np.sqrt(low * high)
    azimuth = 1.0 + ratio * (2.0 + ratio * 0.5 * (low + high) / np.sqrt(low * high))
    return np.add.reduce(2.0 * pre * azimuth, axis=0)


def variables(mu, alpha):
    """The variables (z, alpha) and the factor z^2 of the fit."""
    z2 = mu / (mu + alpha)
    return (np.sqrt(z2), alpha), z2


def fitted(mu, alpha, coefficients):
    arguments, z2 = variables(mu, alpha)
    return 1.0 - z2 * FORM.value(arguments, coefficients)


def points(across=61, along=41, root=0.0, least=LEAST):
    """Grid of alpha and x = mu / sqrt(alpha^2 + (1 - alpha^2) mu^2), returned as mu and alpha.

    Points are closely spaced near 0 and 1. A positive `root` moves points towards alpha = 0.
    """
    x, alpha = (np.array(extrema(count), float) for count in (across, along))
    x, alpha = np.meshgrid(np.maximum(x, least), np.maximum(alpha * alpha**root, LEAST))
    mu = x * alpha / np.sqrt((1.0 - x * x) + x * x * alpha * alpha)
    return np.minimum(mu.ravel(), 1.0), alpha.ravel()


def fit():
    """Rounded coefficients of N, then of D."""
    mu, alpha = points()
    arguments, z2 = variables(mu, alpha)
    return refined(FORM, arguments, (1.0 - albedo(mu, alpha)) / z2, z2, START)


def largest_error(coefficients, across=145, along=97):
    """Largest absolute error of E_ss on a finer grid than the grid of the fit."""
    mu, alpha = points(across, along)
    return float(np.max(np.abs(fitted(mu, alpha, coefficients) - albedo(mu, alpha))))


def peak(mu, alpha, count=400):
    """Largest pi f cos of perfectly reflecting facets. The maximum is in the plane of incidence."""
    mu_i = (np.arange(count) + 0.5).reshape(-1, *(1,) * np.ndim(mu)) / count
    s, s_i = (np.sqrt((1.0 - each) * (1.0 + each)) for each in (mu, mu_i))
    alpha2 = alpha * alpha
    h2 = (mu + mu_i) ** 2 / (2.0 + 2.0 * (mu * mu_i - s * s_i))  # squared cosine of the half vector
    lambdas = (np.sqrt(alpha2 + (1.0 - alpha2) * each * each) for each in (mu, mu_i))
    smith = sum(each * other for each, other in zip(lambdas, (mu_i, mu), strict=True))
    return np.max(alpha2 / (1.0 + (alpha2 - 1.0) * h2) ** 2 * mu_i / (2.0 * smith), axis=0)


def value_errors(coefficients, across=145, along=97):
    """Largest error of a compensated value v / E_ss, and largest factor v (1 - E_ss) / E_ss.

    The factor multiplies F_ss. Errors of values above 1 are relative. If v exceeds 1, the factor is
    divided by v.
    """
    mu, alpha = points(across, along)
    E, v = albedo(mu, alpha), peak(mu, alpha)
    relative = np.abs(fitted(mu, alpha, coefficients) - E) / E
    factor = np.minimum(v, 1.0) * (1.0 - E) / E
    return float(np.max(np.minimum(v / E, 1.0) * relative)), float(np.max(factor))


if __name__ == "__main__":
    found = fit()
    print(*printed(found))
    print(f"largest absolute error {largest_error(found):.3g}")
    error, factor = value_errors(found)
    print(f"of a value over itself {error:.3g}, times the error of F_ss {factor:.2g}")
