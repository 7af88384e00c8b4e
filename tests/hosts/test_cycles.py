# SPDX-License-Identifier: Apache-2.0
"""Blender's Cycles as a host returns exact values and pixels, and reports failures."""

import os
import sys
from dataclasses import replace
from types import SimpleNamespace

import MaterialX as mx
import numpy as np
import pytest

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import cycles
from mxeon.hosts.cycles import process as cycles_process
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import EON, material_text
from mxeon.shaders.scene import BACK, FRONT, FURNACE, SIDE, Paths, sphere, tangents
from mxeon.survey.cycles_native import NODES
from tests.support.availability import available
from tests.support.documents import material
from tests.support.tolerances import (
    CYCLES_EON_RELATIVE,
    CYCLES_FURNACE_MEAN,
    CYCLES_NORMAL,
    CYCLES_RIM,
    CYCLES_SUBSURFACE,
)
from tests.support.verdicts import FAILED, PASSED, RENDERER_NODES, has

EMIT = "shader emit\n(\n    output closure color out = 0\n)\n{{\n    {}\n}}\n"
SMALL = replace(FRONT, size=64)
LIGHTS = [replace(scene, size=64) for scene in (FRONT, SIDE, BACK)]


def eon(color, roughness):
    return material_text(EON, {"color": color, "roughness": roughness})


def osl(text, **options):
    return generate(text, "osl", **options)[0]


def emit(statement):
    """Object like a generated shader, whose OSL executes the given statement."""
    document = mx.createDocument()
    document.addNode("surface", "emit", "surfaceshader")
    stages = {"pixel": EMIT.format(statement)}
    return SimpleNamespace(stages=stages, document=document, element="emit", root="")


def lit(scene):
    """Masks of pixels away from rim and terminator, and of pixels with dot(wo, wi) < mu_o mu_i."""
    points = sphere(scene.size)
    light = np.asarray(scene.light)
    mu_o, mu_i = points.normal[..., 2], points.normal @ light
    pixels = points.mask & (mu_o > CYCLES_RIM) & (mu_i > CYCLES_RIM)
    return pixels, light[2] < mu_o * mu_i


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    (folder / "test.osl").write_text(
        "color same_color(color rho)\n{\n    return rho;\n}\n"
        "float same_float(float x)\n{\n    return x;\n}\n"
        "vector scaled(vector wo,\n              float x)\n{\n    return wo * x;\n}\n"
    )
    return folder


@pytest.fixture(scope="module")
def host(sources):
    with available("cycles"):
        host = cycles.CyclesHost(sources)
        host.identity()
    with host:
        yield host


def test_an_interpreter_in_the_working_folder_is_not_started(monkeypatch, tmp_path):
    monkeypatch.delenv("MXEON_CYCLES_PYTHON", raising=False)
    monkeypatch.setattr(cycles_process, "CHECKOUT", str(tmp_path / "elsewhere"))
    python = tmp_path / ".venv-cycles" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(sys.executable)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NotRun, match="needs Blender's Python package"):
        cycles_process.interpreter()


def test_a_pixel_is_its_point_of_the_sphere(host):
    points = sphere(SMALL.size)
    picture = host.picture(emit("out = color(N) * emission();"), SMALL)
    error = np.where(points.mask[..., None], picture - points.normal, picture)
    assert np.abs(error[..., :2]).max() <= CYCLES_NORMAL
    assert np.abs(error[..., 2] * points.normal[..., 2]).max() <= CYCLES_NORMAL
    assert np.array_equal(picture.any(axis=-1), points.mask)


def test_tangents_point_eastward(host):
    points = sphere(SMALL.size)
    picture = host.picture(emit("out = color(normalize(dPdu)) * emission();"), SMALL)
    expected = tangents(points.normal[points.mask])
    error = np.abs(picture[points.mask] - expected).max(axis=1)
    # Tangents before normalization have the length `across`, which is 0 at the poles.
    across = np.linalg.norm(points.normal[points.mask][:, ::2], axis=1)
    assert (error * across * points.normal[points.mask][:, 2]).max() <= 2.0 * CYCLES_NORMAL


@pytest.mark.parametrize("scene", LIGHTS)
@pytest.mark.parametrize("roughness", [0.0, 2e-5, 1.0])
def test_eon_with_the_profile_is_exact(host, reference, scene, roughness):
    shader = osl(eon("1.0, 0.4, 0.0", roughness), profile="cycles")
    expected = reference.picture(shader, scene)
    error = np.abs(host.picture(shader, scene) - expected)
    pixels, _ = lit(scene)
    bound = CYCLES_EON_RELATIVE * expected
    assert np.all(error[pixels] <= bound[pixels])


def test_a_white_furnace_returns_all_light(host):
    scene = replace(FURNACE, size=64)
    shader = osl(eon("1.0, 1.0, 1.0", 1.0), profile="cycles")
    picture = host.picture(shader, scene)
    mask = sphere(scene.size).mask
    assert abs(picture[mask].mean() - 1.0) < CYCLES_FURNACE_MEAN
    assert not picture[~mask].any()


def test_a_shader_that_does_not_compile_is_the_shaders_error(host):
    with pytest.raises(ShaderError, match="function 'nothing' was not declared"):
        host.picture(emit("out = nothing();"), SMALL)


def test_a_hang_is_not_run_and_the_next_picture_is(host):
    host.worker.start()
    limit, host.worker.limit = host.worker.limit, 1.0
    with pytest.raises(NotRun, match="no answer within 1 s; last output"):
        host.picture(emit("while (P[0] < 2.0) { out = color(P) * emission(); }"), SMALL)
    host.worker.limit = limit
    assert host.call("same_float", [0.5])[0, 0] == 0.5


def test_nothing_is_left_behind(sources, host):
    with cycles.CyclesHost(sources) as other:
        other.worker.start()
        pid = other.worker.pid
        log = other.worker.log
        os.kill(pid, 0)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    assert not log.exists()


def test_subsurface_keeps_its_color(host):
    color = np.array([0.2, 0.5, 0.8])
    text = material(
        '<subsurface_bsdf name="lobe" type="BSDF"><input name="color" type="color3" '
        f'value="{", ".join(map(str, color))}"/><input name="radius" type="color3" '
        'value="0.01, 0.01, 0.01"/></subsurface_bsdf>'
    )
    scene = replace(FURNACE, size=16, paths=Paths(samples=64))
    means = []
    for library in ("eonlib", "stock"):
        profile = "cycles" if library == "eonlib" else None
        pixels = host.picture(osl(text, library=library, profile=profile), scene)
        means.append(pixels[sphere(16).mask].mean(axis=0))
    assert np.abs(means[0] - color).max() < CYCLES_SUBSURFACE
    # Stock MaterialX ignores the color, so the sphere is white.
    assert np.abs(means[1] - 1.0).max() < CYCLES_SUBSURFACE


@pytest.mark.parametrize("node", NODES)
def test_blender_has_one_power_of_the_color_too_many(judged, node):
    keys = ("value", "environment", "black")
    value, environment, black = (
        judged(key, node.title, "cycles-native", RENDERER_NODES) for key in keys
    )
    assert (value.verdict, environment.verdict, black.verdict) == (FAILED, FAILED, PASSED)
    assert all(each.control.caught for each in (value, environment, black))
    assert has(value, "model", "EON with rho^3")
    assert value.diagnosis.distances["EON with rho^3"] < 1e-6
    assert environment.error > 100.0 * environment.tolerance
