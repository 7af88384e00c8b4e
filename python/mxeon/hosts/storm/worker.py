# SPDX-License-Identifier: Apache-2.0
"""Code of the `storm` host that runs in Blender's Python; see `mxeon.hosts.process`.

The first argument of `start` is a folder whose `libraries` replace the libraries of Blender's
MaterialX, or "". The other arguments are folders of other libraries.
"""

from __future__ import annotations

import ctypes
import math
import os
import sys
from collections.abc import Callable
from ctypes import byref, c_char_p, c_double, c_float, c_int, c_uint, c_void_p
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Foreign: TypeAlias = Any  # an object of OpenUSD, or the result of a library function
Pixels: TypeAlias = NDArray[np.float32]
Type: TypeAlias = type[c_void_p | c_uint | c_char_p] | None  # result type in EGL or OpenGL

INSTALL, DEBIAN = "pip install bpy==5.0.1", "apt-get install libegl1 libgl1-mesa-dri"
MODULES = ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdImagingGL", "UsdLux", "UsdShade", "Vt")
# Distance of the camera, which is large because Storm computes view directions from the position of
# the camera, even for an orthographic projection.
FAR = 1e6
ANGLE = 0.1  # angle of the distant light in degrees; the light would be black with angle 0
# Storm sums a dome's irradiance over a right angle in 64 steps. In float32, 64 steps add up to less
# than the angle, so Storm adds a 65th step and divides by 65. The irradiance of a white dome is
# therefore too small by this factor.
WHITE_DOME = math.pi / 130.0 / math.tan(math.pi / 128.0)
CARD = 2.0  # distance from the origin to a white card that emits light, behind the quads
# A white pixel in the Radiance format, for the dome, because a dome without a texture is black.
WHITE_IMAGE = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81"

# Values of constants in EGL and OpenGL.
DEVICE, DESKTOP = 0x313F, 0x30A2
CONFIG = (c_int * 5)(0x3040, 0x0008, 0x3033, 0, 0x3038)  # OpenGL without a surface
# OpenGL 4.5 in the compatibility profile, because Storm uses functions that the core profile lacks.
CONTEXT = (c_int * 7)(0x3098, 4, 0x30FB, 5, 0x30FD, 2, 0x3038)
FRAMEBUFFER, BUFFER, COLOR, DEPTH = 0x8D40, 0x8D41, 0x8CE0, 0x8D00
RGBA32F, DEPTH32F, RGBA, FLOAT = 0x8814, 0x8CAC, 0x1908, 0x1406
BOTH, RENDERER = 0x4100, 0x1F01
usd: Foreign = None  # the package of OpenUSD, which `start` imports


class Handle(c_void_p):
    pass


class Canvas:
    """A frame of float32 pixels, which OpenGL 4.5 draws without a window through EGL."""

    def __init__(self) -> None:
        self._size, self._name = 0, c_uint()
        self._egl = ctypes.CDLL("libEGL.so.1")
        self._egl.eglGetProcAddress.restype = c_void_p
        devices, config, count = (Handle * 8)(), Handle(), c_int()
        self._call("eglQueryDevicesEXT", c_uint, 8, devices, byref(count))
        display = self._call("eglGetPlatformDisplayEXT", Handle, DEVICE, devices[0], None)
        self._call("eglInitialize", c_uint, display, None, None)
        self._call("eglBindAPI", c_uint, DESKTOP)
        self._call("eglChooseConfig", c_uint, display, CONFIG, byref(config), 1, byref(count))
        context = self._call("eglCreateContext", Handle, display, config, None, CONTEXT)
        if not self._call("eglMakeCurrent", c_uint, display, None, None, context):
            raise OSError("no OpenGL 4.5")
        self.device = self._call("glGetString", c_char_p, RENDERER).decode()

    def clear(self, size: int) -> None:
        """Start a black frame, `size` pixels wide and high."""
        if size != self._size:
            self._size, buffers = size, (c_uint * 2)()
            self._call("glGenFramebuffers", None, 1, byref(self._name))
            self._call("glBindFramebuffer", None, FRAMEBUFFER, self._name)
            self._call("glGenRenderbuffers", None, 2, buffers)
            kinds, places = (RGBA32F, DEPTH32F), (COLOR, DEPTH)
            for buffer, kind, place in zip(buffers, kinds, places, strict=True):
                self._call("glBindRenderbuffer", None, BUFFER, buffer)
                self._call("glRenderbufferStorage", None, BUFFER, kind, size, size)
                self._call("glFramebufferRenderbuffer", None, FRAMEBUFFER, place, BUFFER, buffer)
        self._call("glBindFramebuffer", None, FRAMEBUFFER, self._name)
        self._call("glClearColor", None, *[c_float(0.0)] * 4)
        self._call("glClearDepth", None, c_double(1.0))
        self._call("glClear", None, BOTH)

    def pixels(self) -> Pixels:
        """Pixels of the frame, (size, size, 3), row 0 at the top."""
        image = np.zeros((self._size, self._size, 4), np.float32)
        self._call("glBindFramebuffer", None, FRAMEBUFFER, self._name)
        memory = c_void_p(image.ctypes.data)
        self._call("glReadPixels", None, 0, 0, self._size, self._size, RGBA, FLOAT, memory)
        return image[::-1, :, :3]

    def _call(self, name: str, result: Type, *arguments: object) -> Foreign:
        address = self._egl.eglGetProcAddress(name.encode())
        if not address:
            raise OSError(f"EGL has no {name}")
        return ctypes.CFUNCTYPE(result)(address)(*arguments)


