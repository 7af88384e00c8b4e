# SPDX-License-Identifier: Apache-2.0
"""Prints fitted coefficients for `mxeon.models.sampling` and the shaders, and the fits' errors.

    python -m tools.fits.eon_sampling

Two inverse cumulative distributions map a random number to x, which is mu or 1 - mu. Both have the
form x = p + sum(a_k B_k(p)), where p is the power of the random number that makes x(p) analytic.
All B_k are 0 at p = 0 and at p = 1, so both ends are exact. Newton steps, each a linear minimax
fit, minimize the largest relative error of the density.

Only shaders use ROOT. ROOT has the coefficients of a polynomial in m = 1 - cos(theta) for
y = (K(theta) / K(pi / 2))^(2/5), K(theta) = (theta - sin(theta) cos(theta)) / 2 - sin(theta)^3 / 3.
Without the polynomial, shaders would need an arc tangent and a power, and digits would cancel.
"""

from tools.fits.fon_loss import closed_form
from tools.fits.minimax import least_largest, mp, roots

COUNT = 400  # points of a fit
STEPS = 4  # Newton steps; a fifth step changes no printed digit

LOSS_AVG = 6 / (5 * mp.pi) - mp.one / 6  # c1 - c2 of [Portsmouth2025], the average of H
UPPER_TOTAL = mp.pi / 4 - mp.one / 3  # integral over [0, 1] of the numerator of `upper_density`
MULTIPLE_POWERS = (2, 4, 5, 6, 7, 11)
UPPER_POWERS = (0, 1, 2, 3, 4, 5)


def multiple_density(mu):
    """Probability density 2 H(mu) mu / (c1 - c2) of mu in EON's part `multiple`."""
    return 2 * closed_form(mu) * mu / LOSS_AVG


def upper_density(m):
    """Probability density S m / (pi/4 - 1/3) of m = 1 - mu in EON's part `upper` for grazing wo."""
    return mp.sqrt(m * (2 - m)) * m / UPPER_TOTAL


def multiple_basis(t):
    """Values and derivatives of the basis functions t w^k with w = sqrt(1 - t)."""
    w = mp.sqrt(1 - t)
    values = [t * w**k for k in MULTIPLE_POWERS]
    return values, [w**k - k * t * w ** (k - 2) / 2 for k in MULTIPLE_POWERS]


def upper_basis(y):
    """Values and derivatives of the basis functions (1 - y) y^(1 + k)."""
    values = [(1 - y) * y ** (1 + k) for k in UPPER_POWERS]
    return values, [(1 + k) * y**k - (2 + k) * y ** (1 + k) for k in UPPER_POWERS]


def density_error(p, basis, density, root, coefficients):
    """Relative error of the density at x(p), and the gradient with respect to the coefficients."""
    values, slopes = basis(p)
    x, slope = p + mp.fdot(values, coefficients), 1 + mp.fdot(slopes, coefficients)
    step = mp.sqrt(mp.eps)
    exact = density(x)
    growth = (exact - density(x - step)) / step
    scale = root * p ** (root - 1)
    gradient = [
        (b * exact + slope * growth * a) / scale for a, b in zip(values, slopes, strict=True)
    ]
    return slope * exact / scale - 1, gradient


def fitted(points, basis, density, root):
    """Coefficients that minimize the largest error of the density, by Newton steps."""
    coefficients = [mp.zero] * len(basis(points[0])[0])
    for _ in range(STEPS):
        errors = [density_error(p, basis, density, root, coefficients) for p in points]
        change, _ = least_largest([row for _, row in errors], [-error for error, _ in errors])
        coefficients = [a + b for a, b in zip(coefficients, change, strict=True)]
    return coefficients


def root_rows(points):
    """Rows of the linear fit of y by the powers m to m^6, divided by y for relative errors.

    Cancellation in K costs at most 14 of 40 digits.
    """
    rows = []
    for m in points:
        mu, S = 1 - m, mp.sqrt(m * (2 - m))
        K = (mp.acos(mu) - S * mu) / 2 - S**3 / 3
        y = (K / UPPER_TOTAL) ** (mp.one * 2 / 5)
        rows.append([m ** (k + 1) / y for k in range(6)])
    return rows


def dense_near_1(count):
    return [1 - w**2 for w in roots(count)]


# Each row has the name, points, basis, density and root of a fit. The random number is p^root.
ROWS = (
    ("MULTIPLE", dense_near_1, multiple_basis, multiple_density, mp.mpf(3)),
    ("UPPER", roots, upper_basis, upper_density, mp.mpf(5) / 2),
)


def printed(name, coefficients):
    """Print coefficients with ten decimals, and return the rounded numbers."""
    rounded = [round(float(each), 10) for each in coefficients]
    print(f"{name} = ({', '.join(f'{c:.10f}' for c in rounded)})")
    return rounded


if __name__ == "__main__":
    for name, points, *row in ROWS:
        found = printed(name, fitted(points(COUNT), *row))
        largest = max(abs(density_error(p, *row, found)[0]) for p in points(10 * COUNT + 1))
        print(f"largest relative error of the density {float(largest):.3g}")
    found, largest = least_largest(root_rows(roots(COUNT)), [mp.one] * COUNT)
    printed("ROOT", found)
    print(f"largest relative error {float(largest):.3g}")
