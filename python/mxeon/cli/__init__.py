# SPDX-License-Identifier: Apache-2.0
"""The command `mxeon`: arguments in, exit status out.

Modules are imported by the sub-command that needs them, so that `mxeon --help` answers at once.
"""

import json
import os
import sys
import traceback
import warnings
from collections import Counter
from functools import partial
from pathlib import Path

from mxeon.cli.arguments import parser, permitted
from mxeon.errors import (
    FAILED,
    MISUSE,
    NOT_RUN,
    PASSED,
    InputError,
    MxeonError,
    one_line,
    printable,
)
from mxeon.jobs.signals import Ended, raised


def main(arguments=None):
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str or None
        Without the program's name; None for those of the process.

    Returns
    -------
    int
        0 all passed, 1 a check failed, 2 misuse, 3 something did not run; above 128, the number
        of the signal that ended it and 128.
    """
    _open_streams()
    try:
        with raised():
            return _flushed(_run(sys.argv[1:] if arguments is None else arguments))
    except Ended as ended:
        return _fail(ended.status, ended)


def _run(arguments):
    """The exit status of the command with these arguments; says why, if it cannot be 0."""
    try:
        _check_encoding(arguments)
        options = parser().parse_args(arguments)
        with warnings.catch_warnings():
            warnings.showwarning = _warn
            return COMMANDS[options.command](options)
    except SystemExit as ended:  # of the parser, which has printed why
        return ended.code
    except BrokenPipeError:  # who read our output has had enough
        _discard(sys.stdout)
        return 141  # as of a program that SIGPIPE ended
    except (MxeonError, OSError) as error:
        return _failed(error)
    except MemoryError:
        return _fail(NOT_RUN, "memory must suffice for the work; there is no more")
    except Exception:  # a bug of ours
        traceback.print_exc()
        return NOT_RUN


def _flushed(status):
    """The exit status once all is printed that was to be."""
    try:
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        _discard(sys.stdout)
        error.filename = "standard output"
        status = 141 if isinstance(error, BrokenPipeError) else status or _failed(error)
    try:
        if sys.stderr:
            sys.stderr.flush()
    except OSError:
        _discard(sys.stderr)
    return status


def _check_encoding(arguments):
    """Raise ValueError unless all arguments are text: other file names reach no library in C++."""
    for argument in arguments:
        try:
            argument.encode()
        except UnicodeEncodeError:
            raise InputError(f"arguments must be UTF-8, file names too; got {argument!r}") from None


def _open_streams():
    """Give this process the streams that its own were not started with: workers print to them."""
    for stream in range(3):
        try:
            os.fstat(stream)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)


def _failed(error):
    """The exit status that an error means, whose line is printed."""
    if isinstance(error, OSError):
        reason = error.strerror or str(error) or type(error).__name__
        return _fail(MISUSE, f"{error.filename or 'file'}: must be accessible; {reason}")
    return _fail(getattr(error, "status", MISUSE), error)


def _fail(status, error):
    _say(one_line(error) or type(error).__name__)
    return status


def _warn(message, *_, **__):
    _say(f"warning: {one_line(message)}")


def _say(line):
    """Print a line on standard error, unless that takes none."""
    try:
        print(f"mxeon: {line}", file=sys.stderr, flush=True)
    except OSError:
        _discard(sys.stderr)


def _discard(stream):
    """Let a stream that failed end at nothing, else it fails again when Python ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _check(options):
    from mxeon.conformance.run import check
    from mxeon.shaders.hosts import host_names

    if options.resume and not options.report:
        raise InputError(
            "--resume needs --report DIR, the folder of the run to go on with; got none"
        )
    hosts = options.host or ("gl",)
    run = check(
        options.files,
        host_names() if "all" in hosts else hosts,
        options.library or ("eonlib",),
        workers=options.workers,
        limit=options.limit,
        folder=options.report,
        resume=options.resume,
        scheduler=options.scheduler,
        wait=options.waitForWorkers,
        policy=permitted(options),
        progress=_progress("mxeon check"),
    )
    return _judged(run, options)


def _report_make(options):
    from mxeon.conformance.run import read_run

    return _judged(read_run(options.report), options)


def _report_diff(options):
    from mxeon.report.diff import WORSE, compare, read_results

    changes = compare(read_results(options.before), read_results(options.after))
    if options.json:
        print(json.dumps([vars(change) for change in changes], indent=1))
    else:
        print("\n".join(map(one_line, changes)) or "no difference")
    return FAILED if any(change.kind == WORSE for change in changes) else PASSED


def _kit_export(options):
    from mxeon.kit.export import export_kit

    print(export_kit(options.folder, options.size))
    return PASSED


def _kit_check(options):
    from mxeon.kit.check import check_kit

    progress = _progress("mxeon kit check")
    return _judged(check_kit(options.folder, options.renderer, progress), options)


