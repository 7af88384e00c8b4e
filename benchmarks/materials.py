# SPDX-License-Identifier: Apache-2.0
"""Generated materials with eonlib and with stock MaterialX: source, compilation, frame time."""

from dataclasses import replace
from functools import partial
from itertools import count

import numpy as np

from benchmarks.rounds import Check, Group, clock_of, figure, interleave, ratio, scaled
from mxeon.shaders.hosts import gl, points, raster
from mxeon.shaders.library import LIBRARIES
from mxeon.shaders.nodes import (
    FLAG,
    OREN_NAYAR,
    SURFACE,
    document_text,
    input_text,
    lobe_text,
    node_text,
)
from mxeon.shaders.scene import SIDE, sphere

SIZE = 1024
FRAMES = 2
MESH = 128  # squares along a side of the mesh, few enough to cost nothing beside the pixels
ROUGHNESS = {
    "open_pbr_surface": "base_diffuse_roughness",
    "standard_surface": "diffuse_roughness",
}
NODES = {"oren_nayar": lobe_text(OREN_NAYAR, {"roughness": 0.6, FLAG: True}) + SURFACE} | {
    category: node_text(category, "surfaceshader", "shading", input_text(name, "float", 0.6))
    for category, name in ROUGHNESS.items()
}
SHORTER = {"oren_nayar": 1.0}
GOALS = {"oren_nayar": 1.0, "open_pbr_surface": 1.0}

# Of values up to 2: MaterialX's own EON loses digits of 1 - E, 3e-4. Its standard_surface asks for
# QON, whose value for s < 0 both libraries give alike.
TOLERANCE = 3e-4

# Cosine from which pixels are compared: the coarse mesh does not end on the rim of the sphere.
FACING = 0.2


def shader(host, node, library):
    """The generated shader of a material around one node."""
    return host.compile(document_text(NODES[node]), library=library)[0]


class Frame:
    """A material on the sphere, drawn again and again with its uniforms and buffers in place.

    One picture as by `mxeon.shaders.hosts.gl`, with its functions, and the set-up kept apart.
    """

    def __init__(self, host, generated, size):
        context = self._context = host._context
        self._target = context.framebuffer([context.renderbuffer((size, size), 4, dtype="f4")])
        program = gl._program(context, generated.stages["vertex"], generated.stages["pixel"])
        gl._set(program, raster.light(SIDE))
        for unit, name in enumerate(("u_envRadiance", "u_envIrradiance")):
            if name in program:
                host._texture(raster.WHITE, False).use(location=unit)
                program[name].value = unit
        vertices, indices = mesh(MESH)
        buffers = [
            (context.buffer(values), f"{values.shape[1]}f", name)
            for name, values in vertices.items()
            if name in program
        ]
        self._mesh = context.vertex_array(program, buffers, context.buffer(indices))

    def draw(self, frames=FRAMES):
        """Draw so many frames, to the end."""
        self._target.use()
        for _ in range(frames):
            self._target.clear()
            self._mesh.render()
        self._context.finish()

    def image(self):
        """Pixels of the last picture."""
        width, height = self._target.size
        pixels = np.frombuffer(self._target.read(components=3, dtype="f4"), np.float32)
        return pixels.reshape(height, width, 3)[::-1]


def mesh(size):
    """Vertices at the pixel centers of a small picture and beyond, and triangles between them."""
    width = size + 2 * points.MARGIN
    corner = np.arange(width * width).reshape(width, width)[:-1, :-1].ravel()
    square = corner[:, None] + [0, 1, width, width, 1, width + 1]
    return points.vertices(size), square.astype("u4")


def first_frame(host, generated, numbers):
    """Compile a material and draw it small, as if for the first time: drivers know texts again."""
    pixel = f"{generated.stages['pixel']}// {next(numbers)}\n"
    frame = Frame(host, replace(generated, stages={**generated.stages, "pixel": pixel}), 8)
    frame.draw(1)


def measure(rounds=7, size=SIZE):
    """The `Group` of all materials."""
    host = gl.Host()
    device = host.identity().device
    with host._context:  # which each verb of a host makes current, and frames do without
        figures, checks = _timed(host, rounds, size, clock_of(device))
    host.close()
    title = f"Materials on {device}, {size} x {size}"
    return Group("materials", title, tuple(figures), tuple(checks))


def _timed(host, rounds, size, clock):
    figures, checks, numbers = [], [], count()
    for node in NODES:
        shaders = {library: shader(host, node, library) for library in LIBRARIES}
        made = {name: partial(first_frame, host, each, numbers) for name, each in shaders.items()}
        compiling = interleave(made, rounds, clock)
        frames = {name: Frame(host, each, size) for name, each in shaders.items()}
        drawing = interleave({name: each.draw for name, each in frames.items()}, rounds, clock)
        difference = np.abs(frames["eonlib"].image() - frames["stock"].image())
        difference = difference[sphere(size).normal[..., 2] > FACING].max()
        checks.append(Check(f"{node}, eonlib - stock", float(difference), TOLERANCE))
        lengths = [len(each.stages["pixel"]) for each in shaders.values()]
        figures += [
            scaled(f"frame, {node}, eonlib", "ms", drawing["eonlib"], 1e3 / FRAMES),
            ratio(f"frame, {node}, eonlib / stock", *drawing.values(), GOALS.get(node)),
            scaled(f"compilation and first frame, {node}, eonlib", "ms", compiling["eonlib"], 1e3),
            ratio(f"compilation and first frame, {node}, eonlib / stock", *compiling.values()),
            figure(f"source, {node}, eonlib", "characters", lengths[:1]),
            ratio(f"source, {node}, eonlib / stock", *zip(lengths), SHORTER.get(node)),
        ]
    return figures, checks
