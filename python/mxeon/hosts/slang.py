# SPDX-License-Identifier: Apache-2.0
"""Generated Slang, which slangpy compiles and runs in float32 on a GPU or the CPU.

The generated text is unchanged. A compute kernel after the text repeats the statements that call
the BSDF. Arguments are read from buffers, one row per thread.
"""

from __future__ import annotations

import atexit
import itertools
import multiprocessing
import signal
import sys
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import NotRun, install, refused
from mxeon.hosts import base, calls, fragment, raster
from mxeon.hosts.base import TABLE, Array, Identity, Query
from mxeon.shaders import functions
from mxeon.shaders.methods import GENERATED, TABLE_SIZE
from mxeon.shaders.scene import Client

Resource: TypeAlias = Any  # an object of slangpy, a package that may not be installed


def _slangpy() -> Resource:
    """The package slangpy, or None. PyTorch, which takes two seconds to import, is not imported."""
    modules = cast(dict[str, object], sys.modules)
    unused = modules.setdefault("torch", None) is None  # makes slangpy skip PyTorch
    try:
        import slangpy
    except ImportError:
        return None
    finally:
        if unused:
            del modules["torch"]
    return slangpy


slangpy = _slangpy()
CLAMP = slangpy and slangpy.TextureAddressingMode.clamp_to_edge

ENTRY = "mxeon_main"
THREADS = 64  # number of threads in a group
READ = {
    1: "{kind} {name} = {kind}(mxeon_{name}[mxeon_row]);",
    2: "float2 {name} = float2(mxeon_{name}[2 * mxeon_row], mxeon_{name}[2 * mxeon_row + 1]);",
    3: "float3 {name} = float3(mxeon_{name}[3 * mxeon_row], mxeon_{name}[3 * mxeon_row + 1], "
    "mxeon_{name}[3 * mxeon_row + 2]);",
}
KERNEL = """
{buffers}
RWStructuredBuffer<float> mxeon_out;
uniform uint mxeon_count;

[shader("compute")]
[numthreads({threads}, 1, 1)]
void {entry}(uint3 mxeon_thread : SV_DispatchThreadID)
{{
    uint mxeon_row = mxeon_thread.x;
    if (mxeon_row >= mxeon_count)
    {{
        return;
    }}
{body}
    for (int mxeon_channel = 0; mxeon_channel < 3; ++mxeon_channel)
    {{
        mxeon_out[3 * mxeon_row + mxeon_channel] = mxeon_value[mxeon_channel];
    }}
}}
"""

# Definitions of GLSL names that occur in shader functions and that Slang lacks.
GLSL = """typealias vec3 = float3;
#define mix lerp
"""
KINDS = {"boolean": "bool", "integer": "int"}

DEVICES = ("vulkan", "cpu")  # the preferred device first

# On the CPU, only a kernel can fill a texture.
FILL = f"""RWTexture2D<float4> mxeon_texture;
StructuredBuffer<float> mxeon_texels;
uniform uint mxeon_width;

[shader("compute")]
[numthreads(1, 1, 1)]
void {ENTRY}(uint3 mxeon_thread : SV_DispatchThreadID)
{{
    uint first = 3 * (mxeon_thread.y * mxeon_width + mxeon_thread.x);
    mxeon_texture[mxeon_thread.xy] = float4(
        mxeon_texels[first], mxeon_texels[first + 1], mxeon_texels[first + 2], 1.0);
}}
"""


