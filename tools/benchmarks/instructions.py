# SPDX-License-Identifier: Apache-2.0
"""SPIR-V instructions of materials, eonlib / stock: what a GPU that is not here is given."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from mxeon.errors import NotRun
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import document_text
from tools.benchmarks.materials import BARE, DIFFUSE, LIBRARIES, NODES, OTHERS
from tools.benchmarks.rounds import Group, figure, ratio

COMPILER = ("glslangValidator", "-V", "--quiet", "--stdin", "-S")
OPTIMIZER = ("spirv-opt", "-O")
HEADER = 5  # words before the first instruction, whose high half counts its words


def sources(node):
    """Stages of a material in Vulkan's GLSL, by library."""
    text = document_text(NODES[node])
    return {
        library: generate(text, "vulkan", library=library, lights=True)[0].stages
        for library in LIBRARIES
    }


def compiled(source, optimize=False):
    """Number of SPIR-V instructions of a fragment shader, as written or as `spirv-opt -O` leaves it; NotRun without it."""
    for program in (COMPILER[0], OPTIMIZER[0]):
        if not shutil.which(program):
            raise NotRun(
                f"instructions: no program {program!r}; on Debian: glslang-tools spirv-tools"
            )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "shader.spv")
        subprocess.run(
            [*COMPILER, "frag", "-o", file],
            input=source,
            text=True,
            check=True,
            capture_output=True,
        )
        if optimize:
            subprocess.run([*OPTIMIZER, file, "-o", file], check=True, capture_output=True)
        words = np.fromfile(file, "<u4")
    number, place = 0, HEADER
    while place < len(words):
        place += int(words[place]) >> 16
        number += 1
    return number


def measure(nodes=(*DIFFUSE, *BARE, *OTHERS)):
    """The `Group` of nodes; a film is a value of an input and adds no instruction."""
    figures = []
    for node in nodes:
        numbers = [[compiled(each["pixel"], optimize=True)] for each in sources(node).values()]
        figures += [
            figure(f"{node}, eonlib", "instructions", numbers[0]),
            ratio(f"{node}, eonlib / stock", *numbers),
        ]
    title = "SPIR-V instructions of fragment shaders after spirv-opt -O"
    return Group("instructions", title, tuple(figures))
