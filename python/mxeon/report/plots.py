# SPDX-License-Identifier: Apache-2.0
"""Pages from templates, and images and plots inside them. Needs the `report` extra."""

import base64
import io
import re
from collections.abc import Callable, Generator, Mapping, Sequence
from hashlib import sha256
from importlib.resources import files
from typing import Any

import matplotlib
import numpy as np
from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from matplotlib import style
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from mxeon.conformance.results import AlbedoCurve
from mxeon.io.srgb import NOT_FINITE
from mxeon.models.lobe_plot import CHANNEL_COLORS
from mxeon.report.formats import LOOKS, number, share

# Larger pictures show every second, third, ... pixel; the files have all pixels.
SHOWN_SIZE = 256
DIFFERENCE_COLORS = matplotlib.colormaps["inferno"]
DIFFERENCE_CODES = DIFFERENCE_COLORS(np.arange(DIFFERENCE_COLORS.N), bytes=True)[:, :3]
NOT_JUDGED = (96, 99, 104)
# A placeholder for the page's text color until the plot is part of the page.
TEXT_COLOR = "#010203"
# Without these, matplotlib adds a description of itself, with addresses, to each plot.
NO_METADATA = dict.fromkeys(("Creator", "Date", "Format", "Type"))
FAST = 1  # zlib's level: a third of the time, and a third more bytes
STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "mxeon",
    "font.size": 9,
    "axes.edgecolor": TEXT_COLOR,
    "axes.labelcolor": TEXT_COLOR,
    "xtick.color": TEXT_COLOR,
    "ytick.color": TEXT_COLOR,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "grid.color": TEXT_COLOR,
    "grid.alpha": 0.12,
    "grid.linewidth": 0.6,
}


def generate_page(
    package: str, name: str, filters: Mapping[str, Callable[..., Any]], **values: Any
) -> Generator[str, None, None]:
    """Pieces of a page from a package's template and script; the page runs no other script."""
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("mxeon.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "share": share, "look": LOOKS.__getitem__, **filters}
    template = environment.get_template(f"{name}.html.jinja")
    script = files(package).joinpath(f"templates/{name}.js").read_text(encoding="utf-8")
    digest = base64.b64encode(sha256(script.encode()).digest()).decode()
    yield from template.generate(script=Markup(script), script_hash=digest, **values)


def picture_uri(pixels: NDArray[np.uint8]) -> str:
    """A picture (size, size, 3) as a data URI of a PNG of at most SHOWN_SIZE pixels on a side."""
    step = -(-len(pixels) // SHOWN_SIZE)
    buffer = io.BytesIO()
    shown = np.ascontiguousarray(pixels[::step, ::step])
    Image.fromarray(shown).save(buffer, "png", compress_level=FAST)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def difference_pixels(difference_map: NDArray[np.float64], scale: float) -> NDArray[np.uint8]:
    """A difference (size, size) in DIFFERENCE_COLORS, which span 0 to `scale`.

    Infinity is magenta. NaN marks pixels that were not judged and is gray.
    """
    finite = np.isfinite(difference_map)
    steps = np.where(finite, difference_map, 0.0) * (len(DIFFERENCE_CODES) / scale)
    colors = DIFFERENCE_CODES[np.minimum(steps, len(DIFFERENCE_CODES) - 1).astype(np.intp)]
    colors[~finite] = NOT_FINITE
    colors[np.isnan(difference_map)] = NOT_JUDGED
    return colors


def difference_gradient() -> str:
    """DIFFERENCE_COLORS from left to right, as a CSS gradient."""
    colors = (matplotlib.colors.to_hex(DIFFERENCE_COLORS(at)) for at in np.linspace(0, 1, 9))
    return f"linear-gradient(to right, {', '.join(colors)})"


def albedo_plot(curves: Sequence[AlbedoCurve], markers: Sequence[str], prefix: str) -> str:
    """Directional albedo over the cosine as an <svg> element: lines expected, markers measured.

    The curves are the same quantity on several hosts, with one of matplotlib's markers each; the first one's
    expectation is drawn. `prefix` makes identifiers unique in a page.
    """
    gray = len(set(curves[0].rho)) == 1
    buffer = io.StringIO()
    # The defaults, not a matplotlibrc of the working folder, which could start LaTeX.
    with style.context(["default", STYLE]):
        figure = Figure(figsize=(3.6, 2.4), layout="constrained", facecolor="none")
        axes = figure.subplots()
        for channel, color in enumerate((TEXT_COLOR,) if gray else CHANNEL_COLORS):
            axes.plot(curves[0].mu, curves[0].expected[:, channel], color=color, linewidth=1.2)
            for curve, marker in zip(curves, markers, strict=True):
                axes.plot(
                    curve.mu,
                    curve.measured[:, channel],
                    linestyle="none",
                    marker=marker,
                    markersize=4.5,
                    markeredgecolor=color,
                    markerfacecolor="none",
                    markevery=-(-len(curve.mu) // 24),
                )
        axes.set(xlim=(-0.03, 1.03), xlabel="cosine of the polar angle", ylabel="albedo")
        axes.margins(y=0.15)
        axes.set_facecolor("none")
        # The layout of an SVG canvas and savefig read SOURCE_DATE_EPOCH, which may be no number.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        canvas: Any = FigureCanvasSVG(figure)
        canvas.print_svg(buffer, metadata=NO_METADATA)
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :].replace(TEXT_COLOR, "currentColor")
    return re.sub(r'((?:\bid="|href="#|url\(#))', rf"\g<1>{prefix}", svg)
