# SPDX-License-Identifier: Apache-2.0
"""Compilation and frame times of generated materials with eonlib and with stock MaterialX."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import numpy as np

from mxeon.hosts import gl, points, raster
from mxeon.shaders import nodes
from mxeon.shaders.scene import SIDE
from tools.benchmarks.rounds import Figure, Group, clock_of, interleave

SIZE = 512  # width and height of the timed frames in pixels
FIRST = 8  # width and height of the first frame in pixels
FRAMES = 3  # timed frames per library and process, after one warm-up frame
PROCESSES = 7  # processes per material; with llvmpipe, about one in six is 17 to 40 % slower
MESH = 128  # squares along a side of the mesh
LIBRARIES = ("eonlib", "stock")


def _lobe(category, **inputs):
    return nodes.lobe_text(category, inputs) + nodes.SURFACE


def _surface(category, **inputs):
    ports = (nodes.input_text(name, "float", value) for name, value in inputs.items())
    return nodes.node_text(category, "surfaceshader", "shading", "".join(ports))


FILM = {"thinfilm_thickness": 500.0, "thinfilm_ior": 1.5}
BARE = {
    "dielectric_bsdf": _lobe("dielectric_bsdf"),
    "conductor_bsdf": _lobe("conductor_bsdf"),
    "generalized_schlick_bsdf": _lobe("generalized_schlick_bsdf"),
    "open_pbr_surface": _surface("open_pbr_surface", base_diffuse_roughness=0.6),
    "standard_surface": _surface("standard_surface", diffuse_roughness=0.6),
    "gltf_pbr": _surface("gltf_pbr"),
    "UsdPreviewSurface": _surface("UsdPreviewSurface"),
}
FILMED = {
    "dielectric_bsdf, film": _lobe("dielectric_bsdf", **FILM),
    "conductor_bsdf, film": _lobe("conductor_bsdf", **FILM),
    "generalized_schlick_bsdf, film": _lobe("generalized_schlick_bsdf", **FILM),
    "open_pbr_surface, film": _surface(
        "open_pbr_surface", thin_film_weight=1.0, thin_film_thickness=0.5
    ),
    "standard_surface, film": _surface("standard_surface", thin_film_thickness=500.0),
    "gltf_pbr, film": _surface("gltf_pbr", iridescence=1.0, iridescence_thickness=500.0),
}
OTHERS = {
    "chiang_hair_bsdf": _lobe("chiang_hair_bsdf"),
    "sheen_bsdf, conty_kulla": _lobe("sheen_bsdf"),
    "sheen_bsdf, zeltner": _lobe("sheen_bsdf", mode="zeltner"),
    "subsurface_bsdf": _lobe("subsurface_bsdf"),
    "translucent_bsdf": _lobe("translucent_bsdf"),
}
DIFFUSE = {"oren_nayar": _lobe(nodes.OREN_NAYAR, roughness=0.6, **{nodes.FLAG: True})}
NODES = DIFFUSE | BARE | FILMED | OTHERS

# Goals for eonlib's time divided by stock's time.
RATIOS = ((DIFFUSE, 1.0), (BARE, 1.03), (FILMED, 1.8), (OTHERS, 1.1))
GOALS = {name: goal for group, goal in RATIOS for name in group}


class Frame:
    """A sphere that is drawn repeatedly with the same material, uniforms and buffers.

    The constructor and `draw` can be timed separately.
    """

    def __init__(self, host, generated, size):
        context = self._context = host._context
        self.resize(size)
        program = gl._program(context, generated.stages["vertex"], generated.stages["pixel"])
        gl._set(program, raster.light(SIDE))
        for unit, name in enumerate(("u_envRadiance", "u_envIrradiance")):
            if name in program:
                host._texture(raster.WHITE_TEXELS, False).use(location=unit)
                program[name].value = unit
        # The mesh has a vertex at each pixel center of a small picture with a margin.
        width = MESH + 2 * points.MARGIN
        corner = np.arange(width * width).reshape(width, width)[:-1, :-1].ravel()
        indices = (corner[:, None] + [0, 1, width, width, 1, width + 1]).astype("u4")
        vertices = points.vertices(points.visible(MESH, "sphere", points.MARGIN))
        buffers = [
            (context.buffer(values), f"{values.shape[1]}f", name)
            for name, values in vertices.items()
            if name in program
        ]
        self._mesh = context.vertex_array(program, buffers, context.buffer(indices))

    def resize(self, size):
        picture = self._context.renderbuffer((size, size), 4, dtype="f4")
        self._target = self._context.framebuffer([picture])

    def draw(self):
        self._target.use()
        self._target.clear()
        self._mesh.render()
        self._context.finish()


def run(node, size, libraries):
    """Device, then seconds to compile and to draw with each library. Call in a new process."""
    host = gl.GlHost()
    device = host.identity().device
    clock = clock_of(device)
    first, *shaders = (
        host.compile(nodes.document_text(NODES[name]), library=library)[0]
        for name, library in [("oren_nayar", "stock"), *((node, each) for each in libraries)]
    )
    with host._context:  # `Frame` needs a current context
        # Another material is drawn first, so that compilation times do not include the driver's
        # start.
        Frame(host, first, FIRST).draw()
        frames, compilation = {}, {}
        for library, generated in zip(libraries, shaders, strict=True):
            start = clock()
            frames[library] = Frame(host, generated, FIRST)
            frames[library].draw()
            compilation[library] = clock() - start
            frames[library].resize(size)
        drawing = interleave({name: frame.draw for name, frame in frames.items()}, FRAMES, clock)
    host.close()
    return device, compilation, {library: np.median(each) for library, each in drawing.items()}


def measure(processes=PROCESSES, size=SIZE):
    """Measure each material in `processes` separate processes, and return a `Group`."""
    figures = []
    turns = [LIBRARIES[:: -1 if turn % 2 else 1] for turn in range(processes)]
    with ProcessPoolExecutor(1, get_context("spawn"), max_tasks_per_child=1) as pool:
        for node in NODES:
            devices, *times = zip(*pool.map(partial(run, node, size), turns), strict=True)
            for kind, seconds in zip(("compilation and first frame", "frame"), times, strict=True):
                eonlib, stock = (np.array([each[name] for each in seconds]) for name in LIBRARIES)
                figures += [
                    Figure(f"{kind}, {node}, eonlib", "ms", 1e3 * eonlib),
                    Figure(f"{kind}, {node}, eonlib / stock", "x", eonlib / stock, GOALS[node]),
                ]
    return Group(f"Materials on {devices[0]}, {size} x {size}", figures)
