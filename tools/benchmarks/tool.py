# SPDX-License-Identifier: Apache-2.0
"""The tool itself: imports, the command, the library, and generation over many documents."""

import os
import subprocess
import sys
import time
from contextlib import contextmanager
from functools import partial

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.shaders.generation import GENERATORS, TARGETS, generate
from mxeon.shaders.library import examples_folder, load_library
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text
from tools.benchmarks.rounds import Check, Group, figure, interleave, peak_memory, reset_memory

STAGES = "pixel", "vertex"
DOCUMENTS = (1, 10, 100, 1000)


def starting(rounds):
    """Figures of imports and of the command's help, each in its own process."""
    codes = {
        "numpy": "import numpy",
        "mxeon": "import numpy, mxeon, mxeon.models.table",
        "help": "from mxeon.cli import main; main(['--help'])",
    }
    start = partial(subprocess.run, check=True, capture_output=True)
    rivals = {name: partial(start, [sys.executable, "-c", code]) for name, code in codes.items()}
    seconds = interleave(rivals, rounds)
    over = 1e3 * (seconds["mxeon"] - seconds["numpy"])
    return [
        figure("import mxeon and its models, beyond import numpy", "ms", over, goal=30.0),
        figure("mxeon --help", "ms", 1e3 * seconds["help"], goal=300.0),
    ]


def raw(library, text, target):
    """The calls of a MaterialX script for the same text, with the library already loaded."""
    document = mx.createDocument()
    mx.readFromXmlString(document, text)
    document.setDataLibrary(library)
    generator = GENERATORS[target].create()
    context = mx_gen.GenContext(generator)
    context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
    generator.registerTypeDefs(document)
    colors = mx_gen.DefaultColorManagementSystem.create(generator.getTarget())
    colors.loadLibrary(document)
    generator.setColorManagementSystem(colors)
    units = mx_gen.UnitSystem.create(generator.getTarget())
    converters = mx.UnitConverterRegistry.create()
    for name in ("distance", "angle"):
        definition = document.getUnitTypeDef(name)
        converters.addUnitConverter(definition, mx.LinearUnitConverter.create(definition))
    units.loadLibrary(document)
    units.setUnitConverterRegistry(converters)
    generator.setUnitSystem(units)
    context.getOptions().targetDistanceUnit = "meter"
    context.getOptions().fileTextureVerticalFlip = target == "osl"
    found = mx_gen.findRenderableElements(document)
    return [generator.generate(each.getName(), each, context) for each in found]


@contextmanager
def unwarned():
    """Suppress MaterialX's output to the process's standard error."""
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)


def generating(rounds, documents=100):
    """Figures of generation over documents of one lobe, against the raw calls, by target."""
    library, figures, checks = load_library(), [], []
    texts = [
        material_text(OREN_NAYAR, {"roughness": 0.5 + 0.004 * k, FLAG: True})
        for k in range(documents)
    ]
    for target in TARGETS:
        rivals = {
            "ours": lambda target=target: [generate(text, target) for text in texts],
            "raw": lambda target=target: [raw(library, text, target) for text in texts],
        }
        same = [dict(each.stages) for each in generate(texts[0], target)] == [
            {stage: each.getSourceCode(stage) for stage in STAGES if each.hasStage(stage)}
            for each in raw(library, texts[0], target)
        ]
        checks.append(Check(f"same text, {target}", float(not same), 0.0))
        seconds = interleave(rivals, rounds)
        name = f"generate / raw MaterialX calls, {target}, {documents} documents"
        figures.append(figure(name, "x", seconds["ours"] / seconds["raw"], goal=1.2))
    return figures, checks


def growing(counts):
    """Figures of time and memory over the number of documents, in glsl."""
    files = sorted(examples_folder().glob("*.mtlx"))
    generate(files[0], "glsl")
    figures = []
    for count in counts:
        before, start = reset_memory(), time.perf_counter()
        for k in range(count):
            generate(files[k % len(files)], "glsl")
        seconds, memory = time.perf_counter() - start, max(0.0, peak_memory() - before)
        figures.append(figure(f"{count} documents", "s", [seconds]))
        name = f"{count} documents, peak memory beyond the start"
        figures.append(figure(name, "MiB", [memory], goal=1.0))
    return figures


def measure(rounds=5, counts=DOCUMENTS, documents=100):
    with unwarned():
        figures, checks = generating(rounds, documents)
    figures = starting(4 * rounds) + figures + growing(counts)
    return Group("tool", "The tool", tuple(figures), tuple(checks))
