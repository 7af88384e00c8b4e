# SPDX-License-Identifier: Apache-2.0
"""Vulkan without a window, which runs generated Vulkan GLSL in float32.

glslang compiles the GLSL to SPIR-V. naga, a part of wgpu, validates the SPIR-V and writes new
SPIR-V for the driver. naga rejects interface blocks, so the unused block of an evaluation is
removed.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

import numpy as np

from mxeon.errors import NotRun, install, refused
from mxeon.hosts import fragment, raster
from mxeon.hosts.base import TABLE, Array, Identity
from mxeon.hosts.raster import FragmentHost
from mxeon.jobs.signals import Temporary

try:
    import wgpu
except ImportError:
    wgpu = None

COMPILER = ("glslangValidator", "-V", "--quiet", "--stdin")
REMOVER = ("spirv-opt", "--remove-unused-interface-variables")
APT = "on Debian: apt-get install"
TIMEOUT = 60.0  # maximum seconds for one run of a compiler

# wgpu's descriptions of binding types.
FILTERED = {"texture": {"sample_type": "float"}}
UNFILTERED = {"texture": {"sample_type": "unfilterable-float"}}
LINEAR = {"mag_filter": "linear", "min_filter": "linear"}
SAMPLER = {"sampler": {"type": "filtering"}}
UNIFORM_BINDING = {"buffer": {"type": "uniform"}}

# Matches the declaration of a binding in generated text.
DECLARATION = re.compile(
    r"^layout \((?:std140, )?binding=(?P<number>\d+)\) uniform "
    r"(?:(?P<kind>sampler2D|texture2D|sampler) (?P<name>\w+);|\w+\s*\{(?P<block>[^}]*)\})",
    re.MULTILINE,
)

INPUT_BLOCK = re.compile(r"^layout \(location = 0\) in (\w+\s*\{[^}]*\} \w+;)", re.MULTILINE)

STD140 = {"mat4": (16, 64), "vec4": (16, 16), "vec3": (16, 12), "vec2": (8, 8)}
STD140 |= dict.fromkeys(("float", "int", "bool"), (4, 4))  # type -> alignment and size, in bytes
BLOCK_SIZE = 1 << 14

FORMATS = {"uint8": "rgba8unorm", "float16": "rgba16float"}  # filterable formats
FLOATS = {1: "r32float", 2: "rg32float", 4: "rgba32float"}  # keys: number of components
WHITE_TEXEL = np.full((1, 1, 4), 255, dtype=np.uint8)

PROGRAMS = 8  # cached programs, because the checks of a node evaluate one shader many times

Resource: TypeAlias = Any  # an object of wgpu, a package that may not be installed
Kind: TypeAlias = Mapping[str, object]
Bindings: TypeAlias = dict[int, tuple[Kind, Resource]]  # keys: binding numbers


class VulkanHost(FragmentHost):
    """The first Vulkan adapter that wgpu finds."""

    name = "vulkan"
    target = "vulkan"
    path: ClassVar[str] = ""  # shader converters, named at the start of the device's description
    # Programs that the host runs, each with a hint on how to install the program.
    programs: ClassVar[tuple[tuple[str, str], ...]] = (
        (COMPILER[0], f"{APT} glslang-tools"),
        (REMOVER[0], f"{APT} spirv-tools"),
    )
    interfaces: ClassVar[tuple[str, ...]] = ("Vulkan",)  # wgpu's names of driver interfaces

    def __init__(self) -> None:
        if wgpu is None:
            raise NotRun(f"{self.name}: wgpu is not installed; {install('vulkan')}")
        for program, remedy in self.programs:
            if shutil.which(program) is None:
                raise NotRun(f"{self.name}: no program {program!r}; {remedy}")
        adapters = wgpu.gpu.enumerate_adapters_sync()
        found = [each for each in adapters if each.info["backend_type"] in self.interfaces]
        if not found:
            interfaces = " or ".join(self.interfaces)
            raise NotRun(f"{self.name}: no {interfaces} device; {APT} mesa-vulkan-drivers")
        self._adapter = found[0]
        self._device = self._adapter.request_device_sync()
        self._programs: dict[str, tuple[tuple[Resource, ...], Resource]] = {}

    def identity(self) -> Identity:
        info = self._adapter.info
        version = (
            f"{self.path}{info['backend_type']}, {info['description']}; wgpu {wgpu.__version__}"
        )
        return Identity(self.name, version, info["device"])

    def close(self) -> None:
        self._device.destroy()

    def _evaluate(self, frame: raster.Frame) -> Array:
        """Values of a pixel stage. The vertex stage of `frame` is ignored."""
        count, size = fragment.frame(frame.arguments)
        texels = [fragment.texels(rows, size, fragment.ODD) for rows in frame.arguments.values()]
        sets: tuple[Bindings, ...] = (
            self._generated(frame),
            {0: (SAMPLER, self._sampler(TABLE in frame.textures))},
            {number: (UNFILTERED, self._texture(rows)) for number, rows in enumerate(texels)},
        )
        layouts, pipeline = self._program(frame.pixel, sets)
        groups = [
            self._device.create_bind_group(
                layout=layout,
                entries=[{"binding": n, "resource": each} for n, (_, each) in bindings.items()],
            )
            for layout, bindings in zip(layouts, sets, strict=True)
        ]
        return self._draw(pipeline, groups, size)[:count]

    def _program(
        self, pixel: str, sets: Iterable[Bindings]
    ) -> tuple[tuple[Resource, ...], Resource]:
        """Layouts of a pixel stage's bindings, and a pipeline that works with any resources."""
        if pixel not in self._programs:
            if len(self._programs) == PROGRAMS:
                self._programs.clear()
            layouts = tuple(
                self._device.create_bind_group_layout(
                    entries=[
                        {"binding": number, "visibility": "FRAGMENT", **kind}
                        for number, (kind, _) in bindings.items()
                    ]
                )
                for bindings in sets
            )
            self._programs[pixel] = layouts, self._pipeline(pixel, layouts)
        return self._programs[pixel]

    def _draw(self, pipeline: Resource, groups: Iterable[Resource], size: tuple[int, int]) -> Array:
        """One frame as float32 rows, with one row per pixel."""
        usage = wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.COPY_SRC
        target = self._device.create_texture(size=size, format=FLOATS[4], usage=usage)
        attachment = {"view": target.create_view(), "load_op": "clear", "store_op": "store"}
        commands = self._device.create_command_encoder()
        render = commands.begin_render_pass(color_attachments=[attachment])
        render.set_pipeline(pipeline)
        for index, group in enumerate(groups):
            render.set_bind_group(index, group)
        corners = raster.TRIANGLE["i_position"]
        corners = self._device.create_buffer_with_data(data=corners, usage="VERTEX")
        render.set_vertex_buffer(0, corners)
        render.draw(3)
        render.end()
        queue = self._device.queue
        queue.submit([commands.finish()])
        layout = {"bytes_per_row": 16 * size[0]}
        frame = queue.read_texture({"texture": target}, layout, (*size, 1))
        return np.frombuffer(frame, dtype=np.float32).reshape(-1, 4)[:, :3]

    def _pipeline(self, pixel: str, layouts: Sequence[Resource]) -> Resource:
        position = {"format": "float32x3", "offset": 0, "shader_location": 0}
        return self._device.create_render_pipeline(
            layout=self._device.create_pipeline_layout(bind_group_layouts=layouts),
            vertex={
                **self._stage("vert", self._vertex(pixel)),
                "buffers": [{"array_stride": 12, "attributes": [position]}],
            },
            fragment={**self._stage("frag", pixel), "targets": [{"format": FLOATS[4]}]},
            primitive={"topology": "triangle-list"},
        )

    def _stage(self, stage: str, text: str) -> dict[str, Resource]:
        code = self._code(stage, text)
        try:
            module = self._device.create_shader_module(label=stage, code=code)
        except wgpu.GPUValidationError as error:
            raise refused(self.name, str(error), text) from None
        return {"module": module, "entry_point": "main"}

    def _vertex(self, pixel: str) -> str:
        return fragment.DIALECTS[self.target].vertex

    def _code(self, stage: str, text: str) -> bytes | str:
        return spirv(stage, text)

    def _generated(self, frame: raster.Frame) -> Bindings:
        """Bindings of the textures and blocks in generated text. Textures are white by default."""
        unique = {id(texels): texels.astype(np.float16) for texels in frame.textures.values()}
        halves = {name: unique[id(texels)] for name, texels in frame.textures.items()}
        bindings: Bindings = {}
        for match in DECLARATION.finditer(frame.pixel):
            number = int(match["number"])
            if match["block"] is not None:
                data = _std140(match["block"], frame.uniforms)
                block = self._device.create_buffer_with_data(data=data, usage="UNIFORM")
                bindings[number] = UNIFORM_BINDING, block
            elif match["kind"] == "sampler":
                bindings[number] = SAMPLER, self._sampler(match["name"].startswith(TABLE))
            else:  # the name of a separate texture ends in _texture
                texels = halves.get(match["name"].removesuffix("_texture"), WHITE_TEXEL)
                bindings[number] = FILTERED, self._texture(texels)
        return bindings

    def _sampler(self, linear: bool) -> Resource:
        return self._device.create_sampler(**(LINEAR if linear else {}))

    def _texture(self, texels: Array) -> Resource:
        """A texture of 8-bit, float16 or float32 texels with one to four components."""
        height, width, components = texels.shape
        if components == 3:  # three components are not supported
            texels = np.pad(texels, ((0, 0), (0, 0), (0, 1)))
        form = FORMATS.get(texels.dtype.name) or FLOATS[texels.shape[2]]
        size = (width, height, 1)
        usage = wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST
        texture = self._device.create_texture(size=size, format=form, usage=usage)
        layout = {"bytes_per_row": texels[0].nbytes, "rows_per_image": height}
        self._device.queue.write_texture({"texture": texture}, texels, layout, size)
        return texture.create_view()


