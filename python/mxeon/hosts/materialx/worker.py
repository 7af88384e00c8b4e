# SPDX-License-Identifier: Apache-2.0
"""Code of the `materialx` host that runs MaterialX's renderer; see `mxeon.hosts.process`.

The first argument of `start` is a folder whose `libraries` replace the libraries of MaterialX, or
"". The other arguments are folders of other libraries. The X display ends with the process.
"""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import lru_cache, partial
from itertools import product
from pathlib import Path
from typing import Any, TypeAlias

REMEDY = "on Debian: apt-get install libgl1 libsm6 libx11-6 xvfb"

PACKAGES = str(Path(__file__).parents[3])  # folder of this package
sys.path[:0] = filter(None, [os.environ.get("MXEON_MATERIALX"), PACKAGES])
import MaterialX as mx  # noqa: E402
import MaterialX.PyMaterialXGenShader as mx_gen  # noqa: E402
import numpy as np  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

try:
    import MaterialX.PyMaterialXRender as mx_render
    import MaterialX.PyMaterialXRenderGlsl as mx_render_glsl
except ImportError as error:
    sys.exit(f"MaterialX's renderer does not load ({error}); {REMEDY}")

from mxeon.shaders.generators import new_generator  # noqa: E402
from mxeon.shaders.methods import TABLE_SIZE  # noqa: E402
from mxeon.shaders.options import set_options  # noqa: E402

Chosen: TypeAlias = tuple[tuple[str, str | int | bool], ...]
FAR = 1e6  # distance of the camera, so that view directions are parallel
DIRECTIONS = 256  # directions over which microfacet shaders sum the environment
PICTURES = 8  # cached renderers, each with the program of a document
ANISOTROPY = ("GL_ARB_texture_filter_anisotropic", "GL_EXT_texture_filter_anisotropic")
SCREEN = ("-screen", "0", "64x64x24", "-nolisten", "tcp")
DIES_WITH_PARENT = 1  # the option PR_SET_PDEATHSIG of prctl
RENDERER = 0x1F01  # argument of glGetString
OPENGL = {
    "darwin": "/System/Library/Frameworks/OpenGL.framework/OpenGL",
    "win32": "opengl32",
}
SEARCH_PATH = mx.getDefaultDataSearchPath()
RAISED = (mx.Exception, mx_render.ExceptionRenderError, LookupError)


def open_display() -> None:
    """Start an Xvfb that ends with this process, unless DISPLAY already names a display."""
    if sys.platform != "linux" or os.environ.get("DISPLAY"):
        return
    program = shutil.which("Xvfb")
    if program is None:
        sys.exit(f"no display: DISPLAY is not set, and there is no Xvfb; {REMEDY}")
    prctl = ctypes.CDLL(None).prctl
    read, write = os.pipe()
    subprocess.Popen(
        [program, "-displayfd", str(write), *SCREEN],
        pass_fds=[write],
        preexec_fn=lambda: prctl(DIES_WITH_PARENT, signal.SIGKILL),
    )
    os.close(write)
    with os.fdopen(read) as pipe:
        number = pipe.readline().strip()
    if not number:
        sys.exit("no display: Xvfb does not start")
    os.environ["DISPLAY"] = f":{number}"


class ShownElement:
    def __init__(self, library: mx.Document, document: str, element: str, methods: Chosen) -> None:
        content = mx.createDocument()
        mx.readFromXmlFile(content, document)
        content.setDataLibrary(library)
        self._sun = content.addNode("directional_light", "mxeon_sun", "lightshader")
        self._sun.setInputValue("color", mx.Color3(1.0, 1.0, 1.0))
        self._sun.setInputValue("intensity", math.pi)
        self._lights = mx_render.LightHandler.create()
        self._lights.setLightSources([self._sun])
        self._lights.setEnvSampleCount(DIRECTIONS)
        generator = new_generator(library, "glsl")
        generator.registerTypeDefs(content)
        context = mx_gen.GenContext(generator)
        context.registerSourceCodeSearchPath(SEARCH_PATH)
        context.getOptions().targetDistanceUnit = "meter"
        set_options(context.getOptions(), **dict(methods))  # type: ignore[arg-type]
        if ("albedo", "table") in methods:
            self._lights.setAlbedoTable(albedo_table(generator, content))
        context.getOptions().fileTextureVerticalFlip = True
        self._lights.registerLights(content, [self._sun], context)
        shader = generator.generate("shader", content.getDescendant(element), context)
        self._renderer, self._mesh = open_renderer(), ""
        self._renderer.setLightHandler(self._lights)
        view = mx_render.Camera.create()
        eye, center, up = mx.Vector3(0, 0, FAR), mx.Vector3(0, 0, 0), mx.Vector3(0, 1, 0)
        view.setViewMatrix(mx_render.Camera.createViewMatrix(eye, center, up))
        matrix = mx_render.Camera.createOrthographicMatrix(-1, 1, -1, 1, FAR - 4, FAR + 4)
        view.setProjectionMatrix(matrix)
        self._renderer.setCamera(view)
        self._renderer.createProgram(shader)
        self._renderer.validateInputs()

    def draw(
        self,
        mesh: str,
        size: int,
        light: tuple[float, float, float] | None,
        environment: float | None,
    ) -> NDArray[np.float32]:
        """Picture of the square [-1, 1]^2, seen along -z, (size, size, 3), row 0 at the top."""
        if mesh != self._mesh:
            self._renderer.setGeometryHandler(geometry(mesh))
            self._mesh = mesh
        self._lights.setDirectLighting(light is not None)
        if light is not None:
            self._sun.setInputValue("direction", mx.Vector3(*(-x for x in light)))
        radiance = environment or 0.0
        color = mx.Color4(radiance, radiance, radiance, 1.0)
        image = mx_render.createUniformImage(2, 1, 3, mx_render.FLOAT, color)
        self._lights.setEnvRadianceMap(image)
        self._lights.setEnvIrradianceMap(image)
        self._lights.setEnvSampleCount(DIRECTIONS if environment else 1)
        self._renderer.setSize(size, size)
        self._renderer.render()
        image = self._renderer.captureImage(None)  # row 0 at the bottom
        texels = [image.getTexelColor(x, y) for y, x in product(range(size), repeat=2)]
        rows = np.array([(each[0], each[1], each[2]) for each in texels], np.float32)
        return rows.reshape(size, size, 3)[::-1]


