# SPDX-License-Identifier: Apache-2.0
"""Figures 3, 6, 7 and 15 of [Portsmouth2025]: values, albedos and their inversion as curves."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from mxeon.models import diffuse
from mxeon.models import diffuse as inversion
from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.table import DIFFUSE_MODELS, diffuse_model
from tools.paper.sheet import Sheet

DEGREES = np.linspace(0.0, 90.0, 181)
DOTS = np.linspace(0.0, 90.0, 13)
ANGLE_TICKS = (0, 30, 60, 90)
SHADES = np.linspace(0.0, 1.0, 101)
ROUGHNESS = (0.25, 0.5, 0.75, 1.0)
SIGMA = (0.1, 0.2, 0.4, 0.8, 0.5 * np.pi)
TARGETS = (0.1, 0.3, 0.5, 0.7, 0.9)
SHORT = {
    "oren_nayar": "full Oren-Nayar",
    "qon": "QON",
    "qon_footnote": "QON, footnote 1",
    "qon_fujii": "QON, Fujii",
    "fon": "FON",
    "eon": "EON",
    "eon_approx": "EON, quartic",
}
# This curve coincides with EON's.
INDISTINGUISHABLE = "eon_approx"


def label(name: str) -> str:
    """A model's short name, or its title if it has none."""
    return SHORT.get(name) or diffuse_model(name).title


