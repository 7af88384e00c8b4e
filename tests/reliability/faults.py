# SPDX-License-Identifier: Apache-2.0
"""Runs of `mxeon check` that are killed, stopped, without room on the disk, and of many documents.

Each run keeps its journal in a folder of its own and goes on where it ended; what it finds is compared
with an undisturbed run.
"""

import os
import random
import signal
import subprocess
import time
from collections import Counter
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

from mxeon.conformance.results import NOT_RUN
from mxeon.conformance.run import read_run
from mxeon.conformance.run.journal import JOURNAL, read_journal
from mxeon.jobs.processes import PYTHON
from mxeon.shaders.library import examples_folder
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text

DOCUMENT = examples_folder() / "plaster.mtlx"
SEED = 1
LIMIT = 600  # seconds for a run, whatever happens to it
ENDED, INTERRUPTED = (
    (0, 1, 3),
    130,
)  # exit statuses of a run that came to its end, or was interrupted
VICTIMS = ("worker", "worker", "parent", "parent", "interrupt")
ITEM = 10.0  # seconds for an item: several times what the longest takes
START = 1.5  # seconds after which a worker is at work
MIB = 1 << 20


def start(folder, *options, files=(DOCUMENT,), capture=True):
    """The process of a run in a folder, resumed if begun; it leads a group, like a command in a terminal."""
    command = [*PYTHON, "-m", "mxeon", "check", *map(str, files), "--node", "common"]
    command += ["--report", str(folder), "--resume", "--workers", "2", *options]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} if capture else {}
    return psutil.Popen(command, text=True, process_group=0, **streams)


def finished(folder):
    """How many items a run has finished; 0 before it has begun."""
    path = Path(folder, JOURNAL)
    return max(0, path.read_bytes().count(b"\n") - 1) if path.exists() else 0


def verdicts(folder):
    """What a run found, as a set that two equal runs share."""
    keys = ("check", "subject", "host", "library", "verdict", "error")
    return {tuple(getattr(each, key) for key in keys) for each in read_run(folder).results}


def undisturbed(base):
    """What a run finds that nothing happens to, and the seconds that it takes."""
    began = time.monotonic()
    wait_for_end(start(Path(base, "calm")))
    return verdicts(Path(base, "calm")), time.monotonic() - began


def workers(process):
    """The processes that work for a run, those that they started included."""
    with suppress(psutil.Error):
        children = process.children(recursive=True)
        return [each for each in children if "spawn_main" in "".join(each.cmdline())]
    return []


def wait_for_end(process):
    """Exit status and standard error of a run."""
    try:
        _, errors = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        process.kill()
        raise TimeoutError(f"a run did not end within {LIMIT} s") from None
    return process.returncode, errors.strip()


def until(condition, process):
    """Wait for a condition, or for the end of the process; whether it came true."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end and process.poll() is None:
        if condition():
            return True
        time.sleep(0.005)
    return condition()


def kills(count=200, progress=iter):
    """Figures of runs whose workers or parents are killed, or which are interrupted, at random moments."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in the background ignore it
    rng, tally = random.Random(SEED), Counter()
    with TemporaryDirectory(prefix="mxeon-kills-") as base:
        calm, usual = undisturbed(base)
        for number in progress(range(count)):
            folder = Path(base, str(number))
            _strike(folder, rng, usual, tally)
            found = verdicts(folder)
            _, findings = read_journal(folder)
            tally["survived"] += found == calm
            tally["lost"] += len(calm - found)
            tally["twice"] += finished(folder) - len(findings)
    return {"runs": count, "seed": SEED, "items_each": len(calm), **tally}


def _strike(folder, rng, usual, tally):
    """A run, struck until it ends undisturbed."""
    status, strikes = None, 0
    while status not in ENDED:
        process = start(folder)
        time.sleep(rng.uniform(0.0, usual))
        victim = rng.choice(VICTIMS)
        if strikes < 3 and _hit(process, victim, rng):
            strikes += 1
            tally[f"struck_{victim}"] += 1
        status, errors = wait_for_end(process)
        tally["tracebacks"] += "Traceback" in errors
        tally["resumed"] += status not in ENDED
        tally["interrupted"] += status == INTERRUPTED


