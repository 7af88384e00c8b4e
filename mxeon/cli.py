# SPDX-License-Identifier: Apache-2.0
"""The command `mxeon`: arguments in, exit status out.

Modules are imported by the sub-command that needs them, so that `mxeon --help` answers at once.
"""

import argparse
import json
import os
import sys
import warnings
from collections import Counter
from pathlib import Path

import mxeon
from mxeon.permissions import LIMITS, Permissions
from mxeon.screening import one_line, printable

PASSED, FAILED, MISUSE, NOT_RUN = 0, 1, 2, 3
TARGETS = ("glsl", "essl", "vulkan", "wgsl", "msl", "slang", "osl", "mdl")
STATUS = "Exit status: 0 all passed, 1 a check failed, 2 misuse, 3 something did not run."


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message):
        self.exit(MISUSE, f"{self.prog}: {one_line(message)}\n")


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
    options = _parser().parse_args(arguments)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warn
            return options.run(options)
    except KeyboardInterrupt:
        return _fail(130, "interrupted")
    except BrokenPipeError:  # who read our output has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PASSED
    except OSError as error:
        return _fail(MISUSE, f"{error.filename or 'file'}: must be accessible; {error.strerror or error}")
    except (ValueError, ImportError) as error:
        return _fail(MISUSE, error)
    except RuntimeError as error:
        return _fail(NOT_RUN if type(error).__name__ == "NotRun" else FAILED, error)


def _fail(status, error):
    print(f"mxeon: {one_line(error)}", file=sys.stderr)
    return status


def _warn(message, *_, **__):
    print(f"mxeon: warning: {one_line(message)}", file=sys.stderr)


