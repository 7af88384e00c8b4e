# SPDX-License-Identifier: Apache-2.0
"""`mxeon render`: render a material to an image."""

import argparse
import os
from functools import partial

from mxeon.cli import arguments, batch, output
from mxeon.errors import PASSED, InputError
from mxeon.hosts import HOSTS
from mxeon.shaders.scene import Paths

TONED = "studio", "environment"  # scenes whose PNG uses a tone curve for highlights


def add_parser(commands: arguments.Commands) -> None:
    rows = (row.name for row in HOSTS if row.scenes and row.name != "gl")
    hosts = ", ".join((*rows, "reference"))
    command = arguments.add_command(
        commands,
        "render",
        "render a material to an image, on a shader ball in a studio",
        run,
        "render my.mtlx --output my.png",
        "render my.mtlx --output my.exr --scene back --shape sphere --library stock",
        "render my.mtlx --output my.png --environment sky.exr --element gold",
        "render my.mtlx --output my.png --geometry teapot.obj",
        "render my.mtlx --output my.png --integrator path --samples 256",
    )
    command.add_argument("file", metavar="FILE", help="a MaterialX document")
    command.add_argument(
        "--output", metavar="OUT", required=True, help="the image: .png (sRGB) or .exr (linear)"
    )
    command.add_argument(
        "--element", metavar="NAME", help="the material, if the document has several"
    )
    command.add_argument(
        "--host", default="gl", metavar="NAME", help=f"renderer: gl (default), {hosts}"
    )
    command.add_argument(
        "--scene",
        metavar="NAME",
        help="light: studio, front, side, back, furnace (default: studio, or side if the host cannot draw it)",
    )
    command.add_argument(
        "--environment",
        metavar="IMAGE",
        help="light it with this latitude-longitude image; with --scene, use both lights",
    )
    command.add_argument(
        "--shape",
        "--geometry",
        metavar="NAME",
        help="ball, a shader ball (default in the studio), sphere (default in all other lights), or an .obj or .glb file",
    )
    command.add_argument(
        "--size",
        type=int,
        default=512,
        metavar="N",
        help="width and height in pixels (default: %(default)s)",
    )
    command.add_argument(
        "--integrator",
        choices=("raster", "path"),
        default="raster",
        help="path: path tracing on gl, with the object's own shadows and reflections",
    )
    command.add_argument(
        "--samples",
        type=int,
        metavar="N",
        help="paths per pixel, for cycles and --integrator path (default: automatic)",
    )
    command.add_argument(
        "--bounces",
        type=int,
        metavar="N",
        help="bounces per path, for cycles and --integrator path (default: automatic)",
    )
    arguments.add_shared(command, "--library", "--materialx", "--workers", "--timeout")
    arguments.add_policy(command, runs_code=True)


def run(options: argparse.Namespace) -> int:
    from mxeon.io.files import check_output
    from mxeon.io.images import PICTURES, write_picture
    from mxeon.io.srgb import pbr_neutral
    from mxeon.shaders.library import library_name

    inputs = arguments.inputs(options, [options.file], options.environment, options.shape)
    check_output(options.output, inputs, PICTURES)
    if not os.path.isdir(folder := os.path.dirname(os.path.abspath(options.output))):
        rule = "output must lie in a folder that exists"
        raise InputError(f"{rule}; got {options.output}: make {folder} first")
    library_name(options.library)
    names = ("host", "scene", "environment", "size", "shape", "element", "library")
    known = {name: getattr(options, name) for name in names}
    if options.integrator == "path" and options.host != "gl":
        raise InputError(f"--integrator path: the host must be gl; got {options.host}")
    known["host"] = "path" if options.integrator == "path" else options.host
    paths = Paths(options.samples, options.bounces)
    work = partial(batch.picture, policy=arguments.policy(options), paths=paths, **known)
    [result] = batch.run_batch(work, [options.file], options.workers, options.timeout)
    for warning in result.warnings:
        output.warn(warning)
    if result.error:
        raise result.error
    image, metadata = result.value
    if options.output.lower().endswith(".png") and metadata["scene"] in TONED:
        image = pbr_neutral(image)
    write_picture(options.output, image, metadata)
    output.show(options.output)
    return PASSED
