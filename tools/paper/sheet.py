# SPDX-License-Identifier: Apache-2.0
"""Output of figures: data as CSV or EXR, and plots in one style."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import style
from matplotlib.figure import Figure
from matplotlib.rcsetup import cycler
from numpy.typing import ArrayLike, NDArray

from mxeon.hosts.gl import GlHost
from mxeon.io.files import replacing, write_text
from mxeon.io.images import write_exr
from mxeon.io.srgb import srgb_encoded
from tools.paper.tracer import Trace, trace

# Distinguishable with color blindness: after Okabe and Ito.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#4d4d4d", "#8c6bb1")
STYLE = {
    "svg.fonttype": "path",
    "svg.hashsalt": "mxeon",
    "font.size": 9,
    "axes.prop_cycle": cycler(color=COLORS),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.titlesize": 9,
    "grid.alpha": 0.2,
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 8,
}
# Without these, matplotlib adds a date and a description of itself.
METADATA = {"svg": dict.fromkeys(("Creator", "Date", "Format", "Type")), "png": {"Software": None}}


def styled() -> AbstractContextManager[None]:
    """Context in which plots have the style of the figures."""
    # The defaults, not a matplotlibrc of the working folder, which could start LaTeX.
    return style.context(["default", STYLE])


@dataclass(frozen=True)
class Sheet:
    """A folder for figures, and the resolution and samples of each."""

    folder: Path
    host: GlHost  # traces the pictures
    size: int = 256  # pixels on a side of a traced picture
    samples: int = 128  # paths per pixel
    draws: int = 1_000_000  # random directions for each point of a statistic

    def axes(
        self, rows: int, columns: int, width: float, height: float, **options: Any
    ) -> tuple[Figure, Any]:
        """A figure, and its axes as an array of `rows` times `columns`."""
        figure = Figure(figsize=(width, height), layout="constrained")
        return figure, figure.subplots(rows, columns, squeeze=False, **options)

    def table(self, name: str, columns: Mapping[str, ArrayLike]) -> None:
        """Write columns of equal length, by their names, as CSV."""
        rows = np.stack([np.ravel(column) for column in columns.values()], axis=-1)
        lines = [",".join(columns), *(",".join(f"{x:.9g}" for x in row) for row in rows)]
        write_text(self.folder / f"{name}.csv", "\n".join(lines) + "\n")

    def plot(self, name: str, figure: Figure, suffix: str = "svg") -> None:
        with replacing(self.folder / f"{name}.{suffix}") as path:
            figure.savefig(path, dpi=150, metadata=METADATA[suffix])

    def trace(self, picture: Mapping[str, Any], **changes: Any) -> NDArray[np.float32]:
        """A traced linear picture; size and samples are the sheet's unless `changes` has them."""
        settings = {"size": self.size, "samples": self.samples} | changes
        return trace(self.host, Trace(**{**picture, **settings}))

    def pictures(
        self,
        name: str,
        rows: Sequence[Sequence[NDArray[Any]]],
        titles: Sequence[str],
        labels: Sequence[str] | None = None,
    ) -> None:
        """Write rows of linear pictures: as one EXR, and as a plot with titles above them."""
        whole = np.concatenate([np.concatenate(row, axis=1) for row in rows], axis=0)
        write_exr(self.folder / f"{name}.exr", whole, {"titles": ", ".join(titles)})
        count = len(rows[0])
        figure, axes = self.axes(len(rows), count, 1.9 * count + 0.2, 1.9 * len(rows) + 0.3)
        for row, cells in zip(rows, axes, strict=True):
            for image, cell in zip(row, cells, strict=True):
                cell.imshow(srgb_encoded(image), interpolation="bicubic")
                cell.set(xticks=[], yticks=[])
                cell.spines[:].set_visible(False)
        for cell, title in zip(axes[0], titles, strict=True):
            cell.set_title(title)
        for cell, label in zip(axes[:, 0], labels or [""] * len(rows), strict=True):
            cell.set_ylabel(label)
        self.plot(name, figure, "png")
