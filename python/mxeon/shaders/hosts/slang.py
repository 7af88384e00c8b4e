# SPDX-License-Identifier: Apache-2.0
"""Slang on a GPU or the CPU: generated Slang compiled by slangpy, in float32.

A compute kernel after the generated text, which stays as it is, repeats the statements by which
the text calls its BSDF. Arguments arrive in buffers, one row per thread.
"""

import numpy as np

from mxeon.errors import NotRun, ShaderError
from mxeon.shaders import functions as twins
from mxeon.shaders.hosts import fragment
from mxeon.shaders.hosts.base import Identity

try:
    import slangpy
except ImportError:
    slangpy = None

ENTRY = "mxeon_main"
THREADS = 64  # in a group
READ = {
    1: "{kind} {name} = {kind}(mxeon_{name}[mxeon_row]);",
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

# GLSL's words for what the twins use, as far as Slang has other words.
GLSL = """typealias vec3 = float3;
#define mix lerp
"""
KINDS = {"boolean": "bool"}

DEVICES = ("vulkan", "cpu")  # the first that works

# The CPU device fills no texture but from a kernel.
WHITE = f"""RWTexture2D<float4> mxeon_white;

[shader("compute")]
[numthreads(1, 1, 1)]
void {ENTRY}()
{{
    mxeon_white[uint2(0)] = float4(1.0);
}}
"""


class Host:
    """The first of DEVICES on which slangpy runs a kernel.

    Raises
    ------
    NotRun
        If there is no slangpy, or neither a GPU nor a C++ compiler for it.
    """

    name = "slang"
    target = "slang"
    profile = None

    def __init__(self):
        if slangpy is None:
            raise NotRun("slang: slangpy is not installed; pip install 'mxeon[slang]'")
        slangpy.Logger.get().level = slangpy.LogLevel.error  # it warns of what a CPU lacks
        for device in DEVICES:
            self._kernels = {}
            try:
                self._device = slangpy.Device(type=slangpy.DeviceType[device])
                self._white = self._texture()
                return
            except RuntimeError as error:
                reason = _reason(error)
        raise NotRun(f"slang: no kernel for the CPU; {reason}")

    def identity(self):
        """slangpy's version and device."""
        info = self._device.info
        return Identity(self.name, f"slangpy {slangpy.__version__}", info.adapter_name)

    def picture(self, shader, scene):
        """Nothing: free pairs tell more.

        Raises
        ------
        NotRun
            Always.
        """
        raise NotRun("slang: there are no pictures here; compare values instead")

    def evaluate(self, shader, wo, wi, inputs, branch):
        """The shader's own BSDF function for pairs of directions; see `mxeon.shaders.hosts`."""
        call = fragment.bsdf_call(shader, wo, wi, inputs, branch)
        body = ["float3 P = float3(0.0);", "float occlusion = 1.0;", call.statements]
        body.append(f"float3 mxeon_value = {call.result}.response;")
        return self._evaluate(shader.stages["pixel"], call.arguments, body, self._environment())

    def call(self, function, *arguments):
        """A function of the GLSL twins, compiled as Slang; see `mxeon.shaders.hosts`."""
        parameters = twins.signature("glsl", function)
        named = {
            name: (kind, value) for (kind, name), value in zip(parameters, arguments, strict=True)
        }
        body = [f"float3 mxeon_value = float3({function}({', '.join(named)}));"]
        return self._evaluate(GLSL + twins.source("glsl"), named, body, {})

    def close(self):
        """Give the device back; the host is of no use afterwards."""
        self._device.close()

    def _evaluate(self, text, arguments, body, uniforms):
        """One thread per element, as many as the longest argument has."""
        rows = fragment.columns(arguments)
        count = max(map(len, rows.values()))
        reads = [
            READ[rows[name].shape[1]].format(name=name, kind=KINDS.get(kind, kind))
            for name, (kind, _) in arguments.items()
        ]
        kernel = self._kernel(text + _kernel_text(rows, [*reads, *body]))
        output = self._device.create_buffer(
            size=12 * count, struct_size=4, usage=slangpy.BufferUsage.unordered_access
        )
        values = {f"mxeon_{name}": self._buffer(each, count) for name, each in rows.items()}
        values |= {"mxeon_out": output, "mxeon_count": count, **uniforms}
        kernel.dispatch(thread_count=[count, 1, 1], vars=values)
        return output.to_numpy().view(np.float32).reshape(count, 3)

    def _kernel(self, text):
        """A text's kernel, compiled once."""
        if text not in self._kernels:
            try:
                name = f"mxeon_{len(self._kernels)}"
                module = self._device.load_module_from_source(name, text)
                program = self._device.link_program([module], [module.entry_point(ENTRY)])
                self._kernels[text] = self._device.create_compute_kernel(program)
            except slangpy.SlangCompileError as error:
                raise ShaderError(f"slang: {str(error).strip()}") from None
        return self._kernels[text]

    def _buffer(self, rows, count):
        data = np.array(np.broadcast_to(rows, (count, rows.shape[1])), order="C")
        usage = slangpy.BufferUsage.shader_resource
        return self._device.create_buffer(data=data, struct_size=4, usage=usage)

    def _texture(self):
        """One white texel."""
        texture = self._device.create_texture(
            type=slangpy.TextureType.texture_2d,
            format=slangpy.Format.rgba32_float,
            usage=slangpy.TextureUsage.shader_resource | slangpy.TextureUsage.unordered_access,
        )
        values = {"mxeon_white": texture}
        self._kernel(WHITE).dispatch(thread_count=[1, 1, 1], vars=values)
        return texture

    def _environment(self):
        """The uniforms of a white surrounding."""
        white = {"tex": self._white, "sampler": self._device.create_sampler()}
        values = {"u_envRadiance": white, "u_envIrradiance": white, "u_envLightIntensity": 1.0}
        return {"pixelCB": {**values, "u_envMatrix": slangpy.float4x4.identity()}}


def _kernel_text(names, body):
    """The kernel that evaluates `body`, with a buffer for each argument."""
    return KERNEL.format(
        buffers="\n".join(f"StructuredBuffer<float> mxeon_{name};" for name in names),
        body="\n".join("    " + line for line in body),
        threads=THREADS,
        entry=ENTRY,
    )


def _reason(error):
    """What slangpy says, and the remedy where it misses the compiler that it hands C++ to."""
    said = [line.strip() for line in str(error).splitlines() if "error" in line]
    return "; ".join(
        [*said, "without a GPU it needs a C++ compiler: on Debian: apt-get install g++"]
    )
