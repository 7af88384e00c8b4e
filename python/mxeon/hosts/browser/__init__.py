# SPDX-License-Identifier: Apache-2.0
"""Renderers from npm in a headless Chromium, each as a page that draws one picture per request.

The page is an ES module beside this file. It imports the renderer from `node_modules`, which a route
inside the browser serves: nothing is bundled, and nothing leaves the machine.
"""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun, install
from mxeon.hosts import webgl
from mxeon.hosts.webgl import Answer, Page
from mxeon.shaders.library import data_folder

try:
    from playwright import sync_api
except ImportError:
    sync_api = None

MODULES = "MXEON_NODE_MODULES"  # environment variable that names another node_modules
ORIGIN = "https://renderers.invalid/"  # a secure origin, without which there is no WebGPU
FLAGS = (*webgl.FLAGS, "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader")
HTML = """<!doctype html><script type="importmap">{imports}</script>
<script type="module">
import * as page from "/page.js";
window.answer = async (job) => {{
    try {{
        return await page.draw(job);
    }} catch (error) {{
        return {{ failed: String(error?.message ?? error) }};
    }}
}};
</script>"""
SHARED = {"Access-Control-Allow-Origin": "*"}
PICTURES = 64  # that are kept: the checks of a node ask for some of them again
LIMIT = 60.0  # seconds that a picture may take, the renderer's start included
TYPES = {".js": "text/javascript", ".mjs": "text/javascript", ".json": "application/json"}


def packages_folder() -> Path:
    """Folder of the package.json and the lock file that pin the renderers."""
    installed = data_folder() / "renderers"
    return installed if installed.is_dir() else data_folder() / "tools" / "renderers"


def modules_folder(package: str, host: str) -> Path:
    """The node_modules that holds a package: MXEON_NODE_MODULES, or that beside the lock file."""
    folder = Path(os.environ.get(MODULES) or packages_folder() / "node_modules")
    if not (folder / package / "package.json").is_file():
        raise NotRun(
            f"{host}: no package {package} in {folder}; npm ci --prefix {packages_folder()}"
        )
    return folder


def package_version(folder: Path, package: str) -> str:
    version: str = json.loads((folder / package / "package.json").read_text("utf-8"))["version"]
    return version


class Browser:
    """A page with a renderer, started by the first request and again after it died.

    Playwright wants a thread without an event loop, and always the same: it gets one of its own.
    `page` is an ES module that exports `draw(job)`, whose answer has `pixels` or `failed`. `imports`
    maps names in the page to paths in `modules`, the folder node_modules; `assets` are PNG files that
    the renderer would load from the network, by address. A request that takes `limit` seconds ends the
    browser.
    """

    def __init__(
        self,
        host: str,
        page: Path,
        imports: Mapping[str, str],
        modules: Path,
        *,
        assets: Mapping[str, bytes] | None = None,
        limit: float = LIMIT,
    ) -> None:
        if sync_api is None:
            raise NotRun(f"{host}: Playwright is not installed; {install('webgl')}")
        self._host = host
        self._script = page
        self._imports = {name: f"/{path}" for name, path in imports.items()}
        self._modules = modules
        self._assets = assets or {}
        self._program = webgl.program(host)
        self._limit = 1000.0 * limit
        self._page: Page = None
        self._stack = ExitStack()
        self._thread = ThreadPoolExecutor(max_workers=1)
        self._picture = lru_cache(maxsize=PICTURES)(self._drawn)

    def picture(self, job: Mapping[str, object], size: int) -> NDArray[np.float32]:
        return self._picture(json.dumps(job), size)

    def ask(self, job: Mapping[str, object]) -> Answer:
        """The page's answer to a job, with the version of the browser; NotRun ends a browser that hangs."""
        answer = self._thread.submit(self._answer, dict(job)).result()
        if "failed" in answer:
            raise NotRun(f"{self._host}: {answer['failed']}")
        return answer

    def close(self) -> None:
        self._thread.submit(self._stop).result()

    def _drawn(self, job: str, size: int) -> NDArray[np.float32]:
        return pixels(self.ask(json.loads(job)), size)

    def _answer(self, job: dict[str, object]) -> Answer:
        try:
            if self._page is None:
                self._start()
            handle = self._page.wait_for_function(
                "job => answer(job)", arg=job, timeout=self._limit
            )
            answer: Answer = handle.json_value()
            return answer | {"browser": self._page.context.browser.version}
        except sync_api.Error as error:
            self._stop()
            return {"failed": f"the browser fails; {error.message.splitlines()[0]}"}

    def _start(self) -> None:
        playwright = self._stack.enter_context(sync_api.sync_playwright())
        browser = self._stack.enter_context(
            playwright.chromium.launch(
                executable_path=self._program, args=FLAGS, chromium_sandbox=os.geteuid() != 0
            )
        )
        self._page = browser.new_page()
        self._page.set_default_timeout(self._limit)
        self._page.route("**/*", self._serve)
        self._page.goto(ORIGIN)
        self._page.wait_for_function("window.answer")

    def _serve(self, route: Page) -> None:
        if route.request.url in self._assets:
            body = self._assets[route.request.url]
            route.fulfill(body=body, content_type="image/png", headers=SHARED)
            return
        path = route.request.url.removeprefix(ORIGIN)
        if not path:
            imports = json.dumps({"imports": self._imports})
            route.fulfill(body=HTML.format(imports=imports), content_type="text/html")
            return
        own = {"page.js": self._script, "sphere.js": Path(__file__).with_name("sphere.js")}
        file = own.get(path, self._modules / path)
        if file.suffix in TYPES and file.is_file():
            route.fulfill(path=file, content_type=TYPES[file.suffix])
        else:
            route.fulfill(status=404, body="")

    def _stop(self) -> None:
        self._page = None
        self._stack.close()


def pixels(answer: Answer, size: int) -> NDArray[np.float32]:
    """Picture of an answer, (size, size, 3), row 0 at the top."""
    values = np.frombuffer(base64.b64decode(answer["pixels"]), dtype=np.float32)
    return values.reshape(size, size, 4)[..., :3]
