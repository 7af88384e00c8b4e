# SPDX-License-Identifier: Apache-2.0
"""WebGL2 in a headless Chromium: generated ESSL as a browser runs it, in float32.

Playwright drives the browser that is installed. The page, `webgl.js`, draws a frame per request;
numbers go there in a file, bit for bit, and come back as text. No host name resolves in this
browser: nothing leaves the machine.
"""

import base64
import os
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from mxeon.errors import NotRun, ShaderError
from mxeon.shaders import functions as twins
from mxeon.shaders.hosts import fragment, raster
from mxeon.shaders.hosts.base import Identity

try:
    from playwright import sync_api
except ImportError:
    sync_api = None

PROGRAM = "MXEON_CHROMIUM"  # environment variable that names the browser
FLAGS = (
    "--use-gl=angle",
    "--use-angle=swiftshader",  # Chromium's own software driver, alike on every machine
    "--enable-unsafe-swiftshader",
    "--no-proxy-server",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
PAGE = "<input type='file'><script>{}</script>"
IDENTITY = np.eye(4).ravel().tolist()

# ESSL gives uniforms no initial values.
UNIFORMS = {
    "u_worldMatrix": IDENTITY,
    "u_viewProjectionMatrix": IDENTITY,
    "u_worldInverseTransposeMatrix": IDENTITY,
    "u_envMatrix": IDENTITY,
    "u_envLightIntensity": 1.0,
}
IMAGE = {"uv_scale": (1.0, 1.0), "uv_offset": (0.0, 0.0)}  # of every image that is no atlas


class Host:
    """A browser, started anew after it died.

    Playwright wants a thread without an event loop, and always the same: it gets one of its own.

    Parameters
    ----------
    limit : float
        Seconds that a frame may take.

    Raises
    ------
    NotRun
        If there is no Playwright, no Chromium, or no WebGL2 with float32 frames in it.
    """

    name = "webgl"
    target = "essl"
    profile = None

    def __init__(self, limit=300.0):
        if sync_api is None:
            raise NotRun("webgl: Playwright is not installed; pip install 'mxeon[webgl]'")
        self._program = program()
        self._limit = 1000.0 * limit
        self._page = None
        self._stack = ExitStack()
        self._thread = ThreadPoolExecutor(max_workers=1)
        try:
            self._ask("identify")
        except NotRun:
            self.close()
            raise

    def identity(self):
        """Version and device as the browser names them."""
        found = self._ask("identify")
        return Identity(self.name, f"Chromium {found['version']}, WebGL2", found["device"])

    def picture(self, shader, scene):
        """The shader on the sphere; see `mxeon.shaders.hosts`."""
        size = scene.size
        uniforms = UNIFORMS | _inputs(shader) | raster.light(scene)
        frame = self._draw(
            shader.stages, uniforms, raster.textures(shader, scene), raster.grid(size), (size, size)
        )
        return raster.picture(frame, size)

    def evaluate(self, shader, wo, wi, inputs, branch):
        """The shader's own BSDF function for pairs of directions; see `mxeon.shaders.hosts`."""
        pixel, arguments = fragment.bsdf_evaluation(shader, wo, wi, inputs, branch)
        return self._evaluate(shader.stages["vertex"], pixel, arguments)

    def call(self, function, *arguments):
        """A function of the GLSL twins; see `mxeon.shaders.hosts`."""
        parameters = twins.signature("glsl", function)
        source = twins.source("glsl")
        pixel, named = fragment.function_evaluation(
            source, function, parameters, arguments, self.target
        )
        return self._evaluate(fragment.DIALECTS[self.target].vertex, pixel, named)

    def close(self):
        """End the browser; the next request starts another."""
        self._thread.submit(self._stop).result()

    def _evaluate(self, vertex, pixel, arguments):
        """One pixel per element, as many as the longest argument has."""
        count, size = fragment.frame(arguments)
        textures = {name: fragment.texels(rows, size) for name, rows in arguments.items()}
        textures |= raster.SURROUNDING
        stages = {"vertex": vertex, "pixel": pixel}
        frame = self._draw(stages, UNIFORMS, textures, raster.triangle(), size)
        return frame.reshape(-1, 3)[:count]

    def _draw(self, stages, uniforms, textures, mesh, size):
        """One frame as float32 (height, width, 3), row 0 at the bottom."""
        arrays = {"textures": textures, "attributes": mesh[0], "mesh": {"indices": mesh[1]}}
        with TemporaryDirectory(prefix="mxeon-webgl-") as folder:
            numbers = Path(folder, "numbers")
            job = {**stages, "size": size, "uniforms": uniforms, **_write(numbers, arrays)}
            answer = self._ask("draw", job, numbers)
        if "refused" in answer:
            raise ShaderError(f"webgl: {answer['refused'].strip()}")
        pixels = np.frombuffer(base64.b64decode(answer["pixels"]), dtype=np.float32)
        return pixels.reshape(size[1], size[0], 4)[..., :3]

    def _ask(self, function, job=None, numbers=None):
        """What a function of the page returns; a browser that dies or hangs is ended."""
        answer = self._thread.submit(self._answer, function, job, numbers).result()
        if "failed" in answer:
            raise NotRun(f"webgl: {answer['failed']}")
        return answer

    def _answer(self, function, job, numbers):
        try:
            if self._page is None:
                self._start()
            if numbers is not None:
                self._page.set_input_files("input", numbers)
            handle = self._page.wait_for_function(function, arg=job, timeout=self._limit)
            return handle.json_value() | {"version": self._page.context.browser.version}
        except sync_api.Error as error:
            self._stop()
            return {"failed": f"the browser fails; {error.message.splitlines()[0]}"}

    def _start(self):
        playwright = self._stack.enter_context(sync_api.sync_playwright())
        browser = self._stack.enter_context(
            playwright.chromium.launch(
                executable_path=self._program, args=FLAGS, chromium_sandbox=os.geteuid() != 0
            )
        )
        self._page = browser.new_page()
        self._page.set_content(PAGE.format(Path(__file__).with_suffix(".js").read_text("utf-8")))

    def _stop(self):
        self._page = None
        self._stack.close()


def program():
    """The browser to drive."""
    named = os.environ.get(PROGRAM)
    found = shutil.which(named or "chromium")
    if found is None:
        raise NotRun(
            f"webgl: no program {named or 'chromium'!r}; on Debian: apt-get install chromium, "
            f"or name another Chromium in {PROGRAM}"
        )
    return found


def _inputs(shader):
    """Values of the uniforms that carry a shader's inputs."""
    names = re.findall(r"^uniform vec2 (\w+_(uv_scale|uv_offset));", shader.stages["pixel"], re.M)
    return {name: IMAGE[kind] for name, kind in names} | raster.inputs(shader)


def _write(path, groups):
    """Write arrays one after the other; shapes and places in the file, by group and name."""
    layout, offset = {}, 0
    with path.open("wb") as file:
        for group, arrays in groups.items():
            layout[group] = {}
            for name, values in arrays.items():
                kind = np.uint32 if values.dtype == np.uint32 else np.float32
                data = np.ascontiguousarray(values, dtype=kind)
                layout[group][name] = {"shape": data.shape, "offset": offset}
                offset += file.write(data.tobytes())
    return layout
