# SPDX-License-Identifier: Apache-2.0
"""The screen shows the stage's radiance with the chosen exposure, also after a lost GL context."""

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.io.srgb import srgb_encoded
from tests.explorer.browser import until
from tests.explorer.stage import LISTEN, frame, opened_stage, picture, settle, side, view

# Tolerance in 8-bit steps. Dithering and rounding add half a step each. Averaging adds a step.
STEPS = 2
# CSS that hides the handles above the canvas and aligns the canvas to whole pixels.
ALONE = """.picture > :not(canvas) { display: none !important }
canvas { position: fixed !important; inset: 0 auto auto 0; z-index: 9;
         width: 140px !important; height: 100px !important }"""
LOSE = """() => {
    const gl = document.querySelector("canvas").getContext("webgl2");
    globalThis.loss = gl.getExtension("WEBGL_lose_context");
    globalThis.loss.loseContext();
}"""


@pytest.fixture(scope="module")
def stage(browser, address):
    with opened_stage(browser, address, bypass_csp=True) as shown:
        shown.add_style_tag(content=ALONE)
        shown.evaluate(LISTEN)
        yield shown


def screen(stage, tmp_path):
    file = tmp_path / "screen.png"
    stage.locator("canvas").screenshot(path=file)
    return oiio.ImageBuf(str(file)).get_pixels(oiio.UINT8)[..., :3].astype(int)


def inner(stage, shape, reach=0.75):
    """Mask of the sphere's pixels that are not near the rim."""
    diameter = stage.evaluate("mxeon.stage.diameter()")
    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    return np.hypot(x - shape[1] / 2, y - shape[0] / 2) < reach * diameter / 2


@pytest.mark.parametrize("exposure", [-1.0, 0.0, 1.5])
def test_the_screen_shows_the_radiance_with_its_exposure(stage, sources, tmp_path, exposure):
    even = {"light": None, "surroundings": "uniform", "exposure": exposure}
    view(stage, side(sources["eon"]), side(sources["lambert"]), wipe=0.5, **even)
    shown, radiance = screen(stage, tmp_path), frame(stage)
    assert shown.shape == (*radiance.shape[:2], 3)
    kept = inner(stage, shown.shape)
    expected = srgb_encoded(2.0**exposure * radiance[..., :3]).astype(int)
    assert np.abs(shown - expected)[kept].max() <= STEPS
    assert np.abs(shown - expected[:, ::-1])[kept].max() > STEPS


def test_a_lost_context_is_restored_with_the_same_picture(browser, address):
    with opened_stage(browser, address, allowed=("[.WebGL",)) as page:
        page.evaluate(LISTEN)
        view(page, side("shader/eonlib"), side("shader/stock"))
        before = picture(page)
        page.evaluate(LOSE)
        until(page, "said.some(each => each.kind === 'lost')")
        assert page.evaluate("mxeon.stage.pick(0.5, 0.5, mxeon.state())") is None
        page.evaluate("globalThis.loss.restoreContext()")
        until(page, "said.some(each => each.kind === 'restored')")
        settle(page)
        assert (picture(page) == before).all()
        assert before.max() > 0.1
