# SPDX-License-Identifier: Apache-2.0
"""Fits of `mxeon.eon_sampling` and of the shaders; prints coefficients and errors.

    python fits/eon_sampling.py

Two inverse distributions map a random number to a cosine without any parameter. Written x = p + sum(a_k B_k(p)), with p
the root of the random number that makes x analytic in it, they keep both ends whatever the
coefficients are. What counts is the density that results, so that is what the fit makes as nearly
right as it can: the largest relative error of the density is least (linear programs on Newton
steps, which need the exact density but not the exact inverse).

ROOT, of the shaders alone, is the root y of K for a given cosine, y = (K / K(pi / 2))^(2/5), which
is analytic in m = 1 - cos: it takes an arc tangent, a cancellation and a power from them.
"""

import numpy as np
from scipy.optimize import linprog

from mxeon.formulas import C1, C2, loss

# Total of `upper_density` over [0, 1], before it is divided by it.
UPPER_TOTAL = np.pi / 4.0 - 1.0 / 3.0

MULTIPLE_POWERS = (2, 4, 5, 6, 7, 11)
UPPER_POWERS = (0, 1, 2, 3, 4, 5)


def multiple_density(mu):
    """Density of the cosine in the part `multiple`, 2 H(mu) mu / (c1 - c2)."""
    return 2.0 * loss(mu) * mu / (C1 - C2)


def upper_density(m):
    """Density of m = 1 - mu in the part `upper` for wo at the horizon, S m / (pi/4 - 1/3)."""
    return np.sqrt(m * (2.0 - m)) * m / UPPER_TOTAL


def multiple_basis(t):
    """t w^k with w^2 = 1 - t, and the derivatives by t."""
    w = np.sqrt(1.0 - t)[:, np.newaxis]
    t, k = t[:, np.newaxis], np.array(MULTIPLE_POWERS)
    return t * w**k, w**k - 0.5 * k * t * w ** (k - 2)


def upper_basis(y):
    """(1 - y) y^(1 + k), and the derivatives by y."""
    y, k = y[:, np.newaxis], np.array(UPPER_POWERS)
    return (1.0 - y) * y ** (1 + k), (1 + k) * y**k - (2 + k) * y ** (1 + k)


def density_error(p, basis, density, root, coefficients):
    """Relative error of the density of x, at x(p), where the random number is p^root."""
    values, slopes = basis(p)
    x = np.clip(p + values @ coefficients, 0.0, 1.0)
    return (1.0 + slopes @ coefficients) * density(x) / (root * p ** (root - 1.0)) - 1.0


def least_largest(matrix, right):
    """Solution of matrix @ x = right with the least largest residual."""
    bound = np.ones((len(matrix), 1))
    constraints = np.block([[matrix, -bound], [-matrix, -bound]])
    cost = np.append(np.zeros(matrix.shape[1]), 1.0)
    free = [(None, None)] * len(cost)
    return linprog(cost, constraints, np.append(right, -right), bounds=free).x[:-1]


def fitted(p, basis, density, root, steps=8):
    """Coefficients with the least largest error of the density, by Newton steps."""
    coefficients = np.zeros(basis(p)[0].shape[1])
    for _ in range(steps):
        error = density_error(p, basis, density, root, coefficients)
        shifted = coefficients + 1e-7 * np.eye(len(coefficients))
        moved = [density_error(p, basis, density, root, row) for row in shifted]
        matrix = (np.stack(moved, axis=-1) - error[:, np.newaxis]) / 1e-7
        coefficients = coefficients + least_largest(matrix, -error)
    return coefficients


def upper_root(m):
    """y / m at the cosine 1 - m, y = (K / K(pi / 2))^(2/5).

    K is the integral of S m; with m x^2 for m, 2 m^(5/2) times that of x^4 sqrt(2 - m x^2) over
    [0, 1], by a Gauss-Legendre rule: the closed form has no digit left near the normal.
    """
    x, weight = np.polynomial.legendre.leggauss(32)
    x = 0.5 * (1.0 + x)
    return ((x**4 * np.sqrt(2.0 - m * x**2)) @ weight / UPPER_TOTAL) ** 0.4


def root_fit(count=400):
    """Coefficients of y / m in powers of m with the least largest relative error, and that."""
    m = nodes(count)[:, np.newaxis]
    matrix = m ** np.arange(6) / upper_root(m)[:, np.newaxis]
    # The factor brings errors near 1e-7 above the solver's tolerance of 1e-7.
    coefficients = least_largest(1e3 * matrix, np.full(count, 1e3)).round(10)
    return coefficients, np.abs(matrix @ coefficients - 1.0).max()


def nodes(count):
    """Points of (0, 1), dense at both ends."""
    return np.sin(0.5 * np.pi * (np.arange(count) + 0.5) / count) ** 2


ROWS = (
    ("MULTIPLE", lambda n: 1.0 - nodes(n) ** 2, multiple_basis, multiple_density, 3.0),
    ("UPPER", nodes, upper_basis, upper_density, 2.5),
)


def main():
    """Print each fit as it stands in the package, and its error after rounding."""
    for name, points, basis, density, root in ROWS:
        coefficients = fitted(points(400), basis, density, root).round(10)
        error = density_error(points(20001), basis, density, root, coefficients)
        print(f"{name} = ({', '.join(f'{c:.10f}' for c in coefficients)})")
        print(f"largest relative error of the density {np.abs(error).max():.3g}")
    coefficients, error = root_fit()
    print(f"ROOT = ({', '.join(f'{c:.10f}' for c in coefficients)})")
    print(f"largest relative error {error:.3g}")


if __name__ == "__main__":
    main()