def _progress(words):
    from tqdm import tqdm

    return lambda steps, total=None: tqdm(
        steps, desc=words, total=total, unit="step", disable=None, leave=False
    )


def _judged(run, options):
    """A run shown as the options ask for it, and the exit status that it means."""
    from mxeon import report

    page = report.write(run, options.report) if options.report else None
    summary = run.summary
    if options.json:
        print(report.to_json(run))
    else:
        _print_run(run, summary, page)
    for error in run.errors:
        _fail(MISUSE, error)
    if run.errors:
        return MISUSE
    return {"passed": PASSED, "failed": FAILED, "not run": NOT_RUN}[summary.verdict]


def _print_run(run, summary, page):
    for (where, reason), count in _not_run(run.results).items():
        print(one_line(f"not run: {where}, {count} checks: {reason}"))
    for result in run.results:
        if result.verdict != "failed":
            continue
        where = f"{result.location}, {result.check}, {result.subject}"
        print(one_line(f"failed: {where}: {result.explanation}"))
    for note in run.notes:
        print(printable(" ".join(f"note: {note}".split())))
    print(printable(summary.sentence))
    if page:
        print(f"report: {page}")


def _not_run(results):
    """How many checks each reason kept from running at each place."""
    return Counter(
        (result.location, result.reason) for result in results if result.verdict == "not run"
    )


def _generate(options):
    from mxeon.cli.batch import Source, texts
    from mxeon.io.files import write_text

    sources = [Source(file, target) for file in options.files for target in options.target]
    known = {name: getattr(options, name) for name in ("element", "library", "profile")}
    written, failed = [], []
    for source, found in zip(sources, _make(texts, sources, options, **known), strict=True):
        if found.error:
            failed.append(found.error)
            continue
        named = {str(Path(options.outputPath) / name): found.value[name] for name in found.value}
        if taken := named.keys() & set(written):
            rule = f"must not overwrite {min(taken)} of this run; rename it"
            failed.append(ValueError(f"{source.file}: {rule}"))
            continue
        for path, text in named.items():
            write_text(path, text)
        written += named
    shown = {"files": written, "errors": list(map(str, failed))}
    print(json.dumps(shown) if options.json else "\n".join(written))
    return min(map(_failed, failed), default=PASSED)


def _make(work, documents, options, **known):
    """What `work` makes of documents as the options say; its warnings are printed."""
    from mxeon.cli.batch import make

    work = partial(work, policy=permitted(options), **known)
    for found in make(work, documents, options.workers, options.limit):
        for warning in found.warnings:
            _warn(warning)
        yield found


def _render(options):
    from mxeon.cli.batch import picture
    from mxeon.io.images import write_picture

    names = ("host", "scene", "environment", "size", "element", "library")
    known = {name: getattr(options, name) for name in names}
    [found] = _make(picture, [options.file], options, **known)
    if found.error:
        raise found.error
    write_picture(options.output, *found.value)
    return PASSED


def _show_library(options):
    from mxeon.shaders.library import (
        assert_ours,
        eonlib_folder,
        implementations,
        load_library,
        profile_folder,
    )

    folder, cycles = eonlib_folder(), profile_folder("cycles")
    if options.folder:
        print(folder)
    elif options.verify:
        document = load_library()
        for found in implementations(document):
            print(f"{found.node:30} {found.target:10} {found.name:40} {found.document}")
        assert_ours(document)
    else:
        print(f"folder                      {folder}")
        print(f"generateshader              --library {folder}")
        print(f"generateshader, for Cycles  --library {cycles} {folder}")
        print(f"USD                         PXR_MTLX_PLUGIN_SEARCH_PATHS={folder}")
        print(
            f'C++                         loadLibraries({{"{folder}", "libraries"}}, path, document)'
        )
    return PASSED


def _invert(options):
    from mxeon.models.inversion import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal

    invert = eon_rho_from_albedo_avg if options.average else eon_rho_from_albedo_normal
    try:
        found = invert([options.R, options.G, options.B], options.roughness)
    except ValueError as error:  # the models know no errors of mxeon's
        raise InputError(str(error)) from None
    print(*(f"{float(rho):.9g}" for rho in found))
    return PASSED


def _figures(options):
    from tqdm import tqdm

    from mxeon.figures import figures

    def progress(steps):
        return tqdm(steps, desc="mxeon figures", unit="figure", disable=None, leave=False)

    print(figures(options.folder, progress))
    return PASSED


COMMANDS = {
    "check": _check,
    "generate": _generate,
    "render": _render,
    "library": _show_library,
    "invert": _invert,
    "figures": _figures,
    "report make": _report_make,
    "report diff": _report_diff,
    "kit export": _kit_export,
    "kit check": _kit_check,
}
