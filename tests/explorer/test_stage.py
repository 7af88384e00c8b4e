# SPDX-License-Identifier: Apache-2.0
"""Pixels of the stage match the models, the gl host and exact albedos."""

import numpy as np
import pytest

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.table import DIFFUSE_MODELS, KNOWN_DEFECTS, diffuse_model
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere
from tests.explorer.stage import (
    LIGHTS,
    RHO,
    ROUGHNESS,
    opened_stage,
    picture,
    side,
    towards,
    view,
    written,
)
from tests.support.tolerances import TWIN_ALBEDO, TWIN_VALUE

DOCUMENTS = ("brick", "mixed_lobes")
PLAIN = 48 * 2.0**-24  # 16 roundings of a point, and 32 of its value
ROWS = DIFFUSE_MODELS + KNOWN_DEFECTS


@pytest.fixture(scope="module")
def stage(browser, tmp_path_factory):
    address = written(tmp_path_factory.mktemp("explorer") / "stage.html", *DOCUMENTS)
    with opened_stage(browser, address) as page:
        yield page


def parameter_of(row):
    return () if row.parameter is None else (ROUGHNESS,)


def exact(row, size, light):
    points = sphere(size)
    normal = points.normal[points.mask]
    wo, wi = local_directions(normal, VIEW), local_directions(normal, towards(light))
    lit = wi[:, 2] > 0.0
    expected = np.zeros((size, size, 3))
    values = np.zeros((len(normal), 3))
    values[lit] = np.pi * wi[lit, 2:] * row.brdf(wo[lit], wi[lit], RHO, *parameter_of(row))
    expected[points.mask] = values
    return expected


def error(measured, expected):
    """Largest difference of two pictures times cos(theta_o), as in the check `picture`."""
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
    """Directional albedo by cosine, in closed form or as the stage interpolates it."""
    arguments = (RHO, *parameter_of(row))
    if row.albedo_dir:
        return row.albedo_dir(mu, *arguments)
    # The stage interpolates between 256 angles.
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
    # A variant's clamp makes a kink of length <= pi across panels of 16 nodes. With nodes h
    # apart, a slope that jumps by 1 adds an error of h^2 / 12 per unit of length.
    kink = (np.pi / 2 / 16) ** 2 / 12 * np.pi if row.name == "eon_clamped" else 0.0
    assert np.abs(measured[points.mask] - white(row, mu)).max() < TWIN_ALBEDO + kink
    assert np.abs(measured[points.mask] - 1.01 * white(row, mu)).max() > TWIN_ALBEDO + kink


def compiled(host, library, flag):
    text = material_text(OREN_NAYAR, {"color": RHO, "roughness": ROUGHNESS, FLAG: flag})
    return host.compile(text, library=library)[0]


# Error of MaterialX's EON, which multiplies two albedos of arc cosines. Mesa's arc cosine is off by
# 1.6e-4 (measured), and an albedo falls by up to 1 / 4 per radian.
ARC_COSINE = 2 * 1.6e-4 / 4


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("flag", [True, False])
def test_pixels_of_the_nodes_are_those_of_the_gl_host(stage, gl, flag, light):
    view(stage, side("shader/eonlib", flag), side("shader/stock", flag), light=light)
    for name, library in (("left", "eonlib"), ("right", "stock")):
        measured = picture(stage, name)
        scene = Scene(light, light=towards(light), size=len(measured))
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
