# SPDX-License-Identifier: Apache-2.0
"""Registers, instructions and estimated cycles of materials on a GPU that is not here, eonlib / stock.

Mesa's driver RADV compiles for a chip by name, `RADV_FORCE_FAMILY`, without the hardware, and says what
its compiler made. Its estimate of cycles counts loops as executed, so that a film's loop counts
in a material without a film. Shaders are compiled for one light: of two libraries the compiler may write out
the loop over lights of one, which then counts once, and several times with the other.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from mxeon.errors import NotRun
from tools.benchmarks.instructions import COMPILER, sources
from tools.benchmarks.materials import BARE, DIFFUSE, OTHERS
from tools.benchmarks.rounds import Group, figure, ratio

CHIP = "navi21"
PROGRAM = Path(__file__).with_name("pipeline_statistics.c")
DRIVERS = Path("/usr/share/vulkan/icd.d")
PACKAGES = "gcc glslang-tools libvulkan-dev mesa-vulkan-drivers"
STATISTICS = {
    "VGPRs": "registers",
    "Instructions": "instructions",
    "Inverse Throughput": "cycles",
}  # of the driver, and their units

# The loop over lights of a generated shader, and what stands there for one light.
LIGHTS = "for (int activeLightIndex = 0; activeLightIndex < numLights; ++activeLightIndex)"
LIGHT = "int activeLightIndex = 0;"

BINDING = re.compile(
    r"^layout \((?:std140, )?binding=(\d+)\) uniform (sampler2D|texture2D|sampler)?", re.MULTILINE
)
KINDS = {"sampler2D": "c", "texture2D": "t", "sampler": "s", "": "u"}
ATTRIBUTE = re.compile(r"^layout \(location = \d+\) in", re.MULTILINE)


def driver():
    """File that names RADV to Vulkan's loader; NotRun if that, a compiler or a header is missing."""
    file = next(DRIVERS.glob("radeon_icd*.json"), None)
    tools = all(map(shutil.which, ("gcc", COMPILER[0])))
    if file is None or not tools or not Path("/usr/include/vulkan/vulkan.h").exists():
        raise NotRun(f"registers: no RADV, compiler or headers; on Debian: {PACKAGES}")
    return file


def one_light(stages):
    """Stages of a material with its first light alone."""
    before, loop, after = stages["pixel"].partition(LIGHTS)
    assert loop and LIGHTS not in after
    return {**stages, "pixel": before + LIGHT + after}


def statistics(stages, folder):
    """The driver's numbers of a material's fragment shader for one light, by name."""
    stages = one_light(stages)
    program = folder / "statistics"
    if not program.exists():
        subprocess.run(["gcc", "-O1", PROGRAM, "-o", program, "-lvulkan"], check=True)
    files = []
    for stage, kind in (("vertex", "vert"), ("pixel", "frag")):
        files.append(folder / f"{kind}.spv")
        command = [*COMPILER, kind, "-o", files[-1]]
        subprocess.run(command, input=stages[stage], text=True, check=True, capture_output=True)
    bindings = {
        number: KINDS[kind] for text in stages.values() for number, kind in BINDING.findall(text)
    }
    words = [str(len(ATTRIBUTE.findall(stages["vertex"]))), *map(":".join, bindings.items())]
    environment = os.environ | {"RADV_FORCE_FAMILY": CHIP, "VK_ICD_FILENAMES": str(driver())}
    command = [program, *files, *words]
    run = subprocess.run(command, env=environment, text=True, capture_output=True, check=True)
    return {
        name: int(number) for name, number in (line.split("\t") for line in run.stdout.splitlines())
    }


def measure(nodes=(*DIFFUSE, *BARE, *OTHERS)):
    """The `Group` of nodes."""
    driver()
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        for node in nodes:
            own, stock = (statistics(each, Path(folder)) for each in sources(node).values())
            for name, unit in STATISTICS.items():
                figures += [
                    figure(f"{node}, {unit}, eonlib", unit, [own[name]]),
                    ratio(f"{node}, {unit}, eonlib / stock", [own[name]], [stock[name]]),
                ]
    title = f"Fragment shaders as Mesa's RADV compiles them for {CHIP}, without the hardware"
    return Group("registers", title, tuple(figures))
