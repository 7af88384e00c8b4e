# SPDX-License-Identifier: Apache-2.0
"""The WebGL host reports failures of the browser and restarts the browser."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.errors import NotRun
from mxeon.hosts import webgl
from mxeon.shaders.generation import generate
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import BACK, FURNACE, SIDE
from tests.support.availability import available

MU = np.array([0.5])


def started():
    with available("webgl"):
        return webgl.WebGlHost()


def test_a_browser_that_hangs_is_not_run_and_the_next_one_works():
    host = started()
    host._limit = 1000.0  # milliseconds, enough because the browser has started
    with pytest.raises(NotRun, match="webgl: the browser failed; .*[Tt]imeout"):
        host._ask("() => { for (;;); }")
    host._limit *= 300.0
    assert host.call("fon_albedo_dir", MU, np.array([0.0])).tolist() == [[1.0, 1.0, 1.0]]
    host.close()


def test_a_lost_context_is_not_run_and_the_next_one_works():
    host, lose = started(), "gl.getExtension('WEBGL_lose_context').loseContext()"
    host._thread.submit(lambda: host._page.evaluate(f"{lose}; gl.getError()")).result()
    with pytest.raises(NotRun, match="webgl: the browser lost its WebGL context"):
        host.call("fon_albedo_dir", MU, np.array([0.0]))
    assert host.call("fon_albedo_dir", MU, np.array([0.0])).tolist() == [[1.0, 1.0, 1.0]]
    host.close()


def test_no_name_resolves_in_the_browser(hosts):
    script = """async () => {
        const found = await fetch("https://example.org/").then(() => "found", () => "nothing");
        return { found };
    }"""
    assert hosts("webgl")._ask(script)["found"] == "nothing"


@pytest.mark.parametrize("scene", (SIDE, BACK, FURNACE))
@pytest.mark.parametrize("name", ("plaster", "brick"))
def test_a_picture_is_the_references(hosts, reference, name, scene):
    host = hosts("webgl")
    host.call("fon_af", MU)  # afterwards, no framebuffer may be bound
    document = examples_folder() / f"{name}.mtlx"
    shader = generate(document, host.target, lights=True)[0]
    image = host.picture(shader, replace(scene, size=64))
    expected = reference.picture(shader, replace(scene, size=64))
    assert expected.max() > 0.1
    np.testing.assert_allclose(image, expected, atol=2.0**-8 if name == "brick" else 1e-5)
