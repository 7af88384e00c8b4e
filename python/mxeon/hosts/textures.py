# SPDX-License-Identifier: Apache-2.0
"""Images that shaders read, which are textures, environments, and the irradiance of environments.

Images are float32 arrays (height, width, channels) of stored values. Shaders transform colors.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import ImageError
from mxeon.io.images import ImageWarning, open_image, read_image

if TYPE_CHECKING:
    from mxeon.shaders.document.policy import Policy
    from mxeon.shaders.generation import Shader

IRRADIANCE_SIZE = 32  # rows of an irradiance map, which is smooth
FIRST_TILE = {"<UDIM>": "1001", "<UVTILE>": "u1_v1"}  # MaterialX's names of the first tile
FILES = 16  # number of cached results of `texels_at`
RADIANCE_SIZE = 64  # minimum rows and columns of a map that is reduced before summing radiance


def texels_of(path: str | Path) -> int:
    """The number of pixels of a texture, according to the header of the file."""
    spec = open_image(path).spec()
    if spec.nchannels > 4:
        raise ImageError(f"{path}: must have at most 4 channels; got {spec.nchannels}")
    return int(spec.image_pixels())


def read_texture(path: str | Path) -> NDArray[np.float32]:
    """Pixels of a texture. Row 0 is at the bottom, where v = 0 in MaterialX.

    Only the tile [0, 1]^2 of a set of tiles is read, because this tile contains all texture
    coordinates of a sphere. A single channel is repeated in all colors, as in MaterialX. The result
    is then a view whose last stride is 0. Raises ImageError for more than four channels, and warns
    of non-finite values.
    """
    for token, word in FIRST_TILE.items():
        path = str(path).replace(token, word)
    texels_of(path)
    pixels = read_image(path)
    if reason := _not_finite(pixels):
        warnings.warn(ImageWarning(f"{path}: should hold finite numbers; {reason}"), stacklevel=2)
    gray = pixels.shape[-1] == 1
    return (np.broadcast_to(pixels, (*pixels.shape[:2], 3)) if gray else pixels)[::-1]


@lru_cache(maxsize=FILES)
def texels_at(path: str, texcoord: bytes) -> NDArray[np.float64]:
    """All channels of a texture at points, (N, channels), with bilinear interpolation."""
    texels = read_texture(path)
    height, width = texels.shape[:2]
    texel = np.frombuffer(texcoord).reshape(-1, 2) * [width, height] - 0.5
    corner = np.floor(texel).astype(int)
    u, v = (texel - corner).T[..., None]
    x, y = corner.T

    def at(dx: int, dy: int) -> NDArray[np.float64]:
        return np.asarray(texels[(y + dy) % height, (x + dx) % width], np.float64)

    lower = at(0, 0) * (1.0 - u) + at(1, 0) * u
    upper = at(0, 1) * (1.0 - u) + at(1, 1) * u
    return np.asarray(lower * (1.0 - v) + upper * v)


def read_latlong(environment: float | str | Path | None) -> NDArray[np.float32]:
    """Radiance of an environment as a latitude-longitude map whose row 0 is at +y."""
    if isinstance(environment, (str, Path)):
        pixels = read_image(environment)
        if pixels.shape[-1] < 3:
            channels = pixels.shape[-1]
            raise ImageError(
                f"{environment}: must have red, green and blue; got {channels} channels"
            )
        if reason := _not_finite(pixels[..., :3]):
            raise ImageError(f"{environment}: must hold finite numbers; {reason}")
        return pixels[..., :3]
    return np.full((1, 1, 3), environment or 0.0, dtype=np.float32)


def _not_finite(pixels: NDArray[np.float32]) -> str:
    """Description of the first non-finite value and the number of such values, or ""."""
    if np.isfinite([pixels.min(), pixels.max()]).all():  # NaN if any pixel is NaN
        return ""
    finite = np.isfinite(pixels)
    place = np.unravel_index(finite.argmin(), finite.shape)
    count = finite.size - np.count_nonzero(finite)
    return f"got {pixels[place]} at row {place[0]}, column {place[1]}, {count} in all"


def irradiance(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """Irradiance divided by pi for every surface normal, as a latitude-longitude map.

        (1 / pi) integral of L(omega) max(0, n . omega) d omega

    The result for a uniform environment is exactly the radiance.
    """
    if radiance.shape[:2] == (1, 1):
        return radiance
    coarse = reduced(radiance)
    incoming, solid_angle = latlong_directions(*coarse.shape[:2])
    normals, _ = latlong_directions(IRRADIANCE_SIZE, 2 * IRRADIANCE_SIZE)
    weights = np.maximum(0.0, normals @ incoming.T) * solid_angle
    weights /= weights.sum(axis=1, keepdims=True)
    pixels = (weights @ coarse.reshape(len(incoming), -1)).reshape(
        IRRADIANCE_SIZE, 2 * IRRADIANCE_SIZE, -1
    )
    irradiance: NDArray[np.float32] = pixels.astype(np.float32)
    return irradiance


def reduced(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """A smaller map of means over blocks of pixels. Sides stay at least RADIANCE_SIZE long."""
    high, wide = (max(1, size // RADIANCE_SIZE) for size in radiance.shape[:2])
    rows, columns = radiance.shape[0] // high, radiance.shape[1] // wide
    blocks = radiance[: rows * high, : columns * wide].reshape(rows, high, columns, wide, -1)
    means: NDArray[np.float32] = blocks.mean(axis=(1, 3))
    return means


def latlong_directions(rows: int, columns: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Direction and relative solid angle of each pixel in MaterialX's latitude-longitude maps."""
    polar = np.pi * (np.arange(rows) + 0.5) / rows
    azimuth = 2.0 * np.pi * ((np.arange(columns) + 0.5) / columns - 0.5)
    polar, azimuth = np.meshgrid(polar, azimuth, indexing="ij")
    x, z = np.sin(polar) * np.sin(azimuth), -np.sin(polar) * np.cos(azimuth)
    directions = np.stack([x, np.cos(polar), z], axis=-1).reshape(-1, 3)
    return directions, np.sin(polar).reshape(-1)


def image_files(shaders: Iterable[Shader]) -> tuple[str, ...]:
    """Distinct names of the images that shaders read."""
    inputs = (port for shader in shaders for port in shader.inputs)
    names = (str(port.value) for port in inputs if port.type == "filename" and port.value)
    return tuple(dict.fromkeys(names))


def check_images(shaders: Iterable[Shader], policy: Policy) -> None:
    """Refuse a document whose images are too large in total, before any image is read.

    Raises DocumentError if all images together have more pixels than the policy permits, and
    ImageError for an image that cannot be used.
    """
    from mxeon.shaders.document.references import files
    from mxeon.shaders.document.values import label

    shaders, texels = tuple(shaders), 0
    for file in {file for name in image_files(shaders) for file in files(Path(name))}:
        texels += texels_of(file)
        rule = f"{label(shaders[0].document)}: images must have"
        policy.check_limit("texels", texels, rule, "pixels together")
