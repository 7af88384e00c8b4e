# SPDX-License-Identifier: Apache-2.0
"""Lists the files that MaterialX itself opens while it generates shaders for the fuzzer's cases.

strace reports all files that a process opens, and Python's audit hook reports the files that mxeon
opens. Files that only strace reports were opened by MaterialX, and must lie in the libraries or in
the documents' folder. A control run without mxeon's checks of sources must report forbidden files.
"""

import codecs
import contextlib
import os
import random
import re
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

from mxeon.shaders import generation
from mxeon.shaders.document.references import library_path
from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import case, cases
from tests.fuzz.trial import trial

ROOT = Path(__file__).resolve().parents[2]
# Names of missing files, which are opened to mark the start and the end of the cases in the log.
START, END = "/the cases begin here", "/the cases end here"
MACHINE = ("/sys/devices/system/cpu/online",)  # the C library opens this file
# Names of files that could make MaterialX wait forever.
ENDLESS = (b"pipe", b"zero", b"/dev/", b"/proc/")
OPEN = re.compile(rb'open(?:at2?)?\((?:AT_FDCWD, |\d+(?:<[^>]*>)?, )?"((?:[^"\\]|\\.)*)"(.*)')
# Pattern for paths inside a case's folder, excluding links that lead out of the folder.
OWN = re.compile(
    r"(?:/mxeon-fuzz-[^/]+/documents/|^)(?!/|\.\./|linked|zero|pipe|link/(?!documents/))"
)
SEED = 3


def selected(count, bare):
    """Random cases that run `generate`, from the family `includes` and from mutated documents."""
    mutated = (case(SEED, number) for number in range(count))
    tried = [*cases("includes", count), *mutated]
    tried = [each for each in tried if each.arguments[0] == "generate"]
    if bare:
        tried = [replace(each, links=()) for each in tried]
        tried = [each for each in tried if not any(word in str(each).encode() for word in ENDLESS)]
    return random.Random(SEED).sample(tried, min(count, len(tried)))


def opens(count, bare=False):
    with tempfile.TemporaryDirectory(prefix="mxeon-opens-") as folder:
        log, audit = Path(folder, "strace"), Path(folder, "audit")
        command = ["strace", "-f", "-qq", "-s", "4096", "-e", "trace=open,openat,openat2"]
        code = f"from tests.fuzz import opens; opens.generate({count}, {bare}, {str(audit)!r})"
        command += ["-o", str(log), sys.executable, "-c", code]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        return _traced(log.read_bytes()) - Counter(audit.read_text().splitlines())


def strangers(paths):
    """Paths outside the libraries and outside the folders of the cases."""
    others = (path for path in paths if not OWN.search(path) and path not in MACHINE)
    return sorted(path for path in others if not library_path(path))


def _traced(log):
    lines = log.split(START.encode())[1].split(END.encode())[0].splitlines()
    found = (OPEN.search(line) for line in lines)
    paths = (each[1] for each in found if each and b"O_DIRECTORY" not in each[2])
    return Counter(_line(os.fsdecode(codecs.escape_decode(path)[0])) for path in paths)


def _line(path):
    return ascii(path)[1:-1]


def generate(count, bare, audit):
    """Run the cases, and write a list of the files that Python opens in the meantime."""
    paths = []
    for target in generation.TARGETS:  # Every generator loads its files before the cases start.
        with contextlib.redirect_stderr(None):
            generation.generate(examples_folder() / "clay.mtlx", target)
    if bare:
        generation.check_sources = lambda *_: None
    tried = selected(count, bare)
    trial(tried[0])  # loads the command's files before the cases start
    sys.addaudithook(lambda event, seen: event == "open" and paths.append(seen[0]))
    with contextlib.suppress(OSError):
        os.open(START, os.O_RDONLY)
    for each in tried:
        trial(each)
    with contextlib.suppress(OSError):
        os.open(END, os.O_RDONLY)
    named = (path for path in paths if isinstance(path, str | bytes | os.PathLike))
    Path(audit).write_text("".join(f"{_line(os.fsdecode(path))}\n" for path in named))
