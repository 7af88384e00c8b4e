# SPDX-License-Identifier: Apache-2.0
"""Renderers from npm packages, which draw pictures on pages in a headless Chromium.

The script of a page is an ES module in this folder. The module imports the renderer from the folder
`node_modules`, which Playwright serves. Nothing is bundled, and nothing leaves the machine.
"""

from __future__ import annotations

import base64
import inspect
import json
import math
import os
from abc import abstractmethod
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun
from mxeon.hosts import base, webgl
from mxeon.shaders.document.graphs import surface_shader
from mxeon.shaders.generation import Shader
from mxeon.shaders.library import data_folder
from mxeon.shaders.scene import Scene, sphere
from mxeon.survey.specs import Material

MODULES = "MXEON_NODE_MODULES"  # environment variable with the path of node_modules
ORIGIN = "https://renderers.invalid/"  # WebGPU needs a secure origin
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
PICTURES = 64  # cached pictures, which the checks of a node share
TYPES = {".js": "text/javascript", ".mjs": "text/javascript", ".json": "application/json"}


def packages_folder() -> Path:
    """Folder of the package.json and the lock file, which pin the renderers' versions."""
    installed = data_folder() / "renderers"
    return installed if installed.is_dir() else data_folder() / "tools" / "renderers"


def modules_folder(package: str, host: str) -> Path:
    """Path of node_modules, from MXEON_NODE_MODULES or next to the lock file."""
    folder = Path(os.environ.get(MODULES) or packages_folder() / "node_modules")
    if not (folder / package / "package.json").is_file():
        raise NotRun(
            f"{host}: no package {package} in {folder}; npm ci --prefix {packages_folder()}"
        )
    return folder


def pixels(answer: webgl.Answer, size: int) -> NDArray[np.float32]:
    """The pixels in the answer of a page, (size, size, 3), row 0 at the top."""
    values = np.frombuffer(base64.b64decode(answer["pixels"]), dtype=np.float32)
    return values.reshape(size, size, 4)[..., :3]


def material(backend: str, **more: str) -> Material:
    """A material with color and roughness, which a backend of the renderer draws."""
    return {"color": "{color}", "roughness": "{roughness}", "backend": backend, **more}


class PackageHost(webgl.Chromium, base.Engine):
    """Materials of an npm package, which a page draws.

    An ES module in the folder of the host's module exports `draw(job)`, which returns `pixels` or
    `failed`. `imports` maps names to paths in node_modules. `assets` are PNG files by address.
    """

    flags = (*webgl.FLAGS, "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader")
    limit = 60.0  # maximum seconds for a picture, including the start of the renderer
    title: ClassVar[str]
    package: ClassVar[str]
    imports: ClassVar[Mapping[str, str]]
    assets: ClassVar[Mapping[str, bytes]] = {}
    backends: ClassVar[tuple[str, ...]] = ("webgl", "webgpu")

    def __init__(self) -> None:
        self._modules = modules_folder(self.package, self.name)
        super().__init__()
        self._script = Path(inspect.getfile(type(self))).with_suffix(".js")
        self._picture = lru_cache(maxsize=PICTURES)(
            lambda job, size: pixels(self.ask(json.loads(job)), size)
        )

    def identity(self) -> base.Identity:
        answers = [self.ask({"backend": backend}) for backend in self.backends]
        known = json.loads((self._modules / self.package / "package.json").read_text("utf-8"))
        version = f"{self.title} {known['version']}, Chromium {answers[0]['browser']}"
        return base.Identity(self.name, version, "; ".join(answer["device"] for answer in answers))

    def node(self, material: Material, scene: Scene) -> base.Array:
        self.refuse_paths(scene)
        job = {
            "size": scene.size,
            "light": scene.light,
            "irradiance": math.pi,
            "environment": scene.environment,
            **material,
        }
        return self._picture(json.dumps(job), scene.size)

    def ask(self, job: Mapping[str, object]) -> webgl.Answer:
        return self._ask("job => answer(job)", dict(job))

    def _load(self) -> None:
        self._page.set_default_timeout(self._limit)
        self._page.route("**/*", self._serve)
        self._page.goto(ORIGIN)
        self._page.wait_for_function("window.answer")

    def _serve(self, route: webgl.Page) -> None:
        if route.request.url in self.assets:
            body = self.assets[route.request.url]
            route.fulfill(body=body, content_type="image/png", headers=SHARED)
            return
        path = route.request.url.removeprefix(ORIGIN)
        if not path:
            imports = {"imports": {name: f"/{path}" for name, path in self.imports.items()}}
            html = HTML.format(imports=json.dumps(imports))
            route.fulfill(body=html, content_type="text/html")
            return
        pages = {"page.js": self._script, "sphere.js": Path(__file__).with_name("sphere.js")}
        file = pages.get(path, self._modules / path)
        if file.suffix in TYPES and file.is_file():
            route.fulfill(path=file, content_type=TYPES[file.suffix])
        else:
            route.fulfill(status=404, body="")


class ReadingHost(PackageHost, base.Host):
    """A package that loads MaterialX documents, as in `mxeon check FILE --host three`.

    The package generates its own shaders, so the GLSL from `compile` is not executed. Only distant
    lights are supported, because packages prefilter environments.
    """

    target, fixed = "glsl", True

    def compile(self, *arguments: Any, **options: Any) -> tuple[Shader, ...]:
        """Compile with stock MaterialX definitions, because the package uses no library."""
        return super().compile(*arguments, **options | {"library": "stock"})

    def picture(self, shader: Shader, scene: Scene) -> base.Array:
        self.refuse_shape(scene)
        if scene.environment is not None:
            raise NotRun(f"{self.name}: light must be distant")
        if not shader.document.getDescendant(shader.element).isA(mx.Node):
            raise NotRun(f"{self.name}: element must be a material; got {shader.element}")
        image = self.node(self.read(shader), scene)
        return np.where(sphere(scene.size).mask[..., None], image, np.float32(0.0))

    def unread(self, shader: Shader) -> str:
        """Description of inputs that the package ignores, except inputs with default values."""
        surface = surface_shader(shader.document, shader.element)
        defaults = {
            each.getName(): each.getValueString() for each in surface.getNodeDef().getActiveInputs()
        }
        values = {each.getName(): each.getValueString() for each in surface.getInputs()}
        ignored = [
            each
            for each in self.ask(self.read(shader))["ignored"]
            if each not in values or values[each] != defaults[each]
        ]
        return f"it ignores {', '.join(ignored)}" if ignored else ""

    @abstractmethod
    def read(self, shader: Shader) -> Material:
        """The job with which the page draws a shader's material."""
