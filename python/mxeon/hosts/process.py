# SPDX-License-Identifier: Apache-2.0
"""A separate process for a renderer, which answers requests in sequence.

The process runs `serve.py` with a script of the host. The process first writes a JSON object with
the renderer's version to standard output. Then the process reads requests from standard input and
writes replies, one JSON object per line, until standard input ends.
"""

from __future__ import annotations

import json
import os
import time
from contextlib import suppress
from pathlib import Path
from signal import Signals
from subprocess import PIPE, Popen
from tempfile import TemporaryDirectory
from threading import Timer
from typing import TypeAlias

from mxeon.errors import LAST_OUTPUT, NotRun
from mxeon.jobs.signals import Temporary

Reply: TypeAlias = dict[str, str]
SERVE = Path(__file__).with_name("serve.py")


class Worker:
    """The process of a script, started by the first request and again after a crash.

    Output of the renderer is written to the file `log` in `folder`. The folder is deleted at the
    end. The process is killed if a request takes more than `limit` seconds. `version` and `device`
    come from the first message of the process.
    """

    limit = 300.0

    def __init__(self, name: str, python: Path, script: Path, *arguments: str) -> None:
        self.name = name
        self._command: list[str | Path] = [python, "-I", "-W", "ignore", SERVE, script, *arguments]
        self._temporary = Temporary(f"mxeon-{name}-")
        self.folder = Path(self._temporary.name)
        self.log = self.folder / "log.txt"
        self._process: Popen[str] | None = None
        self.version: str | None = None
        self.device = ""

    @property
    def pid(self) -> int | None:
        return self._process.pid if self._process and self._process.poll() is None else None

    def start(self) -> None:
        """Start the process unless it is running already, and wait for the renderer's version."""
        if self.pid is not None:
            return
        self._end()
        self._read = 0
        with self.log.open("wb") as log:
            self._process = Popen(
                self._command,
                stdin=PIPE,
                stdout=PIPE,
                stderr=log,
                text=True,
                errors="replace",
                env=os.environ | {"TMPDIR": str(self.folder)},  # Blender leaves temporary files
            )
        greeting = self._reply()
        if "error" in greeting:
            self._end()
            raise NotRun(f"{self.name}: {greeting['error']}")
        self.version, self.device = greeting["version"], greeting.get("device", "")

    def ask(self, **request: object) -> Reply:
        """The reply to a request.

        Raises NotRun, with the last lines of output, if the process ends or hangs.
        """
        self.start()
        self._read = self.log.stat().st_size
        assert self._process
        with suppress(BrokenPipeError):
            print(json.dumps(request), file=self._process.stdin, flush=True)
        return self._reply()

    def _reply(self) -> Reply:
        assert self._process and self._process.stdout
        begin = time.monotonic()
        killer = Timer(self.limit, self._process.kill)
        killer.start()
        line = self._process.stdout.readline()
        killer.cancel()
        if line.endswith("}\n"):
            reply: Reply = json.loads(line)
            return reply
        if line:  # the reply is incomplete because the process is ending
            self._process.kill()
        status = self._process.wait()
        if time.monotonic() - begin >= self.limit:
            end = f"no answer within {self.limit:g} s"
        else:
            end = f"ended by {Signals(-status).name}" if status < 0 else f"exit status {status}"
        last = " | ".join(self.printed()[-4:]) or "none"
        self._end()
        raise NotRun(f"{self.name}: {end}{LAST_OUTPUT}{last}")

    def printed(self) -> list[str]:
        with self.log.open("rb") as log:
            log.seek(self._read)
            text = log.read().decode(errors="replace")
        return [line for each in text.splitlines() if (line := each.strip())]

    def temporary(self) -> TemporaryDirectory[str]:
        """A new temporary folder inside `folder`."""
        return TemporaryDirectory(dir=self.folder)

    def close(self) -> None:
        self._end()
        self._temporary.cleanup()

    def _end(self) -> None:
        if self._process:
            self._process.kill()
            self._process.communicate()
            self._process = None
