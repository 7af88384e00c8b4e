# SPDX-License-Identifier: Apache-2.0
"""A process of a renderer's own, which answers one request after the other.

The other end of the pipe is a script of the host.
"""

from __future__ import annotations

import json
import os
import time
from contextlib import suppress
from pathlib import Path
from signal import Signals
from subprocess import PIPE, Popen
from threading import Timer
from typing import TypeAlias

from mxeon.errors import NotRun

Reply: TypeAlias = dict[str, str]  # of a renderer's process


class Worker:
    """The process of a script, started by the first request and again after a crash.

    Parameters
    ----------
    name : str
        The host's, for messages.
    python : Path
        Interpreter that has the renderer.
    script : Path
        It prints `{"version": ...}`, then one JSON object for each that it reads; or `{"error": ...}`,
        and ends.
    log : Path
        File for what the renderer prints.
    limit : float
        Seconds that a request may take; after them the process is killed.
    *arguments : str
        Of the script.

    Attributes
    ----------
    version : str or None
        The renderer's, once it has been started.
    device : str
        That on which it draws, if the script prints one with the version.
    """

    def __init__(
        self, name: str, python: Path, script: Path, log: Path, limit: float, *arguments: str
    ) -> None:
        self._name = name
        self._command: list[str | Path] = [python, "-I", "-W", "ignore", script, *arguments]
        self.log = log
        self.limit = limit
        self._process: Popen[str] | None = None
        self.version: str | None = None
        self.device = ""

    @property
    def pid(self) -> int | None:
        """Number of the running process, or None."""
        return self._process.pid if self._process and self._process.poll() is None else None

    def start(self) -> None:
        """Start the process unless it runs; wait for its version.

        Raises
        ------
        NotRun
            If it ends, or says what it lacks.
        """
        if self.pid is not None:
            return
        # Start it, with what it prints in the log.
        self.close()
        self._read = 0
        with self.log.open("w") as log:
            self._process = Popen(
                self._command,
                stdin=PIPE,
                stdout=PIPE,
                stderr=log,
                text=True,
                errors="replace",
                env=os.environ | {"TMPDIR": str(self.log.parent)},  # Blender leaves a folder
            )
        # Read who it is, or what it lacks.
        greeting = self._reply()
        if "error" in greeting:
            self.close()
            raise NotRun(f"{self._name}: {greeting['error']}")
        self.version, self.device = greeting["version"], greeting.get("device", "")

    def ask(self, **request: object) -> Reply:
        """The reply to a request.

        Raises
        ------
        NotRun
            If the process ends or is silent for too long; with the last lines it printed.
        """
        self.start()
        self._read = self.log.stat().st_size
        assert self._process
        with suppress(BrokenPipeError):
            print(json.dumps(request), file=self._process.stdin, flush=True)
        return self._reply()

    def _reply(self) -> Reply:
        assert self._process and self._process.stdout
        # Read one line within the limit.
        begin = time.monotonic()
        killer = Timer(self.limit, self._process.kill)
        killer.start()
        line = self._process.stdout.readline()
        killer.cancel()
        # Return a whole answer.
        if line.endswith("}\n"):
            reply: Reply = json.loads(line)
            return reply
        # Say how the process ended.
        if line:  # an answer cut short: the process is on its way out
            self._process.kill()
        status = self._process.wait()
        if time.monotonic() - begin >= self.limit:
            end = f"no answer within {self.limit:g} s"
        else:
            end = f"ended by {Signals(-status).name}" if status < 0 else f"exit status {status}"
        last = " | ".join(self.printed()[-4:]) or "none"
        self.close()
        raise NotRun(f"{self._name}: {end}; last output: {last}")

    def printed(self) -> list[str]:
        """The lines printed since the last request."""
        with self.log.open("rb") as log:
            log.seek(self._read)
            text = log.read().decode(errors="replace")
        return [line.strip() for line in text.splitlines() if line.strip()]

    def close(self) -> None:
        """End the process if it runs."""
        if self._process:
            self._process.kill()
            self._process.communicate()
            self._process = None
