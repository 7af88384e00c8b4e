# SPDX-License-Identifier: Apache-2.0
"""The OSL inside Blender: it compiles a shader and runs it once for each pixel of a plane."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon.errors import ShaderError
from mxeon.hosts.cycles import process
from mxeon.hosts.cycles.process import interpreter
from mxeon.hosts.osl.carriers import DEBUG, HOLDOUT
from mxeon.hosts.osl.points import side
from mxeon.hosts.process import Worker
from mxeon.hosts.testrender.programs import find_program, output, version
from mxeon.shaders.scene import Scene

DARK = Scene("dark")
SECONDS = 300.0  # for one run
TROUBLE = ("ERROR", "WARNING")  # the first words of the engine's messages


class Blender:
    """A process of Blender, started by the first run."""

    carrier = HOLDOUT
    rooted = False
    place = "0.5 + 0.5 * P[0], 0.5 - 0.5 * P[1]"  # on the plane that the worker shows

    def __init__(self) -> None:
        python = interpreter("osl")
        self._temporary = TemporaryDirectory(prefix="mxeon-osl-")
        script = Path(process.__file__).with_name("worker.py")
        log = Path(self._temporary.name, "log.txt")
        self._worker = Worker("osl", python, script, log, SECONDS)

    @property
    def version(self) -> str:
        self._worker.start()
        return f"Blender {self._worker.version}"

    def folder(self) -> TemporaryDirectory[str]:
        return TemporaryDirectory(dir=self._temporary.name)

    def printed(self, folder: Path, text: str, count: int) -> list[str]:
        shader = folder / "shader.osl"
        shader.write_text(text, encoding="utf-8")
        frame = process.request(DARK, ()) | {"body": "plane", "size": side(count)}
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
        self._temporary.cleanup()


HOST = "osl"
ROOTED = (1, 15, 2)  # the first OSL whose closure takes the root of Zeltner's roughness


class Testshade:
    """oslc and testshade, on PATH or named by variables; see `mxeon.hosts.osl.engines.Blender`."""

    carrier = DEBUG
    place = "u, v"
    version = "testshade"

    def __init__(self) -> None:
        self._programs = find_program("oslc", HOST), find_program("testshade", HOST)
        words = version(self._programs[0]).split()[-1]
        self.rooted = tuple(map(int, words.split(".")[:3])) >= ROOTED
        self._temporary = TemporaryDirectory(prefix="mxeon-osl-")

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
