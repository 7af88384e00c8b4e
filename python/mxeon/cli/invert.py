# SPDX-License-Identifier: Apache-2.0
"""`mxeon invert`: compute EON's input color, rho, from a target albedo."""

import argparse
from collections.abc import Callable
from typing import Any

from mxeon.cli import arguments
from mxeon.errors import PASSED, InputError


def add_parser(commands: arguments.Commands) -> None:
    command = arguments.add_command(
        commands,
        "invert",
        "compute the input color that gives EON the albedo you want",
        run,
        "invert 0.8 0.4 0.1 --roughness 0.7",
        "invert 0.8 0.4 0.1 --roughness 0.7 --average",
    )
    for channel in "RGB":
        command.add_argument(
            channel, type=float, help="albedo to reach, linear (not sRGB), in [0, 1]"
        )
    command.add_argument("--roughness", type=float, required=True, help="in [0, 1]")
    command.add_argument(
        "--average",
        action="store_true",
        help="R G B is the average over all views, not the albedo seen head-on",
    )


def run(options: argparse.Namespace) -> int:
    from mxeon.models.diffuse import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal

    invert: Callable[..., Any] = (
        eon_rho_from_albedo_avg if options.average else eon_rho_from_albedo_normal
    )
    try:
        rho = invert([options.R, options.G, options.B], options.roughness)
    except ValueError as error:  # the models raise ValueError, not errors of mxeon
        raise InputError(str(error)) from None
    print(*(f"{float(channel):.9g}" for channel in rho))
    return PASSED
