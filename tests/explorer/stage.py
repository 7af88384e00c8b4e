# SPDX-License-Identifier: Apache-2.0
"""Functions that change the view of the explorer's stage, and read the pictures as arrays."""

import base64

import numpy as np

from mxeon.explorer import document_sources, page, page_data
from mxeon.io.files import write_text
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import sphere
from tests.explorer.browser import opened, show, shows, until

RHO = (0.8, 0.4, 0.1)
ROUGHNESS = 0.9
LIGHTS = {"side": (60.0, 20.0), "back": (125.0, 10.0)}  # azimuth and elevation in degrees
VIEWPORT = {"width": 200, "height": 170}
# Script that scales the page's clock. At speed 0, no frame seems slow, so the resolution stays
# high.
CLOCK = """speed => {
    globalThis.clock ??= performance.now.bind(performance);
    performance.now = () => speed * globalThis.clock();
}"""
LISTEN = "globalThis.said = []; mxeon.stage.onStatus(status => globalThis.said.push(status))"
READ = """side => {
    const bytes = new Uint8Array(mxeon.stage.read(side).buffer);
    let text = "";
    for (let k = 0; k < bytes.length; k += 8192)
        text += String.fromCharCode(...bytes.subarray(k, k + 8192));
    return btoa(text);
}"""


def written(file, *names):
    """Write an explorer page with the named example documents, and return the page's URL."""
    documents = [document_sources(str(examples_folder() / f"{name}.mtlx")) for name in names]
    write_text(file, page(page_data(documents)))
    return file.as_uri()


def opened_stage(browser, address, **options):
    """Context manager that opens a page as narrow as a phone, so the rendered picture is small."""
    return opened(browser, address, **({"viewport": VIEWPORT} | options))


def side(source, flag=True, sampler="exact"):
    return {"source": source, "flag": flag, "sampler": sampler}


def view(stage, left, right=None, light="side", **patch):
    """Show two sources, with one of LIGHTS or without a light, and wait for the final picture."""
    azimuth, elevation = LIGHTS[light or "side"]
    common = {
        "left": left,
        "right": right or left,
        "shape": "sphere",
        "azimuth": azimuth,
        "elevation": elevation,
        "light": 1 if light else 0,
        "surroundings": "none",
        "color": list(RHO),
        "roughness": ROUGHNESS,
        "paths": False,
        "inputs": {},
        "comparison": "wipe",
        "exposure": 0,
        "probe": None,
    }
    show(stage, **(common | patch))
    shows(stage, **(common | patch))
    settle(stage)


def settle(stage):
    until(stage, "mxeon.stage.isSettled(mxeon.state())")


def frame(stage, name=None, size=None):
    """Radiance of one side, top row first. Path-traced pictures may have a different `size`."""
    width, height = size or stage.evaluate("Object.values(mxeon.stage.size())")
    data = np.frombuffer(base64.b64decode(stage.evaluate(READ, name)), dtype=np.float32)
    return data.reshape(height, width, 4)[::-1]


def picture(stage, name="left"):
    """Cut the square around the sphere from a frame. The host gl renders the same square."""
    whole = frame(stage, name)
    diameter = stage.evaluate("mxeon.stage.diameter()")
    top, left = ((length - diameter) // 2 for length in whole.shape[:2])
    square = whole[top : top + diameter, left : left + diameter]
    assert (square[..., 3] == sphere(diameter).mask).all()
    return square[..., :3]


def towards(light):
    azimuth, elevation = np.radians(LIGHTS[light])
    x, z = np.cos(elevation) * np.array([np.sin(azimuth), np.cos(azimuth)])
    return float(x), float(np.sin(elevation)), float(z)