def open_renderer() -> mx_render_glsl.GlslRenderer:
    renderer = mx_render_glsl.GlslRenderer.create(1, 1, mx_render.FLOAT)
    renderer.initialize()
    images = mx_render_glsl.GLTextureHandler.create(mx_render.StbImageLoader.create())
    renderer.setImageHandler(images)
    return renderer


def albedo_table(generator: mx_gen.ShaderGenerator, content: mx.Document) -> mx_render.Image:
    """The table of albedos, which a shader of the library computes by Monte Carlo integration."""
    context = mx_gen.GenContext(generator)
    context.registerSourceCodeSearchPath(SEARCH_PATH)
    context.getOptions().hwWriteAlbedoTable = True
    set_options(context.getOptions(), albedo="monteCarlo")
    output = content.addOutput("mxeon_table", "color3")
    output.setConnectedNode(content.addNode("constant", "mxeon_black", "color3"))
    renderer = open_renderer()
    renderer.setSize(TABLE_SIZE, TABLE_SIZE)
    renderer.createProgram(generator.generate("table", output, context))
    renderer.renderTextureSpace(mx.Vector2(0.0, 0.0), mx.Vector2(1.0, 1.0))
    return renderer.captureImage(None)


@lru_cache(maxsize=2)
def geometry(path: str) -> mx_render.GeometryHandler:
    """The quads in a NumPy file, cached because MaterialX takes long to read an OBJ file."""
    data, target = np.load(path), Path(path).with_suffix(".obj")
    lines = [
        f"{word} {' '.join(f'{number:.9g}' for number in row)}"
        for word, name in (("v", "position"), ("vt", "texcoord"), ("vn", "normal"))
        for row in data[name].tolist()
    ]
    corners = np.arange(1, len(data["position"]) + 1).reshape(-1, 4).tolist()
    lines += [f"f {' '.join(f'{each}/{each}/{each}' for each in quad)}" for quad in corners]
    target.write_text("\n".join(lines) + "\n", encoding="ascii")
    handler = mx_render.GeometryHandler.create()
    handler.addLoader(mx_render.TinyObjLoader.create())
    handler.loadGeometry(mx.FilePath(str(target)), False)
    return handler


def start(
    root: str, *folders: str
) -> tuple[dict[str, str], Callable[..., None], tuple[type[Exception], ...]]:
    global SEARCH_PATH
    # MaterialX reads textures with anisotropic filtering, which blurs the textures on Mesa.
    os.environ["MESA_EXTENSION_OVERRIDE"] = " ".join(f"-{each}" for each in ANISOTROPY)
    open_display()
    if root:
        SEARCH_PATH = mx.FileSearchPath(root)
    library = mx.createDocument()
    mx.loadLibraries([*folders, *mx.getDefaultDataLibraryFolders()], SEARCH_PATH, library)
    first_sources = [*folders, SEARCH_PATH.asString()]
    SEARCH_PATH = mx.FileSearchPath(mx.PATH_LIST_SEPARATOR.join(first_sources))
    first = open_renderer()
    picture = lru_cache(maxsize=PICTURES)(partial(ShownElement, library))

    def answer(
        output: str, document: str, element: str, methods: dict[str, Any] | None = None, **draw: Any
    ) -> None:
        shown = picture(document, element, tuple((methods or {}).items()))
        np.save(output, shown.draw(**draw))

    first.setSize(1, 1)  # make the context of `first` current
    function = ctypes.CDLL(OPENGL.get(sys.platform, "libGL.so.1")).glGetString
    function.restype = ctypes.c_char_p
    device = str(function(RENDERER).decode())
    greeting = {"version": f"MaterialX {mx.getVersionString()}", "device": device}
    return greeting, answer, RAISED
