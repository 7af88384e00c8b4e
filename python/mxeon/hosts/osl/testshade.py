# SPDX-License-Identifier: Apache-2.0
"""testshade of a build of OSL: it runs a shader once for each point of a grid."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon.errors import ShaderError
from mxeon.hosts.osl.carriers import DEBUG
from mxeon.hosts.osl.points import side
from mxeon.hosts.testrender.programs import find_program, output, version

HOST = "osl"
ROOTED = (1, 15, 2)  # the first OSL whose closure takes the root of Zeltner's roughness


class Testshade:
    """oslc and testshade, on PATH or named by variables; see `mxeon.hosts.osl.blender.Blender`."""

    carrier = DEBUG
    place = "u, v"
    version = "testshade"

    def __init__(self) -> None:
        self._programs = find_program("oslc", HOST), find_program("testshade", HOST)
        words = version(self._programs[0]).split()[-1]
        self.rooted = tuple(map(int, words.split(".")[:3])) >= ROOTED
        self._temporary = TemporaryDirectory(prefix="mxeon-osl-")

    def folder(self) -> TemporaryDirectory[str]:
        """Folder for the files of one run."""
        return TemporaryDirectory(dir=self._temporary.name)

    def printed(self, folder: Path, text: str, count: int) -> list[str]:
        """Lines that a shader prints; see `mxeon.hosts.osl.blender.Blender`."""
        oslc, testshade = self._programs
        (folder / "shader.osl").write_text(text, encoding="utf-8")
        output([oslc, "-q", "-o", "shader.oso", "shader.osl"], folder, ShaderError, HOST)
        size = str(side(count))
        command = [testshade, "-t", "1", "--res", size, size, "--center", "shader"]
        return output(command, folder, ShaderError, HOST).splitlines()

    def close(self) -> None:
        self._temporary.cleanup()
