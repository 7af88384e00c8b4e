# SPDX-License-Identifier: Apache-2.0
"""A figure of a model: its lobe, its albedo, and the density of its samples. Needs matplotlib."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from mxeon.models.core.arrays import Array, ArrayLike

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

VIEWS = (0.0, 30.0, 60.0)  # polar angles of the viewer, degrees
VIEW_COLORS = ("#6a4c93", "#c9811b", "#1b8f8f")  # none of them a channel's
CHANNEL_COLORS = ("#d8505f", "#2f9e63", "#3f7fd1")
ANGLES = 721  # points per lobe
FIBER = "chiang_hair_bsdf"
STYLE = {"axes.grid": True, "grid.alpha": 0.3, "font.size": 9, "axes.titlesize": 10}


class Drawn(Protocol):
    """A model that can be plotted, such as `mxeon.models.shading_model.ShadingModel`."""

    @property
    def lights(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def node(self) -> str: ...
    @property
    def functions(self) -> tuple[str, ...]: ...
    def bsdf(self, wo: ArrayLike, wi: ArrayLike, **inputs: ArrayLike) -> Array: ...
    def albedo_dir(self, mu: ArrayLike, **inputs: ArrayLike) -> Array: ...
    def pdf(self, wo: ArrayLike, wi: ArrayLike, **inputs: ArrayLike) -> Array: ...


def draw(model: Drawn, inputs: Mapping[str, ArrayLike], path: str | None = None) -> Figure:
    """The figure of a model with these inputs, one material; written to `path` if given."""
    # Only plots need matplotlib.
    try:
        from matplotlib import style
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError(
            "plot needs matplotlib: pip install '.[report]' in a checkout of mxeon"
        ) from None
    with style.context(["default", STYLE]):
        columns = 3 if "pdf" in model.functions else 2
        figure = Figure(figsize=(3.7 * columns, 3.6), layout="constrained")
        words = {n: " ".join(f"{each:.4g}" for each in np.ravel(v)) for n, v in inputs.items()}
        figure.suptitle(model.title + "".join(f", {n} {v}" for n, v in words.items()))
        polar = cast("PolarAxes", figure.add_subplot(1, columns, 1, projection="polar"))
        _draw_lobe(polar, model, inputs)
        _draw_albedo(figure.add_subplot(1, columns, 2), model, inputs)
        if columns == 3:
            _draw_density(figure.add_subplot(1, columns, 3), model, inputs)
        if path:
            figure.savefig(path, dpi=150)
    return figure


def _plane(angles: ArrayLike) -> Array:
    """Directions in the plane of the tangent, from their angles to the normal in radian."""
    angle = np.asarray(angles, np.float64)
    return np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)


def _lobes(model: Drawn, inputs: Mapping[str, ArrayLike]) -> tuple[Array, list[Array]]:
    """Angles of lights, and for each view the value times |cosine|, averaged over the channels.

    Values of a fiber are not multiplied by the cosine.
    """
    ends = {"front": (-0.5, 0.5), "back": (0.5, 1.5), "all sides": (-1.0, 1.0)}[model.lights]
    angles = np.linspace(ends[0] * np.pi + 1e-4, ends[1] * np.pi - 1e-4, ANGLES)
    wi = _plane(angles)
    cosine = np.ones(ANGLES) if model.node == FIBER else np.abs(np.cos(angles))
    lobes = []
    for view in VIEWS:
        values = model.bsdf(_plane(np.radians(view)), wi, **inputs)
        values = values if values.ndim == 1 else values.mean(axis=-1)
        lobes.append(values * cosine)
    return angles, lobes


def _draw_lobe(axes: PolarAxes, model: Drawn, inputs: Mapping[str, ArrayLike]) -> None:
    """Value times cosine over the angle of the light; the views are marked."""
    angles, lobes = _lobes(model, inputs)
    for view, color, lobe in zip(VIEWS, VIEW_COLORS, lobes, strict=True):
        axes.plot(angles, lobe, color=color, linewidth=1.2, label=f"viewer at {view:g}°")
    largest = max(float(lobe.max()) for lobe in lobes) or 1.0
    for view, color in zip(VIEWS, VIEW_COLORS, strict=True):
        mark = [largest, 1.1 * largest]
        axes.plot([np.radians(view)] * 2, mark, color=color, linewidth=2.5)
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    if model.lights == "front":
        axes.set_thetalim(-0.5 * np.pi, 0.5 * np.pi)
    axes.set_rlim(0.0, 1.1 * largest)
    rings = [0.5 * largest, largest]
    axes.set_yticks(rings, [f"{each:.2g}" for each in rings])
    quantity = "value" if model.node == FIBER else "value times cosine"
    axes.set_title(f"{quantity}, mean of the channels, 1/sr")
    below = (0.5, 0.02 if model.lights == "front" else -0.1)
    axes.legend(loc="upper center", bbox_to_anchor=below, ncols=3, fontsize=7, frameon=False)


def _draw_albedo(axes: Axes, model: Drawn, inputs: Mapping[str, ArrayLike]) -> None:
    """Directional albedo over the angle of the viewer."""
    degrees = np.linspace(0.0, 89.5, 60)
    albedo = model.albedo_dir(np.cos(np.radians(degrees)), **inputs)
    channels = albedo[:, np.newaxis] if albedo.ndim == 1 else albedo
    gray = bool((channels == channels[:, :1]).all())
    colored = channels.shape[1] == 3 and not gray
    colors = CHANNEL_COLORS if colored else ("#444444",) * channels.shape[1]
    names = ("red", "green", "blue") if colored else ("all channels",) * channels.shape[1]
    for channel, color, name in zip(channels.T, colors, names, strict=True):
        axes.plot(degrees, channel, color=color, linewidth=1.2, label=name)
    if colored:
        axes.legend(fontsize=7, frameon=False)
    axes.set(xlim=(0.0, 90.0), xlabel="viewer's angle, degrees", title="directional albedo")
    axes.set_ylim(0.0, max(1.05, 1.05 * float(channels.max())))
    axes.set_xticks(range(0, 91, 15))


def _draw_density(axes: Axes, model: Drawn, inputs: Mapping[str, ArrayLike]) -> None:
    """Density of samples over the angle of the light, and the density for zero variance."""
    axes.set(title="density of samples, 1/sr", xlabel="light's angle, degrees")
    angles, lobes = _lobes(model, inputs)
    for view, color, lobe in zip(VIEWS, VIEW_COLORS, lobes, strict=True):
        pdf = model.pdf(_plane(np.radians(view)), _plane(angles), **inputs)
        albedo = float(np.mean(model.albedo_dir(np.cos(np.radians(view)), **inputs)))
        axes.plot(np.degrees(angles), pdf, color=color, linewidth=1.2)
        if albedo > 0.0:
            axes.plot(np.degrees(angles), lobe / albedo, color=color, linewidth=2.5, alpha=0.3)
    exact = f"value{'' if model.node == FIBER else ' times cosine'}, over the albedo"
    axes.plot([], [], color="#444444", linewidth=1.2, label="density")
    axes.plot([], [], color="#444444", linewidth=2.5, alpha=0.3, label=exact)
    first, *_, last = np.degrees(angles).round()
    axes.set_xticks(np.linspace(first, last, 7))
    axes.set_ylim(0.0, None)
    axes.legend(fontsize=7, frameon=False)
