# SPDX-License-Identifier: Apache-2.0
"""OpenGL without a window: generated GLSL on Mesa's software driver or a GPU, in float32."""

from functools import lru_cache, wraps

import moderngl
import numpy as np

from mxeon.errors import NotRun, ShaderError
from mxeon.shaders import functions as twins
from mxeon.shaders.hosts import fragment, raster
from mxeon.shaders.hosts.base import Identity

PROGRAMS = 16  # that are kept: a document's scenes and a node's checks share theirs


def _current(verb):
    """A verb with the host's context current: other hosts of a process have contexts of their own."""

    @wraps(verb)
    def wrapped(self, *arguments):
        with self._context:
            return verb(self, *arguments)

    return wrapped


class Host:
    """OpenGL through EGL.

    Raises
    ------
    NotRun
        If there is no EGL or no OpenGL 4.3.
    """

    name = "gl"
    target = "glsl"
    profile = None

    def __init__(self):
        try:
            self._context = moderngl.create_standalone_context(require=430, backend="egl")
        except Exception as error:  # moderngl and glcontext raise bare Exception
            raise NotRun(
                f"gl: no OpenGL 4.3 through EGL ({str(error).strip()}); on Debian: "
                "apt-get install libegl1 libgl1-mesa-dri"
            ) from None
        self._context.gc_mode = "auto"
        self._program = lru_cache(maxsize=PROGRAMS)(self._compile)

    @_current
    def identity(self):
        """Version and device as the driver names them."""
        info = self._context.info
        return Identity(self.name, info["GL_VERSION"], info["GL_RENDERER"])

    @_current
    def picture(self, shader, scene):
        """The shader on the sphere; see `mxeon.shaders.hosts`."""
        program = self._program(shader.stages["vertex"], shader.stages["pixel"])
        _set(program, raster.inputs(shader) | raster.light(scene))
        size = scene.size
        image = self._draw(program, raster.textures(shader, scene), raster.grid(size), (size, size))
        return raster.picture(image, size)

    @_current
    def evaluate(self, shader, wo, wi, inputs, branch):
        """The shader's own BSDF function for pairs of directions; see `mxeon.shaders.hosts`."""
        pixel, arguments = fragment.bsdf_evaluation(shader, wo, wi, inputs, branch)
        return self._evaluate(shader.stages["vertex"], pixel, arguments)

    @_current
    def call(self, function, *arguments):
        """A function of the GLSL twins; see `mxeon.shaders.hosts`."""
        parameters = twins.signature("glsl", function)
        source = twins.source("glsl")
        pixel, named = fragment.function_evaluation(source, function, parameters, arguments)
        return self._evaluate(fragment.DIALECTS["glsl"].vertex, pixel, named)

    @_current
    def accumulate(self, pixel, uniforms, size, passes):
        """The sum over passes of what a fragment shader draws; the uniform `tracer_pass` counts them.

        Parameters
        ----------
        pixel : str
            Fragment shader.
        uniforms : mapping of str to value
            Those that the shader does not use are left out.
        size : tuple of int
            Width and height.
        passes : iterable of int
            What `tracer_pass` is in each.

        Returns
        -------
        ndarray, shape (height, width, 4), float32
            Row 0 at the bottom.
        """
        context = self._context
        program = self._program(fragment.DIALECTS["glsl"].vertex, pixel)
        _set(program, uniforms)
        vertices, indices = raster.triangle()
        corners = [(context.buffer(vertices["i_position"]), "3f", "i_position")]
        triangle = context.vertex_array(program, corners, context.buffer(indices))
        frame = context.framebuffer([context.renderbuffer(size, components=4, dtype="f4")])
        frame.use()
        frame.clear()
        context.enable(context.BLEND)
        context.blend_func = context.ONE, context.ONE
        for each in passes:
            program["tracer_pass"].value = each
            triangle.render()
            context.finish()
        context.disable(context.BLEND)
        image = np.frombuffer(frame.read(components=4, dtype="f4"), dtype=np.float32)
        return image.reshape(size[1], size[0], 4)

    def close(self):
        """Give the context back; the host is of no use afterwards."""
        with self._context:  # later, programs would be deleted in whatever context is current then
            self._program.cache_clear()
        self._context.release()

    def _evaluate(self, vertex, pixel, arguments):
        """One pixel per element, as many as the longest argument has."""
        count, size = fragment.frame(arguments)
        textures = {name: fragment.texels(rows, size) for name, rows in arguments.items()}
        textures |= raster.SURROUNDING
        program = self._program(vertex, pixel)
        return self._draw(program, textures, raster.triangle(), size).reshape(-1, 3)[:count]

    def _compile(self, vertex, pixel):
        try:
            return self._context.program(vertex_shader=vertex, fragment_shader=pixel)
        except moderngl.Error as error:
            raise ShaderError(f"gl: {str(error).strip()}") from None

    def _draw(self, program, textures, mesh, size):
        """One frame as float32 (height, width, 3), row 0 at the bottom."""
        context = self._context
        frame = context.framebuffer([context.renderbuffer(size, components=4, dtype="f4")])
        frame.use()
        frame.clear()
        used = [name for name in textures if name in program]
        bound = [self._texture(textures[name], name == "u_envRadiance") for name in used]
        for unit, (name, texture) in enumerate(zip(used, bound, strict=True)):
            texture.use(location=unit)
            program[name].value = unit
        vertices, indices = mesh
        buffers = [
            (context.buffer(values), f"{values.shape[1]}f", name)
            for name, values in vertices.items()
            if name in program
        ]
        context.vertex_array(program, buffers, context.buffer(indices)).render()
        image = np.frombuffer(frame.read(components=3, dtype="f4"), dtype=np.float32)
        return image.reshape(size[1], size[0], 3)

    def _texture(self, texels, mipmaps):
        height, width, components = texels.shape
        data = np.ascontiguousarray(texels, dtype=np.float32)
        texture = self._context.texture((width, height), components, data, dtype="f4")
        if mipmaps:
            texture.build_mipmaps()
        return texture


def _set(program, values):
    """Gives the uniforms that the program has their values."""
    for name, value in values.items():
        if name in program:
            program[name].value = value
