# SPDX-License-Identifier: Apache-2.0
"""Page controls work by mouse and keyboard, the probe displays values, and texts can be copied."""

import re
import sys
from contextlib import contextmanager

import numpy as np
import pytest

import mxeon
from mxeon.models import eon_brdf
from tests.explorer.browser import DRAWN, judged, show, shows, state, until
from tests.support.command import output

# JavaScript that returns a checksum of all pixels.
PIXELS = "mxeon.stage.read().reduce((sum, value, k) => (31 * sum + value * (1 + k)) % 65521, 0)"


@contextmanager
def redrawn(page):
    """Context manager that asserts that the rendered radiance changes."""
    before = page.evaluate(PIXELS)
    yield
    until(page, f"before => {PIXELS} !== before", before)


@contextmanager
def recolored(page):
    """Context manager that asserts that the screen changes and the rendered radiance does not."""
    canvas = page.locator("canvas")
    before, radiance = canvas.screenshot(), page.evaluate(PIXELS)
    yield
    for _ in range(6000):
        if canvas.screenshot() != before:
            break
        page.wait_for_timeout(100)
    assert canvas.screenshot() != before and page.evaluate(PIXELS) == radiance


def fill(page, label, value):
    page.get_by_label(label, exact=True).fill(str(value))
    page.get_by_label(label, exact=True).blur()


def choose(page, group, option):
    page.get_by_role("group", name=group).get_by_role("radio", name=option, exact=True).check()


SLIDERS = [
    ("Roughness", "roughness", 0.5, redrawn),
    ("Light around", "azimuth", 40, redrawn),
    ("Light above", "elevation", -20, redrawn),
    ("Light strength", "light", 0.5, redrawn),
    ("Exposure", "exposure", 1.5, recolored),
]


@pytest.mark.parametrize(("label", "field", "value", "effect"), SLIDERS)
def test_a_slider_changes_the_view_and_the_picture(page, label, field, value, effect):
    with effect(page):
        fill(page, f"{label}, number", value)
        shows(page, **{field: value})
    slider = page.get_by_label(re.compile(f"^{label}( [a-z]+)?$")).first
    slider.focus()
    slider.press("ArrowLeft")
    assert state(page)[field] < value


@pytest.mark.parametrize(
    ("group", "option", "field", "value"),
    [
        ("Shape", "on a plane", "shape", "plane"),
        ("Shape", "cloth", "shape", "cloth"),
        ("Shape", "sphere", "shape", "sphere"),
        ("Shape", "hair", "shape", "fiber"),
        ("Environment", "white", "surroundings", "uniform"),
        ("Environment", "black", "surroundings", "none"),
        ("Environment", "sky", "surroundings", "sky"),
        ("Compare", "Difference", "comparison", "difference"),
    ],
)
def test_a_choice_changes_the_view_and_the_picture(page, group, option, field, value):
    with redrawn(page):
        choose(page, group, option)
        shows(page, **{field: value})


def test_the_color_changes_the_picture_and_the_albedo(page):
    albedo = page.locator(".albedos").inner_text()
    with redrawn(page):
        fill(page, "Color entered, green", 0.9)
    shows(page, color=[0.8, 0.9, 0.1])
    assert page.locator(".albedos").inner_text() != albedo
    page.get_by_label("Color entered, picker").fill("#ffffff")
    shows(page, color=[1, 1, 1])
    rows = page.locator(".albedos tbody tr")
    assert rows.nth(0).inner_text().count("1.000, 1.000, 1.000") == 2


def test_the_flag_is_drawn_and_judged(page):
    judged(page, "right", "not EON")
    page.locator(".side.right").get_by_role("checkbox", name="energy_compensation").uncheck()
    judged(page, "right", "not QON")
    assert "environment" in page.locator(".side.right .verdict").inner_text()
    page.locator(".side.left").get_by_role("checkbox", name="energy_compensation").uncheck()
    judged(page, "left", "QON")


def test_a_reader_learns_which_is_eon_and_by_how_much_the_other_is_wrong(page):
    judged(page, "left", "EON")
    assert page.locator(".side.left .verdict").inner_text().startswith("EON Correct")
    verdict = page.locator(".side.right .verdict").inner_text()
    found = re.search(r"up to (\S+) in this light, (\S+) in any light", verdict)
    here, anywhere = map(float, found.groups())
    assert "too bright where the light comes from behind" in verdict
    until(page, "document.querySelector('.values').innerText.includes('too bright')")
    error = page.locator(".values tbody tr").nth(2).locator("td").nth(1).inner_text()
    assert error == f"+{here:g} too bright" and here < anywhere < 0.4


