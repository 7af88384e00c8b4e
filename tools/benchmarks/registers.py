# SPDX-License-Identifier: Apache-2.0
"""Registers, instructions and estimated cycles of eonlib's and stock materials on an AMD GPU.

No GPU is needed, because Mesa's driver RADV compiles for the chip in `RADV_FORCE_FAMILY` and
reports statistics. Shaders have one light, because the compiler might unroll the loop over lights
for only one of the libraries. Cycles are estimated without thin films, because the driver's
estimate counts the body of the loop over interference orders eight times.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from mxeon.errors import NotRun
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import document_text
from tools.benchmarks.materials import BARE, DIFFUSE, LIBRARIES, NODES, OTHERS
from tools.benchmarks.rounds import Figure, Group

COMPILER = ("glslangValidator", "-V", "--quiet", "--stdin", "-S")
HEADER = 5  # words before the first SPIR-V instruction
CHIP = "navi21"
PROGRAM = Path(__file__).with_name("pipeline_statistics.c")
DRIVERS = Path("/usr/share/vulkan/icd.d")
PACKAGES = "gcc glslang-tools libvulkan-dev mesa-vulkan-drivers"
# Units of the driver's statistics.
STATISTICS = {"VGPRs": "registers", "Instructions": "instructions", "Inverse Throughput": "cycles"}

# The loop over lights in a generated shader, and the code for one light that replaces the loop.
LIGHTS = "for (int activeLightIndex = 0; activeLightIndex < numLights; ++activeLightIndex)"
LIGHT = "int activeLightIndex = 0;"

BINDING = re.compile(
    r"^layout \((?:std140, )?binding=(\d+)\) uniform (sampler2D|texture2D|sampler)?", re.MULTILINE
)
KINDS = {"sampler2D": "c", "texture2D": "t", "sampler": "s", "": "u"}
ATTRIBUTE = re.compile(r"^layout \(location = \d+\) in", re.MULTILINE)


def sources(node):
    text = document_text(NODES[node])
    return {
        library: generate(text, "vulkan", library=library, lights=True)[0].stages
        for library in LIBRARIES
    }


def compiled(source, kind, file):
    """Compile a stage to SPIR-V and count instructions. Raises NotRun if there is no compiler."""
    if not shutil.which(COMPILER[0]):
        raise NotRun(f"registers: no program {COMPILER[0]!r}; on Debian: glslang-tools")
    command = [*COMPILER, kind, "-o", file]
    subprocess.run(command, input=source, text=True, check=True, capture_output=True)
    words = np.fromfile(file, "<u4")
    number, place = 0, HEADER
    while place < len(words):
        place += int(words[place]) >> 16
        number += 1
    return number


def material_statistics(stages, program, driver):
    """Statistics of a material's fragment shader for one light, by name."""
    assert stages["pixel"].count(LIGHTS) == 1
    text = stages["pixel"].replace(LIGHTS, LIGHT)
    without_films = text.replace("if (fd.airy)", "if (false)")
    found, bare = (
        statistics({**stages, "pixel": each}, program, driver) for each in (text, without_films)
    )
    return found | {"Inverse Throughput": bare["Inverse Throughput"]}


def statistics(stages, program, driver):
    """Statistics that the driver reports for a fragment shader, by name."""
    files = [program.with_name("vert.spv"), program.with_name("frag.spv")]
    for stage, file in zip(("vertex", "pixel"), files, strict=True):
        compiled(stages[stage], file.stem, file)
    bindings = {
        number: KINDS[kind] for text in stages.values() for number, kind in BINDING.findall(text)
    }
    words = [str(len(ATTRIBUTE.findall(stages["vertex"]))), *map(":".join, bindings.items())]
    environment = os.environ | {"RADV_FORCE_FAMILY": CHIP, "VK_ICD_FILENAMES": str(driver)}
    run = subprocess.run(
        [program, *files, *words], env=environment, text=True, capture_output=True, check=True
    )
    rows = (line.split("\t") for line in run.stdout.splitlines())
    return {name: int(number) for name, number in rows}


def measure(nodes=(*DIFFUSE, *BARE, *OTHERS)):
    """Measure a material of each node. Raises NotRun if RADV, a compiler or a header is missing."""
    driver = next(DRIVERS.glob("radeon_icd*.json"), None)
    tools = all(map(shutil.which, ("gcc", COMPILER[0])))
    if driver is None or not tools or not Path("/usr/include/vulkan/vulkan.h").exists():
        raise NotRun(f"registers: no RADV, compiler or headers; on Debian: {PACKAGES}")
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, "statistics")
        subprocess.run(["gcc", "-O1", PROGRAM, "-o", program, "-lvulkan"], check=True)
        for node in nodes:
            eonlib, stock = (
                material_statistics(each, program, driver) for each in sources(node).values()
            )
            for name, unit in STATISTICS.items():
                ratio = eonlib[name] / stock[name]
                figures += [
                    Figure(f"{node}, {unit}, eonlib", unit, [eonlib[name]]),
                    Figure(f"{node}, {unit}, eonlib / stock", "x", [ratio]),
                ]
    title = f"Fragment shaders as Mesa's RADV compiles them for {CHIP}, without the hardware"
    return Group(title, figures)