def cosine(degrees: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cosine, 0 at 90 degrees."""
    return np.where(degrees == 90.0, 0.0, np.cos(np.radians(degrees)))


def directions(theta: ArrayLike, phi: ArrayLike) -> NDArray[np.float64]:
    """Unit vectors at polar angle `theta` and azimuth `phi`, both in degrees."""
    theta, phi = np.radians(theta), np.radians(phi)
    parts = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta).clip(0.0)
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def comparison(sheet: Sheet) -> None:
    """Figure 3: every model at half its largest roughness, rho = 0.8: the BRDF times the cosine."""
    figure, axes = sheet.axes(3, 3, 7.6, 6.4, sharex=True, sharey="row")
    columns = {"theta_o": DEGREES}
    for row, phi in enumerate((0.0, 90.0, 180.0)):
        for column, theta_i in enumerate((15.0, 45.0, 75.0)):
            wo, wi = directions(DEGREES, phi), directions(theta_i, 0.0)
            for each in DIFFUSE_MODELS:
                if each.name == INDISTINGUISHABLE:
                    continue
                parameter = [0.5 * each.largest] if each.parameter else []
                value = each.brdf(wo, wi, 0.8, *parameter)[:, 0] * wi[2]
                columns[f"{each.name} theta_i={theta_i:g} phi={phi:g}"] = value
                axes[row, column].plot(DEGREES, value, label=label(each.name))
            axes[row, column].set_title(f"$\\theta_i = {theta_i:g}°,\\ \\phi = {phi:g}°$")
    for cell in axes[2]:
        cell.set(xlabel="$\\theta_o$ (degrees)", xticks=ANGLE_TICKS)
    for cell in axes[:, 0]:
        cell.set(ylabel="$f \\cos\\theta_i$ (1/sr)", ylim=(0.0, None))
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    sheet.table("figure_03", columns)
    sheet.plot("figure_03", figure)


def qon_albedos(sheet: Sheet) -> None:
    """Figure 6: directional and average albedo of QON; lines are closed forms, dots quadrature."""
    figure, (axes,) = sheet.axes(1, 2, 7.2, 3.2)
    names = [f"$\\sigma = {sigma:g}$" for sigma in SIGMA[:-1]] + ["$\\sigma = \\pi/2$"]
    columns = _directional(axes[0], diffuse.qon_albedo_dir, diffuse.qon_brdf, SIGMA, names)
    sheet.table("figure_06_directional", columns)
    columns = _average(axes[1], diffuse.qon_albedo_avg, diffuse.qon_brdf, np.pi / 2.0)
    axes[1].set_xlabel("$\\sigma$ (radian)")
    sheet.table("figure_06_average", columns)
    sheet.plot("figure_06", figure)


def fon_albedos(sheet: Sheet) -> None:
    """Figure 7: the same for FON, and the error of the paper's quartic."""
    figure, (axes,) = sheet.axes(1, 3, 9.6, 3.2)
    names = [f"$r = {r:g}$" for r in ROUGHNESS]
    columns = _directional(axes[0], diffuse.fon_albedo_dir, diffuse.fon_brdf, ROUGHNESS, names)
    sheet.table("figure_07_directional", columns)
    columns = _average(axes[1], diffuse.fon_albedo_avg, diffuse.fon_brdf, 1.0)
    axes[1].set_xlabel("$r$")
    sheet.table("figure_07_average", columns)
    columns = {"theta_o": DEGREES}
    for r in ROUGHNESS:
        error = diffuse.fon_albedo_dir(cosine(DEGREES), r) - diffuse.fon_albedo_dir_approx(
            cosine(DEGREES), r
        )
        columns[f"r={r:g}"] = error
        axes[2].plot(DEGREES, 100.0 * error)
    axes[2].set(title="exact $-$ quartic (%)", xlabel="$\\theta_o$ (degrees)", xticks=ANGLE_TICKS)
    sheet.table("figure_07_difference", columns)
    sheet.plot("figure_07", figure)


def _directional(
    cell: Axes,
    closed: Callable[..., NDArray[np.float64]],
    brdf: Callable[..., NDArray[np.float64]],
    parameters: Sequence[float],
    names: Sequence[str],
) -> dict[str, ArrayLike]:
    """Draw directional albedos over the angle; return the columns of their table."""
    columns: dict[str, ArrayLike] = {"theta_o": DOTS}
    mu = cosine(DOTS)
    for parameter, name in zip(parameters, names, strict=True):
        dots = albedo_dir_quadrature(brdf, mu, 1.0, parameter)[:, 0]
        (line,) = cell.plot(DEGREES, closed(cosine(DEGREES), parameter), label=name)
        cell.plot(DOTS, dots, "o", markersize=3.5, color=line.get_color())
        columns[f"{parameter:.6g}"] = closed(mu, parameter)
        columns[f"{parameter:.6g} by quadrature"] = dots
    cell.axhline(1.0, color="0.6", linewidth=0.8, zorder=0)
    cell.set(xlabel="$\\theta_o$ (degrees)", title="directional albedo", xticks=ANGLE_TICKS)
    handles, labels = cell.get_legend_handles_labels()
    cell.figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return columns


def _average(
    cell: Axes,
    closed: Callable[..., NDArray[np.float64]],
    brdf: Callable[..., NDArray[np.float64]],
    largest: float,
) -> dict[str, ArrayLike]:
    """Draw the average albedo over the parameter; return the columns of its table."""
    x, weight = np.polynomial.legendre.leggauss(32)
    mu, weight = 0.5 * (1.0 + x), 0.5 * weight
    parameter = largest * SHADES
    line, at = closed(parameter), parameter[::10]
    dots = [2.0 * (weight * mu) @ albedo_dir_quadrature(brdf, mu, 1.0, p)[:, 0] for p in at]
    cell.plot(parameter, line)
    cell.plot(at, dots, "o", markersize=3.5, color=cell.lines[0].get_color())
    cell.set(title="average albedo")
    return {"parameter": at, "closed form": line[::10], "quadrature": dots}


def inverted(sheet: Sheet) -> None:
    """Figure 15: the rho that gives a color, over roughness, and the error of the fits."""
    figure, axes = sheet.axes(2, 2, 7.4, 5.6, sharex=True, sharey="row")
    columns, r = {"roughness": SHADES}, SHADES
    sides = ("normal", "color at normal incidence, Eq. (32)"), ("avg", "average albedo, Eq. (34)")
    for (above, below), (constraint, title) in zip(axes.T, sides, strict=True):
        exact = getattr(inversion, f"eon_rho_from_albedo_{constraint}")
        approx = getattr(inversion, f"eon_rho_from_albedo_{constraint}_approx")
        for color in TARGETS:
            line, dashed = exact(color, r)[:, 0], approx(color, r)[:, 0]
            columns[f"{constraint} C={color:g}"] = line
            columns[f"{constraint} approx C={color:g}"] = dashed
            above.plot(r, line, color="black", linewidth=1.0)
            above.plot(r, dashed, "--", label=f"$C = {color:g}$")
            below.plot(r, 100.0 * (dashed - line))
        for bound in (-0.3, 0.3):
            below.axhline(bound, color="black", linewidth=0.8, linestyle=":")
        above.set(title=title)
        below.set(xlabel="$r$")
    axes[0, 0].set(ylabel="$\\rho$, exact and approximate")
    axes[1, 0].set(ylabel="error (%), stated below 0.3")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(TARGETS))
    sheet.table("figure_15", columns)
    sheet.plot("figure_15", figure)
