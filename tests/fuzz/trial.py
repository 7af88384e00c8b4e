# SPDX-License-Identifier: Apache-2.0
"""Runs the command of a case in a new folder, and reports forbidden effects of the command."""

import contextlib
import io
import itertools
import os
import resource
import shutil
import tempfile
import traceback
from pathlib import Path

from mxeon.errors import COMMAND, STEERING
from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import AROUND, OUT
from tests.fuzz.documents import CANARY, POISON

STATUSES = (0, 2, 3)
OUTPUTS = ("--outputPath", "--output", "--report")
# MAKING commands use worker processes, which would hide crashes. JUDGING commands may exit with
# status 1 if a check fails.
MAKING = ("generate", "render")
JUDGING = ("check", "kit", "report", "render", "library")
LONGEST_LINE = 1200  # maximum characters of a message (1000), its prefix, and a path
MEMORY = 6 * 2**30


def judged(tried):
    """Run a case in this process with limited memory, and return the result of `trial`."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    return trial(tried)


def trial(tried):
    """Run a case. Return the exit status, and a line that lists all forbidden effects or ""."""
    with tempfile.TemporaryDirectory(prefix="mxeon-fuzz-") as folder:
        root = Path(folder).resolve()
        home = _prepared(root, tried)
        before = _contents(root)
        with contextlib.chdir(home):
            status, out, err = _called(tried.arguments, tried.encoding)
        judging = set(tried.arguments[:1]) & set(JUDGING)
        named = tuple(os.path.realpath(home / each) for each in _outputs(tried.arguments))
        allowed = 0 if status == 1 and judging else status
        return status, "; ".join(_faults(root, named, before, allowed, out, err))


def _outputs(arguments):
    """Paths that a command line permits mxeon to write."""
    if arguments[:2] == ("report", "make"):  # `report make` writes to the folder of the run
        return [path for path in arguments[2:3] if "\0" not in path]
    pairs = itertools.pairwise(arguments)
    return [path for option, path in pairs if option in OUTPUTS and "\0" not in path]


def _prepared(root, tried):
    """Create and return a case's working folder.

    A link in the folder leads outside, and the files AROUND lie outside.
    """
    home = root / "documents"
    shutil.copytree(examples_folder() / "textures", home / "textures")
    (home / "link").symlink_to(root)
    (home / "own.glsl").write_text("void x(out BSDF r) { r = BSDF(vec3(0.0), vec3(1.0)); }\n")
    (home / "results.json").write_text('{"format": 5, "results": [{"host": "gl"}], "pictures": []}')
    for name, text in AROUND:
        (root / name).write_text(text)
    if tried.arguments[:1] == ("render",):  # `render` does not create folders
        (home / OUT).mkdir()
    for name, data in tried.files:
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_bytes(data)
    for name, end in tried.links:
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).symlink_to(end) if end else os.mkfifo(home / name)
    return home


def _called(arguments, encoding):
    """Run a command, and return the exit status or a traceback, the output and the error output."""
    from mxeon.cli import main

    out, err = (io.TextIOWrapper(io.BytesIO(), encoding, newline="") for _ in range(2))
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            here = ("--workers", "0") if arguments[:1] and arguments[0] in MAKING else ()
            status = main([*arguments[:1], *here, *arguments[1:]])
        except SystemExit as ended:
            status = ended.code or 0
        except BaseException:
            status = traceback.format_exc()
    for stream in (out, err):
        stream.flush()
    return status, *(stream.buffer.getvalue().decode(encoding) for stream in (out, err))


def _faults(root, named, before, status, out, err):
    if status not in STATUSES:
        lines = str(status).strip().splitlines()
        yield f"ended with {lines[-1]} from {' '.join(lines[-4:-1])}"
    lines = err.splitlines()
    odd = (line for line in lines if not line.startswith("mxeon") or STEERING.search(line))
    yield from (f"said {line!r}" for line in odd)
    if any(len(line) > LONGEST_LINE for line in lines):
        yield f"said a line of {max(map(len, lines))} characters"
    if status == 2 and not lines:
        yield "did not say why"
    if command := COMMAND.search(f"{out}\n{err}"):
        yield f"said {command.string[command.start() :].splitlines()[0]!r} to a runner"
    after = _contents(root)
    written = {name: data for name, data in after.items() if before.get(name) != data}
    yield from (f"wrote {name}" for name in written if not str(root / name).startswith(named))
    texts = b"\n".join(written.values())
    if CANARY in out or CANARY.encode() in texts:
        yield "gave away a file from outside"
    if POISON.encode() in texts and "contains its own code" not in err:
        yield "let a word into a shader as code"


def _contents(root):
    """Contents of all files below a folder, by relative path; links are not followed."""
    paths = (Path(each) / name for each, _, names in os.walk(root) for name in names)
    files = (path for path in paths if path.is_file() and not path.is_symlink())
    return {str(file.relative_to(root)): file.read_bytes() for file in files}
