# SPDX-License-Identifier: Apache-2.0
"""What the stage puts on the screen, and when: exposure, comparisons, idleness, loss of the context."""

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.explorer import page, page_data
from mxeon.io.files import write_text
from mxeon.io.srgb import srgb_encoded
from tests.explorer.browser import until
from tests.explorer.stage import (
    CLOCK,
    frame,
    model_sources,
    opened_stage,
    picture,
    settle,
    side,
    view,
    written,
)

# Noise of half a step against bands, half a step of rounding, and one for the average of frames.
STEPS = 2
# Of explorer/src/stage/colors.ts.
STOPS = [
    (0.02, 0.19, 0.38),
    (0.13, 0.4, 0.67),
    (0.4, 0.66, 0.84),
    (0.74, 0.86, 0.93),
    (0.95, 0.95, 0.94),
    (0.99, 0.84, 0.7),
    (0.95, 0.6, 0.36),
    (0.8, 0.3, 0.14),
    (0.45, 0.11, 0.04),
]
COUNT = """() => {
    const gl = WebGL2RenderingContext.prototype, draw = gl.drawArrays;
    globalThis.draws = 0;
    gl.drawArrays = function (...all) { globalThis.draws += 1; return draw.apply(this, all); };
}"""
FRAMES = """count => new Promise(done => {
    const next = () => count-- > 0 ? requestAnimationFrame(next) : done(globalThis.draws);
    next();
})"""
# The canvas without the handles above it, on whole pixels.
ALONE = """.picture > :not(canvas) { display: none !important }
canvas { position: fixed !important; inset: 0 auto auto 0; z-index: 9;
         width: 140px !important; height: 100px !important }"""
LISTEN = "globalThis.said = []; mxeon.stage.onStatus(status => globalThis.said.push(status))"
LOSE = """() => {
    const gl = document.querySelector("canvas").getContext("webgl2");
    globalThis.loss = gl.getExtension("WEBGL_lose_context");
    globalThis.loss.loseContext();
}"""


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    return written(tmp_path_factory.mktemp("explorer") / "screen.html")


@pytest.fixture(scope="module")
def stage(browser, address):
    with opened_stage(browser, address, bypass_csp=True) as shown:
        shown.add_style_tag(content=ALONE)
        shown.evaluate(COUNT)
        shown.evaluate(LISTEN)
        yield shown


@pytest.fixture(scope="module")
def sources(stage):
    return model_sources(stage)


def screen(stage, tmp_path):
    """The canvas as the screen shows it, 8 bits a channel."""
    file = tmp_path / "screen.png"
    stage.locator("canvas").screenshot(path=file)
    return oiio.ImageBuf(str(file)).get_pixels(oiio.UINT8)[..., :3].astype(int)


def inner(stage, shape, reach=0.75):
    """Pixels of the sphere away from its rim."""
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


def test_flicker_shows_one_side_and_the_wipe_splits_them(stage, sources):
    black = {"light": None, "surroundings": "uniform", "comparison": "flicker"}
    for shown in ("left", "right"):
        view(stage, side(sources["fon_white_lobe"]), side(sources["qon"]), shown=shown, **black)
        assert (frame(stage) == frame(stage, shown)).all()
    view(stage, side(sources["fon_white_lobe"]), side(sources["qon"]), wipe=0.25)
    whole, left, right = frame(stage), frame(stage, "left"), frame(stage, "right")
    edge = whole.shape[1] // 4
    assert (whole[:, : edge - 1] == left[:, : edge - 1]).all()
    assert (whole[:, edge + 1 :] == right[:, edge + 1 :]).all()
    assert (left != right).any()


