# SPDX-License-Identifier: Apache-2.0
"""Fits of F_ss, the cosine-weighted average of a Fresnel reflectance, for the shaders.

Of a dielectric of index n above 1, with t = 1 / n:

    1 - F_ss = t N / D,

polynomials in t. Below 1 it follows from the other side: 1 - F_ss(n) = n^2 (1 - F_ss(1 / n)).
Of a metal, whose curve is 1 at grazing:

    1 - F_ss = sum of w_k (1 - F(c_k)),

with three cosines and the weights whose largest error over metals is least. Schlick's curve needs
no fit.

    python -m tools.fits.fresnel_average
"""

from tools.fits.ggx_albedo import legendre
from tools.fits.minimax import least_largest, mp
from tools.fits.rational import DIGITS

COUNT = 400  # points of the fit for dielectrics
ABOVE, BELOW = 4, 3  # degrees of N and D
STEPS = 12  # of the reweighted fit, after which no printed digit changes

COSINES = (0.22, 0.58, 0.9)
INDICES = tuple(mp.mpf(5) ** (mp.mpf(k) / 6 - 1) / 4 for k in range(0, 12)) + (mp.mpf(5),)
EXTINCTIONS = (0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)
NODES = 24  # of the average over the hemisphere


def dielectric_average(n):
    """F_ss for n > 1: [Walsh1926]."""
    n2 = n * n
    n4 = n2 * n2
    return (
        mp.mpf(1) / 2
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + n2 * (n2 - 1) ** 2 / (n2 + 1) ** 3 * mp.log((n - 1) / (n + 1))
        - 2 * n**3 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1))
        + 8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) ** 2) * mp.log(n)
    )


def reciprocals(count):
    """Points of (0, 1), dense at both ends."""
    return [(1 - mp.cos(mp.pi * (2 * k + 1) / (2 * count))) / 2 for k in range(count)]


def dielectric_fit():
    """Coefficients of N and D but for the constant 1 of D, by linear fits of N - D T over D.

    Each takes D of the one before as weight; where they agree, the largest error is least.
    """
    t = reciprocals(COUNT)
    T = [(1 - dielectric_average(1 / x)) / x for x in t]
    D = [mp.one] * COUNT
    for _ in range(STEPS):
        rows, right = [], []
        for x, goal, divisor in zip(t, T, D, strict=True):
            factor = x / divisor
            above = [factor * x**k for k in range(ABOVE + 1)]
            rows.append(above + [-factor * goal * x**k for k in range(1, BELOW + 1)])
            right.append(factor * goal)
        found, _ = least_largest(rows, right)
        below = found[ABOVE + 1 :]
        D = [1 + mp.fdot(below, [x**k for k in range(1, BELOW + 1)]) for x in t]
    return tuple(float(mp.nstr(x, DIGITS)) for x in found)


def dielectric_error(coefficients):
    """Largest absolute error of F_ss on a finer set of points."""
    worst = mp.zero
    for t in reciprocals(4 * COUNT + 1):
        N = mp.fdot((c, t**k) for k, c in enumerate(coefficients[: ABOVE + 1]))
        D = 1 + mp.fdot((c, t**k) for k, c in enumerate(coefficients[ABOVE + 1 :], 1))
        worst = max(worst, abs(1 - dielectric_average(1 / t) - t * N / D))
    return float(worst)


def conductor(c, n, k):
    """Fresnel reflectance of a conductor, [MaterialX2026], Conductor Fresnel Equations."""
    c2 = c * c
    s2 = 1 - c2
    t0 = n * n - k * k - s2
    ab = mp.sqrt(t0 * t0 + 4 * n * n * k * k)
    t1, t2 = ab + c2, 2 * c * mp.sqrt((ab + t0) / 2)
    t3, t4 = c2 * ab + s2 * s2, t2 * s2
    perpendicular = (t1 - t2) / (t1 + t2)
    return perpendicular * (1 + (t3 - t4) / (t3 + t4)) / 2


def conductor_average(n, k):
    """F_ss of a conductor by Gauss-Legendre; its error is below 1e-6."""
    x, w = legendre(NODES)
    pairs = zip(map(mp.mpf, map(float, x)), map(mp.mpf, map(float, w)), strict=True)
    return sum(2 * weight * c * conductor(c, n, k) for c, weight in pairs)


def conductor_fit():
    """Weights of the cosines, and the largest absolute error over the metals."""
    metals = [(n, mp.mpf(k)) for n in INDICES for k in EXTINCTIONS]
    rows = [[1 - conductor(mp.mpf(c), n, k) for c in COSINES] for n, k in metals]
    weights, error = least_largest(rows, [1 - conductor_average(n, k) for n, k in metals])
    return tuple(float(mp.nstr(w, DIGITS)) for w in weights), float(error)


def main():
    """Print the lines for the shaders and the errors of the fits."""
    coefficients = dielectric_fit()
    names = [f"N{k}" for k in range(ABOVE + 1)] + [f"D{k + 1}" for k in range(BELOW)]
    for name, x in zip(names, coefficients, strict=True):
        print(f"#define FRESNEL_AVG_{name} {x:.{DIGITS}g}")
    print(f"largest absolute error, dielectrics: {dielectric_error(coefficients):.3g}")
    weights, error = conductor_fit()
    for k, (c, w) in enumerate(zip(COSINES, weights, strict=True)):
        print(f"#define FRESNEL_AVG_C{k} {c}\n#define FRESNEL_AVG_W{k} {w:.{DIGITS}g}")
    print(f"largest absolute error, metals: {error:.3g}")


if __name__ == "__main__":
    main()