class Stage:
    def __init__(self, canvas: Canvas) -> None:
        self._canvas, self._mesh_path = canvas, ""
        self._stage = usd.Usd.Stage.CreateInMemory()
        self._mesh = usd.UsdGeom.Mesh.Define(self._stage, "/mesh")
        self._mesh.CreateSubdivisionSchemeAttr("none")
        self._mesh.SetNormalsInterpolation("vertex")
        kind = usd.Sdf.ValueTypeNames.TexCoord2fArray
        self._texcoord = usd.UsdGeom.PrimvarsAPI(self._mesh).CreatePrimvar("st", kind, "vertex")
        self._look = self._stage.OverridePrim("/look")
        self._sun = usd.UsdLux.DistantLight.Define(self._stage, "/sun")
        self._sun.CreateIntensityAttr(math.pi)
        self._sun.CreateNormalizeAttr(True)
        self._sun.CreateAngleAttr(ANGLE)
        self._turn = usd.UsdGeom.Xformable(self._sun).AddTransformOp()
        white = Path(os.environ["TMPDIR"], "white.hdr")
        white.write_bytes(WHITE_IMAGE)
        self._dome = usd.UsdLux.DomeLight.Define(self._stage, "/dome")
        self._dome.CreateTextureFileAttr(str(white))
        self._card = usd.UsdGeom.Mesh.Define(self._stage, "/card")
        self._card.CreateSubdivisionSchemeAttr("none")
        corners = [(x, y, -CARD) for x, y in ((-2, -2), (2, -2), (2, 2), (-2, 2))]
        self._card.CreatePointsAttr(usd.Vt.Vec3fArray(corners))
        self._card.CreateFaceVertexCountsAttr([4])
        self._card.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
        white_look = usd.UsdShade.Material.Define(self._stage, "/white")
        shader = usd.UsdShade.Shader.Define(self._stage, "/white/shader")
        shader.CreateIdAttr("UsdPreviewSurface")
        color = usd.Sdf.ValueTypeNames.Color3f
        shader.CreateInput("emissiveColor", color).Set((1.0, 1.0, 1.0))
        shader.CreateInput("diffuseColor", color).Set((0.0, 0.0, 0.0))
        shader.CreateInput("roughness", usd.Sdf.ValueTypeNames.Float).Set(1.0)
        shader.CreateInput("useSpecularWorkflow", usd.Sdf.ValueTypeNames.Int).Set(1)
        white_look.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        usd.UsdShade.MaterialBindingAPI.Apply(self._card.GetPrim()).Bind(white_look)
        self._engine = usd.UsdImagingGL.Engine()
        self._engine.SetRendererAov("color")

    def render(
        self,
        mesh: str,
        document: str,
        element: str,
        size: int,
        light: tuple[float, float, float] | None,
        environment: float | None,
        card: bool = False,
    ) -> Pixels:
        """Picture of a square with sides of length 2, seen along -z."""
        if mesh != self._mesh_path:
            data, self._mesh_path = np.load(mesh), mesh
            self._center = usd.Gf.Vec3d(*map(float, data["center"]), FAR)
            count = len(data["position"])
            vectors, numbers = usd.Vt.Vec3fArray.FromNumpy, usd.Vt.IntArray.FromNumpy
            self._mesh.CreatePointsAttr(vectors(data["position"]))
            self._mesh.CreateNormalsAttr(vectors(data["normal"]))
            self._mesh.CreateFaceVertexCountsAttr(numbers(np.full(count // 4, 4, np.int32)))
            self._mesh.CreateFaceVertexIndicesAttr(numbers(np.arange(count, dtype=np.int32)))
            self._texcoord.Set(usd.Vt.Vec2fArray.FromNumpy(data["texcoord"]))
        references = self._look.GetReferences()
        references.ClearReferences()
        references.AddReference(document, "/MaterialX")
        prim = self._stage.GetPrimAtPath(f"/look/Materials/{element}")
        if not prim:
            raise LookupError(f"OpenUSD found no material {element}")
        binding = usd.UsdShade.MaterialBindingAPI.Apply(self._mesh.GetPrim())
        binding.Bind(usd.UsdShade.Material(prim))
        self._sun.GetPrim().SetActive(light is not None)
        self._dome.GetPrim().SetActive(environment is not None)
        if light is not None:
            turn = usd.Gf.Rotation(usd.Gf.Vec3d(0.0, 0.0, 1.0), usd.Gf.Vec3d(*light))
            self._turn.Set(usd.Gf.Matrix4d().SetRotate(turn))
        if environment is not None:
            self._dome.CreateIntensityAttr(environment / WHITE_DOME)
        self._card.GetPrim().SetActive(card)
        frustum = usd.Gf.Frustum()
        frustum.projectionType = usd.Gf.Frustum.Orthographic
        frustum.window = usd.Gf.Range2d((-1.0, -1.0), (1.0, 1.0))
        frustum.position = self._center
        frustum.nearFar = usd.Gf.Range1d(FAR - 4.0, FAR + 4.0)
        view, projection = frustum.ComputeViewMatrix(), frustum.ComputeProjectionMatrix()
        self._engine.SetCameraState(view, projection)
        self._engine.SetRenderViewport(usd.Gf.Vec4d(0.0, 0.0, size, size))
        options = usd.UsdImagingGL.RenderParams()
        options.colorCorrectionMode = "disabled"
        self._canvas.clear(size)
        self._engine.Render(self._stage.GetPseudoRoot(), options)
        return self._canvas.pixels()


def import_usd(root: str, libraries: str) -> Foreign:
    """Import OpenUSD from Blender's package.

    `libraries` are added to the libraries of `root`, or of Blender's MaterialX if `root` is "".
    """
    # Find Blender's package without importing it.
    found = find_spec("bpy")
    if found is None or not found.submodule_search_locations:
        raise ImportError("no package bpy")
    package = Path(found.submodule_search_locations[0])
    sys.path += map(str, package.glob("*/python/lib/python*/site-packages"))
    # OpenUSD reads the environment variables PXR_... when imported.
    os.environ["PXR_PLUGINPATH_NAME"] = str(package / "lib" / "usd")
    standard = Path(root or package / "lib" / "materialx", "libraries")
    os.environ["PXR_MTLX_STDLIB_SEARCH_PATHS"] = str(standard)
    os.environ["PXR_MTLX_PLUGIN_SEARCH_PATHS"] = libraries
    # Storm copies a picture by sampling a texture. Mesa's anisotropic filter would blur the copy.
    os.environ["HGI_MAX_ANISOTROPY"] = "1"
    for name in MODULES:
        import_module(f"pxr.{name}")
    return import_module("pxr")


def start(
    root: str, *libraries: str
) -> tuple[dict[str, str], Callable[..., None], tuple[type[Exception], ...]]:
    global usd
    try:
        canvas = Canvas()
    except OSError as error:
        sys.exit(f"no OpenGL 4.5 through EGL ({error}); on Debian: {DEBIAN}")
    try:
        usd = import_usd(root, os.pathsep.join(libraries))
        materialx = import_module("MaterialX").getVersionString()
    except ImportError as error:
        sys.exit(f"{error}; {INSTALL} in the environment of {sys.executable}")
    stage = Stage(canvas)
    _, minor, patch = usd.Usd.GetVersion()
    version = f"OpenUSD {minor}.{patch}, MaterialX {materialx}"

    def answer(output: str, **request: Any) -> None:
        np.save(output, stage.render(**request))

    return (
        {"version": version, "device": canvas.device},
        answer,
        (LookupError, usd.Tf.ErrorException),
    )
