# SPDX-License-Identifier: Apache-2.0
"""Path tracing on the stage makes white furnaces white, with models and with generated text."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from mxeon.shaders.generation import generate
from mxeon.shaders.library import examples_folder
from tests.explorer.browser import until
from tests.explorer.stage import CLOCK, LISTEN, frame, opened_stage, side, view, written
from tests.support.tolerances import EON_WEIGHT

SAMPLES = 16


@pytest.fixture(scope="module")
def stage(browser, tmp_path_factory):
    address = written(tmp_path_factory.mktemp("explorer") / "paths.html", "brick")
    with opened_stage(browser, address) as page:
        page.evaluate(LISTEN)
        page.evaluate(CLOCK, 0)
        yield page


def traced(stage, left, right=None, **patch):
    """Show both sides, trace all samples, and return the last status of each kind."""
    stage.evaluate("said.length = 0")
    view(stage, left, right, **({"paths": True, "samples": SAMPLES} | patch))
    return {status["kind"]: status for status in stage.evaluate("said")}


def whole(stage, name):
    """Pixels whose paths all hit the sphere, and the cosines at their centers."""
    status = stage.evaluate("said.findLast(status => status.kind === 'drawn')")
    pixels = frame(stage, name, (status["width"], status["height"]))
    height, width = pixels.shape[:2]
    diameter = 2 * round(min(width, height) / 2 / 1.14)
    y, x = np.mgrid[:height, :width] + 0.5
    squared = ((x - width / 2) ** 2 + (y - height / 2) ** 2) * 4 / diameter**2
    kept = (pixels[..., 3] == 1.0) & (squared < 1.0)
    # All pixels entirely inside the sphere's outline are kept.
    assert kept.sum() > np.pi / 4 * (diameter - np.sqrt(2.0)) ** 2
    return pixels[kept][:, :3], np.sqrt(1.0 - squared[kept])


@pytest.mark.parametrize("source", ["model", "shader/eonlib"])
def test_a_white_furnace_keeps_every_exact_path(stage, sources, source):
    white = {"color": [1, 1, 1], "light": None, "surroundings": "uniform"}
    eon = sources["eon"] if source == "model" else source
    status = traced(stage, side(eon), side(sources["fon"]), **white)
    assert status["samples"]["done"] == SAMPLES
    measured, _ = whole(stage, "left")
    assert np.abs(measured - 1.0).max() < EON_WEIGHT
    assert whole(stage, "right")[0].mean() < 0.95


def test_generated_text_is_traced_like_its_model(stage, sources):
    """Generated text takes color and roughness from the view, like the model."""
    traced(stage, side("shader/eonlib"), side(sources["eon"]), samples=256)
    text, model = (whole(stage, name)[0].mean(axis=0) for name in ("left", "right"))
    np.testing.assert_allclose(text, model, 0.01)


def test_the_example_traces_a_generated_text(browser, tmp_path):
    [shader] = generate(examples_folder() / "plaster.mtlx", "essl", profile="path")
    text = tmp_path / "plaster.essl"
    text.write_text(shader.stages["pixel"], encoding="utf-8")
    page = browser.new_page()
    page.set_default_timeout(600_000.0)
    page.goto((examples_folder() / "path_tracer.html").as_uri())
    page.set_input_files("input", text)
    until(page, "parseInt(document.querySelector('#said').textContent) > 1")
    canvas = Image.open(BytesIO(page.locator("canvas").screenshot()))
    page.close()
    pixels = np.asarray(canvas.convert("RGB"), float)
    ball, sky = pixels[200:300, 200:300].mean(axis=(0, 1)), pixels[:20].mean(axis=(0, 1))
    assert 255 > ball[0] > 1.2 * ball[2] and 255 > sky[2] > 1.1 * sky[0]
