# SPDX-License-Identifier: Apache-2.0
"""Survey of renderers' own materials: engines, nodes, checks, and a page that compares them.

`mxeon.hosts` and `mxeon.conformance` name no renderer: `mxeon.check` and the command register `ROWS`.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

from mxeon.hosts import Row
from mxeon.hosts.base import Engine
from mxeon.shaders.scene import BACK, SIDE


def start(name: str) -> Engine:
    """Start the renderer of a row of `ROWS`. Its module is imported only where it runs."""
    match name:
        case "cycles-native":
            from mxeon.survey.cycles_native import CyclesNativeHost

            return CyclesNativeHost()
        case "three":
            from mxeon.survey.browser.three import ThreeHost

            return ThreeHost()
        case "babylon":
            from mxeon.survey.browser.babylon import BabylonHost

            return BabylonHost()
        case "three-gpu-pathtracer":
            from mxeon.survey.browser.pathtracer import GpuPathTracerHost

            return GpuPathTracerHost()
        case "mitsuba":
            from mxeon.survey.polyhedron.mitsuba import MitsubaHost

            return MitsubaHost()
        case _:
            from mxeon.survey.polyhedron.eevee import EeveeHost

            return EeveeHost()


def nodes(name: str) -> Sequence[Any]:
    """Judged nodes of a renderer; also imports the checks and backends of renderers."""
    from mxeon.survey import checks as checks
    from mxeon.survey import cycles_native
    from mxeon.survey.browser import babylon, pathtracer, three
    from mxeon.survey.polyhedron import eevee, mitsuba

    return {
        "cycles-native": cycles_native.NODES,
        "three": three.NODES,
        "babylon": babylon.NODES,
        "three-gpu-pathtracer": pathtracer.NODES,
        "mitsuba": mitsuba.NODES,
        "eevee": eevee.NODES,
    }[name]


_row = partial(Row, target="", start=start, nodes=nodes)
ROWS = (
    _row("cycles-native", way="native"),
    _row("three", way="exact", scenes=(SIDE, BACK)),
    _row("babylon", way="exact", scenes=(SIDE, BACK)),
    _row("three-gpu-pathtracer", way="facet pairs"),
    _row("mitsuba", way="facet pairs"),
    _row("eevee", way="coarse facets"),
)