def test_paths_have_samplers_and_count_their_samples(page):
    page.get_by_label("Path tracing, with interreflections").check()
    fill(page, "Samples per pixel, number", 2)
    page.locator(".side.right").get_by_label("Samples").select_option("cosine")
    side = {"source": "shader/stock", "flag": True, "sampler": "cosine"}
    shows(page, paths=True, samples=2, right=side)
    status = "document.querySelector('.picture .status').textContent"
    until(page, f"{status}.startsWith('2 of 2 samples')")
    # The status reports the noise only if there are 16 samples or more.
    assert "noise" not in page.locator(".picture .status").inner_text()


def in_sight(page):
    canvas = page.locator("canvas")
    canvas.scroll_into_view_if_needed()
    return canvas.bounding_box()


def drag(page, start, end):
    """Drag the mouse between two points of the picture, in coordinates from 0 to 1."""
    box = in_sight(page)
    corner, size = np.array([[box["x"], box["y"]], [box["width"], box["height"]]])
    start, end = corner + size * start, corner + size * end
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*(start + end) / 2)
    page.mouse.move(*end)
    page.mouse.up()


def test_the_light_is_dragged_and_moved_by_keys(page):
    first = state(page)
    choose(page, "Shape", "sphere")
    drag(page, (0.75, 0.7), (0.6, 0.4))
    view = state(page)
    assert (view["azimuth"], view["elevation"]) != (first["azimuth"], first["elevation"])
    assert view["probe"] is None and (view["turn"], view["tilt"]) == (0, 0)
    page.get_by_role("button", name="Light,").press("ArrowUp")
    shows(page, elevation=min(view["elevation"] + 5, 90))


def test_the_viewer_is_dragged_around_and_scrolls_closer(page):
    first = state(page)
    with redrawn(page):
        drag(page, (0.75, 0.7), (0.65, 0.7))
    view = state(page)
    assert view["turn"] > 10 and view["tilt"] == 0 and view["azimuth"] == first["azimuth"]
    with redrawn(page):
        page.mouse.wheel(0, -100)
    until(page, "mxeon.state().zoom > 1")
    sun = page.get_by_role("button", name="Light,").bounding_box()
    page.mouse.move(sun["x"] + sun["width"] / 2, sun["y"] + sun["height"] / 2)
    page.mouse.down()
    page.mouse.move(sun["x"] - 40, sun["y"] + 40)
    page.mouse.up()
    after = state(page)
    assert after["turn"] == view["turn"] and after["azimuth"] != view["azimuth"]


def pixels(page, **view):
    """Change fields of the view, and return the radiance of the left side."""
    show(page, **view)
    shows(page, **view)
    until(page, DRAWN)
    return np.array(page.evaluate("[...mxeon.stage.read('left')]"))


def test_a_turned_viewer_sees_a_turned_light_alike(page):
    even = {"surroundings": "uniform", "elevation": 50}
    ahead = pixels(page, shape="ball", azimuth=40, turn=0, **even)
    # The cut in the ball rotates out of view, so the picture changes.
    assert not np.allclose(pixels(page, azimuth=130, turn=90, **even), ahead)
    # The plane and the floor are rotationally symmetric, so the picture stays the same.
    ahead = pixels(page, shape="plane", azimuth=40, turn=0, **even)
    aside = pixels(page, azimuth=130, turn=90, **even)
    # A few pixels at rims and at the shadow's edge depend on rounding.
    assert (np.abs(aside - ahead) > 1e-3).mean() < 5e-3


def test_side_by_side_shows_the_middles_of_both_pictures(page):
    show(page, comparison="side")
    until(page, DRAWN)
    picks = page.evaluate("[0.3, 0.8].map(x => mxeon.stage.pick(x, 0.5, mxeon.state())?.normal)")
    assert picks[0] == picks[1] and picks[0] is not None
    for name in ("left", "right"):
        assert page.locator(f".picture .label.{name}").is_visible()


