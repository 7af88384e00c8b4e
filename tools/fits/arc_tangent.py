# SPDX-License-Identifier: Apache-2.0
"""Coefficients for the arc tangent: atan(t) / t in powers of t^2.

    python -m tools.fits.arc_tangent

For `tools.benchmarks.numba_eon` on [0, 1] in float64, and for `oren_nayar_angle` of the shader twins on
[0, tan(pi / 8)] in float32.

The polynomial that meets atan(t) / t at the roots of a Chebyshev polynomial in t^2, solved with 40
digits. Nearer than the branch points t^2 = -1 there is no singularity, so that each term gains a
factor of 5.8 on [0, 1], and one of 25 below tan(pi / 8).
"""

from tools.fits.minimax import mp

COMPILED = {"terms": 20, "top": mp.one}
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
    """Print the coefficients in rows of four, and their error."""
    for row in (COMPILED, TWINS):
        series = coefficients(**row)
        for first in range(0, len(series), 4):
            print("    (" + ", ".join(f"{c:.{DIGITS}g}" for c in series[first : first + 4]) + "),")
        print(f"largest relative error {largest_error(series, row['top']):.2g}")


if __name__ == "__main__":
    main()
