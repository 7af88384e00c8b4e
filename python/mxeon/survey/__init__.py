# SPDX-License-Identifier: Apache-2.0
"""Renderers with their own materials: their engines, nodes and checks, and the page that compares them.

`mxeon.hosts` and `mxeon.conformance` name no renderer: `mxeon.check` and the command register `ROWS`.
"""

from collections.abc import Sequence
from functools import partial
from importlib import import_module
from typing import Any

from mxeon.hosts import Row
from mxeon.shaders.scene import BACK, SIDE


def nodes(name: str) -> Sequence[Any]:
    """The nodes of a renderer that are judged; the checks and backends of renderers are imported."""
    from mxeon.survey import checks as checks

    [module] = (row.engine.rpartition(".")[0] for row in ROWS if row.name == name)
    found: Sequence[Any] = import_module(f"mxeon.{module}").NODES
    return found


_row = partial(Row, target="", nodes=nodes)
ROWS = (
    _row("cycles-native", way="native", engine="survey.cycles_native.CyclesNativeHost"),
    _row("three", way="exact", engine="survey.browser.three.ThreeHost", scenes=(SIDE, BACK)),
    _row("babylon", way="exact", engine="survey.browser.babylon.BabylonHost", scenes=(SIDE, BACK)),
    _row(
        "three-gpu-pathtracer",
        way="facet pairs",
        engine="survey.browser.pathtracer.GpuPathTracerHost",
    ),
    _row("mitsuba", way="facet pairs", engine="survey.polyhedron.mitsuba.MitsubaHost"),
    _row("eevee", way="coarse facets", engine="survey.polyhedron.eevee.EeveeHost"),
)
