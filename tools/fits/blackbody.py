# SPDX-License-Identifier: Apache-2.0
"""The shaders' fits of X and Z of a black body in CIE 1931 XYZ with Y = 1.

X and Z are quotients N / D of polynomials in t = 1000 K / T, for T from 800 K to 25000 K.

    python -m tools.fits.blackbody
"""

import numpy as np

from mxeon.models.core.colorimetry import CIE_1931, WAVELENGTHS
from mxeon.models.media import SECOND
from tools.fits.minimax import Form, defines, mp, refined, roots

COLDEST, HOTTEST = 800, 25000  # K
COUNT = 120
DEGREE = 4
FORM = Form(tuple((k,) for k in range(DEGREE + 1)), tuple((k,) for k in range(1, DEGREE + 1)))
# Least-squares coefficients, rounded to six digits, from which the minimax fit starts.
STARTS = {
    "X": (1.0228, 2.98338, 15.7174, 26.6339, 22.5429, 3.34545, 21.0468, 2.47854, 8.48835),
    "Z": (2.24174, -4.94097, 5.96466, -4.06478, 1.14041, 0.466323, 17.7771, -22.9823, 46.1071),
}


def sampled(count):
    """Arrays of t, X and Z. Values of t are closely spaced at both ends of the range."""
    low, high = mp.mpf(1000) / HOTTEST, mp.mpf(1000) / COLDEST
    second = mp.mpf(SECOND) * 10**6  # unit: nm times 1000 K
    points, quotients = [low + (high - low) * x for x in roots(count)], []
    for t in points:
        totals = [mp.zero] * 3
        for wavelength, row in zip(WAVELENGTHS, CIE_1931, strict=True):
            length = mp.mpf(float(wavelength))
            light = 1 / (length**5 * mp.expm1(second * t / length))
            totals = [x + light * mp.mpf(float(each)) for x, each in zip(totals, row, strict=True)]
        X, Y, Z = totals
        quotients.append((X / Y, Z / Y))
    return np.array(points, float), *np.array(quotients, float).T


def fit():
    """Rounded coefficients of N, then of D, for X and for Z."""
    t, X, Z = sampled(COUNT)
    return {
        name: refined(FORM, (t,), values, np.ones(COUNT), STARTS[name])
        for name, values in (("X", X), ("Z", Z))
    }


def largest_errors(coefficients, count=400):
    """Largest absolute errors of X and Z at points that the fit did not use."""
    t, X, Z = sampled(count)
    return {
        name: float(np.abs(FORM.value((t,), coefficients[name]) - values).max())
        for name, values in (("X", X), ("Z", Z))
    }


if __name__ == "__main__":
    found = fit()
    for name, coefficients in found.items():
        print(*defines(FORM, coefficients, f"BLACKBODY_{name}"), sep="\n")
    for name, error in largest_errors(found).items():
        print(f"{name}: largest absolute error {error:.3g}")
