# SPDX-License-Identifier: Apache-2.0
"""Coefficients for the arc tangent: atan(t) / t in powers of t^2.

    python fits/arc_tangent.py

For `mxeon.compiled` on [0, 1] in float64, and for `oren_nayar_angle` of the shader twins on
[0, tan(pi / 8)] in float32.

The polynomial that meets atan(t) / t at the roots of a Chebyshev polynomial in t^2, solved with 50
digits. Nearer than the branch points t^2 = -1 there is no singularity, so that each term gains a
factor of 5.8 on [0, 1], and one of 25 below tan(pi / 8).
"""

import mpmath
import numpy as np

COMPILED = {"terms": 20, "top": 1.0}
TWINS = {"terms": 5, "top": float(np.tan(np.pi / 8.0))}
DIGITS = 17  # that tell any two float64 numbers apart


def coefficients(terms, top):
    """Coefficients for [0, top], lowest power first, as float64."""
    with mpmath.workdps(50):
        angles = [mpmath.pi * (2 * k + 1) / (2 * terms) for k in range(terms)]
        z = [mpmath.mpf(top) ** 2 * (1 + mpmath.cos(angle)) / 2 for angle in angles]
        powers = mpmath.matrix([[each**k for k in range(terms)] for each in z])
        values = mpmath.matrix([mpmath.atan(mpmath.sqrt(each)) / mpmath.sqrt(each) for each in z])
        return [float(each) for each in mpmath.lu_solve(powers, values)]


def largest_error(found, top, count=2001):
    """Largest relative error of the polynomial itself, without the roundings of its evaluation."""
    with mpmath.workdps(50):
        t = [mpmath.mpf(float(each)) for each in np.linspace(0.0, top, count)[1:]]
        rows = [
            mpmath.fsum(c * each ** (2 * k + 1) for k, c in enumerate(found)) / mpmath.atan(each)
            for each in t
        ]
        return float(max(abs(row - 1) for row in rows))


def main():
    """Print the coefficients in rows of four, and their error."""
    for wanted in (COMPILED, TWINS):
        found = coefficients(**wanted)
        for first in range(0, len(found), 4):
            print("    (" + ", ".join(f"{c:.{DIGITS}g}" for c in found[first : first + 4]) + "),")
        print(f"largest relative error {largest_error(found, wanted['top']):.2g}")


if __name__ == "__main__":
    main()
