# SPDX-License-Identifier: Apache-2.0
"""Figures of the page on the thin film of pbrlib's text: what its approximations cost."""

import numpy as np

from mxeon.models import thin_film as films
from mxeon.models.core.colorimetry import XYZ_TO_REC709
from mxeon.models.microfacet.fresnel import fresnel_conductor, fresnel_schlick
from mxeon.models.thin_film import formulas as film
from mxeon.models.thin_film.curve import film_curve, without_clamp
from mxeon.models.thin_film.spectrum import film_spectrum_xyz

GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)
# Index and extinction of substrates: diamond, glass, water, a dark metal and a bright one.
SUBSTRATES = ((2.4, 0.0), (1.5, 0.0), (1.33, 0.0), (2.9, 3.1), (0.2, 3.4))
INDICES = (1.0, 1.33, 1.6, 2.3)
THICKNESSES = np.linspace(0.0, 2000.0, 26)
COSINES = np.linspace(0.05, 1.0, 8)
DIGITS = 12  # of a reflectance


def grid():
    """Cosine, thickness and index of the film, and index and extinction, each of shape (5, 4, 26, 8)."""
    shape = (len(SUBSTRATES), len(INDICES), len(THICKNESSES), len(COSINES))
    ior, extinction = np.array(SUBSTRATES).T.reshape(2, -1, 1, 1, 1)
    arrays = (COSINES, THICKNESSES[:, None], np.reshape(INDICES, (-1, 1, 1)), ior, extinction)
    return [np.broadcast_to(array, shape) for array in arrays]


def text_xyz(orders):
    """XYZ of the grid by the text, shape (..., 3)."""
    mu, thickness, index, ior, extinction = grid()
    opd = film.path_difference(mu, thickness, index)
    both = film.over_index(mu, index, ior, extinction)
    return np.moveaxis(0.5 * sum(film.tristimulus(each, opd, orders) for each in both), 0, -1)


def errors(orders):
    """Differences of the text's XYZ and of that by wavelengths, of dielectrics and of metals."""
    error = np.abs(text_xyz(orders) - film_spectrum_xyz(*grid()))
    metal = np.array(SUBSTRATES)[:, 1] > 0.0
    return error[~metal].max(), error[metal].max()


def agreeing_digits(wavelength=550e-9):
    """Digits in which all orders of the text agree with matrices at one wavelength; DIGITS at most.

    Further ones are those of a machine's sines.
    """
    mu, thickness, index, ior, extinction = grid()
    opd = film.path_difference(mu, thickness, index)
    airy = 0.0
    for first, second, phase in film.over_index(mu, index, ior, extinction):
        passed = 1.0 - first
        through = passed**2 * second / (1.0 - first * second)
        wave = np.sqrt(first * second) * np.exp(1j * (2.0 * np.pi * opd / wavelength + phase))
        orders = 2.0 * (wave / (1.0 - wave)).real
        airy = airy + 0.5 * (first + through + (through - passed) * orders)
    error = np.abs(airy - _by_matrices(mu, index, ior + 1j * extinction, opd / wavelength))
    return min(DIGITS, int(-np.log10(error.max())))


def _by_matrices(mu, index, substrate, waves):
    """Reflectance of a film for unpolarized light, by the matrix of its fields; `waves` of a path and back."""
    sine2, delta = 1.0 - mu * mu, np.pi * waves
    indices = (1.0, index, substrate)
    cosines = [np.sqrt(1.0 - sine2 / n**2 + 0j) for n in indices]
    total = 0.0
    for power in (1, -1):  # perpendicular and parallel
        above, within, below = (n * c**power for n, c in zip(indices, cosines, strict=True))
        E = np.cos(delta) - 1j * below / within * np.sin(delta)
        H = below * np.cos(delta) - 1j * within * np.sin(delta)
        total = total + 0.5 * np.abs((above * E - H) / (above * E + H)) ** 2
    return total


def unclamped(form):
    """Least and largest linear RGB of gray metals of the grid before the clamp."""
    mu, thickness, index, ior, extinction = (each[3:] for each in grid())
    curve = film_curve("conductor_bsdf", without_clamp(form))
    channels = (3, *mu.shape)
    rgb = curve.at(
        mu,
        thinfilm_thickness=np.maximum(thickness, 1e-9),
        thinfilm_ior=index,
        ior=np.broadcast_to(ior, channels),
        extinction=np.broadcast_to(extinction, channels),
    )
    return rgb.min(), rgb.max()


def thin_gold(form):
    """Largest change of a channel of gold along the normal by a film of 1e-3 nm and index 1.5."""
    coated = films.film_conductor(1.0, 1e-3, 1.5, *GOLD, without_clamp(form))
    return float(np.abs(coated - fresnel_conductor(1.0, *GOLD)).max())


def thin_schlick():
    """Largest change of a Schlick curve of color0 0.5 by a film of 1e-3 nm and index 1.5."""
    ones, half, mu = np.ones(3), np.full(3, 0.5), np.linspace(0.1, 1.0, 91)
    coated = films.film_schlick(mu, 1e-3, 1.5, half, ones, ones, 5.0)
    return float(np.abs(coated - fresnel_schlick(mu, half, ones, ones, 5.0)).max())


def white():
    """RGB, by the printed matrix, of what reflects all light of equal energy."""
    return " ".join(f"{value:.3f}" for value in XYZ_TO_REC709 @ np.ones(3))


def thin_film_block():
    """Figures of the text's thin film."""
    fitted, short = errors(None), errors(2)
    low, high = unclamped(films.TEXT)
    rows = (
        ("error in XYZ of all orders, dielectrics", fitted[0], 0),
        ("error in XYZ of all orders, metals", fitted[1], 0),
        ("error in XYZ of two orders, dielectrics", short[0], 0),
        ("error in XYZ of two orders, metals", short[1], 0),
        ("white under the matrix printed for `lin_rec709`", white(), "1 1 1"),
        ("change of gold by a film of 0.001 nm, index k in XYZ k", thin_gold(films.PRINTED), 0),
        ("the same, each channel over all of XYZ", thin_gold(films.TEXT), 0),
        ("change of Schlick's curve by a film of 0.001 nm", thin_schlick(), 0),
        ("least RGB before the clamp, gray metals", low, 0),
        ("largest RGB before the clamp, gray metals", high, 1),
    )
    lines = (
        f"| {name} | {value if isinstance(value, str) else f'{value:.2g}'} | {expected} |\n"
        for name, value, expected in rows
    )
    return "| quantity | measured | expected |\n|---|---|---|\n" + "".join(lines)


OF_FILMS = {"pbrlib_thin_film": thin_film_block}
