# SPDX-License-Identifier: Apache-2.0
"""Fits of the CIE 1931 XYZ of a black body with Y = 1, for the shaders.

With t = 1000 K / T, X and Z are quotients N / D of polynomials in t, from 800 K to 25000 K.

    python -m tools.fits.blackbody
"""

import numpy as np

from mxeon.models.core.colorimetry import CIE_1931, WAVELENGTHS
from mxeon.models.media.blackbody import BOLTZMANN, LIGHT, PLANCK
from tools.fits.minimax import mp
from tools.fits.rational import Form, defines, refined

COLDEST, HOTTEST = 800, 25000  # K
COUNT = 120  # points of the fit
DEGREE = 4
FORM = Form(tuple((k,) for k in range(DEGREE + 1)), tuple((k,) for k in range(1, DEGREE + 1)))
# Six digits of fits of least squares, from which the exchange starts.
STARTS = {
    "X": (1.0228, 2.98338, 15.7174, 26.6339, 22.5429, 3.34545, 21.0468, 2.47854, 8.48835),
    "Z": (2.24174, -4.94097, 5.96466, -4.06478, 1.14041, 0.466323, 17.7771, -22.9823, 46.1071),
}


def points(count):
    """Points of t, dense at both ends."""
    low, high = mp.mpf(1000) / HOTTEST, mp.mpf(1000) / COLDEST
    return [
        low + (high - low) * (1 - mp.cos(mp.pi * (2 * k + 1) / (2 * count))) / 2
        for k in range(count)
    ]


def xyz(t):
    """X and Z of a black body with Y = 1."""
    second = mp.mpf(PLANCK) * mp.mpf(LIGHT) / mp.mpf(BOLTZMANN) * 10**6  # nm times 1000 K
    totals = [mp.zero] * 3
    for wavelength, row in zip(WAVELENGTHS, CIE_1931, strict=True):
        length = mp.mpf(float(wavelength))
        light = 1 / (length**5 * mp.expm1(second * t / length))
        totals = [x + light * mp.mpf(float(each)) for x, each in zip(totals, row, strict=True)]
    X, Y, Z = totals
    return X / Y, Z / Y


def fit():
    """Coefficients of X and of Z, numerator first, rounded as printed."""
    t = points(COUNT)
    rows = np.array([[float(each) for each in xyz(x)] for x in t])
    variables = (np.array([float(x) for x in t]),)
    weights = np.ones(COUNT)
    return {
        name: refined(FORM, variables, values, weights, STARTS[name])
        for name, values in zip("XZ", rows.T, strict=True)
    }


def largest_errors(coefficients, count=400):
    """Largest absolute errors of X and Z, at other points than those of the fit."""
    t = points(count)
    rows = np.array([[float(each) for each in xyz(x)] for x in t])
    variables = (np.array([float(x) for x in t]),)
    return {
        name: float(np.abs(FORM.value(variables, coefficients[name]) - values).max())
        for name, values in zip("XZ", rows.T, strict=True)
    }


def main():
    """Print the lines for the shaders and the errors of the fits."""
    coefficients = fit()
    for name, row in coefficients.items():
        print(*defines(FORM, row, f"BLACKBODY_{name}"), sep="\n")
    for name, error in largest_errors(coefficients).items():
        print(f"{name}: largest absolute error {error:.3g}")


if __name__ == "__main__":
    main()
