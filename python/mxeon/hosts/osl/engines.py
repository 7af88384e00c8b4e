# SPDX-License-Identifier: Apache-2.0
"""Engines of OSL: Blender, which runs it at each pixel of a plane, and OSL's own programs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import warnings
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon.errors import MxeonError, NotRun, ShaderError
from mxeon.hosts.base import RendererWarning
from mxeon.hosts.cycles import process
from mxeon.hosts.cycles.process import interpreter
from mxeon.hosts.osl.carriers import DEBUG, HOLDOUT
from mxeon.hosts.osl.points import side
from mxeon.hosts.process import Worker
from mxeon.jobs.signals import Temporary

VARIABLES = {"oslc": "MXEON_OSLC", "testrender": "MXEON_TESTRENDER", "testshade": "MXEON_TESTSHADE"}
TIMEOUT = 300.0  # seconds for one run
LINES = 4  # quoted last lines of a program's output
# The version is in the first line of the help: oslc has no option for it.
TITLE = re.compile(r"^oslc -- (Open Shading Language) compiler (\S+)", re.MULTILINE)


def find_program(name: str, host: str = "testrender") -> str:
    """Path of a program that a host needs, named by its variable or on PATH."""
    variable = VARIABLES[name]
    program = os.environ.get(variable) or name
    path = shutil.which(program)
    if path is None:
        raise NotRun(
            f"{host}: no program {program!r}; build Open Shading Language, as tools/build_testrender.sh "
            f"does on Debian 12, and name it in {variable}"
        )
    return os.path.abspath(path)


def version(oslc: str) -> str:
    """Name and version of the language, from the help of oslc."""
    title = TITLE.search(output([oslc, "--help"]))
    if title is None:
        raise NotRun(f"testrender: {oslc} must be OSL's compiler; its help names no version")
    return f"{title[1]} {title[2]}"


def output(
    command: Sequence[str],
    folder: Path | None = None,
    failure: type[MxeonError] = NotRun,
    host: str = "testrender",
) -> str:
    """Standard output of a program; its warnings become `RendererWarning`.

    Raises `failure` with the last lines of a failed program, ShaderError if a successful program reports an error:
    testrender continues without lobes that exceed its memory.
    """
    try:
        process = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotRun(f"{host}: {error}") from None
    lines = (process.stdout + process.stderr).strip().splitlines()
    program = Path(command[0]).name
    if process.returncode:
        last = " | ".join(lines[-LINES:])
        raise failure(f"{host}: {program}: exit status {process.returncode}; last output: {last}")
    for line in lines:
        if line.startswith("ERROR") or "Assertion" in line:
            raise ShaderError(f"{host}: {program}: {line}")
    for line in dict.fromkeys(lines):
        if line.startswith("WARNING"):
            warnings.warn(f"{program}: {line}", RendererWarning, stacklevel=2)
    return process.stdout


TROUBLE = ("ERROR", "WARNING")  # first words of the engine's messages


class Blender:
    """A process of Blender, started on demand."""

    carrier = HOLDOUT
    rooted = False
    place = process.PLACE

    def __init__(self) -> None:
        script = Path(process.__file__).with_name("worker.py")
        self._worker = Worker("osl", interpreter("osl"), script, TIMEOUT)
        self.folder = self._worker.temporary

    @property
    def version(self) -> str:
        self._worker.start()
        return f"Blender {self._worker.version}"

    def printed(self, folder: Path, text: str, count: int) -> list[str]:
        shader = folder / "shader.osl"
        shader.write_text(text, encoding="utf-8")
        frame = process.request(process.DARK, ()) | {"body": "plane", "size": side(count)}
        reply = self._worker.ask(output=str(folder / "output.exr"), shader=str(shader), **frame)
        lines = self._worker.printed()
        if "error" in reply:
            raise ShaderError(f"osl: the shader does not compile: {' | '.join(lines[:4])}")
        for line in lines:
            if line.startswith(TROUBLE) or "Assertion" in line:
                raise ShaderError(f"osl: {line.partition(', called from')[0]}")
        return lines

    def close(self) -> None:
        self._worker.close()


HOST = "osl"
ROOTED = (1, 15, 2)  # first OSL whose sheen closure takes the root of Zeltner's roughness


class Testshade:
    """oslc and testshade, on PATH or named by variables; see `mxeon.hosts.osl.engines.Blender`."""

    carrier = DEBUG
    place = "u, v"
    version = "testshade"

    def __init__(self) -> None:
        self._programs = find_program("oslc", HOST), find_program("testshade", HOST)
        words = version(self._programs[0]).split()[-1]
        self.rooted = tuple(map(int, words.split(".")[:3])) >= ROOTED
        self._temporary = Temporary("mxeon-osl-")

    def folder(self) -> TemporaryDirectory[str]:
        return TemporaryDirectory(dir=self._temporary.name)

    def printed(self, folder: Path, text: str, count: int) -> list[str]:
        oslc, testshade = self._programs
        (folder / "shader.osl").write_text(text, encoding="utf-8")
        output([oslc, "-q", "-o", "shader.oso", "shader.osl"], folder, ShaderError, HOST)
        size = str(side(count))
        command = [testshade, "-t", "1", "--res", size, size, "--center", "shader"]
        return output(command, folder, ShaderError, HOST).splitlines()

    def close(self) -> None:
        self._temporary.cleanup()
