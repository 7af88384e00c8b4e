# SPDX-License-Identifier: Apache-2.0
"""`mxeon kit`: test a renderer by the images that it renders of the conformance kit's scenes."""

import argparse
from contextlib import nullcontext

from mxeon.cli import arguments
from mxeon.cli.output import Progress, show, warn
from mxeon.errors import PASSED, PackageError
from mxeon.shaders.nodes import OREN_NAYAR


def add_parser(commands: arguments.Commands) -> None:
    examples = (
        "kit export kit  # then render its scenes to kit/renders",
        "kit check kit --renderer MyRenderer --report out",
        "kit check kit --claims qon  # for a renderer that claims only QON",
    )
    summary = "find out which rough-diffuse model a renderer uses, from its images"
    group = arguments.add_command(commands, "kit", summary, None, *examples)
    actions = group.add_subparsers(required=True, title="commands", metavar="ACTION")
    summary = "write scenes, materials and instructions"
    export = arguments.add_command(actions, "export", summary, run_export, examples[0])
    export.add_argument("folder", metavar="DIR", help="folder to write to")
    export.add_argument(
        "--size",
        type=int,
        default=128,
        metavar="N",
        help="width and height in pixels, 64 to 2048 (default: %(default)s)",
    )
    export.add_argument(
        "--node",
        default=OREN_NAYAR,
        metavar="NAME",
        help="BSDF node of the materials, with inputs color and roughness (default: %(default)s)",
    )
    arguments.add_shared(export, "--definitions", "--library", "--materialx")
    summary = "check the images in DIR/renders"
    check = arguments.add_command(actions, "check", summary, run_check, *examples[1:])
    check.add_argument("folder", metavar="DIR", help="the folder of the kit")
    check.add_argument(
        "--renderer", default="renderer", metavar="NAME", help="name of the renderer in the report"
    )
    check.add_argument(
        "--claims",
        default="",
        metavar="MODEL",
        help="the one model that the renderer claims: eon, qon, fon or lambert (default: EON and QON, "
        "chosen by energy_compensation)",
    )
    arguments.add_shared(check, "--report", "--full", "--json")


def run_export(options: argparse.Namespace) -> int:
    """Write the kit and print the path of its page; warn if `kit check` lacks a package."""
    from mxeon.kit.export import export_kit, kit_node
    from mxeon.kit.noise import student_quantile

    node = kit_node(options.node, arguments.definitions(options), options.library)
    show(export_kit(options.folder, options.size, node))
    try:
        student_quantile()
    except PackageError as error:
        warn(error)
    return PASSED


def run_check(options: argparse.Namespace) -> int:
    from mxeon.cli.answer import show_run
    from mxeon.conformance.results import REPORT
    from mxeon.conformance.run.journal import Journal
    from mxeon.io.files import check_output
    from mxeon.kit.check import check_kit, kit_files

    progress = Progress("mxeon kit check", lambda question: str(question.title))
    if options.report:
        check_output(options.report, kit_files(options.folder), replaced=REPORT, apart=True)
    with Journal(options.report) if options.report else nullcontext():
        result = check_kit(options.folder, options.renderer, progress, options.claims)
    return show_run(result, options)