def _parser():
    parser = _Parser(prog="mxeon", description=mxeon.__doc__.splitlines()[0], epilog=STATUS)
    parser.add_argument("--version", action="version", version=f"mxeon {mxeon.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    check = _command(commands, "check", _check, "run the checks and compare pictures")
    check.add_argument("files", nargs="*", metavar="FILE", help="documents; none: the examples")
    check.add_argument("--host", action="append", help="gl (the default), webgl, vulkan, slang, cycles, cycles-native, testrender, msl, mdl, wgsl, or all; may be repeated")
    check.add_argument("--library", action="append", help="eonlib (the default), stock; may be repeated")
    check.add_argument("--report", metavar="DIR", help="write a page, JSON, JUnit and the pictures")
    check.add_argument("--resume", action="store_true", help="go on with the interrupted run in DIR")
    check.add_argument("--workers", type=int, default=os.cpu_count(), metavar="N", help="processes that share the work; 0 for none but this")
    check.add_argument("--materialx", nargs="+", metavar="VERSION", help="judge these versions of MaterialX, each in its own environment")
    check.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the work")
    check.add_argument("--limit", type=float, default=300.0, metavar="SECONDS", help="for one item of work")
    _permissions(check, runs=True)
    _json(check)

    generate = _command(commands, "generate", _generate, "write shader sources")
    generate.add_argument("files", nargs="+", metavar="FILE", help="MaterialX documents")
    generate.add_argument("--target", action="append", required=True, help=", ".join(TARGETS))
    generate.add_argument("--element", metavar="NAME", help="one renderable element; none: all")
    generate.add_argument("--profile", help="cycles: osl for Blender's Cycles")
    generate.add_argument("--outputPath", metavar="DIR", required=True, help="where to write")
    _library(generate)
    _permissions(generate)
    _json(generate)

    render = _command(commands, "render", _render, "make a picture of a material on a sphere")
    render.add_argument("file", metavar="FILE", help="a MaterialX document")
    render.add_argument("--host", default="gl", help="gl, cycles, reference")
    render.add_argument("--element", metavar="NAME", help="needed where there are several")
    render.add_argument("--output", metavar="OUT", required=True, help="linear .exr or sRGB .png")
    render.add_argument("--scene", default="side", help="front, side, back, furnace")
    render.add_argument("--environment", metavar="IMAGE", help="a latitude-longitude image instead")
    render.add_argument("--size", type=int, default=512, help="width and height in pixels")
    _library(render)
    _permissions(render, runs=True)

    library = _command(commands, "library", _show_library, "say where eonlib lies, for other hosts")
    library.add_argument("--folder", action="store_true", help="print the folder alone")
    library.add_argument("--verify", action="store_true", help="list what each target finds")

    invert = _command(commands, "invert", _invert, "find the color input for a colour to be seen")
    for channel in "RGB":
        invert.add_argument(channel, type=float, help="wanted, in [0, 1]")
    invert.add_argument("--roughness", type=float, required=True)
    invert.add_argument("--average", action="store_true", help="seen on average, not head-on")

    figures = _command(commands, "figures", _figures, "make the figures of the EON paper, checked")
    figures.add_argument("folder", metavar="DIR", help="where to write")

    report = _command(commands, "report", None, "make and compare reports of runs")
    actions = report.add_subparsers(required=True, metavar="ACTION")
    make = _command(actions, "make", _report_make, "make the report of a run, finished or not")
    make.add_argument("report", metavar="DIR", help="the folder of the run")
    _json(make)

    diff = _command(actions, "diff", _report_diff, "tell what is not the same in two reports")
    diff.add_argument("before", metavar="A", help="folder of a report, or its results.json")
    diff.add_argument("after", metavar="B")
    _json(diff)

    kit = _command(commands, "kit", None, "judge a renderer by the pictures it makes")
    actions = kit.add_subparsers(required=True, metavar="ACTION")
    export = _command(actions, "export", _kit_export, "write scenes, materials and a page")
    export.add_argument("folder", metavar="DIR")
    export.add_argument("--size", type=int, default=128, help="width and height in pixels")
    judge = _command(actions, "check", _kit_check, "judge the pictures in DIR/renders")
    judge.add_argument("folder", metavar="DIR")
    judge.add_argument("--renderer", default="renderer", metavar="NAME", help="who made them")
    judge.add_argument("--report", metavar="DIR", help="write a page, JSON, JUnit and the pictures")
    _json(judge)
    return parser


def _command(commands, name, run, summary):
    command = commands.add_parser(name, help=summary, description=summary, epilog=STATUS)
    command.set_defaults(run=run)
    return command


def _library(command):
    command.add_argument("--library", default="eonlib", help="eonlib (the default) or stock")


def _permissions(command, runs=False):
    """Options for what documents may do; code can only be forbidden where it would run."""
    group = command.add_argument_group("documents from strangers")
    group.add_argument("--allowOutside", action="store_true", help="let documents name files outside their folders and the libraries")
    if runs:
        group.add_argument("--allowCode", action="store_true", help="run the shader code that documents bring along")
    for name, meaning in LIMITS.items():
        limit = getattr(Permissions, name)
        group.add_argument(f"--max{name.capitalize()}", type=int, default=limit, metavar="N", help=f"{meaning}; {limit}")


def _permitted(options):
    """What documents may do, as the options say."""
    limits = {name: getattr(options, f"max{name.capitalize()}") for name in LIMITS}
    return Permissions(options.allowOutside, getattr(options, "allowCode", True), **limits)


def _json(command):
    command.add_argument("--json", action="store_true", help="print JSON for machines")


def _check(options):
    from mxeon.conformance import JUDGED, check

    if options.resume and not options.report:
        raise ValueError("--resume needs --report DIR, the folder of the run to go on with; got none")
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
        permissions=_permitted(options),
        progress=_progress("mxeon check"),
    )
    return _judged(run, options)


