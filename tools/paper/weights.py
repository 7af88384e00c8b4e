# SPDX-License-Identifier: Apache-2.0
"""Figures 11 and 13 of [Portsmouth2025]: variance, largest value and mean of the throughput weight.

The weight of a sample of EON at unit reflectance is f cos(theta_i) / p, and 0 below the horizon.
`moments` has its statistics by quadrature; the figures draw samples.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.diffuse import eon_brdf
from tools.paper.curves import directions
from tools.paper.samplers import SAMPLERS
from tools.paper.sheet import Sheet

ANGLES = np.append(np.linspace(0.0, 85.0, 18), [87.0, 88.5, 89.5, 90.0])
BY_NAME = {sampler.name: sampler for sampler in SAMPLERS}
STATISTICS = (
    ("variance", np.var),
    ("largest weight", np.max),
    ("mean weight", np.mean),
)
# Lower end of the variance plots. The variance of exact samples is due to the returned density: two fits
# make it differ from the true one by up to 1.3e-5, so the variance is (1.3e-5)^2.
EXACT_VARIANCE = 1.7e-10


def moments(
    name: str,
    mu: float,
    roughness: float,
    light: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None,
    nodes: int = 96,
) -> tuple[float, float, float]:
    """Mean, variance and largest value of the weight times a light's radiance, by quadrature."""
    wo, wi, projected = hemisphere_nodes(mu, nodes)
    value, pdf = eon_brdf(wo, wi, 1.0, roughness)[:, 0], BY_NAME[name].pdf(wo, wi, roughness)
    value = value if light is None else value * light(wi)
    drawn, cosine = pdf > 0.0, wi[:, 2]
    weight = value[drawn] * cosine[drawn] / pdf[drawn]
    share = projected[drawn] * pdf[drawn] / cosine[drawn]
    mean = float(weight @ share)
    return mean, float((weight - mean) ** 2 @ share), float(weight.max())


def statistics(
    sampler: Any, angles: NDArray[np.float64], roughness: float, draws: int
) -> NDArray[np.float64]:
    """Variance, largest weight and mean weight of samples over the angle, shape (3, angles)."""
    rows = []
    for theta_o in angles:
        u = np.random.default_rng(int(4.0 * theta_o)).random((draws, 2))
        wo = directions(theta_o, 0.0)
        wi, pdf = sampler.sample(wo, u, roughness)
        good = (wi[:, 2] > 0.0) & (pdf > 0.0)
        weight = np.zeros(draws)
        value = eon_brdf(wo, wi[good], 1.0, roughness)[:, 0]
        weight[good] = value * wi[good, 2] / pdf[good]
        rows.append([function(weight) for _, function in STATISTICS])
    return np.transpose(rows)


def over_angle(sheet: Sheet) -> None:
    """Figure 11: variance, largest value and mean of the weight of every sampler at roughness 1."""
    figure, (axes,) = sheet.axes(1, 3, 9.6, 3.5)
    columns = {"theta_o": ANGLES}
    for sampler in SAMPLERS:
        rows = statistics(sampler, ANGLES, 1.0, sheet.draws)
        for cell, (name, _), values in zip(axes, STATISTICS, rows, strict=True):
            columns[f"{sampler.name} {name}"] = values
            if name == "variance":
                values = np.maximum(values, EXACT_VARIANCE)
            cell.plot(ANGLES, values, label=sampler.title)
    _label(axes)
    axes[2].set_ylim(0.985, 1.005)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(SAMPLERS))
    sheet.table("figure_11", columns)
    sheet.plot("figure_11", figure)


def over_roughness(sheet: Sheet) -> None:
    """Figure 13: cosine, the paper's mixture and the exact sampler at several roughnesses."""
    figure, (axes,) = sheet.axes(1, 2, 7.4, 3.7)
    columns = {"theta_o": ANGLES[::2]}
    styles = ("cosine", "-"), ("eon_cltc", "--"), ("eon", ":")
    for shade, r in enumerate((0.05, 0.25, 0.5, 1.0)):
        for name, style in styles:
            rows = statistics(BY_NAME[name], ANGLES[::2], r, sheet.draws)
            for cell, (statistic, _), values in zip(axes, STATISTICS, rows, strict=False):
                columns[f"{name} r={r:g} {statistic}"] = values
                if statistic == "variance":
                    values = np.maximum(values, EXACT_VARIANCE)
                label = f"{BY_NAME[name].title}, $r = {r:g}$"
                cell.plot(ANGLES[::2], values, style, color=f"C{shade}", label=label)
    _label(axes)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    sheet.table("figure_13", columns)
    sheet.plot("figure_13", figure)


def _label(axes: Sequence[Any]) -> None:
    for cell, (name, _) in zip(axes, STATISTICS, strict=False):
        cell.set(xlabel="$\\theta_o$ (degrees)", title=name, xticks=(0, 30, 60, 90))
        if name != "mean weight":
            cell.set_yscale("log")
