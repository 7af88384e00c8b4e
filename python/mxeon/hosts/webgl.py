# SPDX-License-Identifier: Apache-2.0
"""WebGL2 in a headless Chromium, which runs generated ESSL in float32.

Playwright drives the installed browser. For each request, the page `webgl.js` reads arrays from a
file, draws a frame and returns pixels as text. The browser resolves no host names, so nothing
leaves the machine.
"""

from __future__ import annotations

import base64
import os
import re
import shutil
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun, install, refused
from mxeon.hosts import calls, fragment, points, raster
from mxeon.hosts.base import Array, Identity
from mxeon.jobs.signals import Temporary
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import VisiblePoints

try:
    from playwright import sync_api
except ImportError:
    sync_api = None

Page: TypeAlias = Any  # an object of Playwright, whose types mypy skips
Answer: TypeAlias = dict[str, str]
Layout: TypeAlias = dict[str, object]  # shape and offset of each array in a file, by name

PROGRAM = "MXEON_CHROMIUM"  # environment variable that names the browser
FLAGS = (
    "--use-gl=angle",
    "--use-angle=swiftshader",  # a software driver, which is the same on every machine
    "--enable-unsafe-swiftshader",
    "--no-proxy-server",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
PAGE = "<input type='file'><script>{}</script>"
# A lost context reports its error only once, so `lostContext` checks all contexts of the page.
CONTEXTS = """
const contexts = [], getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (...wanted) {
    const context = getContext.apply(this, wanted);
    if (context?.isContextLost) contexts.push(context);
    return context;
};
globalThis.lostContext = () => contexts.some((context) => context.isContextLost());
"""
IDENTITY = np.eye(4).ravel().tolist()
VERTEX = fragment.DIALECTS["essl"].vertex
POINTS = 4  # cached textures of points; most materials share a texture

# Matrices have to be set here, because uniforms have no initial values in ESSL.
UNIFORMS: dict[str, object] = {
    "u_worldMatrix": IDENTITY,
    "u_viewProjectionMatrix": IDENTITY,
    "u_worldInverseTransposeMatrix": IDENTITY,
}


class Chromium:
    """A headless browser with a page, started on demand and restarted after a crash.

    Playwright runs in its own thread, because the caller's thread may have an event loop. A request
    that takes `limit` seconds, or loses a WebGL context, ends the browser.
    """

    name: str
    flags: ClassVar[tuple[str, ...]] = FLAGS
    limit: ClassVar[float] = 300.0

    def __init__(self) -> None:
        if sync_api is None:
            raise NotRun(f"{self.name}: Playwright is not installed; {install('webgl')}")
        self._program = program(self.name)
        self._limit = 1000.0 * self.limit
        self._page: Page = None
        self._stack = ExitStack()
        self._thread = ThreadPoolExecutor(max_workers=1)

    def close(self) -> None:
        """End the browser. The next request starts a new browser."""
        self._thread.submit(self._stop).result()

    def _load(self) -> None:
        self._page.set_content(PAGE.format(Path(__file__).with_suffix(".js").read_text("utf-8")))

    def _ask(
        self, function: str, job: dict[str, object] | None = None, file: Path | None = None
    ) -> Answer:
        """The result of a JavaScript function of the page, plus the browser's "version"."""
        answer = self._thread.submit(self._answer, function, job, file).result()
        if "failed" in answer:
            raise NotRun(f"{self.name}: {answer['failed']}")
        return answer

    def _answer(self, function: str, job: dict[str, object] | None, file: Path | None) -> Answer:
        try:
            if self._page is None:
                playwright = self._stack.enter_context(sync_api.sync_playwright())
                browser = playwright.chromium.launch(
                    executable_path=self._program, args=self.flags, chromium_sandbox=not is_root()
                )
                session = self._stack.enter_context(browser).new_context()
                session.add_init_script(CONTEXTS)
                self._page = session.new_page()
                self._load()
            if file is not None:
                self._page.set_input_files("input", file)
            handle = self._page.wait_for_function(function, arg=job, timeout=self._limit)
            answer: Answer = handle.json_value()
            if self._page.evaluate("lostContext()"):
                self._stop()
                return {"failed": "the browser lost its WebGL context"}
            return answer | {"browser": self._page.context.browser.version}
        except sync_api.Error as error:
            self._stop()
            return {"failed": f"the browser failed; {error.message.splitlines()[0]}"}

    def _stop(self) -> None:
        self._page = None
        self._stack.close()


class WebGlHost(Chromium, raster.FragmentHost):
    name = "webgl"
    target = "essl"
    draws_images = True

    def __init__(self) -> None:
        super().__init__()
        self._points = lru_cache(maxsize=POINTS)(self._capture)
        # Request the device now, since the browser may lack WebGL2.
        try:
            self._ask("identify")
        except NotRun:
            self.close()
            raise

    def identity(self) -> Identity:
        answer = self._ask("identify")
        return Identity(self.name, f"Chromium {answer['browser']}, WebGL2", answer["device"])

    def _shade(
        self,
        shader: Shader,
        seen: VisiblePoints,
        textures: dict[str, Array],
        uniforms: raster.Uniforms,
        parts: Sequence[raster.Rectangle],
    ) -> Array:
        captured, frame = points.outputs(shader), points.frame(seen)
        pattern = r"^uniform vec2 (\w+(_uv_scale|_uv_offset));"
        images = re.findall(pattern, shader.stages["pixel"], re.MULTILINE)
        placed = {name: calls.PLACED[kind] for name, kind in images}
        if captured:
            given = points.constants(shader)
            textures[points.SAMPLER] = self._points(shader.stages["vertex"], captured, seen, given)
        pixel = points.pixel_stage(shader)
        drawn = raster.Frame(VERTEX, pixel, textures=textures, uniforms=placed | uniforms)
        return self._draw(drawn, frame)[::-1]

    def _evaluate(self, frame: raster.Frame) -> Array:
        count, size = fragment.frame(frame.arguments)
        arguments = {name: fragment.texels(rows, size) for name, rows in frame.arguments.items()}
        textures = {**arguments, **frame.textures}
        return self._draw(frame._replace(textures=textures), size).reshape(-1, 3)[:count]

    def _draw(self, frame: raster.Frame, size: tuple[int, int]) -> Array:
        """One frame as float32 pixels (height, width, 3), with row 0 at the bottom."""
        uniforms = UNIFORMS | frame.uniforms
        job = {"vertex": frame.vertex, "pixel": frame.pixel, "size": size, "uniforms": uniforms}
        arrays = {"textures": frame.textures, "attributes": raster.TRIANGLE}
        pixels = np.frombuffer(self._bytes("draw", job, arrays), dtype=np.float32)
        return pixels.reshape(size[1], size[0], 4)[..., :3]

    def _capture(
        self,
        vertex: str,
        captured: tuple[points.Output, ...],
        seen: VisiblePoints,
        constants: points.Constants,
    ) -> NDArray[np.float32]:
        """Texels of a vertex stage's outputs at the points of a picture."""
        attributes = points.vertices(seen, constants)
        job = {
            "vertex": vertex,
            "outputs": [each.name for each in captured],
            "count": len(attributes["i_position"]),
            "stride": points.stride(captured),
            "uniforms": UNIFORMS,
        }
        buffer = self._bytes("capture", job, {"attributes": attributes})
        return points.texels(buffer, captured, seen)

    def _bytes(
        self, function: str, job: Mapping[str, object], arrays: Mapping[str, Mapping[str, Array]]
    ) -> bytes:
        with Temporary("mxeon-webgl-") as folder:
            file = Path(folder, "arrays")
            answer = self._ask(function, {**job, **_write(file, arrays)}, file)
        if "refused" in answer:
            raise refused("webgl", answer["refused"], str(job.get("pixel", "")))
        return base64.b64decode(answer["bytes"])


def is_root() -> bool:
    """Whether the user is root, for whom Chromium has no sandbox."""
    return sys.platform != "win32" and os.geteuid() == 0


def program(host: str = "webgl") -> str:
    name = os.environ.get(PROGRAM) or "chromium"
    path = shutil.which(name)
    if path is None:
        raise NotRun(
            f"{host}: no program {name!r}; on Debian: apt-get install chromium, "
            f"or name a Chromium, Chrome or Edge in {PROGRAM}"
        )
    return path


def _write(path: Path, groups: Mapping[str, Mapping[str, Array]]) -> dict[str, Layout]:
    """Write each array once, and return shapes and offsets in the file by group and name."""
    layout: dict[str, Layout] = {}
    places: dict[int, object] = {}  # maps id(array) to shape and offset
    offset = 0
    with path.open("wb") as file:
        for group, arrays in groups.items():
            layout[group] = {}
            for name, values in arrays.items():
                if id(values) not in places:
                    data = np.ascontiguousarray(values, dtype=np.float32)
                    places[id(values)] = {"shape": data.shape, "offset": offset}
                    offset += file.write(data.data)
                layout[group][name] = places[id(values)]
    return layout