def test_a_click_probes_a_point(page):
    choose(page, "Shape", "sphere")
    fill(page, "Light above, number", 20)
    fill(page, "Light around, number", 30)
    box = in_sight(page)
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
    assert np.allclose(state(page)["probe"], (0.6, 0.4), atol=0.01)
    before = page.locator(".directions").inner_text()
    page.get_by_role("button", name="Probe; arrow keys").press("ArrowDown")
    until(page, "before => document.querySelector('.directions').innerText !== before", before)
    page.get_by_role("button", name="Go to the largest difference").click()
    shows(page, probe=None)


SHADER = 64 * 2**-24  # relative error of a shader's value with at most 64 float32 roundings
# JavaScript that returns the texts of the table's rows, or false until both shaders have values.
READ = """(() => {
    const rows = [...document.querySelectorAll('.values tbody tr')].map(
        row => [...row.querySelectorAll('td')].map(cell => cell.innerText));
    const texts = rows.flat().join();
    return texts.includes('float32') && !texts.includes('measuring') && rows;
})()"""


def numbers(text):
    return [float(word) for word in re.findall(r"[+-]?\d+\.\d+", text.replace("−", "-"))]


def test_the_probe_shows_the_value_of_the_shader_and_the_reference(page):
    rows = until(page, READ)
    wo, wi = np.reshape(numbers(page.locator(".directions").inner_text()), (2, 3))
    value, reference = (numbers(rows[row][0]) for row in (0, 1))
    wo, wi = wo / np.linalg.norm(wo), wi / np.linalg.norm(wi)
    expected = np.pi * eon_brdf(wo, wi, [0.8, 0.4, 0.1], 1.0) * wi[2]
    # The page prints directions with four digits.
    assert np.allclose(reference, expected, atol=1e-3)
    assert np.allclose(value, reference, atol=SHADER)
    assert "rounding" in rows[2][0]


def copied(page, side, what):
    page.get_by_role("button", name=f"Copy {side} as {what}").click()
    until(page, f"document.querySelector('.copies .said').textContent === '{side}, {what} copied.'")
    return page.evaluate("navigator.clipboard.readText()")


def test_the_python_line_runs_and_gives_the_value(page):
    rows = until(page, READ)
    for column, side in enumerate("AB"):
        line = copied(page, side, "Python")
        found = [float(word) for word in output(sys.executable, "-c", line).split()]
        assert np.allclose(found, numbers(rows[0][column]), atol=SHADER)


def test_the_copied_document_is_the_material_in_sight(page):
    show(page, roughness=0.25, color=[0.5, 0.25, 0.125])
    page.locator(".side.left").get_by_role("checkbox", name="energy_compensation").uncheck()
    text = copied(page, "A", "MaterialX")
    values = {port.name: port.value for port in mxeon.generate(text, "essl")[0].inputs}
    assert values["lobe_color"] == (0.5, 0.25, 0.125) and values["lobe_roughness"] == 0.25
    assert values["lobe_energy_compensation"] is False


def test_a_reader_learns_which_color_to_enter(page):
    answer = page.locator(".answer output")
    assert answer.inner_text() == "(0.836, 0.460, 0.125)"
    choose(page, "Seen", "on average")
    shows(page, average=True)
    assert answer.inner_text() == "(0.828, 0.445, 0.118)"
    fill(page, "To look like, red", 0.5)
    shows(page, wanted=[0.5, 0.4, 0.1])
    assert answer.inner_text() == "(0.546, 0.445, 0.118)"


def test_keys_choose_the_comparison_and_show_the_other_material(page):
    page.locator("h1").click()
    page.keyboard.press("d")
    shows(page, comparison="difference")
    page.keyboard.press("f")
    shows(page, comparison="flicker", shown="right")
    with redrawn(page):
        page.get_by_role("button", name="Show A").click()
    shows(page, shown="left")
    page.keyboard.press("w")
    shows(page, comparison="wipe")


def test_the_line_is_dragged_and_moved_by_keys(page):
    with redrawn(page):
        drag(page, (0.5, 0.2), (0.25, 0.2))
    assert abs(state(page)["wipe"] - 0.25) < 0.01
    page.get_by_role("slider", name="Wipe between A and B").press("ArrowRight")
    assert abs(state(page)["wipe"] - 0.27) < 0.01


def test_the_link_is_the_address_of_the_view(page):
    show(page, exposure=2)
    until(page, "location.hash.includes('exposure=2')")
    page.get_by_role("button", name="Copy a link").click()
    until(page, "document.querySelector('header .said').textContent === 'Copied'")
    assert page.evaluate("navigator.clipboard.readText()").endswith("#exposure=2")
