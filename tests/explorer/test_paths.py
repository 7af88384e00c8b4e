# SPDX-License-Identifier: Apache-2.0
"""Path tracing on the stage: a white furnace shows every pixel white."""

import numpy as np
import pytest

from tests.explorer.stage import (
    CLOCK,
    frame,
    model_sources,
    opened_stage,
    side,
    view,
    written,
)
from tests.support.tolerances import EON_WEIGHT

SAMPLES = 16


@pytest.fixture(scope="module")
def stage(browser, tmp_path_factory):
    address = written(tmp_path_factory.mktemp("explorer") / "paths.html", "brick")
    with opened_stage(browser, address) as page:
        page.evaluate(
            "globalThis.said = []; mxeon.stage.onStatus(status => globalThis.said.push(status))"
        )
        page.evaluate(CLOCK, 0)
        yield page


@pytest.fixture(scope="module")
def sources(stage):
    return model_sources(stage)


def traced(stage, left, right=None, **patch):
    """Both sides after SAMPLES paths per pixel, and the last status of each kind."""
    stage.evaluate("said.length = 0")
    view(stage, left, right, **({"paths": True, "samples": SAMPLES} | patch))
    return {status["kind"]: status for status in stage.evaluate("said")}


def whole(stage, name):
    """The pixels all of whose paths met the sphere, and their centers' cosines."""
    status = stage.evaluate("said.findLast(status => status.kind === 'drawn')")
    pixels = frame(stage, name, (status["width"], status["height"]))
    height, width = pixels.shape[:2]
    diameter = 2 * round(min(width, height) / 2 / 1.14)
    y, x = np.mgrid[:height, :width] + 0.5
    squared = ((x - width / 2) ** 2 + (y - height / 2) ** 2) * 4 / diameter**2
    kept = (pixels[..., 3] == 1.0) & (squared < 1.0)
    assert kept.sum() > np.pi / 4 * (diameter - np.sqrt(2.0)) ** 2  # all that lie within as a whole
    return pixels[kept][:, :3], np.sqrt(1.0 - squared[kept])


def test_a_white_furnace_keeps_every_exact_path(stage, sources):
    white = {"color": [1, 1, 1], "light": None, "surroundings": "uniform"}
    status = traced(stage, side(sources["eon"]), side(sources["fon"]), **white)
    assert status["samples"]["done"] == SAMPLES
    measured, _ = whole(stage, "left")
    assert np.abs(measured - 1.0).max() < EON_WEIGHT
    assert whole(stage, "right")[0].mean() < 0.95
