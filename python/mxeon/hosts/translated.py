# SPDX-License-Identifier: Apache-2.0
"""Vulkan's SPIR-V translated to languages that MaterialX does not generate, and run on Vulkan.

spirv-cross writes HLSL, which glslang or DXC, Microsoft's compiler, compiles to SPIR-V again. naga
writes WGSL, which wgpu compiles. Values are float32.
"""

from __future__ import annotations

import re
from pathlib import Path

from mxeon.errors import NotRun, ShaderError, install
from mxeon.hosts import vulkan
from mxeon.jobs.signals import Temporary

try:
    from compushady import SHADER_BINARY_TYPE_SPIRV
    from compushady.backends import dxc
    from compushady.shaders import hlsl as _library  # noqa: F401 (loads the library that dxc calls)
except ImportError:
    dxc = None

TRANSLATOR = ("spirv-cross", "--hlsl", "--shader-model", "60")
COMPILER = ("glslangValidator", "-D", "-V", "--quiet", "-S", "frag", "-e", "main")
# Optimizing, glslang inlines every function, which takes half a minute for path tracers. Texts with
# functions that take textures (Vulkan) or with unused stage inputs (wgpu) still need the
# optimization.
KEEP_FUNCTIONS = "-Od"
OPTIMIZED = re.compile(r"^\w+ \w+\(.*\bTexture2D\b| : TEXCOORD\d+;$", re.MULTILINE)
REGISTER = re.compile(r"^(?=.* : register\([bst](\d+), space(\d+)\))", re.MULTILINE)


class HlslHost(vulkan.VulkanHost):
    """The host `vulkan`, whose pixel stages are translated to HLSL and back."""

    name = "hlsl"
    path = "HLSL, glslang, "
    programs = (*vulkan.VulkanHost.programs, (TRANSLATOR[0], f"{vulkan.APT} spirv-cross"))

    def _code(self, stage: str, text: str) -> bytes | str:
        code = vulkan.spirv(stage, text)
        if stage == "vert":
            return code
        with Temporary("mxeon-translated-") as folder:
            Path(folder, "generated.spv").write_bytes(code)
            return self._translated(Path(folder))

    def _run(self, *command: str | Path) -> None:
        vulkan.run([str(word) for word in command], host=self.name)

    def _hlsl(self, folder: Path) -> Path:
        text = folder / "text"
        self._run(*TRANSLATOR, folder / "generated.spv", "--output", text)
        return text

    def _translated(self, folder: Path) -> bytes | str:
        """Code for wgpu, translated from generated.spv in `folder`."""
        text, compiled = self._hlsl(folder), folder / "compiled"
        flags = () if OPTIMIZED.search(text.read_text()) else (KEEP_FUNCTIONS,)
        self._run(*COMPILER, *flags, "-o", compiled, text)
        return compiled.read_bytes()


class DxcHost(HlslHost):
    """HLSL compiled by DXC, through the Python package compushady; the text names the bindings."""

    name = "dxc"
    path = "HLSL, DXC, "

    def __init__(self) -> None:
        if dxc is None:
            raise NotRun(f"{self.name}: compushady is not installed; {install('dxc')}")
        super().__init__()

    def _translated(self, folder: Path) -> bytes | str:
        text = REGISTER.sub(r"[[vk::binding(\1, \2)]] ", self._hlsl(folder).read_text())
        try:
            compiled: bytes = dxc.compile(text, "main", SHADER_BINARY_TYPE_SPIRV, "ps_6_0")
        except ValueError as error:
            raise ShaderError(f"{self.name}: {' '.join(str(error).split())}") from None
        return compiled


class NagaHost(HlslHost):
    """The host `vulkan`, whose pixel stages naga translates to WGSL."""

    name = "naga"
    path = "WGSL of naga, "
    programs = (*vulkan.VulkanHost.programs, ("naga", "cargo install naga-cli"))

    def _translated(self, folder: Path) -> bytes | str:
        text = folder / "translated.wgsl"
        self._run("naga", folder / "generated.spv", text)
        return text.read_text()


HOSTS = {host.name: host for host in (HlslHost, DxcHost, NagaHost)}
