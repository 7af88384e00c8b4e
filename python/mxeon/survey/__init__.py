# SPDX-License-Identifier: Apache-2.0
"""Survey of the built-in materials of renderers, with a page that compares the renderers.

`mxeon.hosts` and `mxeon.conformance` do not import this package. `mxeon.check` and the command line
register `ROWS`.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

from mxeon.hosts import Row
from mxeon.hosts.base import Engine
from mxeon.shaders.scene import BACK, SIDE


def renderers() -> dict[str, tuple[type[Engine], Sequence[Any]]]:
    """Engine and nodes of each renderer. The imports add checks and backends of the survey."""
    from mxeon.survey import checks as checks
    from mxeon.survey import cycles_native
    from mxeon.survey.browser import babylon, pathtracer, three
    from mxeon.survey.polyhedron import eevee, mitsuba

    return {
        "cycles-native": (cycles_native.CyclesNativeHost, cycles_native.NODES),
        "three": (three.ThreeHost, three.NODES),
        "babylon": (babylon.BabylonHost, babylon.NODES),
        "three-gpu-pathtracer": (pathtracer.GpuPathTracerHost, pathtracer.NODES),
        "mitsuba": (mitsuba.MitsubaHost, mitsuba.NODES),
        "eevee": (eevee.EeveeHost, eevee.NODES),
    }


def start(name: str) -> Engine:
    return renderers()[name][0]()


def nodes(name: str) -> Sequence[Any]:
    return renderers()[name][1]


_row = partial(Row, target="", start=start, nodes=nodes)
ROWS = (
    _row("cycles-native", way="native"),
    _row("three", way="exact", scenes=(SIDE, BACK)),
    _row("babylon", way="exact", scenes=(SIDE, BACK)),
    _row("three-gpu-pathtracer", way="facet pairs"),
    _row("mitsuba", way="facet pairs"),
    _row("eevee", way="coarse facets"),
)
