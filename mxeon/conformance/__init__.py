# SPDX-License-Identifier: Apache-2.0
"""Conformance: hosts and libraries judged by the table of checks, and documents by their pictures.

The only place that sees both chains, the shaders and the models.
"""

import platform
from contextlib import ExitStack, closing
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path

import mxeon
from mxeon.conformance.documents import SCENES, judge_document
from mxeon.conformance.nodes import judge_curve, judge_subject, judge_twins
from mxeon.conformance.probes import PROBES
from mxeon.conformance.subjects import SUBJECTS
from mxeon.conformance.sources import check_sources
from mxeon.hosts import NotRun, open_host
from mxeon.library import LIBRARIES, examples_folder
from mxeon.results import NOT_RUN, Result, Run

SOFTWARE = ("MaterialX", "numpy", "OpenImageIO", "moderngl")


@dataclass(frozen=True)
class Findings:
    """What one step of a run found; see `mxeon.results.Run`."""

    results: tuple = ()
    pictures: tuple = ()
    curves: tuple = ()
    notes: tuple = ()
    errors: tuple = ()


def check(files=(), hosts=("gl",), library="eonlib", progress=list):
    """Every check on every host, and every document's pictures against the reference's.

    Parameters
    ----------
    files : sequence of path-like
        MaterialX documents; none for the bundled examples.
    hosts : sequence of str
        Who is judged; `mxeon.conformance.probes.PROBES` has them.
    library : str
        "eonlib", or "stock" for MaterialX as it comes.
    progress : callable (list) -> iterable
        Goes through the steps; a progress bar, say.

    Returns
    -------
    Run
        A document that cannot be judged is among its errors; the others are judged.

    Raises
    ------
    ValueError
        If a host or the library is unknown; lists the known ones.
    """
    for host in hosts:
        if host not in PROBES:
            raise ValueError(f"host must be one of {', '.join(PROBES)}; got {host!r}")
    if library not in LIBRARIES:
        raise ValueError(f"library must be one of {', '.join(LIBRARIES)}; got {library!r}")
    files = [Path(file) for file in files] or _examples(library)
    subjects = [subject for subject in SUBJECTS if subject.stock or library != "stock"]
    steps = [lambda: Findings(results=check_sources(subjects, library))]
    identities = []
    with ExitStack() as stack:
        judge = stack.enter_context(closing(open_host("reference")))
        for name in hosts:
            try:
                host = stack.enter_context(closing(open_host(name)))
                identities.append(host.identity())
            except NotRun as reason:
                steps.append(partial(_not_run, name, library, str(reason)))
            else:
                steps += _steps(host, judge, subjects, files, library)
        parts = [step() for step in progress(steps)]
    found = {name: sum((getattr(part, name) for part in parts), ()) for name in vars(Findings())}
    return Run(
        version=mxeon.__version__,
        software={"Python": platform.python_version()} | {each: version(each) for each in SOFTWARE},
        hosts=tuple(identities),
        documents=tuple(files),
        **found | {"notes": _grouped(found["notes"])},
    )


def _examples(library):
    """The bundled documents, but for those with a node that the library lacks."""
    files = sorted(examples_folder().glob("*.mtlx"))
    lacking = [subject.node for subject in SUBJECTS if library == "stock" and not subject.stock]
    return [file for file in files if not any(node in file.read_text() for node in lacking)]


def _steps(host, judge, subjects, files, library):
    """The work on one host: independent steps, each giving Findings."""
    steps = [lambda: Findings(results=judge_twins(host, library))]
    for subject in subjects:
        probe = PROBES[host.name](host, subject, library)
        steps.append(lambda probe=probe: Findings(results=judge_subject(probe)))
        steps.append(lambda probe=probe: Findings(curves=judge_curve(probe)))
    if host.name in SCENES:
        steps += [partial(_document, file, host, judge, library) for file in files]
    return steps


def _document(file, host, judge, library):
    try:
        results, pictures, notes = judge_document(file, host, judge, library)
    except ValueError as error:
        return Findings(errors=(str(error),))
    return Findings(results=results, pictures=pictures, notes=notes)


def _grouped(notes):
    """One line for each text, with all its places."""
    places = {}
    for text, place in notes:
        places.setdefault(text, []).append(place)
    return tuple(f"{text}: {', '.join(found)}" for text, found in places.items())


def _not_run(name, library, reason):
    claim = "The host executes shaders here."
    return Findings(results=(Result("host", claim, name, name, library, NOT_RUN, reason=reason),))
