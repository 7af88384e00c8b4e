# SPDX-License-Identifier: Apache-2.0
"""Color of a black body: Planck's law seen by the CIE 1931 observer, in linear Rec. 709.

- `temperature` (...): In kelvin, in [1, 1e9].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.colorimetry import CIE_1931, WAVELENGTHS, XYZ_TO_REC709
from mxeon.models.core.namespaces import any_array, array_namespace, like

# Constants of radiation of the SI of 2019, which are exact: c1 = 2 h c^2 and c2 = h c / k_B.
PLANCK, LIGHT, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23  # J s, m/s, J/K
FIRST = 2.0 * PLANCK * LIGHT**2  # W m^2 / sr
SECOND = PLANCK * LIGHT / BOLTZMANN  # m K
NANOMETER = 1e-9  # m
LUMINANCE = np.linalg.inv(XYZ_TO_REC709)[1]  # Y of linear Rec. 709

# Cubic fits of the black bodies' chromaticity, 1667 K to 25000 K: x in 1000 K / T below and above 4000 K,
# and y in x below 2222 K, below 4000 K and above, coefficients from the highest power.
KANG_X = (
    (-0.2661239, -0.2343589, 0.8776956, 0.179910),
    (-3.0258469, 2.1070379, 0.2226347, 0.240390),
)
KANG_Y = (
    (-1.1063814, -1.34811020, 2.18555832, -0.20219683),
    (-0.9549476, -1.37418593, 2.09137015, -0.16748867),
    (3.0817580, -5.87338670, 3.75112997, -0.37001483),
)


@any_array
def planck_radiance(wavelength: ArrayLike, temperature: ArrayLike) -> Array:
    """Spectral radiance of a black body.

        L = c1 / (lambda^5 (exp(c2 / (lambda T)) - 1))

    - `wavelength`: In nm, in [1, 1e9]; broadcasts with the temperature.

    Result: in W / (m^2 sr nm); 0 where it is less than float64 holds. [Planck1901].

        >>> round(float(planck_radiance(500.0, 6504.0)), 2)
        46224.39
    """
    length, kelvin = checked_numbers(wavelength=wavelength, temperature=temperature)
    xp, length = array_namespace(length, kelvin), NANOMETER * length
    x = SECOND / (length * kelvin)
    return FIRST * NANOMETER / length**5 * xp.exp(-x) / -xp.expm1(-x)  # which does not overflow


@any_array
def blackbody_xyz(temperature: ArrayLike) -> Array:
    """CIE 1931 XYZ of a black body, with Y = 1.

    Result (..., 3). Sums over the observer's table, of 5 nm, which are within 5e-5 of those over 1
    nm. Spectra are scaled by their largest exponential, so that cold bodies, of which no light is
    left in float64, keep their color. [Planck1901]; ISO/CIE 11664-1.

        >>> blackbody_xyz(6504.0).round(4)
        array([0.9688, 1.    , 1.1218])
    """
    kelvin = checked_numbers(temperature=temperature)[0][..., np.newaxis]
    xp = array_namespace(kelvin)
    exponent = SECOND / (like(NANOMETER * WAVELENGTHS, kelvin) * kelvin)
    least = exponent[..., -1:]  # of the longest wavelength
    # exp(x) - 1 over exp(least), which never overflows for the terms that count
    growth = xp.exp(xp.minimum(exponent - least, 700.0)) * -xp.expm1(-exponent)
    xyz = xp.tensordot(like(WAVELENGTHS**-5.0, kelvin) / growth, like(CIE_1931, kelvin), axes=1)
    return xyz / xyz[..., 1:2]


@any_array
def blackbody(temperature: ArrayLike) -> Array:
    """Color of a black body in linear Rec. 709, with luminance 1.

    Result (..., 3): Channels are negative outside Rec. 709's gamut: blue below 1900 K, green below
    964 K. The specification says "radiant emittance", in words alone. The true one grows with the
    fourth power of the temperature; implementations give the color with luminance 1, as here.
    [MaterialX2026], blackbody; [Planck1901]; ISO/CIE 11664-1.

        >>> blackbody([2000.0, 6504.0]).round(3)
        array([[2.52 , 0.647, 0.02 ],
               [1.043, 0.984, 1.036]])
    """
    xyz = blackbody_xyz(temperature)
    return array_namespace(xyz).tensordot(xyz, like(XYZ_TO_REC709.T, xyz), axes=1)


def kang_xyz(temperature: ArrayLike) -> Array:
    """CIE 1931 XYZ of a black body by cubic fits, with Y = 1.

    The fits are of 1667 K to 25000 K, where x and y are within 6e-4. Below, as GLSL takes them,
    they turn back: at 800 K the color is paler than at 1667 K. [Kang2002].
    """
    (kelvin,) = checked_numbers(temperature=temperature)
    warm, hot = (np.polyval(fit, 1000.0 / kelvin) for fit in KANG_X)
    x = np.where(kelvin < 4000.0, warm, hot)
    cold, warm, hot = (np.polyval(fit, x) for fit in KANG_Y)
    y = np.where(kelvin < 2222.0, cold, np.where(kelvin < 4000.0, warm, hot))
    return np.asarray(np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=-1))
