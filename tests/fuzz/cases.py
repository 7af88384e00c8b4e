# SPDX-License-Identifier: Apache-2.0
"""Random cases for the fuzzer, made from a seed and a number."""

import random
import re
from dataclasses import dataclass

from tests.fuzz.documents import XI, document, word
from tests.fuzz.words import CANARY

TARGETS = ("glsl", "essl", "vulkan", "wgsl", "msl", "slang", "osl", "mdl")
OUT = "../out"

# Command lines to mutate. Commands that would be slow name a host that does not exist.
COMMANDS = (
    ("generate", "base.mtlx", "--target", "osl", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "glsl", "--element", "look", "--json", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "osl", "--profile", "cycles", "--outputPath", OUT),
    ("generate", "base.mtlx", "part.mtlx", "--target", "mdl", "--library", "stock", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "osl", "--maxSize", "9999", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "osl", "--allowOutside", "--outputPath", OUT),
    ("render", "base.mtlx", "--host", "reference", "--size", "4", "--output", f"{OUT}/a.png"),
    ("render", "base.mtlx", "--host", "reference", "--scene", "back", "--output", f"{OUT}/a.exr", "--size", "4"),
    ("render", "base.mtlx", "--host", "reference", "--environment", "textures/a.png", "--output", f"{OUT}/a.png", "--size", "4"),
    ("check", "base.mtlx", "--host", "abacus"),
    ("check", "--library", "stock", "--report", f"{OUT}/r", "--resume", "--host", "abacus"),
    ("check", "--workers", "1", "--timeout", "5", "--json", "--host", "abacus"),
    ("library",),
    ("library", "--folder"),
    ("invert", "0.5", "0.4", "0.3", "--roughness", "0.5"),
    ("invert", "0.5", "0.4", "0.3", "--roughness", "1", "--average"),
    ("report", "make", "textures"),
    ("report", "diff", "results.json", "results.json"),
    ("kit", "check", "textures", "--renderer", "mine"),
    ("--version",),
    ("--help",),
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One test of the fuzzer: files and links in a folder, and a command line."""

    name: str
    files: tuple[tuple[str, bytes], ...]
    arguments: tuple[str, ...]
    links: tuple[tuple[str, str], ...] = ()
    encoding: str = "utf-8"


def case(seed, number):
    """Random case that depends only on the seed and the number."""
    rng = random.Random(f"{seed}-{number}")
    files = [("base.mtlx", document(rng))]
    if rng.random() < 0.15:
        files = [("base.mtlx", _including(rng)), ("part.mtlx", document(rng))]
    arguments = _command(rng) if rng.random() < 0.15 else _document(rng, files[0][1])
    return Case(f"{seed}-{number}", tuple(files), arguments)


def _including(rng):
    name = rng.choice(
        ("part.mtlx", "base.mtlx", "./part.mtlx", "../documents/part.mtlx", word(rng))
    )
    href = "".join(each for each in name if each.isprintable() and each not in '"&<')
    includes = f'<xi:include href="{href}"/>' * rng.choice((1, 1, 2))
    return f'<materialx version="1.39" {XI}>{includes}</materialx>'.encode()


def _document(rng, data):
    """Random command line that generates shaders from a document or renders it."""
    kind = rng.random()
    names = re.findall(r'<surfacematerial name="(\w+)"', data.decode(errors="replace"))
    if kind < 0.2:
        host = "gl" if kind < 0.01 else "reference"
        element = ("--element", rng.choice(names)) if names else ()
        output = ("--size", "4", "--output", f"{OUT}/a.png")
        return ("render", "base.mtlx", "--host", host, *element, *output)
    library = rng.choice(("eonlib", "eonlib", "eonlib", "stock"))
    arguments = ["generate", "base.mtlx", "--target", rng.choice(TARGETS), "--library", library]
    if rng.random() < 0.1:
        arguments += ["--profile", "cycles"]
    return (*arguments, "--outputPath", OUT)


def _command(rng):
    """Random command line, mutated from COMMANDS."""
    arguments = list(rng.choice(COMMANDS))
    for _ in range(rng.choice((1, 1, 2, 4))):
        place = rng.randrange(len(arguments))
        kind = rng.random()
        if kind < 0.5:
            kept = arguments[place - 1] in ("--outputPath", "--output", "--report", "--size")
            arguments[place] = arguments[place] if kept else word(rng)
        elif kind < 0.65:
            arguments.insert(place, rng.choice(arguments))
        elif kind < 0.8:
            other = rng.choice(COMMANDS)
            arguments.insert(place, rng.choice(other))
        elif len(arguments) > 1:
            del arguments[place]
    if "check" in arguments[:1]:
        arguments += ["--host", "abacus"]
    return tuple(arguments)


# Files next to the working folder, which no case may read.
SECRET = f'<materialx version="1.39"><constant name="{CANARY}" type="float"/></materialx>'
AROUND = (
    ("secret.mtlx", SECRET),
    ("secret.glsl", f"// {CANARY}\n"),
    ("secret.png", CANARY),
    ("1001.png", CANARY),
)
