# SPDX-License-Identifier: Apache-2.0
"""Fills templates of HTML pages, and embeds images. The extra `report` must be installed."""

import base64
import io
from collections.abc import Callable, Generator, Mapping
from hashlib import sha256
from importlib.resources import files
from typing import Any

import matplotlib
import numpy as np
from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from numpy.typing import NDArray
from PIL import Image

from mxeon.io.srgb import NOT_FINITE
from mxeon.report.formats import LOOKS, number, share, unbroken

SHOWN_SIZE = 256  # maximum pixels on a side of embedded pictures; larger pictures are subsampled
DIFFERENCE_COLORS = matplotlib.colormaps["inferno"]
DIFFERENCE_CODES = DIFFERENCE_COLORS(np.arange(DIFFERENCE_COLORS.N), bytes=True)[:, :3]
NOT_JUDGED = (96, 99, 104)
FAST = 1  # level of zlib with a third of the time and 4/3 of the bytes of the default level


def generate_page(
    package: str, name: str, filters: Mapping[str, Callable[..., Any]], **values: Any
) -> Generator[str, None, None]:
    """Generate a page in pieces from a package's template and script. No other script can run."""
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
    whole = template.generate(script=Markup(script), script_hash=digest, **values)
    yield from map(unbroken, whole)


def picture_uri(pixels: NDArray[np.uint8], largest: int = SHOWN_SIZE) -> str:
    """Encode a picture, (size, size, 3), as a data URI of at most `largest` pixels on a side."""
    step = -(-len(pixels) // largest)
    buffer = io.BytesIO()
    shown = np.ascontiguousarray(pixels[::step, ::step])
    Image.fromarray(shown).save(buffer, "png", compress_level=FAST)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def difference_pixels(difference_map: NDArray[np.float64], scale: float) -> NDArray[np.uint8]:
    """Color a difference map, (size, size), by DIFFERENCE_COLORS, which span 0 to `scale`.

    Infinite differences are magenta. Pixels that were not judged are NaN in the map, and become
    gray.
    """
    finite = np.isfinite(difference_map)
    steps = np.where(finite, difference_map, 0.0) * (len(DIFFERENCE_CODES) / scale)
    colors = DIFFERENCE_CODES[np.minimum(steps, len(DIFFERENCE_CODES) - 1).astype(np.intp)]
    colors[~finite] = NOT_FINITE
    colors[np.isnan(difference_map)] = NOT_JUDGED
    return colors


def difference_gradient() -> str:
    """A CSS gradient that shows DIFFERENCE_COLORS from left to right."""
    colors = (matplotlib.colors.to_hex(DIFFERENCE_COLORS(at)) for at in np.linspace(0, 1, 9))
    return f"linear-gradient(to right, {', '.join(colors)})"
