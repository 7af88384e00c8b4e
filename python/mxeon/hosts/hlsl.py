# SPDX-License-Identifier: Apache-2.0
"""HLSL, which MaterialX does not generate: spirv-cross's translation of Vulkan's SPIR-V, in float32.

glslang compiles the translation to SPIR-V again, which the Vulkan driver executes.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from mxeon.hosts import vulkan
from mxeon.jobs.signals import Temporary

TRANSLATOR = ("spirv-cross", "--hlsl", "--shader-model", "60")
COMPILER = ("glslangValidator", "-D", "-V", "--quiet", "-S", "frag", "-e", "main")


class HlslHost(vulkan.VulkanHost):
    """The host `vulkan`, whose pixel stages are translated to HLSL and back."""

    name = "hlsl"
    path = "HLSL, "
    programs = (*vulkan.VulkanHost.programs, (TRANSLATOR[0], "spirv-cross"))

    def _code(self, stage: str, text: str) -> bytes:
        code = vulkan.spirv(stage, text)
        return code if stage == "vert" else _translated(code)


@lru_cache(maxsize=8)
def _translated(code: bytes) -> bytes:
    """SPIR-V of the HLSL for a pixel stage's SPIR-V."""
    with Temporary("mxeon-hlsl-") as folder:
        own, text, translated = (Path(folder, name) for name in ("own", "hlsl", "translated"))
        own.write_bytes(code)
        vulkan.run([*TRANSLATOR, str(own), "--output", str(text)])
        vulkan.run([*COMPILER, "-o", str(translated), str(text)])
        return translated.read_bytes()
