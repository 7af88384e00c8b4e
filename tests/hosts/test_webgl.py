# SPDX-License-Identifier: Apache-2.0
"""The browser as a host: what is missing is said, and a browser that fails is replaced."""

from dataclasses import replace

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.conformance import reference
from mxeon.errors import NotRun
from mxeon.hosts import webgl
from mxeon.shaders.generation import generate
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene
from tests.support.availability import available

MU = np.array([0.5])


def started(**options):
    with available("webgl"):
        return webgl.Host(**options)


def test_a_browser_that_hangs_is_not_run_and_the_next_one_works():
    host = started()
    host._limit = 1000.0  # milliseconds, now that the browser runs
    with pytest.raises(NotRun, match="webgl: the browser fails; .*[Tt]imeout"):
        host._ask("() => { for (;;); }")
    host._limit *= 300.0
    assert host.call("fon_albedo_dir", MU, np.array([0.0])).tolist() == [[1.0, 1.0, 1.0]]
    host.close()


def test_an_environment_image_is_turned_as_on_gl(gl, hosts, tmp_path):
    sky = np.zeros((32, 64, 3), dtype=np.float32)
    sky[:, 32:48] = 1.0  # to one side of the middle
    oiio.ImageBuf(sky).write(str(tmp_path / "sky.exr"))
    scene = Scene("sky", environment=tmp_path / "sky.exr", size=32)
    images = []
    for host in (gl, hosts("webgl")):
        shader = host.compile(examples_folder() / "plaster.mtlx")[0]
        images.append(host.picture(shader, scene))
    np.testing.assert_allclose(*images, rtol=0.0, atol=2.0**-8)  # filter weights
    assert images[0].max() > 0.1 and np.ptp(images[0][16, 8:24]) > 0.02


def test_no_name_resolves_in_the_browser(hosts):
    script = """async () => {
        const found = await fetch("https://example.org/").then(() => "found", () => "nothing");
        return { found };
    }"""
    assert hosts("webgl")._ask(script)["found"] == "nothing"


@pytest.mark.parametrize("scene", (SIDE, BACK, FURNACE), ids=lambda scene: scene.name)
@pytest.mark.parametrize("name", ("plaster", "brick"))
def test_a_picture_is_the_references(hosts, name, scene):
    host = hosts("webgl")
    host.call("fon_a", MU)  # leaves no frame behind that a picture would draw into
    document = examples_folder() / f"{name}.mtlx"
    shader = generate(document, host.target, lights=True)[0]
    image = host.picture(shader, replace(scene, size=64))
    expected = reference.Host().picture(shader, replace(scene, size=64))
    assert expected.max() > 0.1
    np.testing.assert_allclose(image, expected, atol=2.0**-8 if name == "brick" else 1e-5)
