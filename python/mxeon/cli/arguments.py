# SPDX-License-Identifier: Apache-2.0
"""What can be asked of the command `mxeon`, and how."""

import argparse
import os

import mxeon
from mxeon.errors import MISUSE, one_line
from mxeon.shaders.document.policy import LIMITS, SEARCH_PATH, Policy, environment_path
from mxeon.shaders.hosts import HOSTS, host_names

TARGETS = ("glsl", "essl", "vulkan", "wgsl", "msl", "slang", "osl", "mdl")
DESCRIPTION = (
    "Rough diffuse reflection made right in every MaterialX target, and proved by running it."
)
STATUS = "Exit status: 0 all passed, 1 a check failed, 2 misuse, 3 something did not run."


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message):
        self.exit(MISUSE, f"{self.prog}: {one_line(message)}\n")


def parser():
    """The parser of the command `mxeon`; its result has the name of what to do in `command`."""
    root = _Parser(prog="mxeon", description=DESCRIPTION, epilog=STATUS)
    root.add_argument("--version", action="version", version=f"mxeon {mxeon.__version__}")
    commands = root.add_subparsers(required=True, metavar="COMMAND")

    check = _command(commands, "check", "run the checks and compare pictures")
    check.add_argument("files", nargs="*", metavar="FILE", help="documents; none: the examples")
    check.add_argument("--host", action="append", help=f"{_hosts()}; may be repeated")
    check.add_argument(
        "--library", action="append", help="eonlib (the default), stock; may be repeated"
    )
    check.add_argument("--report", metavar="DIR", help="write a page, JSON, JUnit and the pictures")
    check.add_argument(
        "--resume", action="store_true", help="go on with the interrupted run in DIR"
    )
    check.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the work"
    )
    check.add_argument(
        "--waitForWorkers",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="how long the cluster may be without a worker that fits; 60",
    )
    _processes(check)
    _permissions(check, runs=True)
    _json(check)

    generate = _command(commands, "generate", "write shader sources")
    generate.add_argument("files", nargs="+", metavar="FILE", help="MaterialX documents")
    generate.add_argument("--target", action="append", required=True, help=", ".join(TARGETS))
    generate.add_argument("--element", metavar="NAME", help="one renderable element; none: all")
    generate.add_argument("--profile", help="cycles: osl for Blender's Cycles")
    generate.add_argument("--outputPath", metavar="DIR", required=True, help="where to write")
    _library(generate)
    _processes(generate)
    _permissions(generate)
    _json(generate)

    render = _command(commands, "render", "make a picture of a material on a sphere")
    render.add_argument("file", metavar="FILE", help="a MaterialX document")
    render.add_argument("--host", default="gl", help=_picture_hosts())
    render.add_argument("--element", metavar="NAME", help="needed where there are several")
    render.add_argument("--output", metavar="OUT", required=True, help="linear .exr or sRGB .png")
    render.add_argument("--scene", default="side", help="front, side, back, furnace")
    render.add_argument("--environment", metavar="IMAGE", help="a latitude-longitude image instead")
    render.add_argument("--size", type=int, default=512, help="width and height in pixels")
    _library(render)
    _processes(render)
    _permissions(render, runs=True)

    library = _command(commands, "library", "say where eonlib lies, for other hosts")
    library.add_argument("--folder", action="store_true", help="print the folder alone")
    library.add_argument("--verify", action="store_true", help="list what each target finds")

    invert = _command(commands, "invert", "find the color input for a colour to be seen")
    for channel in "RGB":
        invert.add_argument(channel, type=float, help="wanted, in [0, 1]")
    invert.add_argument("--roughness", type=float, required=True)
    invert.add_argument("--average", action="store_true", help="seen on average, not head-on")

    figures = _command(commands, "figures", "make the figures of the EON paper, checked")
    figures.add_argument("folder", metavar="DIR", help="where to write")

    report = _command(commands, "report", "make and compare reports of runs")
    actions = report.add_subparsers(required=True, metavar="ACTION")
    make = _command(actions, "report make", "make the report of a run, finished or not")
    make.add_argument("report", metavar="DIR", help="the folder of the run")
    _json(make)

    diff = _command(actions, "report diff", "tell what is not the same in two reports")
    diff.add_argument("before", metavar="A", help="folder of a report, or its results.json")
    diff.add_argument("after", metavar="B")
    _json(diff)

    kit = _command(commands, "kit", "judge a renderer by the pictures it makes")
    actions = kit.add_subparsers(required=True, metavar="ACTION")
    export = _command(actions, "kit export", "write scenes, materials and a page")
    export.add_argument("folder", metavar="DIR")
    export.add_argument("--size", type=int, default=128, help="width and height in pixels")
    judge = _command(actions, "kit check", "judge the pictures in DIR/renders")
    judge.add_argument("folder", metavar="DIR")
    judge.add_argument("--renderer", default="renderer", metavar="NAME", help="who made them")
    judge.add_argument("--report", metavar="DIR", help="write a page, JSON, JUnit and the pictures")
    _json(judge)
    return root


def _command(commands, name, summary):
    """A command, or an action of one, which `options.command` is called after."""
    command = commands.add_parser(
        name.split()[-1], help=summary, description=summary, epilog=STATUS
    )
    command.set_defaults(command=name)
    return command


def _hosts():
    """Hosts that check takes, the default one first."""
    default, *others = host_names()
    return ", ".join((f"{default} (the default)", *others, "all"))


def _picture_hosts():
    """Hosts that show a document."""
    return ", ".join((*(row.name for row in HOSTS if row.scenes), "reference"))


def _library(command):
    command.add_argument("--library", default="eonlib", help="eonlib (the default) or stock")


def _processes(command):
    command.add_argument(
        "--workers",
        type=int,
        default=os.cpu_count(),
        metavar="N",
        help="processes that share the work; 0 for none but this",
    )
    command.add_argument(
        "--limit", type=float, default=300.0, metavar="SECONDS", help="for one item of work"
    )


def _permissions(command, runs=False):
    """Options for what documents may do; code can only be forbidden where it would run."""
    command.add_argument(
        "--path",
        action="append",
        type=_folder,
        default=[],
        metavar="FOLDER",
        help="search it for the files that documents name, after their own folders and before "
        f"those of {SEARCH_PATH}; may be repeated",
    )
    group = command.add_argument_group("documents from strangers")
    group.add_argument(
        "--allowOutside",
        action="store_true",
        help="let documents name files outside their folders and the libraries",
    )
    if runs:
        group.add_argument(
            "--allowCode",
            action="store_true",
            help="run the shader code that documents bring along",
        )
    for name, meaning in LIMITS.items():
        limit = getattr(Policy, name)
        group.add_argument(
            f"--max{name.capitalize()}",
            type=int,
            default=limit,
            metavar="N",
            help=f"{meaning}; {limit}",
        )


def _folder(name):
    """The name of a folder."""
    if not os.path.isdir(name):
        raise argparse.ArgumentTypeError(f"must name a folder that exists; got {name!r}")
    return name


def permitted(options):
    """What documents may do, as the options say."""
    limits = {name: getattr(options, f"max{name.capitalize()}") for name in LIMITS}
    path = (*map(os.path.abspath, options.path), *environment_path())
    return Policy(options.allowOutside, getattr(options, "allowCode", True), path, **limits)


def _json(command):
    command.add_argument("--json", action="store_true", help="print JSON for machines")
