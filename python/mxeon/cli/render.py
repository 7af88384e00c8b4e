# SPDX-License-Identifier: Apache-2.0
"""`mxeon render`: draw a material on a sphere."""

import argparse
import os
from functools import partial

from mxeon.cli import arguments
from mxeon.cli.batch import picture, run_batch
from mxeon.cli.output import warn
from mxeon.errors import PASSED, InputError
from mxeon.hosts import HOSTS
from mxeon.shaders.scene import Paths


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its options."""
    # Name the hosts that make pictures.
    rows = (row.name for row in HOSTS if row.scenes and row.name != "gl")
    hosts = ", ".join((*rows, "reference"))
    command = arguments.add_command(
        commands, "render", "draw a material on a sphere or a shader ball", run
    )
    # Choose the material, the light and the size.
    command.add_argument("file", metavar="FILE", help="a MaterialX document")
    command.add_argument("--host", default="gl", metavar="NAME", help=f"gl (the default), {hosts}")
    command.add_argument("--element", metavar="NAME", help="needed where there are several")
    command.add_argument("--output", metavar="OUT", required=True, help="linear .exr or sRGB .png")
    command.add_argument(
        "--scene", metavar="NAME", help="its light: front, side (the default), back, furnace"
    )
    command.add_argument(
        "--environment",
        metavar="IMAGE",
        help="light it with a latitude-longitude image, alone unless --scene is given",
    )
    command.add_argument(
        "--shape",
        default="sphere",
        metavar="NAME",
        help="sphere (the default), or ball: a shader ball",
    )
    command.add_argument(
        "--size", type=int, default=512, help="width and height in pixels; %(default)s"
    )
    command.add_argument(
        "--samples", type=int, metavar="N", help="paths of a pixel, on a host that traces paths"
    )
    command.add_argument(
        "--bounces", type=int, metavar="N", help="times that such a path may be scattered"
    )
    # Choose the library and the limits.
    arguments.add_library(command)
    arguments.add_materialx(command)
    arguments.add_workers(command)
    arguments.add_policy(command, runs_code=True)


def run(options: argparse.Namespace) -> int:
    """Write a picture and print its path; return the exit status."""
    from mxeon.io.images import write_picture

    arguments.assert_other(options.output, [options.file, options.environment])
    if not os.path.isdir(folder := os.path.dirname(os.path.abspath(options.output))):
        rule = "output must lie in a folder that exists"
        raise InputError(f"{rule}; got {options.output}: make {folder} first")
    # Draw the picture in a worker process.
    names = ("host", "scene", "environment", "size", "shape", "element", "library")
    known = {name: getattr(options, name) for name in names}
    paths = Paths(options.samples, options.bounces)
    work = partial(picture, policy=arguments.policy(options), paths=paths, **known)
    [result] = run_batch(work, [options.file], options.workers, options.timeout)
    # Report what happened there.
    for warning in result.warnings:
        warn(warning)
    if result.error:
        raise result.error
    # Write the picture, and say where it is.
    write_picture(options.output, *result.value)
    print(options.output)
    return PASSED
