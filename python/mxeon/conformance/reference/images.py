# SPDX-License-Identifier: Apache-2.0
"""Images as shaders read them: bilinear, periodic, in float64."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.reference.operations import Values
from mxeon.errors import NotRun
from mxeon.hosts.textures import read_texture

FILES = 16  # of which the values at the points of a picture are kept
CHANNELS = {"float": 1, "color3": 3}  # of an image, by the type that it is read as


def lookup(
    node: mx.Node, texcoord: Values | None, linear: Callable[[mx.Element, Values], Values]
) -> Callable[[], Values]:
    """Function that reads an image node: texel centers at half-integers, v = 0 at the bottom.

    Raise NotRun if the image is read in another way.
    """
    if texcoord is None or node.getInput("texcoord") is not None:
        raise NotRun("reference: images are read at the sphere's own coordinates only")
    file = node.getInput("file")
    if not file or not file.getValueString():
        raise NotRun("reference: an image must name its file itself")
    if file.hasUnit():
        raise NotRun("reference: an image must hold no lengths")
    channels = CHANNELS.get(node.getType(), 0)
    values = _texels(file.getValueString(), texcoord.tobytes())
    if not 0 < channels <= values.shape[-1]:
        raise NotRun(
            f"reference: {file.getValueString()}: must be read as float, or as color3 from an "
            f"image of 3 channels; got {node.getType()} from {values.shape[-1]}"
        )
    value = linear(file, values[:, :channels]) if channels == 3 else values[:, :channels]
    return lambda: value


@lru_cache(maxsize=FILES)
def _texels(path: str, texcoord: bytes) -> Values:
    """Values of all channels of an image at points, (N, channels)."""
    where = np.frombuffer(texcoord).reshape(-1, 2)
    return _bilinear(read_texture(path), where)


def _bilinear(texels: NDArray[np.float32], texcoord: Values) -> Values:
    height, width = texels.shape[:2]
    texel = texcoord * [width, height] - 0.5
    corner = np.floor(texel).astype(int)
    u, v = (texel - corner).T[..., None]
    x, y = corner.T

    def at(dx: int, dy: int) -> Values:
        return np.asarray(texels[(y + dy) % height, (x + dx) % width], np.float64)

    lower = at(0, 0) * (1.0 - u) + at(1, 0) * u
    upper = at(0, 1) * (1.0 - u) + at(1, 1) * u
    return np.asarray(lower * (1.0 - v) + upper * v)
