# SPDX-License-Identifier: Apache-2.0
"""Fit of the polynomials of `tools.paper.claims.inversion` for rho; prints coefficients and errors.

    python -m tools.fits.eon_inversion

The forms are those of [Portsmouth2025], Eqs. (32) and (34), C + a (b - C) C r, with b = 1 in the
second. The fit minimizes the largest error over colors and roughness in [0, 1].
"""

from tools.fits.minimax import least_largest, mp

C1 = mp.one / 2 - 2 / (3 * mp.pi)
C2 = mp.mpf(2) / 3 - 28 / (15 * mp.pi)

# If color or roughness is 0, the polynomials are exact for any coefficients. The one for the average
# albedo is also exact at color 1.
GRID = [(mp.mpf(i) / 200, mp.mpf(j) / 20) for i in range(1, 201) for j in range(1, 21)]


def normal():
    """Coefficients (a, b) for the albedo at normal incidence, and the largest error.

    rho is that of [Portsmouth2025], Eqs. (29) and (30).
    """
    rows, right = [], []
    for color, r in GRID:
        least, mean = 1 / (1 + C1 * r), (1 + C2 * r) / (1 + C1 * r)
        a, b = mean - least, least + color * (1 - mean)
        rows.append([color * r, -(color**2) * r])
        right.append((mp.sqrt(b * b + 4 * a * color) - b) / (2 * a) - color)
    (ab, a), error = least_largest(rows, right)
    return (float(a), float(ab / a)), float(error)


def average():
    """Coefficient a for the average albedo, and the largest error; rho of [Portsmouth2025], Eqs. (29) and (33)."""
    rows, right = [], []
    for color, r in GRID:
        if color < 1:
            mean = (1 + C2 * r) / (1 + C1 * r)
            rows.append([(1 - color) * color * r])
            right.append(color / (color + mean * (1 - color)) - color)
    (a,), error = least_largest(rows, right)
    return float(a), float(error)


if __name__ == "__main__":
    pair, largest = normal()
    print(f"normal: ({pair[0]:.7f}, {pair[1]:.7f})\nlargest error {largest:.3g}")
    one, largest = average()
    print(f"avg: {one:.7f}\nlargest error {largest:.3g}")
