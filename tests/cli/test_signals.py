# SPDX-License-Identifier: Apache-2.0
"""After a signal, a command prints one line, exits with the usual status, and leaves no files."""

import os
import signal
import subprocess
import sys

import pytest

from mxeon.jobs.signals import ENDING, raise_signals
from tests.support.command import DEADLINE, PLASTER, wait_for

GENERATE = [sys.executable, "-m", "mxeon", "generate", PLASTER, "--target", "osl"]
GENERATE += ["--outputPath", "out", "--workers", "1"]
CHECK = ["check", PLASTER, "--workers", "1", "--report", "report"]


def start(folder, *arguments, code="from mxeon.__main__ import main; sys.exit(main())"):
    """Start a command in its own process group, with its temporary files in `folder`/tmp."""
    (folder / "tmp").mkdir()
    return subprocess.Popen(
        [sys.executable, "-c", f"import sys\n{code}", *arguments],
        cwd=folder,
        env=os.environ | {"TMPDIR": str(folder / "tmp")},
        stderr=subprocess.PIPE,
        text=True,
        process_group=0,
    )


def wait_for_results(folder, process):
    journal = folder / "report" / "journal" / "items.jsonl"
    wait_for(lambda: journal.exists() and journal.read_bytes().count(b"\n") > 1, process)


@pytest.mark.parametrize(
    ("number", "to"),
    [(signal.SIGTERM, "command"), (signal.SIGINT, "terminal")],
)
def test_a_signal_ends_the_command_in_one_line_and_nothing_stays(tmp_path, number, to):
    process = start(tmp_path, *CHECK)
    wait_for_results(tmp_path, process)
    (os.kill if to == "command" else os.killpg)(process.pid, number)
    _, errors = process.communicate(timeout=DEADLINE)
    line = "interrupted" if number == signal.SIGINT else f"ended by {number.name}"
    line += "; --resume continues; `mxeon report make report` reports finished checks"
    assert (process.returncode, errors) == (128 + number, f"mxeon: {line}\n")
    assert not list((tmp_path / "tmp").iterdir())
    assert not list(tmp_path.rglob(".mxeon*"))


def test_a_killed_command_leaves_its_folder_to_the_next_one(tmp_path):
    process = start(tmp_path, *CHECK)
    folder = tmp_path / "tmp"
    wait_for_results(tmp_path, process)
    # Pause the command, because the command would remove its folder at the end.
    process.send_signal(signal.SIGSTOP)
    [made] = folder.glob("mxeon-pool-*")
    os.utime(made, (0, 0))  # folders younger than a minute are never deleted
    alive = subprocess.run(GENERATE, cwd=tmp_path, env=os.environ | {"TMPDIR": str(folder)})
    assert alive.returncode == 0 and list(folder.glob("mxeon-pool-*"))  # a folder in use remains
    process.kill()
    process.communicate(timeout=DEADLINE)
    for each in folder.iterdir():
        os.utime(each, (0, 0))
    after = subprocess.run(GENERATE, cwd=tmp_path, env=os.environ | {"TMPDIR": str(folder)})
    assert after.returncode == 0 and not list(folder.iterdir())


def test_a_signal_before_the_workers_work_ends_them_too(tmp_path):
    process = start(tmp_path, *CHECK)
    # Python creates a randomly named file in TMPDIR; only mxeon's names contain a hyphen.
    wait_for(lambda: list((tmp_path / "tmp").glob("*-*")), process)
    os.killpg(process.pid, signal.SIGTERM)
    _, errors = process.communicate(timeout=DEADLINE)
    assert (process.returncode, errors) == (128 + signal.SIGTERM, "mxeon: ended by SIGTERM\n")
    assert not list((tmp_path / "tmp").iterdir())


def test_a_signal_while_a_temporary_folder_is_made_leaves_none(tmp_path):
    code = """
import os, signal, tempfile
usual, made = tempfile.mkdtemp, []
def mkdtemp(*arguments, **options):
    made.append(usual(*arguments, **options))
    if len(made) > 1: os.kill(os.getpid(), signal.SIGUSR2)
    return made[-1]
tempfile.mkdtemp = mkdtemp
from mxeon.__main__ import main
sys.exit(main())"""
    process = start(tmp_path, *CHECK, code=code)
    _, errors = process.communicate(timeout=DEADLINE)
    assert process.returncode == 128 + signal.SIGUSR2
    assert errors.startswith("mxeon: ended by SIGUSR2") and errors.count("\n") == 1
    assert not list((tmp_path / "tmp").iterdir())


def test_a_signal_that_is_ignored_stays_ignored(tmp_path):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # `nohup` also ignores SIGHUP
    try:
        with raise_signals():
            os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


def test_handlers_are_as_before_afterwards():
    before = [signal.getsignal(each) for each in ENDING]
    with raise_signals():
        pass
    assert [signal.getsignal(each) for each in ENDING] == before


def test_an_interrupt_during_the_imports_shows_no_traceback(tmp_path):
    code = """import mxeon.__main__ as m, builtins, os, signal
usual = builtins.__import__
def slow(name, *rest):
    if name == "mxeon.cli": os.kill(os.getpid(), signal.SIGINT)
    return usual(name, *rest)
builtins.__import__ = slow
m.main()"""
    process = start(tmp_path, code=code)
    _, errors = process.communicate(timeout=DEADLINE)
    assert (process.returncode, errors) == (-signal.SIGINT, "")
