# SPDX-License-Identifier: Apache-2.0
"""Appendix A of [Portsmouth2025]: the rho that gives a wanted albedo."""

import numpy as np

from mxeon.figures.claims import HOLDS, Claim, verdict
from mxeon.models import inversion
from mxeon.models.albedo import eon_albedo_avg, eon_albedo_dir
from mxeon.models.formulas import C1, C2

COLORS = np.linspace(0.0, 1.0, 401)
ROUGHNESS = np.linspace(0.0, 1.0, 101)
ROUNDING = 1e-14
STATED = 3e-3


def rho(name):
    """An inversion on the grid of roughness times color."""
    return getattr(inversion, f"eon_rho_from_albedo_{name}")(COLORS, ROUGHNESS)


def normal():
    return _round_trip(eon_albedo_dir(1.0, rho("normal"), ROUGHNESS))


def average():
    return _round_trip(eon_albedo_avg(rho("avg"), ROUGHNESS))


def _round_trip(back):
    largest = np.abs(back - COLORS).max()
    return f"color off by {largest:.1e} there and back", verdict(largest < ROUNDING)


def printed_root():
    """Eq. (30) as printed, at low roughness."""
    parts = []
    for r in (1e-3, 1e-6, 1e-9):
        E, average = 1.0 / (1.0 + C1 * r), (1.0 + C2 * r) / (1.0 + C1 * r)
        A, B = average - E, E + COLORS * (1.0 - average)
        found = (-B + np.sqrt(B * B + 4.0 * A * COLORS)) / (2.0 * A)
        exact = inversion.eon_rho_from_albedo_normal(COLORS, r)
        parts.append(f"{np.abs(found - exact).max():.0e} at r = {r:g}")
    ours = "2 C d / (b + sqrt(b^2 + 4 c2 r d C)) needs no switch to a series"
    return f"error of the printed form in float64: {', '.join(parts)}; {ours}", HOLDS


def taylor():
    parts = []
    for r in (0.01, 0.1, 1.0):
        E, average = 1.0 / (1.0 + C1 * r), (1.0 + C2 * r) / (1.0 + C1 * r)
        A, B = average - E, E + COLORS * (1.0 - average)
        error = COLORS * (B * B - A * COLORS) / B**3
        error -= inversion.eon_rho_from_albedo_normal(COLORS, r)
        parts.append(f"{np.abs(error).max():.0e} at r = {r:g}")
    return f"error {', '.join(parts)}", HOLDS


def _polynomial(constraint):
    """Largest errors of the paper's polynomial and of ours, and where the first is."""
    error = np.abs(rho(f"{constraint}_approx") - rho(constraint))
    ours = np.abs(rho(f"{constraint}_refit_approx") - rho(constraint)).max()
    row, column = np.unravel_index(error.argmax(), error.shape)
    where = f"at r = {ROUGHNESS[row]:g}, C = {COLORS[column]:.2f}"
    found = f"{100 * error.max():.3f} % of full scale, {where}"
    return f"{found}; our fit of the same form {100 * ours:.3f} %", verdict(error.max() < STATED)


CLAIMS = (
    Claim("Eqs. (30), (31)", "rho from the color at normal incidence", normal),
    Claim("below Eq. (31)", "the root as printed fails at low roughness", printed_root),
    Claim("below Eq. (31)", "a series serves at low roughness", taylor),
    Claim("Eq. (32)", "within 0.3 %", lambda: _polynomial("normal")),
    Claim("Eq. (33)", "rho from the average albedo", average),
    Claim("Eq. (34)", "within 0.3 %", lambda: _polynomial("avg")),
)
