# SPDX-License-Identifier: Apache-2.0
"""Conformance: hosts and libraries judged by the table of checks, and documents by their pictures.

The only place that sees both chains, the shaders and the models.
"""

from contextlib import closing, contextmanager, nullcontext
from functools import lru_cache, partial
from pathlib import Path

from mxeon.conformance.known_issues import repaired
from mxeon.conformance.results import Findings, Run
from mxeon.conformance.run.journal import Journal, read_journal, refusal
from mxeon.conformance.run.plan import Judge, not_run, plan
from mxeon.errors import InputError, NotRun
from mxeon.jobs import dask as cluster
from mxeon.jobs import pool
from mxeon.jobs.timeouts import TIMEOUT, WAIT, check_timeout
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.library import untested

__all__ = ["check", "read_run", "to_run", "work"]


def check(
    files=(),
    hosts=("gl",),
    libraries=("eonlib",),
    *,
    workers=0,
    timeout=TIMEOUT,
    folder=None,
    resume=False,
    scheduler=None,
    wait=WAIT,
    policy=DEFAULT,
    progress=lambda items, total: items,
):
    """Run every check on every host, and compare pictures of documents with the reference's.

    Parameters
    ----------
    files : sequence of path-like
        MaterialX documents; none for the bundled examples.
    hosts : sequence of str
        Who is judged; `mxeon.shaders.hosts.host_names` has them.
    libraries : sequence of str
        "eonlib", "stock" for MaterialX as it comes, and folders of MaterialX documents, which are
        loaded before the standard libraries.
    workers : int
        Processes that share the work, of which any may crash or hang; 0 to work in this one.
    timeout : float
        Seconds that one item may take in a worker.
    folder : path-like or None
        Where what is finished is kept, pictures included, so that an interrupted run can be
        resumed; None to keep it in memory.
    resume : bool
        Go on with the run that `folder` holds.
    scheduler : str or None
        Address of a Dask scheduler whose workers do the work instead.
    wait : float
        Seconds that its cluster may be without a worker that fits.
    policy : Policy
        What the documents may do, and how large they may be.
    progress : callable (iterable, int) -> iterable
        Goes through the items that are to be done, whose number it is told; a progress bar, say.

    Returns
    -------
    Run
        A document that cannot be judged is among its errors; the others are judged.

    Raises
    ------
    ValueError
        If a host or a library is unknown, `folder` holds another run than the one to resume or
        one of other drivers, `workers`, `timeout` or `wait` leave their ranges, or no scheduler
        answers or has workers that fit.
    NotRun
        If no process can start, or the cluster has no workers for too long.
    """
    planned = plan(files, hosts, libraries, policy, resumable=folder is not None)
    # Who cannot work must not touch what the folder holds.
    with (
        _crew(policy, workers, timeout, scheduler, wait) as crew,
        _open_journal(folder, planned, resume) as journal,
    ):
        places = [place for place in range(len(planned.items)) if place not in journal.findings]
        waiting = [planned.items[place] for place in places]
        # A farm's machines may differ from each other.
        known = {} if scheduler else _identities(journal.findings.values())
        for number, findings in progress(_done(waiting, crew), len(waiting)):
            _assert_same_hosts(folder, known, _identities([findings]))
            journal.add(places[number], findings)
        return to_run(planned, journal.findings)


def read_run(folder):
    """What the run in a folder has found so far.

    Raises
    ------
    ValueError
        If the folder holds no journal that this version reads.
    """
    return to_run(*read_journal(folder))


def work(policy, item):
    """Findings of an item, by this process's judge: what workers run.

    Raises
    ------
    NotRun
        If the host cannot be opened here.
    """
    return _judge(policy).work(item)


def settled(policy, item):
    """Findings of an item whatever is missing: what cannot be done here is not run."""
    return _settled(_judge(policy), item)


def to_run(planned, findings):
    """A run from its plan and the findings of the items that are done, by their places."""
    done = [findings[place] for place in sorted(findings)]
    found = {
        name: tuple(each for part in done for each in getattr(part, name))
        for name in vars(Findings())
    }
    return Run(
        version=planned.version,
        software=planned.software,
        documents=tuple(map(Path, planned.documents)),
        missing=tuple(str(i) for place, i in enumerate(planned.items) if place not in findings),
        **found
        | {
            "notes": _grouped(
                found["notes"]
                + repaired(found["results"], planned.software)
                + _untested(planned.software)
            ),
            "errors": tuple(dict.fromkeys(found["errors"])),
            "hosts": tuple(dict.fromkeys(found["hosts"])),
        },
    )


def _identities(findings):
    """Version and device of each host that findings are of, by its name."""
    return {host.name: f"{host.version}, {host.device}" for part in findings for host in part.hosts}


def _assert_same_hosts(folder, known, found):
    """Raise ValueError if a host of a run that is resumed has another version or device."""
    differences = [
        f"host {name} ({known[name]}, now {found[name]})"
        for name in known.keys() & found.keys()
        if known[name] != found[name]
    ]
    if differences:
        raise InputError(refusal(folder, differences))


class InMemoryJournal:
    """In-memory stand-in for Journal."""

    def __init__(self):
        self.findings = {}
        self.add = self.findings.__setitem__


def _open_journal(folder, planned, resume):
    return nullcontext(InMemoryJournal()) if folder is None else Journal(folder, planned, resume)


@contextmanager
def _crew(policy, workers, timeout, scheduler, wait):
    """Who works: a function from items to their outcomes."""
    if workers < 0:
        raise InputError(f"workers must be at least 0; got {workers}")
    check_timeout(timeout)
    if scheduler:
        with cluster.connect(scheduler, wait) as found:
            at_work = partial(work, policy)
            yield partial(cluster.run, at_work, workers=found, timeout=timeout, unavailable=NotRun)
    elif workers:
        yield partial(pool.run, partial(settled, policy), workers=workers, timeout=timeout)
    else:
        yield partial(_here, policy)


def _done(items, crew):
    """Findings of the items as they come, each with its place."""
    for place, outcome in crew(items):
        failed = outcome.value is None
        yield place, not_run(items[place], outcome.failure) if failed else outcome.value


def _here(policy, items):
    with closing(Judge(policy)) as judge:
        for place, item in enumerate(items):
            yield place, pool.Outcome(_settled(judge, item))


def _settled(judge, item):
    try:
        return judge.work(item)
    except NotRun as reason:
        return not_run(item, str(reason))


@lru_cache(maxsize=1)
def _judge(policy):
    return Judge(policy)


def _untested(software):
    """A note on a version of MaterialX that mxeon has not been tested with."""
    version = software.get("MaterialX")
    return ((untested(version), "every result"),) if version and untested(version) else ()


def _grouped(notes):
    """One line for each text, with all its places."""
    places = {}
    for text, place in dict.fromkeys(notes):
        places.setdefault(text, []).append(place)
    return tuple(f"{text}: {', '.join(found)}" for text, found in places.items())
