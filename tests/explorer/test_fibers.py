# SPDX-License-Identifier: Apache-2.0
"""Hair on the fibers of the stage: its curve lies along them, and light comes through."""

import numpy as np
import pytest

from mxeon.explorer.sources import MATERIALS
from mxeon.models.hair import DEFAULTS, chiang_hair_bcsdf
from mxeon.shaders.generation import generate
from tests.explorer.stage import frame, opened_stage, side, towards, view

EYE = np.array([0.0, 0.0, 8.0])
CENTER = np.array([0.0, -1.9, 0.0])  # of the bend: explorer/src/stage/scenes.ts
HAIR = "lobe/hair"
# A place 8 away is known to 5e-7 in float32, its normal on a fiber of radius 0.085 to 6e-6. A lobe of a
# width of 0.3 changes by some 3 times as much of itself, and one of its normals is what is drawn.
RELATIVE = 2e-5


@pytest.fixture(scope="module")
def stage(browser, address):
    with opened_stage(browser, address) as page:
        yield page


def expected(pick, along):
    """pi f at a point, of hair whose curve has this direction there."""
    [material] = (each for each in MATERIALS if each.key == HAIR)
    shader = generate(material.text, "essl", lights=True)[0]
    own = {port.path.rpartition("/")[2]: np.asarray(port.value) for port in shader.inputs}
    normal, position = np.array(pick["normal"]), np.array(pick["position"])
    x = along(position)
    x = x - np.dot(x, normal) * normal
    x /= np.linalg.norm(x)
    axes = np.stack([x, np.cross(normal, x), normal])
    wo = EYE - position
    pair = [axes @ (wo / np.linalg.norm(wo)), axes @ towards("side")]
    inputs = {name: own.get(name, np.asarray(value)) for name, value in DEFAULTS.items()}
    wo, wi = (each[np.newaxis] for each in pair)
    return np.pi * chiang_hair_bcsdf(wo, wi, **inputs)[0]


def along_ring(position):
    tangent = np.cross(position - CENTER, [0.0, 0.0, 1.0])
    return tangent / np.linalg.norm(tangent)


def test_hair_lies_along_its_fibers(stage):
    view(stage, side(f"{HAIR}/eonlib", flag=False), shape="fiber")
    pixels = frame(stage)
    height, width = pixels.shape[:2]
    errors, mistakes = [], []
    for column in range(width // 8, width, width // 5):
        rows = np.flatnonzero((pixels[:, column, 3] == 1.0) & (pixels[:, column, 0] > 1e-3))
        for row in rows[:: max(len(rows) // 4, 1)]:
            place = [(column + 0.5) / width, (row + 0.5) / height]
            pick = stage.evaluate("([x, y]) => mxeon.stage.pick(x, y, mxeon.state())", place)
            own = expected(pick, along_ring)
            other = expected(pick, lambda position: np.array([1.0, 0.0, 0.0]))
            errors.append(np.abs(pixels[row, column, :3] / own - 1.0).max())
            mistakes.append(np.abs(pixels[row, column, :3] / other - 1.0).max())
    assert len(errors) > 5
    assert max(errors) < RELATIVE < max(mistakes)


def test_light_from_behind_comes_through(stage):
    view(stage, side(f"{HAIR}/eonlib", flag=False), shape="fiber", light="back")
    assert frame(stage)[..., :3].max() > 0.1
