# SPDX-License-Identifier: Apache-2.0
"""`mxeon check`: run the checks on hosts, and compare pictures of documents."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from mxeon import survey
from mxeon.cli import arguments, output
from mxeon.errors import MISUSE, PASSED, InputError
from mxeon.hosts import host_names, register
from mxeon.jobs import WAIT, signals

if TYPE_CHECKING:
    from mxeon.report.diff import Report

T = TypeVar("T")


def add_parser(commands: arguments.Commands) -> None:
    register(*survey.ROWS)
    default, *others = host_names()
    command = arguments.add_command(
        commands,
        "check",
        "check materials, or a shader library, against the specification",
        run,
        "check my.mtlx  # your materials, with eonlib and with stock MaterialX",
        "check my.mtlx --library stock --report out  # with MaterialX's own shaders, and a report",
        "check --library ./libraries --node all  # every node of your copy of MaterialX",
        "check --library ./libraries --baseline accepted  # what got worse since an earlier run",
    )
    command.add_argument(
        "files",
        nargs="*",
        metavar="FILE",
        help="MaterialX documents, or folders of documents; without FILE, check the library's common "
        "nodes and the bundled examples",
    )
    command.add_argument(
        "--host",
        action="append",
        metavar="NAME",
        help=f"where to run the shaders: {default} (default), {', '.join(others)}, or all; repeatable",
    )
    command.add_argument(
        "--library",
        action="append",
        metavar="NAME",
        help=f"{arguments.LIBRARY}. Repeatable. Without it, FILEs are checked with stock too, "
        "for comparison; only eonlib determines the exit status",
    )
    command.add_argument(
        "--node",
        action="append",
        metavar="NAME",
        help="check the nodes of this category (such as sheen_bsdf), or 'common' or 'all' nodes, "
        "even if no document uses them; repeatable. 'list' prints the names",
    )
    arguments.add_shared(command, "--report")
    command.add_argument(
        "--baseline",
        metavar="FILE",
        help="results.json, or the report's folder, of an accepted run: the exit status is 1 only "
        "if something got worse, 3 if a check no longer runs",
    )
    command.add_argument(
        "--annotations",
        action="store_true",
        help="also print failures, or what got worse, as annotations for GitHub",
    )
    command.add_argument(
        "--resume", action="store_true", help="continue an interrupted run in the --report folder"
    )
    arguments.add_shared(command, "--full", "--json", "--workers", "--timeout")
    command.add_argument(
        "--seed",
        type=int,
        default=1,
        metavar="N",
        help="random seed; also varies the number of samples (default: %(default)s)",
    )
    command.add_argument("--scheduler", metavar="ADDRESS", help="run on this Dask cluster")
    command.add_argument(
        "--waitForWorkers",
        type=float,
        default=WAIT,
        metavar="SECONDS",
        help="how long to wait for a worker of the cluster (default: %(default)g)",
    )
    arguments.add_methods(command)
    arguments.add_shared(command, "--materialx")
    arguments.add_policy(command, runs_code=True)


def run(options: argparse.Namespace) -> int:
    progress = output.Progress("mxeon check", _label)
    progress.show("reads the documents" if options.files else "reads the library")
    from mxeon.cli.answer import show_run
    from mxeon.conformance.run import check
    from mxeon.conformance.run.journal import JOURNAL
    from mxeon.conformance.run.plan import node_names

    if "list" in (options.node or ()):
        progress.clear()
        print("\n".join(sorted(node_names())))
        return PASSED
    if options.resume and not options.report:
        raise InputError("--resume needs the folder of the run to continue; pass --report DIR")
    if options.report:
        from mxeon.report import require_extra

        require_extra("--report")
    if options.scheduler and options.materialx:
        raise InputError(
            "--materialx does not reach the workers of a --scheduler; put that package on "
            "their PYTHONPATH"
        )
    baseline = _baseline(options) if options.baseline else None
    refused: list[str] = []

    def refuse(error: str) -> None:
        refused.append(error)
        output.fail(MISUSE, error)

    try:
        result = check(
            options.files or None,
            options.host or "gl",
            options.library or "eonlib",
            workers=options.workers,
            timeout=options.timeout,
            folder=options.report,
            resume=options.resume,
            scheduler=options.scheduler,
            wait=options.waitForWorkers,
            policy=arguments.policy(options),
            nodes=options.node,
            progress=_importing(progress) if options.report else progress,
            refuse=refuse,
            # Documents are also judged with stock MaterialX, unless the user names libraries.
            compared="stock" if options.files and not options.library else (),
            seed=options.seed,
            methods=arguments.methods(options),
        )
    except signals.SignalExit as end:
        if options.report and Path(options.report, JOURNAL).exists():
            remedy = (
                f"--resume continues; `mxeon report make {options.report}` reports finished checks"
            )
            end.args = (f"{end}; {remedy}",)
        raise
    return show_run(result, options, refused, baseline)


def _baseline(options: argparse.Namespace) -> Report:
    """Read the accepted run first, because --report moves earlier results away."""
    from mxeon.conformance.run.journal import Journal
    from mxeon.report.diff import read_results

    try:
        return read_results(options.baseline)
    except InputError:
        if options.report:
            with Journal(options.report, options.resume):
                pass
        raise


def _importing(progress: output.Progress) -> Callable[[Iterable[T], int], Iterator[T]]:
    """Show progress, and import the packages of the report while the workers are busy."""

    def steps(outcomes: Iterable[T], total: int) -> Iterator[T]:
        for outcome in progress(outcomes, total):
            yield outcome
            # A signal during an import could get lost. The report itself reports a missing package.
            with signals.block_signals(), suppress(ImportError):
                import mxeon.report.page as _  # noqa: F401

    return steps


def _label(outcome: Any) -> str:
    _, findings = outcome
    return ", ".join(f"{each.check}, {each.subject}, {each.host}" for each in findings.results[:1])
