# SPDX-License-Identifier: Apache-2.0
"""The same run with other versions of MaterialX, each in an environment made on demand.

An environment is a folder that holds one MaterialX and comes before all others on the path of
Python, so that everything else is what it is here.
"""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from filelock import FileLock

from mxeon import conformance
from mxeon.hosts import NotRun
from mxeon.library import VERSIONS
from mxeon.processes import HOME, PYTHON
from mxeon.results import Run

PLACE = "materialx-{}"  # in a report's folder, the run of a version


def check(versions, arguments, folder):
    """One run made of those of several versions of MaterialX.

    Parameters
    ----------
    versions : sequence of str
    arguments : sequence of str
        Of `mxeon check`, but for --report and --materialx.
    folder : path-like
        Gets a folder with the run of each version.

    Returns
    -------
    Run
        Its libraries carry the version in their names.

    Raises
    ------
    ValueError
        If a version is not known to work, lists the known ones; or a run is refused.
    NotRun
        If a version cannot be installed.
    """
    for version in versions:
        _known(version)
    places = {version: Path(folder, PLACE.format(version)) for version in versions}
    for version, place in places.items():
        check_in(environment(version), version, arguments, place)
    return read_run(folder)


def read_run(folder):
    """What the run in a folder has found so far, with one version of MaterialX or several.

    Raises
    ------
    ValueError
        If the folder holds no journal that this version reads.
    """
    parts = sorted(Path(folder).glob(PLACE.format("*")))
    if not parts:
        return conformance.read_run(folder)
    start = len(PLACE.format(""))
    return merged({part.name[start:]: conformance.read_run(part) for part in parts})


def environment(version):
    """The folder that holds a version of MaterialX; installed by pip the first time.

    It lies in MXEON_ENVIRONMENTS, else in .cache/mxeon of the home folder.

    Raises
    ------
    ValueError
        If the version is not known to work; lists the known ones.
    NotRun
        If pip cannot install it; says why.
    """
    _known(version)
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    base = os.environ.get("MXEON_ENVIRONMENTS") or Path.home() / ".cache" / "mxeon"
    folder = Path(base, f"materialx-{version}-{python}")
    folder.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(f"{folder}.lock"):
        if not folder.is_dir():
            with TemporaryDirectory(dir=folder.parent) as beside:
                install(version, Path(beside, "new"))
                Path(beside, "new").rename(folder)
    return folder


def install(version, folder):
    """Put a version of MaterialX, and nothing else, into a new folder.

    Raises
    ------
    NotRun
        If pip cannot; says why.
    """
    command = [*PYTHON, "-m", "pip", "install", "--quiet", "--no-deps", "--target"]
    done = subprocess.run([*command, folder, f"materialx=={version}"], capture_output=True, text=True)
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise NotRun(f"MaterialX {version}: pip cannot install it; {reason}")


def check_in(environment, version, arguments, place):
    """`mxeon check` with the MaterialX of a folder, in a process of its own.

    Parameters
    ----------
    environment : path-like
    version : str
        Of that MaterialX, for messages.
    arguments : sequence of str
        Of `mxeon check`, but for --report.
    place : path-like
        The report's folder.

    Raises
    ------
    ValueError
        If it refuses; in its words.
    """
    paths = [str(environment), HOME]
    if os.environ.get("PYTHONPATH"):
        paths.append(os.environ["PYTHONPATH"])
    done = subprocess.run(
        [*PYTHON, "-m", "mxeon", "check", "--report", str(place), "--json", *arguments],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE if not sys.stderr.isatty() else None,
        text=True,
    )
    if not done.stdout.strip():  # it has a run to show unless it refuses
        reason = ((done.stderr or "").strip() or "see above").splitlines()[-1]
        raise ValueError(f"MaterialX {version}: {reason.removeprefix('mxeon: ')}")


def merged(runs):
    """The runs of several versions as one, by version; a library is called after both.

    Parameters
    ----------
    runs : dict of str to Run

    Returns
    -------
    Run
    """
    first = next(iter(runs.values()))
    parts = [_named(run, version) for version, run in runs.items()]
    software = first.software | {"MaterialX": ", ".join(runs)}
    found = {
        name: tuple(dict.fromkeys(each for part in parts for each in getattr(part, name)))
        for name in ("hosts", "notes", "errors", "documents", "missing")
    }
    listed = {
        name: tuple(each for part in parts for each in getattr(part, name))
        for name in ("results", "pictures", "curves")
    }
    return Run(version=first.version, software=software, **found, **listed)


def _named(run, version):
    """A run whose records carry the version of MaterialX in the names of their libraries."""

    def named(records):
        return tuple(
            replace(each, library=f"{each.library}, MaterialX {version}") for each in records
        )

    return replace(
        run,
        results=named(run.results),
        pictures=named(run.pictures),
        curves=named(run.curves),
        missing=tuple(f"{item}, MaterialX {version}" for item in run.missing),
        errors=tuple(f"MaterialX {version}: {error}" for error in run.errors),
    )


def _known(version):
    if version not in VERSIONS:
        raise ValueError(f"materialx must be one of {', '.join(VERSIONS)}; got {version!r}")
