# SPDX-License-Identifier: Apache-2.0
"""Hosts that translate SPIR-V to HLSL or WGSL, and run the translated shaders on Vulkan.

spirv-cross translates to HLSL, which glslang or Microsoft's compiler DXC compiles to SPIR-V again.
naga translates to WGSL, which wgpu compiles. Values are float32.
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
# The option -Od turns off optimization, which takes half a minute for path tracers. Two kinds of
# shaders must be optimized, because Vulkan refuses functions with texture parameters, and wgpu
# refuses stages with unused inputs.
KEEP_FUNCTIONS = "-Od"
OPTIMIZED = re.compile(r"^\w+ \w+\(.*\bTexture2D\b| : TEXCOORD\d+;$", re.MULTILINE)
REGISTER = re.compile(r"^(?=.* : register\([bst](\d+), space(\d+)\))", re.MULTILINE)


class HlslHost(vulkan.VulkanHost):
    """The host `vulkan` with pixel stages that are translated to HLSL and back to SPIR-V."""

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
    """The host `vulkan` with HLSL that DXC compiles, through the Python package compushady."""

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
    """The host `vulkan` with pixel stages that naga translates to WGSL."""

    name = "naga"
    path = "WGSL of naga, "
    programs = (*vulkan.VulkanHost.programs, ("naga", "cargo install naga-cli"))

    def _translated(self, folder: Path) -> bytes | str:
        text = folder / "translated.wgsl"
        self._run("naga", folder / "generated.spv", text)
        return text.read_text()


HOSTS = {host.name: host for host in (HlslHost, DxcHost, NagaHost)}
