# SPDX-License-Identifier: Apache-2.0
"""SPIR-V of materials: what a GPU that is not here is given."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from mxeon.errors import NotRun
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import document_text
from tools.benchmarks.materials import LIBRARIES, NODES

COMPILER = ("glslangValidator", "-V", "--quiet", "--stdin", "-S")
HEADER = 5  # words before the first instruction, whose high half counts its words


def sources(node):
    """Stages of a material in Vulkan's GLSL, by library."""
    text = document_text(NODES[node])
    return {
        library: generate(text, "vulkan", library=library, lights=True)[0].stages
        for library in LIBRARIES
    }


def compiled(source):
    """Number of SPIR-V instructions of a fragment shader; NotRun without the compiler."""
    if not shutil.which(COMPILER[0]):
        raise NotRun(f"instructions: no program {COMPILER[0]!r}; on Debian: glslang-tools")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "shader.spv")
        subprocess.run(
            [*COMPILER, "frag", "-o", file],
            input=source,
            text=True,
            check=True,
            capture_output=True,
        )
        words = np.fromfile(file, "<u4")
    number, place = 0, HEADER
    while place < len(words):
        place += int(words[place]) >> 16
        number += 1
    return number