def _check_versions(options):
    from tempfile import TemporaryDirectory

    from mxeon import versions

    arguments = [*options.files, "--workers", str(options.workers), "--limit", str(options.limit)]
    for word in ("host", "library"):
        arguments += [each for name in getattr(options, word) or () for each in (f"--{word}", name)]
    arguments += ["--scheduler", options.scheduler] if options.scheduler else []
    flags = ("resume", "allowOutside", "allowCode")
    arguments += [f"--{flag}" for flag in flags if getattr(options, flag)]
    limits = [f"max{name.capitalize()}" for name in LIMITS]
    arguments += [f"--{name}={getattr(options, name)}" for name in limits]
    with TemporaryDirectory(prefix="mxeon-versions-") as temporary:
        run = versions.check(options.materialx, arguments, options.report or temporary)
        return _judged(run, options)


def _report_make(options):
    from mxeon.conformance import read_run

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
    summary = summarize(run.results, run.missing)
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
    for (place, reason), count in _not_run(run.results).items():
        print(f"not run: {place}, {count} checks: {reason}")
    for result in run.results:
        if result.verdict != "failed":
            continue
        figure = "" if result.figure is None else f" {result.figure:.3g} > {result.tolerance:.3g}"
        print(f"failed: {result.host}, {result.check}, {result.subject}:{figure} {result.diagnosis}")
    for note in run.notes:
        print(f"note: {note}")
    print(summary.sentence)
    if page:
        print(f"report: {page}")


def _not_run(results):
    """How many checks each reason kept from running at each place."""
    from mxeon.verdict import place

    return Counter(
        (place(result), result.reason)
        for result in results
        if result.verdict == "not run"
    )


def _generate(options):
    from mxeon.writing import write_text

    written, errors = [], []
    for file in map(Path, options.files):
        for target in options.target:
            try:
                texts = _sources(file, target, options)
            except ValueError as error:
                errors.append(str(error))
                continue
            if taken := texts.keys() & set(written):
                errors.append(f"{file}: must not overwrite {min(taken)} of this run; rename it")
                continue
            for path, text in texts.items():
                write_text(path, text)
            written += texts
    print(json.dumps({"files": written, "errors": errors}) if options.json else "\n".join(written))
    for error in errors:
        _fail(MISUSE, error)
    return MISUSE if errors else PASSED


def _sources(file, target, options):
    """Texts of a document's shaders, by the path that each is written to."""
    from mxeon.generation import generate

    known = {"library": options.library, "profile": options.profile}
    known["permissions"] = _permitted(options)
    return {
        str(Path(options.outputPath) / _file_name(file.stem, shader, stage)): text
        for shader in generate(file, target, options.element, **known)
        for stage, text in shader.stages.items()
    }


def _file_name(stem, shader, stage):
    """As generateshader calls them, with the document in front: its elements may share names."""
    ending = {"pixel": ".frag", "vertex": ".vert"}[stage] if len(shader.stages) > 1 else ""
    plain = " ".join(printable(stem).split())
    return f"{plain}.{shader.name}.{shader.target}{ending}"


def _render(options):
    from dataclasses import replace

    from mxeon import scene as scenes
    from mxeon.generation import generate
    from mxeon.hosts import open_host
    from mxeon.pictures import write_picture

    scene = scenes.scene(options.scene)
    if options.environment:
        scene = scenes.Scene("environment", environment=Path(options.environment))
    host = open_host(options.host)
    found = generate(
        options.file,
        host.target,
        options.element,
        library=options.library,
        profile=host.profile,
        lights=True,
        permissions=_permitted(options),
    )
    if len(found) > 1:
        known = ", ".join(shader.element for shader in found)
        raise ValueError(f"--element must name one of {known}; got none")
    image = host.picture(found[0], replace(scene, size=options.size))
    identity = host.identity()
    write_picture(
        options.output,
        image,
        {
            "version": mxeon.__version__,
            "host": f"{identity.name} {identity.version}",
            "device": identity.device,
            "library": options.library,
            "document": options.file,
            "element": found[0].element,
            "scene": scene.name,
        },
    )
    host.close()
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
        print(f'C++                         loadLibraries({{"{folder}", "libraries"}}, path, document)')
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
