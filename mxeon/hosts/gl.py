# SPDX-License-Identifier: Apache-2.0
"""OpenGL without a window: generated GLSL on Mesa's software driver or a GPU, in float32.

A picture draws one vertex per pixel, placed at its centre, so each pixel holds the shader's value
at an exact point of the sphere, with neighbours to take derivatives from.
"""

from functools import lru_cache

import moderngl
import numpy as np

from mxeon import twins
from mxeon.hosts import Identity, NotRun, ShaderError, fragment
from mxeon.images import irradiance, read_latlong, read_texture
from mxeon.scene import sphere

VIEW_DISTANCE = 1e8  # makes normalize(u_viewPosition - positionWorld) the z axis, in float32
PROGRAMS = 16  # that are kept: a document's scenes and a node's checks share theirs
WHITE = np.ones((1, 1, 3), dtype=np.float32)


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

    def identity(self):
        """Version and device as the driver names them."""
        info = self._context.info
        return Identity(self.name, info["GL_VERSION"], info["GL_RENDERER"])

    def picture(self, shader, scene):
        """The shader on the sphere; see `mxeon.hosts`."""
        points = sphere(scene.size)
        radiance = read_latlong(scene.environment)
        textures = {
            each.name: read_texture(each.value)
            for each in shader.inputs
            if each.type == "filename" and each.value
        }
        textures |= {"u_envRadiance": radiance, "u_envIrradiance": irradiance(radiance)}
        program = self._program(shader.stages["vertex"], shader.stages["pixel"])
        _set_light(program, scene)
        image = self._draw(program, textures, _grid(scene.size), (scene.size, scene.size))
        return np.where(points.mask[..., None], image[::-1], np.float32(0.0))

    def evaluate(self, shader, wo, wi, inputs, branch):
        """The shader's own BSDF function for pairs of directions; see `mxeon.hosts`."""
        pixel, arguments = fragment.bsdf_evaluation(shader, wo, wi, inputs, branch)
        return self._evaluate(shader.stages["vertex"], pixel, arguments)

    def call(self, function, *arguments):
        """A function of the GLSL twins; see `mxeon.hosts`."""
        parameters = twins.signature("glsl", function)
        source = twins.source("glsl")
        pixel, named = fragment.function_evaluation(source, function, parameters, arguments)
        return self._evaluate(fragment.DIALECTS["glsl"].vertex, pixel, named)

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
        vertices, indices = _triangle()
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
        self._context.release()

    def _evaluate(self, vertex, pixel, arguments):
        """One pixel per element, as many as the longest argument has."""
        count, size = fragment.frame(arguments)
        textures = {name: fragment.texels(rows, size) for name, rows in arguments.items()}
        textures |= {"u_envRadiance": WHITE, "u_envIrradiance": WHITE}
        program = self._program(vertex, pixel)
        return self._draw(program, textures, _triangle(), size).reshape(-1, 3)[:count]

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


def _set_light(program, scene):
    values = {"u_viewPosition": (0.0, 0.0, VIEW_DISTANCE), "u_envRadianceMips": 1}
    values["u_numActiveLightSources"] = 0  # a program keeps what the last scene gave it
    if scene.light is not None:
        values |= {
            "u_numActiveLightSources": 1,
            "u_lightData[0].type": 1,
            "u_lightData[0].direction": tuple(-x for x in scene.light),
            "u_lightData[0].color": (1.0, 1.0, 1.0),
            "u_lightData[0].intensity": np.pi,
        }
    _set(program, values)


def _set(program, values):
    """Gives the uniforms that the program has their values."""
    for name, value in values.items():
        if name in program:
            program[name].value = value


def _grid(size):
    """Vertices at the pixel centres, one row more on each side, and triangles between them.

    A centre beside the sphere is moved to the nearest point of its rim, so the triangles that
    meet in a pixel's vertex surround it, and one of them covers the pixel.
    """
    points = sphere(size, margin=1)
    size = len(points.mask)
    flat = points.normal.reshape(-1, 3)
    tangent = np.stack([flat[:, 2], np.zeros(len(flat)), -flat[:, 0]], axis=1)
    vertices = {
        "i_position": flat,
        "i_normal": flat,
        "i_tangent": tangent / np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-30),
        "i_texcoord_0": points.texcoord.reshape(-1, 2),
    }
    corner = np.arange(size * size).reshape(size, size)[:-1, :-1].ravel()
    square = corner[:, None] + [0, 1, size, size, 1, size + 1]
    return {name: values.astype("f4") for name, values in vertices.items()}, square.astype("u4")


def _triangle():
    """One triangle over the whole frame."""
    corners = np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], dtype="f4")
    normals = np.tile(np.array([[0, 0, 1]], dtype="f4"), (3, 1))
    return {"i_position": corners, "i_normal": normals}, np.arange(3, dtype="u4")