def test_the_difference_map_has_the_colors_of_its_scale(stage, sources, tmp_path):
    even = {"light": None, "surroundings": "uniform", "comparison": "difference", "color": [1] * 3}
    # White FON loses energy and white Lambert none: the right one is brighter by up to 0.23.
    view(stage, side(sources["fon"]), side(sources["lambert"]), scale=0.3, **even)
    shown = screen(stage, tmp_path)
    difference = frame(stage)[..., 0]
    stops = np.array(STOPS)
    at = 4.0 + 4.0 * np.clip(difference / 0.3, -1.0, 1.0)
    linear = np.where(stops <= 0.04045, stops / 12.92, ((stops + 0.055) / 1.055) ** 2.4)
    mixed = [np.interp(at, np.arange(9), linear[:, k]) for k in range(3)]
    expected = srgb_encoded(np.stack(mixed, axis=-1)).astype(int)
    kept = inner(stage, shown.shape)
    assert np.abs(shown - expected)[kept].max() <= STEPS
    assert np.ptp(at[kept]) > 0.5


def test_nothing_is_drawn_when_nothing_changes(stage):
    view(stage, side("shader/eonlib"), side("shader/stock"))
    stage.wait_for_timeout(500)  # The probe measures soon after a picture.
    before = stage.evaluate("globalThis.draws")
    assert stage.evaluate(FRAMES, 10) == before
    view(stage, side("shader/eonlib"), side("shader/stock"), light="back")
    assert stage.evaluate("globalThis.draws") > before


def test_a_wipe_that_moves_draws_no_material_again(stage):
    view(stage, side("shader/eonlib"), side("shader/stock"), wipe=0.5)
    stage.evaluate(CLOCK, 0)  # as on a device that draws in no time, on which sizes stay
    draw = "wipe => mxeon.stage.draw({...mxeon.state(), wipe}, true)"
    stage.evaluate(draw, 0.4)
    stage.evaluate(FRAMES, 12)
    stage.evaluate("globalThis.draws = 0")
    stage.evaluate(draw, 0.6)
    assert stage.evaluate(FRAMES, 12) == 2  # the picture and the screen
    stage.evaluate("mxeon.stage.draw({...mxeon.state(), azimuth: 5}, true)")
    assert stage.evaluate(FRAMES, 12) == 2 + 4  # both materials too
    stage.evaluate(CLOCK, 1)
    stage.evaluate("mxeon.stage.draw(mxeon.state())")
    settle(stage)


def test_while_dragging_a_slow_picture_is_coarse_and_at_rest_full(stage):
    view(stage, side("shader/eonlib"))
    full = stage.evaluate("Object.values(mxeon.stage.size())")
    stage.evaluate(CLOCK, 1000)
    stage.evaluate("mxeon.stage.draw({...mxeon.state(), azimuth: 1})")
    stage.evaluate(FRAMES, 25)
    stage.evaluate("globalThis.said.length = 0")
    for azimuth in (10, 20, 30):
        stage.evaluate("a => mxeon.stage.draw({...mxeon.state(), azimuth: a}, true)", azimuth)
        stage.evaluate(FRAMES, 10)
    sizes = stage.evaluate("said.filter(each => each.kind === 'drawn').map(each => each.width)")
    assert 0 < max(sizes) < 0.5 * full[0]
    stage.evaluate(CLOCK, 1)
    stage.evaluate("mxeon.stage.draw(mxeon.state())")
    settle(stage)
    last = stage.evaluate("said.findLast(each => each.kind === 'drawn')")
    assert [last["width"], last["height"]] == full


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


def test_a_shader_that_does_not_compile_is_named_and_the_other_side_stays(browser, tmp_path):
    data = page_data()
    sources = [vars(each) for each in data.sources]
    first = type(data.sources[0])(**(sources[0] | {"pixel": sources[0]["pixel"] + "oops"}))
    file = tmp_path / "broken.html"
    write_text(file, page(type(data)(**(vars(data) | {"sources": (first, *data.sources[1:])}))))
    with opened_stage(browser, file.as_uri() + "#a=model/eon&b=model/eon") as shown:
        shown.evaluate(LISTEN)
        view(shown, side(sources[0]["id"]), side(sources[1]["id"]))
        said = shown.evaluate("said.filter(each => each.kind === 'error')")
        assert said[0]["source"] == sources[0]["id"]
        assert "syntax error" in said[0]["message"]
        assert frame(shown, "left").max() == 0.0
        assert frame(shown, "right").max() == 1.0
