# SPDX-License-Identifier: Apache-2.0
"""Coefficients for the arc tangent: atan(t) / t in powers of t^2.

    python -m tools.fits.arc_tangent

For `oren_nayar_angle` of the shaders on [0, tan(pi / 8)] in float32.

The polynomial that meets atan(t) / t at the roots of a Chebyshev polynomial in t^2, solved with 40
digits. Nearer than the branch points t^2 = -1 there is no singularity, so each term gains a factor of 25.
"""

from tools.fits.minimax import mp

TWINS = {"terms": 5, "top": mp.sqrt(2) - 1}
DIGITS = 17  # that tell any two float64 numbers apart


def coefficients(terms, top):
    """Coefficients for [0, top], lowest power first, as float64."""
    angles = [mp.pi * (2 * k + 1) / (2 * terms) for k in range(terms)]
    squares = [top**2 * (1 + mp.cos(angle)) / 2 for angle in angles]
    powers = mp.matrix([[z**k for k in range(terms)] for z in squares])
    values = mp.matrix([mp.atan(mp.sqrt(z)) / mp.sqrt(z) for z in squares])
    return [float(each) for each in mp.lu_solve(powers, values)]


def largest_error(series, top, count=2000):
    """Largest relative error of the polynomial itself, without the roundings of its evaluation."""
    points = [top * k / count for k in range(1, count + 1)]
    values = [mp.fdot(series, _odd_powers(t, len(series))) / mp.atan(t) for t in points]
    return float(max(abs(value - 1) for value in values))


def _odd_powers(t, count):
    """t, t^3, and so on."""
    return [t ** (2 * k + 1) for k in range(count)]


def main():
    """Print the coefficients and their error."""
    series = coefficients(**TWINS)
    print(", ".join(f"{c:.{DIGITS}g}" for c in series))
    print(f"largest relative error {largest_error(series, TWINS['top']):.2g}")


if __name__ == "__main__":
    main()
