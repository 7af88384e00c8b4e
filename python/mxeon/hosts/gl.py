# SPDX-License-Identifier: Apache-2.0
"""OpenGL without a window, which runs generated GLSL in float32 on Mesa's driver or a GPU."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache, partial, wraps
from typing import Any, Concatenate, ParamSpec, TypeVar, cast

import moderngl
import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun, refused
from mxeon.hosts import fragment, points, raster
from mxeon.hosts.base import TABLE, Array, Identity
from mxeon.hosts.raster import FragmentHost
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import VisiblePoints

PROGRAMS = 4  # cached programs of 10 MB, which a document's scenes or a node's checks share
COPIED = 256  # rows of a texture that are copied at a time
CONSTANTS = 64  # cached textures of one value, because most inputs are constant
POINTS = 4  # cached textures of points; most materials share a texture
REMEDIES = {
    "linux": "on Debian: apt-get install libegl1 libgl1-mesa-dri",
    "darwin": "macOS supports only OpenGL 4.1: use --host wgsl or --host webgl",
    "win32": "install the driver of a GPU, or use --host wgsl or --host webgl",
}

P = ParamSpec("P")
T = TypeVar("T")


def _current(verb: Callable[Concatenate[GlHost, P], T]) -> Callable[Concatenate[GlHost, P], T]:
    """Make the host's context current during a method, because every host has its own context.

    The same number names different objects in different contexts. Objects that Python has dropped
    are therefore deleted here, while the context that has created the objects is current.
    """

    @wraps(verb)
    def wrapped(self: GlHost, /, *arguments: P.args, **options: P.kwargs) -> T:
        with self._context:
            try:
                return verb(self, *arguments, **options)
            finally:
                self._context.gc()

    return wrapped


class GlHost(FragmentHost):
    name = "gl"
    target = "glsl"
    draws_images = True

    def __init__(self) -> None:
        backend: Any = {"backend": "egl"} if sys.platform == "linux" else {}
        try:
            self._context = moderngl.create_context(require=430, standalone=True, **backend)
        except Exception as error:  # moderngl and glcontext raise bare Exception
            remedy = REMEDIES.get(sys.platform, REMEDIES["linux"])
            raise NotRun(f"gl: no OpenGL 4.3 ({str(error).strip()}); {remedy}") from None
        self._context.gc_mode = "context_gc"
        self._program = lru_cache(maxsize=PROGRAMS)(partial(_program, self._context))
        self._constant = lru_cache(maxsize=CONSTANTS)(self._filled)
        self._points = lru_cache(maxsize=POINTS)(partial(_points, self._context))

    @_current
    def identity(self) -> Identity:
        info = self._context.info
        return Identity(self.name, info["GL_VERSION"], info["GL_RENDERER"])

    @_current
    def _shade(
        self,
        shader: Shader,
        seen: VisiblePoints,
        textures: dict[str, Array],
        uniforms: raster.Uniforms,
        parts: Sequence[raster.Rectangle],
    ) -> Array:
        program = self._program(fragment.DIALECTS["glsl"].vertex, points.pixel_stage(shader))
        _set(program, uniforms)
        captured, frame = points.outputs(shader), points.frame(seen)
        bound = self._textures(program, textures)
        if captured:
            given = points.constants(shader)
            bound[points.SAMPLER] = self._points(shader.stages["vertex"], captured, seen, given)
        return self._draw(program, bound, frame, parts)[::-1]

    @_current
    def accumulate(
        self,
        pixel: str,
        uniforms: Mapping[str, object],
        size: tuple[int, int],
        passes: Iterable[int],
        textures: Mapping[str, Array],
    ) -> NDArray[np.float32]:
        """Sum of the frames of a fragment shader, one frame for each value of `tracer_pass`.

        The sum has the shape (height, width, 4), with row 0 at the bottom. The values of the
        uniform `tracer_pass` are `passes`. Unused uniforms are ignored.
        """
        context = self._context
        program = self._program(fragment.DIALECTS["glsl"].vertex, pixel)
        _set(program, uniforms)
        frame, triangle = self._begin(program, self._textures(program, textures), size)
        context.enable(context.BLEND)
        context.blend_func = context.ONE, context.ONE
        for index in passes:
            _set(program, {"tracer_pass": index})
            triangle.render()
            context.finish()
        context.disable(context.BLEND)
        image = np.frombuffer(frame.read(components=4, dtype="f4"), dtype=np.float32)
        return image.reshape(size[1], size[0], 4)

    def _begin(
        self,
        program: moderngl.Program,
        textures: Mapping[str, moderngl.Texture | moderngl.TextureArray],
        size: tuple[int, int],
    ) -> tuple[moderngl.Framebuffer, moderngl.VertexArray]:
        """Bind textures and a black frame. Returns the frame, and a triangle over all pixels."""
        context = self._context
        frame = context.framebuffer([context.renderbuffer(size, components=4, dtype="f4")])
        frame.use()
        frame.clear()
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(location=unit)
            _set(program, {name: unit})
        buffers = _buffers(context, program, raster.TRIANGLE)
        return frame, context.vertex_array(program, buffers)

    def close(self) -> None:
        self._program.cache_clear()
        self._constant.cache_clear()
        self._points.cache_clear()
        self._context.release()

    @_current
    def _evaluate(self, frame: raster.Frame) -> Array:
        program = self._program(frame.vertex, frame.pixel)
        _set(program, frame.uniforms)
        count, size = fragment.frame(frame.arguments)
        arguments = {
            name: self._argument(rows, size)
            for name, rows in frame.arguments.items()
            if program.get(name, None)
        }
        textures = {**arguments, **self._textures(program, frame.textures)}
        return self._draw(program, textures, size).reshape(-1, 3)[:count]

    def _draw(
        self,
        program: moderngl.Program,
        textures: Mapping[str, moderngl.Texture | moderngl.TextureArray],
        size: tuple[int, int],
        parts: Sequence[raster.Rectangle] = (),
    ) -> Array:
        """Float32 pixels (height, width, 3) of a frame or its parts, row 0 at the bottom."""
        frame, triangle = self._begin(program, textures, size)
        # Mesa would compile a program for entirely covered tiles and again for other tiles. Masking
        # a color component avoids the second compilation.
        frame.color_mask = True, True, True, False
        for part in parts or [(0, 0, *size)]:
            frame.scissor = part
            triangle.render()
        image = np.frombuffer(frame.read(components=3, dtype="f4"), dtype=np.float32)
        return image.reshape(size[1], size[0], 3)

    def _textures(
        self, program: moderngl.Program, texels: Mapping[str, Array]
    ) -> dict[str, moderngl.Texture | moderngl.TextureArray]:
        """Textures for the samplers of a program. Samplers with the same array share a texture.

        Environment maps are clamped at the poles. Uniform maps repeat, because clamping would turn
        a NaN coordinate into a number and hide the NaN from a check.
        """
        created: dict[tuple[int, bool], moderngl.Texture] = {}
        textures: dict[str, moderngl.Texture | moderngl.TextureArray] = {}
        for name, values in texels.items():
            if program.get(name, None):
                key = id(values), name == "u_envRadiance"
                textures[name] = created[key] = created.get(key) or self._texture(values, key[1])
        for name in textures.keys() & {"u_envRadiance", "u_envIrradiance"}:
            textures[name].repeat_y = texels[name].shape[0] <= len(raster.WHITE_TEXELS)
        if table := textures.get(TABLE):
            table.repeat_x = table.repeat_y = False
        return textures

    def _argument(self, rows: Array, size: tuple[int, int]) -> moderngl.Texture:
        if rows.ndim == 2 and len(rows) == 1:
            return self._constant(rows.tobytes(), size)
        return self._texture(fragment.texels(rows, size, fragment.ODD), mipmaps=False)

    def _filled(self, value: bytes, size: tuple[int, int]) -> moderngl.Texture:
        row = np.frombuffer(value, np.float32)[np.newaxis]
        return self._texture(fragment.texels(row, size, fragment.ODD), mipmaps=False)

    def _texture(self, texels: Array, mipmaps: bool) -> moderngl.Texture:
        if gray := not texels.strides[-1]:  # the array repeats one channel; see read_texture
            texels = texels[..., :1]
        height, width, components = texels.shape
        texture = self._context.texture((width, height), components, dtype="f4")
        for row in range(0, height, COPIED):
            rows = np.ascontiguousarray(texels[row : row + COPIED], dtype=np.float32)
            texture.write(rows, viewport=(0, row, width, len(rows)))
        if gray:
            texture.swizzle = "RRR1"
        if mipmaps:
            texture.build_mipmaps()
        return texture


def _program(context: moderngl.Context, vertex: str, pixel: str) -> moderngl.Program:
    try:
        return context.program(vertex_shader=vertex, fragment_shader=pixel)
    except moderngl.Error as error:
        raise refused("gl", str(error), pixel) from None


def _points(
    context: moderngl.Context,
    vertex: str,
    captured: tuple[points.Output, ...],
    seen: VisiblePoints,
    constants: points.Constants,
) -> moderngl.TextureArray:
    program = context.program(vertex_shader=vertex, varyings=tuple(each.name for each in captured))
    vertices = points.vertices(seen, constants)
    count = len(vertices["i_position"])
    stage = context.vertex_array(program, _buffers(context, program, vertices))
    buffer = context.buffer(reserve=count * points.stride(captured))
    context.simple_framebuffer((1, 1)).use()  # OpenGL draws nothing without a framebuffer
    stage.transform(buffer, mode=context.POINTS, vertices=count)
    texels = points.texels(buffer.read(), captured, seen)
    layers, height, width, _ = texels.shape
    return context.texture_array((width, height, layers), 4, texels, dtype="f4")


def _buffers(
    context: moderngl.Context, program: moderngl.Program, vertices: Mapping[str, Array]
) -> list[tuple[moderngl.Buffer, str, str]]:
    return [
        (context.buffer(values), f"{values.shape[1]}f", name)
        for name, values in vertices.items()
        if program.get(name, None)
    ]


def _set(program: moderngl.Program, values: Mapping[str, object]) -> None:
    for name, value in values.items():
        if member := program.get(name, None):
            cast(moderngl.Uniform, member).value = value
