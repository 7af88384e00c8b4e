# SPDX-License-Identifier: Apache-2.0
"""Conversion of spectra to colors: the CIE 1931 standard observer, and linear Rec. 709."""

from __future__ import annotations

from pathlib import Path

import numpy as np

_OBSERVER = np.loadtxt(Path(__file__).with_name("cie_1931.csv"), delimiter=",")
WAVELENGTHS = _OBSERVER[:, 0]  # unit: nm
CIE_1931 = _OBSERVER[:, 1:]  # color-matching functions x, y, z at WAVELENGTHS
# The specification's matrix from CIE XYZ to linear Rec. 709, white point D65, by IEC 61966-2-1.
XYZ_TO_REC709 = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)
# XYZ_TO_REC709 after a Bradford adaptation of equal-energy white to D65. Each row sums to 1.
XYZ_TO_REC709_E = np.array(
    [
        [3.1462511, -1.6661240, -0.4801271],
        [-0.9955350, 1.9557635, 0.0397715],
        [0.0635978, -0.2145965, 1.1509987],
    ]
)
