# SPDX-License-Identifier: Apache-2.0
"""Generated materials with eonlib and with stock MaterialX: source, compilation, frame time."""

import statistics
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context

import numpy as np

from mxeon.hosts import gl, points, raster
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
from tools.benchmarks.rounds import Check, Group, clock_of, figure, interleave, ratio, scaled

SIZE = 512
FIRST = 8  # pixels along a side of a first frame
FRAMES = 3  # of each library in a process, after one that is dropped
PROCESSES = 7  # in one of six, llvmpipe's code of one text takes a sixth to two fifths longer
MESH = 128  # squares along a side of the mesh, few enough to cost nothing beside the pixels
LIBRARIES = ("eonlib", "stock")


def _lobe(category, **inputs):
    return lobe_text(category, inputs) + SURFACE


def _surface(category, **inputs):
    texts = (input_text(name, "float", value) for name, value in inputs.items())
    return node_text(category, "surfaceshader", "shading", "".join(texts))


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
DIFFUSE = {"oren_nayar": _lobe(OREN_NAYAR, roughness=0.6, **{FLAG: True})}
NODES = DIFFUSE | BARE | FILMED | OTHERS

# Largest ratios eonlib / stock, of time and of source.
TIMES = (
    dict.fromkeys(DIFFUSE, 1.0)
    | dict.fromkeys(BARE, 1.03)
    | dict.fromkeys(FILMED, 1.5)
    | dict.fromkeys(OTHERS, 1.1)
)
TEXTS = dict.fromkeys(DIFFUSE, 1.0) | dict.fromkeys(BARE, 1.1)

# Where both libraries have one model, of values up to 2: MaterialX's own EON loses digits of 1 - E.
SAME = {"oren_nayar": 3e-4}

# Cosine from which pixels are compared: the coarse mesh does not end on the rim of the sphere.
FACING = 0.2


def shader(host, node, library):
    """The generated shader of a material around one node."""
    return host.compile(document_text(NODES[node]), library=library)[0]


class Frame:
    """A material on the sphere, drawn again and again with its uniforms and buffers in place.

    One picture as by `mxeon.hosts.gl`, with its functions, and the set-up kept apart.
    """

    def __init__(self, host, generated, size):
        context = self._context = host._context
        self.resize(size)
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

    def resize(self, size):
        """Draw into a picture of so many pixels along a side from now on."""
        picture = self._context.renderbuffer((size, size), 4, dtype="f4")
        self._target = self._context.framebuffer([picture])

    def draw(self):
        """Draw to the end."""
        self._target.use()
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
    return points.vertices(size, "sphere"), square.astype("u4")


@dataclass(frozen=True)
class Run:
    """One material in one process: the device, and by library characters, seconds of compilation and of a frame."""

    device: str
    lengths: Mapping[str, int]
    compilation: Mapping[str, float]
    frame: Mapping[str, float]
    checks: tuple[Check, ...]


def _start_compiler(host):
    """Draw another material first, or the first compilation is that of a driver that starts."""
    Frame(host, shader(host, "oren_nayar", "stock"), FIRST).draw()


def run(node, size, libraries):
    """The `Run` of a material, the libraries in this order."""
    host = gl.Host()
    device = host.identity().device
    clock = clock_of(device)
    shaders = {library: shader(host, node, library) for library in libraries}
    with host._context:  # which each verb of a host makes current, and frames do without
        _start_compiler(host)
        frames, compilation = {}, {}
        for library, generated in shaders.items():
            start = clock()
            frames[library] = Frame(host, generated, FIRST)
            frames[library].draw()
            compilation[library] = clock() - start
            frames[library].resize(size)
        rivals = {library: frame.draw for library, frame in frames.items()}
        drawing = interleave(rivals, FRAMES, clock)
        checks = tuple(_checks(node, frames, size))
    host.close()
    lengths = {library: len(each.stages["pixel"]) for library, each in shaders.items()}
    seconds = {library: statistics.median(each) for library, each in drawing.items()}
    return Run(device, lengths, compilation, seconds, checks)


def measure(
    processes=PROCESSES, size=SIZE, nodes=tuple(NODES), keep: Callable[[Group], None] | None = None
):
    """The `Group` of materials, each in so many processes; `keep` is handed it after each, as far as it is."""
    group = Group("materials", "Materials")
    with ProcessPoolExecutor(1, get_context("spawn"), max_tasks_per_child=1) as pool:
        for node in nodes:
            turns = [LIBRARIES[:: -1 if turn % 2 else 1] for turn in range(processes)]
            runs = list(pool.map(partial(run, node, size), turns))
            group = replace(
                group,
                title=f"Materials on {runs[0].device}, {size} x {size}",
                figures=group.figures + _figures(node, runs),
                checks=group.checks + tuple(_largest(runs)),
            )
            if keep:
                keep(group)
    return group


COMPILATION = "compilation and first frame"


def _figures(node, runs):
    """Figures of one material, a value for each process."""
    frame, compilation, length = (
        {library: [getattr(each, kind)[library] for each in runs] for library in LIBRARIES}
        for kind in ("frame", "compilation", "lengths")
    )
    return (
        scaled(f"frame, {node}, eonlib", "ms", frame["eonlib"], 1e3),
        ratio(f"frame, {node}, eonlib / stock", *frame.values(), TIMES[node]),
        scaled(f"{COMPILATION}, {node}, eonlib", "ms", compilation["eonlib"], 1e3),
        ratio(f"{COMPILATION}, {node}, eonlib / stock", *compilation.values(), TIMES[node]),
        figure(f"source, {node}, eonlib", "characters", length["eonlib"]),
        ratio(f"source, {node}, eonlib / stock", *length.values(), TEXTS.get(node)),
    )


def _largest(runs):
    """The checks of one material, with the largest error of all processes."""
    for checks in zip(*(each.checks for each in runs), strict=True):
        yield replace(checks[0], error=float(np.max([each.error for each in checks])))


def _checks(node, frames, size):
    """That a material's pixels are finite and, where both libraries have its model, the same."""
    facing = sphere(size).normal[..., 2] > FACING
    ours, stock = (frames[library].image()[facing] for library in LIBRARIES)
    yield Check(f"{node}, pixels that are not finite", float((~np.isfinite(ours)).sum()), 0.0)
    if node in SAME:
        difference = float(np.abs(ours - stock).max())
        yield Check(f"{node}, eonlib - stock", difference, SAME[node])
