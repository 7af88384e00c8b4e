# SPDX-License-Identifier: Apache-2.0
"""Claims of [Portsmouth2025], Appendix A, where rho is computed from a given albedo."""

import numpy as np

from mxeon.models.diffuse import C1, C2, eon_rho_from_albedo_avg, eon_rho_from_albedo_normal
from tools.paper.claims import Measured, Section

COLORS = np.linspace(0.0, 1.0, 401)
ROUGHNESS = np.linspace(0.0, 1.0, 101)
STATED = 3e-3
# A formula in float64 fails if the error exceeds a rounding of float32.
FLOAT32 = 2.0**-24
SECTION = Section("Appendix A: inversion of the albedo")
claim = SECTION.claim


def _quadratic(r: float) -> tuple[float, np.ndarray]:
    E, average = 1.0 / (1.0 + C1 * r), (1.0 + C2 * r) / (1.0 + C1 * r)
    return average - E, E + COLORS * (1.0 - average)


def _error(values: np.ndarray, r: float) -> float:
    return float(np.abs(values - eon_rho_from_albedo_normal(COLORS, r)).max())


def _listed(errors: dict[float, float]) -> str:
    return ", ".join(f"{error:.0e} at r = {r:g}" for r, error in errors.items())


def _polynomial(slope: float, zero: float, exact: np.ndarray) -> Measured:
    """Largest error of the approximation rho = C + slope (zero - C) C r."""
    error = np.abs(COLORS + slope * (zero - COLORS) * COLORS * ROUGHNESS[:, np.newaxis] - exact)
    row, column = np.unravel_index(error.argmax(), error.shape)
    place = f"at r = {ROUGHNESS[row]:g}, C = {COLORS[column]:.2f}"
    return f"{100 * error.max():.3f} % of full scale, {place}", error.max()


@claim(
    "below Eq. (31)",
    "the root as printed fails at low roughness",
    "error at r = 1e-9",
    least=FLOAT32,
)
def printed_root() -> Measured:
    """A sentence on errors of Eq. (30) as published, and the error for roughness 1e-9."""
    errors = {}
    for r in (1e-3, 1e-6, 1e-9):
        A, B = _quadratic(r)
        root = (-B + np.sqrt(B * B + 4.0 * A * COLORS)) / (2.0 * A)
        errors[r] = _error(root, r)
    ours = "2 C d / (b + sqrt(b^2 + 4 c2 r d C)) needs no switch to a series"
    return f"error of the printed form in float64: {_listed(errors)}; {ours}", errors[1e-9]


@claim("below Eq. (31)", "a series serves at low roughness", "error up to r = 0.1", most=STATED)
def taylor() -> Measured:
    """Errors of the series below Eq. (31). The errors must be small up to roughness 0.1."""
    errors = {}
    for r in (0.01, 0.1, 1.0):
        A, B = _quadratic(r)
        errors[r] = _error(COLORS * (B * B - A * COLORS) / B**3, r)
    return f"error {_listed(errors)}", [errors[0.01], errors[0.1]]


@claim("Eq. (32)", "within 0.3 %", "error", most=STATED)
def polynomial_normal() -> Measured:
    return _polynomial(0.258831, 0.98995, eon_rho_from_albedo_normal(COLORS, ROUGHNESS))


@claim("Eq. (34)", "within 0.3 %", "error", most=STATED)
def polynomial_average() -> Measured:
    return _polynomial(0.189468, 1.0, eon_rho_from_albedo_avg(COLORS, ROUGHNESS))
