# SPDX-License-Identifier: Apache-2.0
"""Figures 1, 2, 4, 5, 8, 9, 10 and 14 of [Portsmouth2025]: traced pictures of an open ball.

The paper's objects are meshes; ours is an analytic ball, cut open so that it lights itself.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mxeon.models.table import diffuse_model
from tools.paper.curves import label
from tools.paper.sheet import Sheet


def _unit(x: float, y: float, z: float) -> tuple[float, float, float]:
    length = float(np.linalg.norm((x, y, z)))
    return x / length, y / length, z / length


EYE = _unit(0.0, 0.42, 1.0)
FRONT, SIDE = _unit(-0.15, 0.6, 1.0), _unit(-1.0, 0.6, 0.3)
VIEW = {"eye": EYE, "height": -0.1, "half_width": 1.35}
# A floor, and enough light from everywhere to see into the shadows.
STAGE = VIEW | {"bounces": 8, "floor": 0.35, "environment": 0.12}
FURNACE = VIEW | {"bounces": 50, "environment": 1.0, "rho": (1.0, 1.0, 1.0)}
# Seen along z and lit like this, QON has its dark ring in the middle of a ball.
RING = {"light": _unit(-0.8, 0.6, 1.0), "opened": False, "bounces": 1, "half_width": 1.05}
CLAY = (0.8, 0.38, 0.18)
# The models of Figure 4, each with a shader function to trace with.
GALLERY = {
    "a": ("lambert", "oren_nayar", "qon", "qon_footnote"),
    "b": ("qon_fujii", "fon", "eon", "eon_approx"),
}
# Exposures below 1, so that values above white remain visible.
FURNACE_SHOWN, LOBES_SHOWN = 0.8, 0.75


def look(name: str, part: float = 1.0) -> dict[str, Any]:
    """A model at a part of its largest roughness, and the sampler that suits it."""
    row = diffuse_model(name)
    if not row.parameter:
        return {"model": name, "parameter": 0.0, "sampler": "cosine"}
    sampler = "eon" if name in ("eon", "eon_approx") else "eon_cltc"
    return {"model": name, "parameter": part * row.largest, "sampler": sampler}


def title(sheet: Sheet) -> None:
    """Figure 1: Lambert, and QON and EON at the highest roughness, lit from front and side."""
    names = ("lambert", "qon", "eon")
    _lit(sheet, "figure_01", names, 1.0, {"front-lit": FRONT, "side-lit": SIDE})


def backscattering(sheet: Sheet) -> None:
    """Figure 2: Lambert, and QON, FON, EON at the highest roughness, lit from the viewer."""
    names = ("lambert", "qon", "fon", "eon")
    _lit(sheet, "figure_02", names, 1.0, {"lit from the eye": EYE})


def gallery(sheet: Sheet) -> None:
    """Figure 4: the models at half their largest roughness, as in Figure 3."""
    for part, names in GALLERY.items():
        _lit(sheet, f"figure_04{part}", names, 0.5, {"front-lit": FRONT, "side-lit": SIDE})


def _lit(
    sheet: Sheet,
    name: str,
    models: Sequence[str],
    part: float,
    lights: Mapping[str, tuple[float, float, float]],
) -> None:
    """Draw models from left to right, lights from top to bottom."""
    rows = [
        [sheet.trace(STAGE | look(each, part), rho=CLAY, light=light) for each in models]
        for light in lights.values()
    ]
    sheet.pictures(name, rows, [label(each) for each in models], list(lights))


def furnaces(sheet: Sheet) -> None:
    """Figures 5, 8, 9: QON, FON and EON, each with one bounce, the same with more contrast, and in a white furnace."""
    for figure, name in (("figure_05", "qon"), ("figure_08", "fon"), ("figure_09", "eon")):
        bounce = sheet.trace(VIEW | look(name), rho=CLAY, light=FRONT)
        ring = sheet.trace(RING | look(name))
        furnace = sheet.trace(FURNACE | look(name))
        row = [bounce, _contrast(ring), FURNACE_SHOWN * furnace]
        titles = [f"{label(name)}, one bounce", "one bounce, contrast", "white furnace, 50 bounces"]
        sheet.pictures(figure, [row], titles)
        columns = {"mean": furnace.mean(dtype=np.float64), "least": furnace.min()}
        sheet.table(f"{figure}_furnace", columns)


def _contrast(image: NDArray[np.float32]) -> NDArray[Any]:
    """The brighter part of the lit pixels, stretched from black to white."""
    low, high = np.quantile(image[image.max(axis=-1) > 0.02], (0.3, 0.995))
    stretched: NDArray[Any] = (image - low) / (high - low)
    return stretched


def lobes(sheet: Sheet) -> None:
    """Figure 10: QON, and the single and the multiple scattering of EON, for three colors."""
    columns = {
        "QON": look("qon"),
        "EON, single": look("fon") | {"model": "eon_single"},
        "EON, multiple": look("eon") | {"model": "eon_multiple"},
        "EON": look("eon"),
    }
    colors = {"white": (0.95,) * 3, "clay": CLAY, "green": (0.12, 0.55, 0.2)}
    lit = VIEW | {"bounces": 1, "light": FRONT}
    rows = [
        [LOBES_SHOWN * sheet.trace(lit | each, rho=rho) for each in columns.values()]
        for rho in colors.values()
    ]
    sheet.pictures("figure_10", rows, list(columns), list(colors))


def noise(sheet: Sheet) -> None:
    """Figure 14: EON at roughness 1 with 50 samples and 50 bounces, by three samplers."""
    samplers = {"cosine": "cosine", "eon_cltc": "CLTC + uniform", "eon": "exact"}
    lights: dict[str, dict[str, Any]] = {
        "uniform light": {"environment": 1.0},
        "distant light": {"environment": 0.0, "light": FRONT, "floor": 0.35},
    }
    rows, columns = [], {}
    for light, lit in lights.items():
        still = VIEW | lit | look("eon") | {"rho": (0.9, 0.75, 0.6), "bounces": 50}
        truth = sheet.trace(still, samples=8 * sheet.samples, seed=1)
        traced = [sheet.trace(still, sampler=name, samples=50) for name in samplers]
        for name, image in zip(samplers, traced, strict=True):
            columns[f"{name} {light}"] = np.sqrt(np.mean((image - truth) ** 2, dtype=np.float64))
        rows += [traced, [4.0 * np.abs(image - truth) for image in traced]]
    labels = [text for light in lights for text in (light, "4 |error|")]
    sheet.pictures("figure_14", rows, list(samplers.values()), labels)
    sheet.table("figure_14_rms_error", columns)
