# SPDX-License-Identifier: Apache-2.0
"""Makes the images in `textures/`: `python make_textures.py [FOLDER]`.

Colors are chosen as sRGB code values, as in a paint program. The pixels are the same on every
machine, because they are computed from seeded random numbers by sums, products and square roots,
which IEEE 754 rounds alike everywhere. All images are tileable, and twice as wide as high, so that
bricks keep their shape under a latitude-longitude mapping.
"""

import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

COLUMNS, ROWS = 8, 12
BRICK = (16, 48)  # height and width in pixels, including half of a joint on each side
SEED = 20250304

# sRGB code values of the lightest and darkest fired clay, of burnt clay, and of joints.
PALE, DARK = np.array([0.72, 0.40, 0.28]), np.array([0.52, 0.22, 0.16])
BURNT, MORTAR = np.array([0.33, 0.21, 0.20]), np.array([0.68, 0.65, 0.59])
BURNT_SHARE = 0.12

# sRGB code values of wood that grows early and late in a year.
EARLY, LATE = np.array([0.72, 0.47, 0.26]), np.array([0.42, 0.22, 0.11])
YEARS = 14  # growth rings across the image


def tileable_noise(rng, shape, cells):
    """Value noise in [0, 1] on an image of `shape` pixels with `cells` lattice cells."""
    lattice = rng.random(cells)
    for axis, (length, count) in enumerate(zip(shape, cells, strict=True)):
        position = (np.arange(length) + 0.5) * count / length
        cell = position.astype(int)
        part = position - cell
        blend = part * part * (3.0 - 2.0 * part)
        blend = blend[:, None] if axis == 0 else blend[None, :]
        low, high = (np.take(lattice, (cell + step) % count, axis=axis) for step in (0, 1))
        lattice = low + (high - low) * blend
    return lattice


def bricks():
    """Index of the brick at each pixel, and the signed distance in pixels from the face of the
    brick. The distance is negative on the face.
    """
    y, x = np.mgrid[: ROWS * BRICK[0], : COLUMNS * BRICK[1]]
    row = y // BRICK[0]
    shifted = x + (row % 2) * BRICK[1] // 2
    index = row * COLUMNS + shifted // BRICK[1] % COLUMNS
    down = np.abs(y % BRICK[0] + 0.5 - BRICK[0] / 2)
    across = np.abs(shifted % BRICK[1] + 0.5 - BRICK[1] / 2)
    # The face is a box with rounded corners, one pixel smaller than the cell on every side.
    corner = 3.0
    outside_y = np.maximum(0.0, down - (BRICK[0] / 2 - 1.0 - corner))
    outside_x = np.maximum(0.0, across - (BRICK[1] / 2 - 1.0 - corner))
    distance = np.sqrt(outside_y * outside_y + outside_x * outside_x) - corner
    return index, distance


def images():
    """An image of color as sRGB code values in [0, 1], and an image of roughness in [0, 1]."""
    rng = np.random.default_rng(SEED)
    index, distance = bricks()
    shape = index.shape
    # Each brick has random numbers for tone, burning and roughness.
    tone, burnt, rough = (rng.random(ROWS * COLUMNS)[index] for _ in range(3))
    coarse = tileable_noise(rng, shape, (24, 48))
    fine = tileable_noise(rng, shape, (96, 192))
    grain = 0.6 * coarse + 0.4 * fine - 0.5
    # Noise moves the border of the face by up to a pixel, like weathering.
    joint = np.clip(distance + 2.0 * grain + 0.5, 0.0, 1.0)[..., None]
    face = DARK + (PALE - DARK) * np.clip(tone + 0.5 * grain, 0.0, 1.0)[..., None]
    is_burnt = burnt < BURNT_SHARE
    face = np.where(is_burnt[..., None], BURNT, face) * (1.0 + 0.35 * grain[..., None])
    mortar = MORTAR * (1.0 + 0.25 * grain[..., None])
    color = face + (mortar - face) * joint
    face_roughness = np.where(is_burnt, 0.45, 0.7 + 0.2 * rough) + 0.1 * grain
    roughness = face_roughness + (0.95 - face_roughness) * joint[..., 0]
    return np.clip(color, 0.0, 1.0), np.clip(roughness, 0.0, 1.0)


def wood():
    """An image of wood as sRGB code values in [0, 1], with vertical grain."""
    rng = np.random.default_rng(SEED + 1)
    shape = (ROWS * BRICK[0], COLUMNS * BRICK[1])
    bend = tileable_noise(rng, shape, (2, 7))
    fibers = tileable_noise(rng, shape, (6, 128)) - 0.5
    pores = tileable_noise(rng, shape, (16, 192))
    year = np.arange(shape[1]) * YEARS / shape[1] + 2.5 * bend + 0.15 * fibers
    part = year - np.floor(year)
    # Wood gets darker slowly in a year, and the dark part ends abruptly.
    late = part * part * np.clip(8.0 * (1.0 - part), 0.0, 1.0)
    color = EARLY + (LATE - EARLY) * late[..., None]
    dark = 1.0 + 0.25 * fibers - 0.3 * np.clip(4.0 * pores - 3.2, 0.0, 1.0)
    return np.clip(color * dark[..., None], 0.0, 1.0)


def save(path, image, space):
    """Write an image with values in [0, 1] as PNG with the name of its color space."""
    pixels = np.floor(np.atleast_3d(image) * 255.0 + 0.5).astype(np.uint8)
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.UINT8)
    spec.attribute("oiio:ColorSpace", space)
    spec.attribute("Description", "Made by mxeon's examples/make_textures.py; Apache-2.0")
    output = oiio.ImageOutput.create(str(path))
    if output is None or not output.open(str(path), spec):
        raise OSError(f"{path} cannot be written: {output.geterror() or oiio.geterror()}")
    output.write_image(pixels)
    output.close()


def main(folder):
    """Write the images to a folder."""
    color, roughness = images()
    save(Path(folder) / "brick_color.png", color, "srgb_rec709_scene")
    save(Path(folder) / "brick_roughness.png", roughness, "data")
    save(Path(folder) / "wood_color.png", wood(), "srgb_rec709_scene")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "textures")
