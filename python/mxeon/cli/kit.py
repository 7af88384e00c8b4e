# SPDX-License-Identifier: Apache-2.0
"""`mxeon kit`: test a renderer by its images of the conformance kit."""

import argparse

from mxeon.cli import arguments
from mxeon.cli.output import Progress, warn
from mxeon.cli.verdict import show_run
from mxeon.errors import PASSED, PackageError
from mxeon.shaders.nodes import OREN_NAYAR


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its actions."""
    # Add the command.
    summary = "test a renderer by its images of the conformance kit"
    actions = commands.add_parser("kit", help=summary, description=summary)
    actions = actions.add_subparsers(required=True, metavar="ACTION")
    # Add the action that writes the kit.
    summary = "write scenes, materials and a page of instructions"
    export = arguments.add_command(actions, "export", summary, run_export)
    export.add_argument("folder", metavar="DIR", help="where to write")
    export.add_argument(
        "--size", type=int, default=128, help="width and height in pixels, 64 to 2048; %(default)s"
    )
    export.add_argument(
        "--node",
        default=OREN_NAYAR,
        metavar="NAME",
        help="BSDF node of the materials, with color and roughness; %(default)s",
    )
    arguments.add_definitions(export)
    arguments.add_library(export)
    arguments.add_materialx(export)
    # Add the action that judges pictures.
    check = arguments.add_command(actions, "check", "check the images in DIR/renders", run_check)
    check.add_argument("folder", metavar="DIR", help="the folder of the kit")
    check.add_argument(
        "--renderer",
        default="renderer",
        metavar="NAME",
        help="name of the renderer, for the report",
    )
    check.add_argument(
        "--claims",
        default="",
        metavar="MODEL",
        help="eon, qon, fon or lambert: the renderer has this model alone, and no switch between EON and QON",
    )
    arguments.add_report(check)
    arguments.add_full(check)
    arguments.add_json(check)


def run_export(options: argparse.Namespace) -> int:
    """Write the kit and print the path of its page; say now what `kit check` will lack."""
    from mxeon.kit.export import export_kit, kit_node
    from mxeon.kit.noise import student_quantile

    node = kit_node(options.node, arguments.definitions(options), options.library)
    print(export_kit(options.folder, options.size, node))
    try:
        student_quantile()
    except PackageError as error:
        warn(error)
    return PASSED


def run_check(options: argparse.Namespace) -> int:
    """Check images of the kit; return the exit status."""
    from mxeon.kit.check import check_kit

    progress = Progress("mxeon kit check", lambda question: str(question.title))
    result = check_kit(options.folder, options.renderer, progress, options.claims)
    return show_run(result, options)
