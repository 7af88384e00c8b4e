# SPDX-License-Identifier: Apache-2.0
"""WebGPU without a browser: MaterialX's text for its target WGSL, in float32.

That text is GLSL for a converter. wgpu's converter, naga, compiles it directly, without writing WGSL.
"""

from __future__ import annotations

import re

from mxeon.hosts import vulkan

INPUT_BLOCK = re.compile(r"^layout \(location = 0\) in (\w+\s*\{[^}]*\} \w+;)", re.MULTILINE)


class WgslHost(vulkan.VulkanHost):
    """The first adapter that wgpu finds, with naga instead of glslang."""

    name = "wgsl"
    target = "wgsl"
    path = "naga, "
    programs = ()
    interfaces = ("Vulkan", "Metal", "D3D12")

    def _vertex(self, pixel: str) -> str:
        """A vertex stage with the pixel stage's block, all 0: wgpu requires it, even if it is unused."""
        head, rest = super()._vertex(pixel).split("\n", 1)
        outputs = [f"layout (location = 0) out {block}\n" for block in INPUT_BLOCK.findall(pixel)]
        return "".join([f"{head}\n", *outputs, rest])

    def _code(self, stage: str, text: str) -> str:
        return text
