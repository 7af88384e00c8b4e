# SPDX-License-Identifier: Apache-2.0
"""Fit of the polynomials of `mxeon.inversion` for rho; prints coefficients and errors.

    python -m tools.fits.eon_inversion

The forms are those of [Portsmouth2025], Eqs. (32) and (34), C + a (b - C) C r, in the second with
b = 1. The largest error over colors and roughness in [0, 1] is least.
"""

from tools.fits.minimax import least_largest, mp

C1 = mp.one / 2 - 2 / (3 * mp.pi)
C2 = mp.mpf(2) / 3 - 28 / (15 * mp.pi)

# Where color or roughness is 0, the polynomials are exact whatever their coefficients are; so is
# that for the average albedo where the color is 1.
GRID = [(mp.mpf(i) / 200, mp.mpf(j) / 20) for i in range(1, 201) for j in range(1, 21)]
INNER = [(color, r) for color, r in GRID if color < 1]


def rho_normal(color, r):
    """rho for the albedo at normal incidence: [Portsmouth2025], Eqs. (29) and (30)."""
    normal, mean = 1 / (1 + C1 * r), (1 + C2 * r) / (1 + C1 * r)
    a, b = mean - normal, normal + color * (1 - mean)
    return (mp.sqrt(b * b + 4 * a * color) - b) / (2 * a)


def rho_average(color, r):
    """rho for the average albedo: [Portsmouth2025], Eqs. (29) and (33)."""
    return color / (color + (1 + C2 * r) / (1 + C1 * r) * (1 - color))


def normal():
    """Coefficients (a, b) for the albedo at normal incidence, and the largest error."""
    rows = [[color * r, -(color**2) * r] for color, r in GRID]
    (ab, a), error = least_largest(rows, [rho_normal(*point) - point[0] for point in GRID])
    return (float(a), float(ab / a)), float(error)


def average():
    """Coefficient a for the average albedo, and the largest error."""
    rows = [[(1 - color) * color * r] for color, r in INNER]
    (a,), error = least_largest(rows, [rho_average(*point) - point[0] for point in INNER])
    return float(a), float(error)


def main():
    """Print each fit as it stands in the package."""
    (a, b), error = normal()
    print(f"NORMAL_REFIT = ({a:.7f}, {b:.7f})\nlargest error {error:.3g}")
    a, error = average()
    print(f"AVERAGE_REFIT = {a:.7f}\nlargest error {error:.3g}")


if __name__ == "__main__":
    main()
