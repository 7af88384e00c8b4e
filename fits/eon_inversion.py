# SPDX-License-Identifier: Apache-2.0
"""Fit of the polynomials of `mxeon.inversion` for rho; prints coefficients and errors.

    python fits/eon_inversion.py

The forms are those of [Portsmouth2025], Eqs. (32) and (34), C + a (b - C) C r, in the second with
b = 1. The largest error over colors and roughness in [0, 1] is least: a linear program.
"""

import numpy as np
from scipy.optimize import linprog

from mxeon import inversion

COLORS, ROUGHNESS = np.meshgrid(np.linspace(0.0, 1.0, 401), np.linspace(0.0, 1.0, 101))


def least_largest(columns, right):
    """Coefficients whose combination of the columns comes nearest to `right`, and how near."""
    matrix = np.stack([column.ravel() for column in columns], axis=-1)
    bound = np.ones((len(matrix), 1))
    constraints = np.block([[matrix, -bound], [-matrix, -bound]])
    cost = np.append(np.zeros(len(columns)), 1.0)
    right = right.ravel()
    free = [(None, None)] * len(cost)
    return linprog(cost, constraints, np.append(right, -right), bounds=free).x


def exact(function):
    """What one of the exact inversions adds to the color, on the grid."""
    return function(COLORS[..., np.newaxis], ROUGHNESS)[..., 0] - COLORS


def normal():
    """Coefficients a, b for the albedo at normal incidence, and the largest error."""
    columns = [COLORS * ROUGHNESS, -(COLORS**2) * ROUGHNESS]
    ab, a, error = least_largest(columns, exact(inversion.eon_rho_from_albedo_normal))
    return a, ab / a, error


def average():
    """Coefficient a for the average albedo, and the largest error."""
    column = (1.0 - COLORS) * COLORS * ROUGHNESS
    return least_largest([column], exact(inversion.eon_rho_from_albedo_avg))


def main():
    """Print each fit as it stands in the package."""
    a, b, error = normal()
    print(f"NORMAL_REFIT = ({a:.7f}, {b:.7f})\nlargest error {error:.3g}")
    a, error = average()
    print(f"AVERAGE_REFIT = {a:.7f}\nlargest error {error:.3g}")


if __name__ == "__main__":
    main()
