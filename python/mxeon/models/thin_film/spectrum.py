# SPDX-License-Identifier: Apache-2.0
"""Reflectance of a thin film wavelength by wavelength, and its color under the CIE 1931 observer.

It is what the specification approximates by Gaussians and a few orders: the amplitudes of both
interfaces and the phase of one passage give the sum of all reflections in closed form.

- `mu` (...): Cosine between direction and normal, in [0, 1].
- `thickness` (...): Of the film, in nm, in [0, 1e9].
- `film_ior` (...): Index of the film, in [1, 1e50].
- `ior`, `extinction` (...): Complex index of the substrate, in [0, 1e50], without channels.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked, checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.colorimetry import matching_functions
from mxeon.models.core.namespaces import any_array, array_namespace, library, like
from mxeon.models.thin_film.formulas import refracted

STEP = 1.0  # nm
VISIBLE = np.arange(360.0, 830.0 + STEP, STEP)


@any_array
def film_spectrum(
    wavelength: ArrayLike,
    mu: ArrayLike,
    thickness: ArrayLike,
    film_ior: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
) -> Array:
    """Reflectance of a thin film on a substrate for unpolarized light of one wavelength.

    - `wavelength` (...): In nm, in [1, 1e9].

    Result (...): in [0, 1]. [Belcour2017], Section 3.

        >>> film_spectrum([450.0, 550.0, 650.0], 1.0, 100.0, 1.38, 1.5, 0.0).round(4)
        array([0.0173, 0.0141, 0.0156])
    """
    film = {"mu": mu, "thickness": thickness, "film_ior": film_ior}
    substrate = {"ior": ior, "extinction": extinction}
    return _spectrum(*checked_numbers(wavelength=wavelength, **film, **substrate))


def _spectrum(
    wavelength: Array, mu: Array, thickness: Array, n2: Array, n: Array, k: Array
) -> Array:
    """`film_spectrum` on valid arrays."""
    xp, n3 = array_namespace(n, k), n + 1j * k
    sin2 = (1.0 - mu) * (1.0 + mu)
    c2 = refracted(mu, n2)
    w3 = xp.sqrt(n3**2 - sin2 + 0j)  # n3 times the cosine in the substrate
    path = 4.0 * np.pi * n2 * c2 * thickness
    turn = xp.exp(1j * path / wavelength)
    s = _amplitude(mu, n2 * c2), _amplitude(n2 * c2, w3)
    p = _amplitude(n2 * mu, c2), _amplitude(n3**2 * c2, n2 * w3)
    both = [(upper + lower * turn) / (1.0 + upper * lower * turn) for upper, lower in (s, p)]
    Rs, Rp = (xp.real(each) ** 2 + xp.imag(each) ** 2 for each in both)
    return 0.5 * (Rs + Rp)


@any_array
def film_spectrum_xyz(
    mu: ArrayLike,
    thickness: ArrayLike,
    film_ior: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    light: ArrayLike = 1.0,
) -> Array:
    """Color of a thin film in CIE XYZ, by a sum over wavelengths in steps of 1 nm.

    - `light` (471,) or (): Spectral power at 360 nm to 830 nm; the default is of equal energy.

    Result (..., 3): relative to the white of the light.

        >>> film_spectrum_xyz(1.0, 400.0, 1.33, 1.5, 0.0).round(4)
        array([0.0246, 0.0326, 0.0161])
    """
    film = {"mu": mu, "thickness": thickness, "film_ior": film_ior}
    material = checked_numbers(**film, ior=ior, extinction=extinction)
    power = checked("light", light)
    if power.shape not in ((), VISIBLE.shape) or not (library(power) or power.any()):
        raise ValueError(f"light must be {len(VISIBLE)} powers, not all 0; got {light!r}")
    R = _spectrum(like(VISIBLE, material[0]), *(each[..., np.newaxis] for each in material))
    xp = array_namespace(R)
    weights = like(matching_functions(VISIBLE), R) * xp.reshape(power / xp.max(power), (-1, 1))
    return xp.tensordot(R, weights / xp.sum(weights, axis=0), axes=1)


def _amplitude(above: Numbers, below: Numbers) -> Numbers:
    """(a - b) / (a + b): reflected amplitude by the admittances of both sides; no step reflects none."""
    total = above + below
    return (above - below) / array_namespace(total).where(total == 0.0, 1.0, total)
