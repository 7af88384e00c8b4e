# SPDX-License-Identifier: Apache-2.0
"""Pictures for browsers without WebGL2, drawn with the float64 models."""

from base64 import b64encode
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mxeon.explorer.data import Still
from mxeon.io.images import write_png
from mxeon.jobs.signals import temporary_folder
from mxeon.models.table import model
from mxeon.shaders.scene import VIEW, local_directions, sphere

SIZE = 176
LIGHT = (0.0, 0.8, -0.6)  # from above and behind
COLOR = (0.8, 0.4, 0.1)
MODELS = ("eon", "eon_clamped", "qon", "lambert")


def stills() -> tuple[Still, ...]:
    """A sphere of the color (0.8, 0.4, 0.1) and roughness 1, lit from behind."""
    return tuple(Still(model(name).title, _address(picture(name))) for name in MODELS)


def picture(name: str) -> NDArray[np.float64]:
    """Radiance of a sphere of one model, (SIZE, SIZE, 3): pi f cos(theta_i)."""
    points = sphere(SIZE)
    normals = points.normal[points.mask]
    wo, wi = (local_directions(normals, each) for each in (VIEW, LIGHT))
    lit = wi[:, 2] > 0.0
    row = model(name)
    parameter = [1.0] if row.parameter else []
    values = np.zeros((len(normals), 3))
    values[lit] = np.pi * row.brdf(wo[lit], wi[lit], COLOR, *parameter) * wi[lit, 2:]
    image = np.zeros((SIZE, SIZE, 3))
    image[points.mask] = values
    return image


def _address(image: NDArray[np.float64]) -> str:
    """An image as a PNG in a data: address."""
    with temporary_folder("mxeon-still-") as folder:
        path = Path(folder, "still.png")
        write_png(path, image.astype(np.float32), {})
        return f"data:image/png;base64,{b64encode(path.read_bytes()).decode()}"
