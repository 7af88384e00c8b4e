# SPDX-License-Identifier: Apache-2.0
"""Thin films by wavelength; the text approximates them by Gaussians and a few orders: [Belcour2017], Section 3.

The amplitudes of both interfaces and the phase of one passage give the sum of all reflections in closed form.
"""

import numpy as np

from mxeon.models.core.colorimetry import CIE_1931, WAVELENGTHS

VISIBLE = np.arange(360.0, 831.0)  # nm


def film_spectrum(wavelength, mu, thickness, n2, n, k):
    """Reflectance of a thin film on a substrate for unpolarized light of one wavelength, in nm."""
    sin2, n3 = (1.0 - mu) * (1.0 + mu), n + 1j * k
    c2 = np.sqrt(1.0 - sin2 / n2**2)
    w3 = np.sqrt(n3**2 - sin2 + 0j)  # n3 times the cosine in the substrate
    turn = np.exp(4j * np.pi * n2 * c2 * thickness / wavelength)
    s = amplitude(mu, n2 * c2), amplitude(n2 * c2, w3)
    p = amplitude(n2 * mu, c2), amplitude(n3**2 * c2, n2 * w3)
    both = [(upper + lower * turn) / (1.0 + upper * lower * turn) for upper, lower in (s, p)]
    return 0.5 * sum(np.abs(each) ** 2 for each in both)


def film_spectrum_xyz(*film):
    """Color of a thin film in CIE XYZ under light of equal energy, by a sum in steps of 1 nm."""
    spectrum = film_spectrum(VISIBLE, *(np.asarray(each)[..., np.newaxis] for each in film))
    weights = np.stack([np.interp(VISIBLE, WAVELENGTHS, each) for each in CIE_1931.T], axis=-1)
    return spectrum @ (weights / weights.sum(axis=0))


def amplitude(above, below):
    """Reflected amplitude by the admittances of both sides; no step reflects none."""
    total = above + below
    return (above - below) / np.where(total == 0.0, 1.0, total)
