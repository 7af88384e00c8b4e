# SPDX-License-Identifier: Apache-2.0
"""Pixels of the stage match the models, the gl host and exact albedos, also with path tracing."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.table import DIFFUSE_MODELS, KNOWN_DEFECTS, diffuse_model
from mxeon.shaders.generation import generate
from mxeon.shaders.library import examples_folder
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere
from tests.explorer import stage as views
from tests.explorer.browser import until
from tests.explorer.stage import opened_stage, picture, side, view
from tests.support.tolerances import EON_WEIGHT, TWIN_ALBEDO, TWIN_VALUE

PLAIN = 48 * 2.0**-24  # a point of the sphere has 16 roundings, and the value has 32
ROWS = DIFFUSE_MODELS + KNOWN_DEFECTS


@pytest.fixture(scope="module")
def stage(browser, tmp_path_factory):
    address = views.written(
        tmp_path_factory.mktemp("explorer") / "stage.html", "brick", "mixed_lobes"
    )
    with opened_stage(browser, address) as page:
        page.evaluate(views.LISTEN)
        page.evaluate(views.CLOCK, 0)
        yield page


def parameter_of(row):
    return () if row.parameter is None else (views.ROUGHNESS,)


def exact(row, size, light):
    points = sphere(size)
    normal = points.normal[points.mask]
    wo, wi = local_directions(normal, VIEW), local_directions(normal, views.towards(light))
    lit = wi[:, 2] > 0.0
    expected = np.zeros((size, size, 3))
    values = np.zeros((len(normal), 3))
    values[lit] = np.pi * wi[lit, 2:] * row.brdf(wo[lit], wi[lit], views.RHO, *parameter_of(row))
    expected[points.mask] = values
    return expected


def error(measured, expected):
    """Largest difference of two pictures, multiplied by cos(theta_o) as in the check `picture`."""
    cosine = sphere(len(measured)).normal[..., 2:]
    return (np.abs(measured - expected) * cosine).max()


@pytest.mark.parametrize("row", ROWS)
def test_pixels_of_every_model_are_those_of_numpy(stage, sources, row):
    view(stage, side(sources[row.name]), side(sources["lambert"]))
    measured = picture(stage)
    expected = exact(row, len(measured), "side")
    assert error(measured, expected) < PLAIN
    other = picture(stage, "right")
    assert row.name == "lambert" or error(other, expected) > 1000 * PLAIN


def white(row, mu):
    """Directional albedo at cosines `mu`, from a closed form or from a table like the stage's."""
    arguments = (views.RHO, *parameter_of(row))
    if row.albedo_dir:
        return row.albedo_dir(mu, *arguments)
    # The stage interpolates linearly in a table with 256 rows.
    angles = np.linspace(0.0, 1.0, 256)
    table = albedo_dir_quadrature(row.brdf, angles, *arguments, nodes=32)
    return np.stack([np.interp(mu, angles, table[:, k]) for k in range(3)], axis=-1)


@pytest.mark.parametrize("name", ["eon", "qon", "fon_white_lobe", "eon_clamped"])
def test_in_uniform_surroundings_pixels_are_the_albedo(stage, sources, name):
    row = diffuse_model(name)
    view(stage, side(sources[row.name]), light=None, surroundings="uniform")
    measured = picture(stage)
    points = sphere(len(measured))
    mu = points.normal[points.mask][:, 2]
    # The clamp in a wrong variant causes a kink in the integrand along a curve of length pi at
    # most. If nodes are h apart and a slope jumps by 1, the error is h^2 / 12 per unit of length.
    kink = (np.pi / 2 / 16) ** 2 / 12 * np.pi if row.name == "eon_clamped" else 0.0
    assert np.abs(measured[points.mask] - white(row, mu)).max() < TWIN_ALBEDO + kink
    assert np.abs(measured[points.mask] - 1.01 * white(row, mu)).max() > TWIN_ALBEDO + kink


def compiled(host, library, flag):
    text = material_text(OREN_NAYAR, {"color": views.RHO, "roughness": views.ROUGHNESS, FLAG: flag})
    return host.compile(text, library=library)[0]


# Error of MaterialX's EON, which multiplies two albedos that contain an arc cosine. Mesa's arc
# cosine has a measured error of 1.6e-4, and an albedo falls by at most 1 / 4 per radian.
ARC_COSINE = 2 * 1.6e-4 / 4


@pytest.mark.parametrize("light", views.LIGHTS)
@pytest.mark.parametrize("flag", [True, False])
def test_pixels_of_the_nodes_are_those_of_the_gl_host(stage, gl, flag, light):
    view(stage, side("shader/eonlib", flag), side("shader/stock", flag), light=light)
    for name, library in (("left", "eonlib"), ("right", "stock")):
        measured = picture(stage, name)
        scene = Scene(light, light=views.towards(light), size=len(measured))
        expected = gl.picture(compiled(gl, library, flag), scene)
        tolerance = ARC_COSINE if flag and library == "stock" else TWIN_VALUE
        assert error(measured, expected) < tolerance
        assert error(measured, 1.001 * expected) > tolerance


def test_the_flag_and_the_inputs_of_a_document_reach_its_shader(stage):
    view(stage, side("shader/eonlib", True), side("shader/eonlib", False))
    assert error(picture(stage, "left"), picture(stage, "right")) > 0.05
    source = stage.evaluate("mxeon.data.sources.find(each => each.id.includes('brick')).id")
    view(stage, side(source), inputs={source: {"brick_lobe_weight": 0.5}})
    half = picture(stage)
    view(stage, side(source))
    assert np.abs(picture(stage) - 2.0 * half).max() < TWIN_VALUE < half.max()


# --- path tracing ------------------------------------------------------------------------------

SAMPLES = 16


def traced(stage, left, right=None, **patch):
    """Show both sides, trace all samples, and return the last status message of each kind."""
    stage.evaluate("said.length = 0")
    view(stage, left, right, **({"paths": True, "samples": SAMPLES} | patch))
    return {status["kind"]: status for status in stage.evaluate("said")}


def whole(stage, name):
    """Pixels whose paths all hit the sphere, and the cosines at the centers of these pixels."""
    status = stage.evaluate("said.findLast(status => status.kind === 'drawn')")
    pixels = views.frame(stage, name, (status["width"], status["height"]))
    height, width = pixels.shape[:2]
    diameter = 2 * round(min(width, height) / 2 / 1.14)
    y, x = np.mgrid[:height, :width] + 0.5
    squared = ((x - width / 2) ** 2 + (y - height / 2) ** 2) * 4 / diameter**2
    kept = (pixels[..., 3] == 1.0) & (squared < 1.0)
    # The selection includes all pixels that lie entirely inside the sphere's outline.
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
    """A generated shader and a model use the color and the roughness that the view sets."""
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
