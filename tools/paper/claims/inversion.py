# SPDX-License-Identifier: Apache-2.0
"""Appendix A of [Portsmouth2025]: the rho for a given albedo."""

from typing import Any

import numpy as np

from mxeon.models import diffuse as inversion
from mxeon.models.diffuse import C1, C2, eon_albedo_avg, eon_albedo_dir
from tools.paper.claims import Measured, Section

COLORS = np.linspace(0.0, 1.0, 401)
ROUGHNESS = np.linspace(0.0, 1.0, 101)
ROUNDING = 1e-14
STATED = 3e-3
# The rounding of float32: a float64 formula with a larger error has failed.
FLOAT32 = 2.0**-24
# Slope a and zero b of Eqs. (32) and (34), C + a (b - C) C r, and of our fits of these forms,
# tools/fits/eon_inversion.py.
PRINTED = {"normal": (0.258831, 0.98995), "avg": (0.189468, 1.0)}
REFIT = {"normal": (0.2531091, 0.9883170), "avg": (0.1843278, 1.0)}
SECTION = Section("Appendix A: inversion of the albedo")
claim = SECTION.claim


def rho(name: str) -> Any:
    """An inversion on the grid of roughness times color."""
    return getattr(inversion, f"eon_rho_from_albedo_{name}")(COLORS, ROUGHNESS)


def _round_trip(back: np.ndarray) -> Measured:
    largest = np.abs(back - COLORS).max()
    return f"color off by {largest:.1e} there and back", largest


def _quadratic(r: float) -> tuple[float, np.ndarray]:
    E, average = 1.0 / (1.0 + C1 * r), (1.0 + C2 * r) / (1.0 + C1 * r)
    return average - E, E + COLORS * (1.0 - average)


def _error(values: np.ndarray, r: float) -> float:
    return float(np.abs(values - inversion.eon_rho_from_albedo_normal(COLORS, r)).max())


def _listed(errors: dict[float, float]) -> str:
    return ", ".join(f"{error:.0e} at r = {r:g}" for r, error in errors.items())


def _polynomial(constraint: str) -> Measured:
    """Largest errors of the paper's polynomial and of ours, and the place of the first."""
    exact = rho(constraint)
    error, ours = (
        np.abs(COLORS + slope * (zero - COLORS) * COLORS * ROUGHNESS[:, np.newaxis] - exact)
        for slope, zero in (PRINTED[constraint], REFIT[constraint])
    )
    row, column = np.unravel_index(error.argmax(), error.shape)
    place = f"at r = {ROUGHNESS[row]:g}, C = {COLORS[column]:.2f}"
    sentence = f"{100 * error.max():.3f} % of full scale, {place}"
    return f"{sentence}; our fit of the same form {100 * ours.max():.3f} %", error.max()


@claim("Eqs. (30), (31)", "rho from the color at normal incidence", "error", most=ROUNDING)
def normal() -> Measured:
    return _round_trip(eon_albedo_dir(1.0, rho("normal"), ROUGHNESS))


@claim(
    "below Eq. (31)",
    "the root as printed fails at low roughness",
    "error at r = 1e-9",
    least=FLOAT32,
)
def printed_root() -> Measured:
    """Eq. (30) as printed, at low roughness; its error at the lowest."""
    errors = {}
    for r in (1e-3, 1e-6, 1e-9):
        A, B = _quadratic(r)
        root = (-B + np.sqrt(B * B + 4.0 * A * COLORS)) / (2.0 * A)
        errors[r] = _error(root, r)
    ours = "2 C d / (b + sqrt(b^2 + 4 c2 r d C)) needs no switch to a series"
    return f"error of the printed form in float64: {_listed(errors)}; {ours}", errors[1e-9]


@claim("below Eq. (31)", "a series serves at low roughness", "error up to r = 0.1", most=STATED)
def taylor() -> Measured:
    """The series below Eq. (31); its error at roughness 0.01 and 0.1."""
    errors = {}
    for r in (0.01, 0.1, 1.0):
        A, B = _quadratic(r)
        errors[r] = _error(COLORS * (B * B - A * COLORS) / B**3, r)
    return f"error {_listed(errors)}", [errors[0.01], errors[0.1]]


@claim("Eq. (32)", "within 0.3 %", "error", most=STATED)
def polynomial_normal() -> Measured:
    return _polynomial("normal")


@claim("Eq. (33)", "rho from the average albedo", "error", most=ROUNDING)
def average() -> Measured:
    return _round_trip(eon_albedo_avg(rho("avg"), ROUGHNESS))


@claim("Eq. (34)", "within 0.3 %", "error", most=STATED)
def polynomial_average() -> Measured:
    return _polynomial("avg")
