# SPDX-License-Identifier: Apache-2.0
"""Fits atan(t) / t by a polynomial in t^2.

    python -m tools.fits.arc_tangent

The shaders' `oren_nayar_angle` uses the coefficients on [0, tan(pi / 8)] in float32.

The polynomial equals atan(t) / t at the roots of a Chebyshev polynomial in t^2. The coefficients
are computed with 40 digits. The singularity of atan(t) / t closest to the interval is at t^2 = -1,
so each additional term reduces the error by a factor of 25.
"""

from tools.fits.minimax import mp, roots

TWINS = {"terms": 5, "top": mp.sqrt(2) - 1}
DIGITS = 17  # enough to distinguish any two float64 numbers


def coefficients(terms, top):
    """Coefficients for t in [0, top], lowest power first, as float64."""
    squares = [top**2 * x for x in roots(terms)]
    powers = mp.matrix([[z**k for k in range(terms)] for z in squares])
    values = mp.matrix([mp.atan(mp.sqrt(z)) / mp.sqrt(z) for z in squares])
    return [float(each) for each in mp.lu_solve(powers, values)]


def largest_error(series, top, count=2000):
    """Largest relative error of the polynomial in 40 digits, without rounding in float32."""
    points = [top * k / count for k in range(1, count + 1)]
    sums = [mp.fsum(each * t ** (2 * k) for k, each in enumerate(series)) for t in points]
    values = [each * t / mp.atan(t) for each, t in zip(sums, points, strict=True)]
    return float(max(abs(value - 1) for value in values))


if __name__ == "__main__":
    found = coefficients(**TWINS)
    print(", ".join(f"{c:.{DIGITS}g}" for c in found))
    print(f"largest relative error {largest_error(found, TWINS['top']):.2g}")