class WgslHost(VulkanHost):
    """WebGPU without a browser.

    For the target WGSL, MaterialX generates GLSL that has to be converted. The converter is naga, a
    part of wgpu.
    """

    name = "wgsl"
    target = "wgsl"
    path = "naga, "
    programs = ()
    interfaces = ("Vulkan", "Metal", "D3D12")

    def _vertex(self, pixel: str) -> str:
        """A vertex stage whose outputs are the inputs of the pixel stage, as wgpu requires."""
        head, rest = super()._vertex(pixel).split("\n", 1)
        outputs = [f"layout (location = 0) out {block}\n" for block in INPUT_BLOCK.findall(pixel)]
        return "".join([f"{head}\n", *outputs, rest])

    def _code(self, stage: str, text: str) -> str:
        return text


HOSTS = {host.name: host for host in (VulkanHost, WgslHost)}


@lru_cache(maxsize=8)  # evaluations share a vertex stage
def spirv(stage: str, text: str) -> bytes:
    with Temporary("mxeon-vulkan-") as folder:
        whole, used = str(Path(folder, "whole")), Path(folder, "used")
        run([*COMPILER, "-S", stage, "-o", whole], text)
        run([*REMOVER, whole, "-o", str(used)])
        return used.read_bytes()


def run(command: Sequence[str], text: str = "", host: str = "vulkan") -> None:
    try:
        process = subprocess.run(
            command, input=text, capture_output=True, text=True, timeout=TIMEOUT, errors="replace"
        )
    except subprocess.TimeoutExpired:
        raise NotRun(f"{host}: {command[0]} takes longer than {TIMEOUT:.0f} s") from None
    if process.returncode:
        raise refused(host, process.stdout + process.stderr, text)


def _std140(members: str, uniforms: raster.Uniforms) -> bytes:
    """Bytes of a uniform block, which ends at the first structure in `members`."""
    data, offset = bytearray(BLOCK_SIZE), 0
    for kind, name in re.findall(r"(\w+) (\w+);", members):
        if kind not in STD140:
            break
        alignment, size = STD140[kind]
        offset = -(-offset // alignment) * alignment
        if name in uniforms:
            form = "<i4" if kind in ("int", "bool") else "<f4"
            values = np.asarray(uniforms[name], form).tobytes()
            data[offset : offset + len(values)] = values
        offset += size
    return bytes(data)