class SlangHost(base.Host):
    """A host that runs slangpy on the first of DEVICES that can run a kernel."""

    name = "slang"
    target = "slang"
    default = GENERATED

    def __init__(self) -> None:
        if slangpy is None:
            raise NotRun(f"slang: slangpy is not installed; {install('slang')}")
        slangpy.Logger.get().level = slangpy.LogLevel.error  # hide warnings about missing features
        for device in DEVICES:
            self._kernels: dict[str, Resource] = {}
            self._names = itertools.count()
            try:
                self._device = slangpy.Device(type=slangpy.DeviceType[device])
                self._white = self._texture(np.ones((1, 1, 3)))
                break
            except RuntimeError as error:
                lines = [line.strip() for line in str(error).splitlines() if "error" in line]
        else:
            remedy = "without a GPU it needs a C++ compiler: on Debian: apt-get install g++"
            raise NotRun(f"slang: no kernel for the CPU; {'; '.join([*lines, remedy])}")
        # Slang removes the files of released kernels. A worker process is killed soon after
        # SIGTERM, so the handler must release the kernels immediately.
        atexit.register(self._kernels.clear)

        def end(*_: object) -> None:
            self._kernels.clear()
            sys.exit()

        if multiprocessing.parent_process():
            signal.signal(signal.SIGTERM, end)

    def identity(self) -> Identity:
        info = self._device.info
        return Identity(self.name, f"slangpy {slangpy.__version__}", info.adapter_name)

    def _values(self, query: Query) -> Array:
        text = query.shader.stages["pixel"]
        if "subsurface_bsdf(closureData" in text:
            raise NotRun(
                "slang: subsurface scattering needs derivatives between pixels, which a kernel lacks"
            )
        call = calls.bsdf_call(query)
        position = calls.POSITION.format("float3(0.0)")
        body = [position, call.statements, f"float3 mxeon_value = {call.value};"]
        environment = self._environment(query.irradiance, query.client)
        sampler = self._device.create_sampler(address_u=CLAMP, address_v=CLAMP)
        for name, texels in self.table(query.shader).items():
            environment["pixelCB"][name] = {"tex": self._texture(texels), "sampler": sampler}
        return self._evaluate(text, call.arguments, body, environment)

    def _drawn_table(self, text: str) -> Array:
        rows, columns = np.indices((TABLE_SIZE, TABLE_SIZE)) + 0.5
        places = np.stack([columns, rows], axis=-1).reshape(-1, 2)
        body = [
            "vd.SV_Position = float4(place, 0.0, 1.0);",
            "float3 mxeon_value = mx_generate_dir_albedo_table();",
        ]
        size = {"pixelCB": {TABLE + "Size": TABLE_SIZE}}
        texels = self._evaluate(text, {"place": ("vector2", places)}, body, size)
        return texels.reshape(TABLE_SIZE, TABLE_SIZE, 3)

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        values, call = functions.call(source, function, arguments)
        body = [f"float3 mxeon_value = float3({call});"]
        return self._evaluate(GLSL + source, values, body, {})

    def close(self) -> None:
        self._device.close()

    def _evaluate(
        self,
        text: str,
        arguments: calls.Arguments,
        body: Sequence[str],
        uniforms: Mapping[str, Resource],
    ) -> Array:
        rows = fragment.columns(arguments)
        count = max(map(len, rows.values()))
        reads = [
            READ[rows[name].shape[1]].format(name=name, kind=KINDS.get(kind, kind))
            for name, (kind, _) in arguments.items()
        ]
        main = KERNEL.format(
            buffers="\n".join(f"StructuredBuffer<float> mxeon_{name};" for name in rows),
            body="\n".join(f"    {line}" for line in (*reads, *body)),
            threads=THREADS,
            entry=ENTRY,
        )
        kernel = self._kernel(text + main)
        output = self._device.create_buffer(
            size=12 * count, struct_size=4, usage=slangpy.BufferUsage.unordered_access
        )
        values = {f"mxeon_{name}": self._buffer(column, count) for name, column in rows.items()}
        values |= {"mxeon_out": output, "mxeon_count": count, **uniforms}
        kernel.dispatch(thread_count=[count, 1, 1], vars=values)
        result: NDArray[np.float32] = output.to_numpy().view(np.float32).reshape(count, 3)
        return result

    def _kernel(self, text: str) -> Resource:
        if text not in self._kernels:
            try:
                name = f"mxeon_{next(self._names)}"  # a name cannot be used again after a failure
                module = self._device.load_module_from_source(name, text)
                program = self._device.link_program([module], [module.entry_point(ENTRY)])
                self._kernels[text] = self._device.create_compute_kernel(program)
            except slangpy.SlangCompileError as error:
                raise refused("slang", str(error), text) from None
        return self._kernels[text]

    def _buffer(self, rows: Array, count: int) -> Resource:
        data = np.array(np.broadcast_to(rows, (count, rows.shape[1])), order="C")
        usage = slangpy.BufferUsage.shader_resource
        return self._device.create_buffer(data=data, struct_size=4, usage=usage)

    def _texture(self, texels: Array) -> Resource:
        """A texture of float32 texels (height, width, 3).

        A CPU device reads the nearest texel, and puts the first and the last texel at coordinates 0
        and 1. Interpolated texels are added, so that every texel has the same coordinate as on a
        GPU.
        """
        if self._device.info.type == slangpy.DeviceType.cpu:
            for axis in (0, 1):
                twice = np.repeat(texels, 2, axis)
                means = 0.5 * (np.delete(twice, 0, axis) + np.delete(twice, -1, axis))
                texels = np.pad(means, [(int(each == axis),) * 2 for each in range(3)], "edge")
        height, width, _ = texels.shape
        texture = self._device.create_texture(
            type=slangpy.TextureType.texture_2d,
            format=slangpy.Format.rgba32_float,
            width=width,
            height=height,
            usage=slangpy.TextureUsage.shader_resource | slangpy.TextureUsage.unordered_access,
        )
        rows = self._buffer(texels.reshape(-1, 3).astype(np.float32), width * height)
        values = {"mxeon_texture": texture, "mxeon_texels": rows, "mxeon_width": width}
        self._kernel(FILL).dispatch(thread_count=[width, height, 1], vars=values)
        return texture

    def _environment(self, irradiance: Array | None, client: Client) -> dict[str, Resource]:
        """Values of the uniforms for an environment, which is white by default."""
        texture = self._white if irradiance is None else self._texture(irradiance)
        tinted = {"tex": texture, "sampler": self._device.create_sampler()}
        matrix = slangpy.float4x4(np.reshape(client.turn, (4, 4)).astype(np.float32))
        values = {"u_envRadiance": tinted, "u_envIrradiance": tinted, **raster.surroundings(client)}
        return {"pixelCB": {**values, **raster.EVALUATION, "u_envMatrix": matrix}}