def _hit(process, victim, rng):
    """Strike; whether there was something to hit."""
    targets = workers(process) if victim == "worker" else [process]
    if process.poll() is not None or not targets:
        return False
    with suppress(psutil.Error, ProcessLookupError):
        if victim == "interrupt":
            os.killpg(process.pid, signal.SIGINT)  # to all in the terminal, as Ctrl-C
        else:
            rng.choice(targets).kill()
        return True
    return False


def hangs(count=10, progress=iter):
    """Figures of runs in which workers were stopped with SIGSTOP, once or for good."""
    rng, tally = random.Random(SEED), Counter()
    with TemporaryDirectory(prefix="mxeon-hangs-") as base:
        calm, _ = undisturbed(base)
        for number in progress(range(count)):
            folder = Path(base, f"once-{number}")
            process, goal = start(folder, "--timeout", str(ITEM)), rng.randrange(len(calm) // 4)
            until(lambda f=folder, g=goal, p=process: finished(f) > g and workers(p), process)
            stopped = _stop(workers(process)[:1])
            wait_for_end(process)
            tally["runs"] += stopped
            tally["survived"] += stopped and verdicts(folder) == calm
        reasons = _stopped_for_good(Path(base, "persistent"))
    named = sum("timed out after 3 s" in reason for reason in reasons)
    return {**tally, "persistent": 1, "reasons": len(reasons), "named": named}


def _stopped_for_good(folder):
    """Why items did not run in a run whose workers are all stopped until two have been given up."""

    def reasons():
        return [each.reason for each in read_run(folder).results if each.verdict == NOT_RUN]

    def given_up():
        _stop(each for each in workers(process) if time.time() - each.create_time() > START)
        return len(reasons()) >= 2

    process = start(folder, "--timeout", "3")
    until(lambda: finished(folder) > 4, process)
    if not until(given_up, process):
        raise RuntimeError("the run came to its end before two of its items were given up")
    wait_for_end(process)
    return reasons()


def _stop(processes):
    """How many could be stopped."""
    count = 0
    for each in processes:
        with suppress(psutil.Error):
            each.suspend()
            count += 1
    return count


def disk(sizes=range(8, 161, 8), progress=iter):
    """Figures of runs on a full disk, a tmpfs of so many KiB, that were resumed once there was room."""
    if os.geteuid() != 0:
        return {"not_run": "a tmpfs can be made by root only"}
    tally = Counter()
    with TemporaryDirectory(prefix="mxeon-disk-") as base:
        calm, _ = undisturbed(base)
        for size in progress(sizes):
            with _tmpfs(Path(base, "small"), size) as folder:
                status, errors = wait_for_end(start(folder / "run"))
                before = finished(folder / "run")
                subprocess.run(["mount", "-o", "remount,size=64m", folder], check=True)
                wait_for_end(start(folder / "run"))
                found = verdicts(folder / "run")
                tally["runs"] += 1
                tally["full"] += status != 0
                tally["one_line"] += (
                    status == 2 and "No space left" in errors and "\n" not in errors
                )
                tally["survived"] += found == calm
                tally["lost"] += len(calm - found) + max(0, before - finished(folder / "run"))
    return dict(tally)


@contextmanager
def _tmpfs(folder, size):
    """A file system of `size` KiB, mounted on `folder`."""
    folder.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "mxeon", folder], check=True)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=True)


def memory(counts=(10, 100, 1000), progress=iter):
    """Peak memory in MiB of the parent and of its largest worker, for each number of documents."""
    rows = []
    for count in progress(counts):
        with TemporaryDirectory(prefix="mxeon-memory-") as base:
            files = [_material(Path(base), number) for number in range(count)]
            began, parent, worker = time.monotonic(), 0, 0
            process = start(Path(base, "run"), files=files, capture=False)
            while process.poll() is None:
                with suppress(psutil.Error):
                    parent = max(parent, process.memory_info().rss)
                    children = process.children(recursive=True)
                    worker = max([worker, *(child.memory_info().rss for child in children)])
                time.sleep(0.1)
            seconds, status = time.monotonic() - began, process.returncode
            rows.append([count, parent / MIB, worker / MIB, seconds, status])
    return [
        dict(zip(("documents", "parent", "worker", "seconds", "status"), row, strict=True))
        for row in rows
    ]


def _material(folder, number):
    """A material that no other document has."""
    path = folder / f"document_{number:04}.mtlx"
    color = (number % 97 / 97, 0.5, number % 31 / 31)
    inputs = {"color": color, "roughness": number % 13 / 13, FLAG: True}
    path.write_text(material_text(OREN_NAYAR, inputs))
    return path
