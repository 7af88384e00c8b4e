# SPDX-License-Identifier: Apache-2.0
"""`mxeon invert`: compute rho from a target albedo."""

import argparse
from collections.abc import Callable
from typing import Any

from mxeon.cli import arguments
from mxeon.errors import PASSED, InputError


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its options."""
    summary = "compute rho, the linear color input of EON, from a target albedo"
    command = arguments.add_command(commands, "invert", summary, run)
    for channel in "RGB":
        command.add_argument(
            channel, type=float, help="target albedo, linear (not sRGB), in [0, 1]"
        )
    command.add_argument("--roughness", type=float, required=True, help="in [0, 1]")
    command.add_argument(
        "--average",
        action="store_true",
        help="the target is the average albedo, not that at normal incidence",
    )


def run(options: argparse.Namespace) -> int:
    """Print rho; return the exit status."""
    from mxeon.models.diffuse.inversion import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal

    invert: Callable[..., Any] = (
        eon_rho_from_albedo_avg if options.average else eon_rho_from_albedo_normal
    )
    try:
        rho = invert([options.R, options.G, options.B], options.roughness)
    except ValueError as error:  # the models know no errors of mxeon's
        raise InputError(str(error)) from None
    print(*(f"{float(channel):.9g}" for channel in rho))
    return PASSED
