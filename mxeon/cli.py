# SPDX-License-Identifier: Apache-2.0
"""The command `mxeon`: arguments in, exit status out.

Modules are imported by the sub-command that needs them, so that `mxeon --help` answers at once.
"""

import json
import os
import sys
import warnings
from collections import Counter
from functools import partial
from pathlib import Path

import mxeon
from mxeon.arguments import MISUSE, parser, permitted
from mxeon.permissions import LIMITS
from mxeon.screening import one_line, printable

PASSED, FAILED, NOT_RUN = 0, 1, 3  # and MISUSE


def main(arguments=None):
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str or None
        Without the program's name; None for those of the process.

    Returns
    -------
    int
        0 all passed, 1 a check failed, 2 misuse, 3 something did not run.
    """
    _open_streams()
    try:
        options = parser().parse_args(arguments)
        with warnings.catch_warnings():
            warnings.showwarning = _warn
            return COMMANDS[options.command](options)
    except KeyboardInterrupt:
        return _fail(130, "interrupted")
    except BrokenPipeError:  # who read our output has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141  # as of a program that SIGPIPE ended
    except (ValueError, ImportError, OSError, RuntimeError) as error:
        return _failed(error)


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
        what = f"{error.filename or 'file'}: must be accessible; {error.strerror or error}"
        return _fail(MISUSE, what)
    if isinstance(error, (ValueError, ImportError)):
        return _fail(MISUSE, error)
    wrong = type(error).__name__ in ("ShaderError", "LibraryError")
    return _fail(FAILED if wrong else NOT_RUN, error)


def _fail(status, error):
    print(f"mxeon: {one_line(error)}", file=sys.stderr)
    return status


def _warn(message, *_, **__):
    print(f"mxeon: warning: {one_line(message)}", file=sys.stderr)


def _check(options):
    from mxeon.conformance import JUDGED, check

    if options.resume and not options.report:
        raise ValueError(
            "--resume needs --report DIR, the folder of the run to go on with; got none"
        )
    if options.materialx:
        return _check_versions(options)
    hosts = options.host or ("gl",)
    run = check(
        options.files,
        JUDGED if "all" in hosts else hosts,
        options.library or ("eonlib",),
        workers=options.workers,
        limit=options.limit,
        folder=options.report,
        resume=options.resume,
        scheduler=options.scheduler,
        permissions=permitted(options),
        progress=_progress("mxeon check"),
    )
    return _judged(run, options)


def _check_versions(options):
    from tempfile import TemporaryDirectory

    from mxeon import versions

    arguments = ["--workers", str(options.workers), "--limit", str(options.limit)]
    for word in ("host", "library"):
        arguments += [each for name in getattr(options, word) or () for each in (f"--{word}", name)]
    arguments += ["--scheduler", options.scheduler] if options.scheduler else []
    arguments += [f"--path={folder}" for folder in options.path]
    flags = ("resume", "allowOutside", "allowCode")
    arguments += [f"--{flag}" for flag in flags if getattr(options, flag)]
    limits = [f"max{name.capitalize()}" for name in LIMITS]
    arguments += [f"--{name}={getattr(options, name)}" for name in limits]
    arguments += ["--", *options.files]
    with TemporaryDirectory(prefix="mxeon-versions-") as temporary:
        run = versions.check(options.materialx, arguments, options.report or temporary)
        return _judged(run, options)


def _report_make(options):
    from mxeon.versions import read_run

    return _judged(read_run(options.report), options)


def _report_diff(options):
    from mxeon.comparison import WORSE, compare, read_results

    changes = compare(read_results(options.before), read_results(options.after))
    if options.json:
        print(json.dumps([vars(change) for change in changes], indent=1))
    else:
        print("\n".join(map(str, changes)) or "no difference")
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
    from mxeon.verdict import summarize

    page = report.write(run, options.report) if options.report else None
    summary = summarize(run.results, run.missing, run.errors)
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
    from mxeon.verdict import explained, place

    for (where, reason), count in _not_run(run.results).items():
        print(one_line(f"not run: {where}, {count} checks: {reason}"))
    for result in run.results:
        if result.verdict != "failed":
            continue
        where = f"{place(result)}, {result.check}, {result.subject}"
        print(one_line(f"failed: {where}: {explained(result)}"))
    for note in run.notes:
        print(printable(" ".join(f"note: {note}".split())))
    print(summary.sentence)
    if page:
        print(f"report: {page}")


def _not_run(results):
    """How many checks each reason kept from running at each place."""
    from mxeon.verdict import place

    return Counter(
        (place(result), result.reason) for result in results if result.verdict == "not run"
    )


def _generate(options):
    from mxeon.making import Source, texts
    from mxeon.writing import write_text

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
    from mxeon.making import make

    work = partial(work, permissions=permitted(options), **known)
    for found in make(work, documents, options.workers, options.limit):
        for warning in found.warnings:
            _warn(warning)
        yield found


def _render(options):
    from mxeon.making import picture
    from mxeon.pictures import write_picture

    names = ("host", "scene", "environment", "size", "element", "library")
    known = {name: getattr(options, name) for name in names}
    [found] = _make(picture, [options.file], options, **known)
    if found.error:
        raise found.error
    write_picture(options.output, *found.value)
    return PASSED


def _show_library(options):
    from mxeon.library import (
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
    from mxeon.inversion import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal

    invert = eon_rho_from_albedo_avg if options.average else eon_rho_from_albedo_normal
    found = invert([options.R, options.G, options.B], options.roughness)
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
