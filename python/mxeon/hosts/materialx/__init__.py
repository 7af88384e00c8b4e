# SPDX-License-Identifier: Apache-2.0
"""MaterialX's OpenGL renderer `MaterialXRenderGlsl`, which MaterialXView uses.

The renderer generates the same shader as the host `gl`, but sets lights, environment and uniforms
itself. Without an X display, the renderer ends the process. Therefore `worker.py` is a separate
process, and starts Xvfb if DISPLAY names no display.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from mxeon.errors import ShaderError
from mxeon.hosts.documents import DocumentHost
from mxeon.shaders.methods import GENERATED


class MaterialXHost(DocumentHost):
    """The GlslRenderer of the installed MaterialX, in float32; see `DocumentHost`."""

    name = "materialx"
    default = GENERATED

    def _interpreter(self) -> Path:
        return Path(sys.executable)

    def _check(self, error: str, printed: Sequence[str]) -> None:
        if error:
            raise ShaderError(f"materialx: {error}")
