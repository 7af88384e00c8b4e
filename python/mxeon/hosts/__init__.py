# SPDX-License-Identifier: Apache-2.0
"""The table of hosts: engines that execute shaders, one module and one row each."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from importlib import import_module

from mxeon.errors import NotRun, Unsupported, assert_known
from mxeon.hosts.base import Engine, Host
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene


@dataclass(frozen=True)
class Row:
    """A host and the properties that determine its checks."""

    name: str
    target: str  # shading language; "" for a renderer that only has its own materials
    way: str = ""  # key of `mxeon.conformance.backends.BACKENDS`, or ""
    needs: str = ""  # what a host needs to run; with a value, only its text is checked
    scenes: tuple[Scene, ...] = ()  # lights under which it renders the materials of documents
    surfaces: bool = False  # whether surface shaders are checked on it
    rounding: float = 0.0  # relative rounding of its pixels, in addition to float32's
    front_lit: tuple[str, ...] = ()  # models that it supports only for s >= 0
    engine: str = ""  # module of mxeon and class; imported only where it runs


# Every pixel sums over the environment, and the picture is smooth: half the usual width is enough.
WHITE_LIGHT = replace(FURNACE, size=128)

HOSTS = (
    Row(
        "gl",
        "glsl",
        "pairs",
        engine="hosts.gl.GlHost",
        scenes=(SIDE, BACK, WHITE_LIGHT),
        surfaces=True,
    ),
    Row("webgl", "essl", "pairs", engine="hosts.webgl.WebGlHost", scenes=(SIDE, BACK, WHITE_LIGHT)),
    Row("vulkan", "vulkan", "pairs", engine="hosts.vulkan.VulkanHost"),
    Row("hlsl", "vulkan", "pairs", engine="hosts.translated.HlslHost"),
    Row("dxc", "vulkan", "pairs", engine="hosts.translated.DxcHost"),
    Row("naga", "vulkan", "pairs", engine="hosts.translated.NagaHost"),
    Row("wgsl", "wgsl", "pairs", engine="hosts.vulkan.WgslHost"),
    Row("slang", "slang", "pairs", engine="hosts.slang.SlangHost"),
    Row("osl", "osl", "closures", engine="hosts.osl.OslHost"),
    Row(
        "materialx",
        "glsl",
        "drawn pictures",
        engine="hosts.materialx.MaterialXHost",
        scenes=(SIDE, BACK, WHITE_LIGHT),
        surfaces=True,
    ),
    # No WHITE_LIGHT: Storm sums an environment over different directions than the other hosts.
    Row(
        "storm",
        "glsl",
        "half pictures",
        engine="hosts.storm.StormHost",
        scenes=(SIDE, BACK),
        surfaces=True,
        rounding=2.0**-10,  # half floats, truncated
    ),
    Row(
        "shadewire",
        "glsl",
        "functions",
        engine="hosts.shadewire.ShadewireHost",
        scenes=(SIDE, BACK),
    ),
    # Cycles samples an environment with noise. None of its closures is QON for s < 0.
    Row(
        "cycles",
        "osl",
        "pictures",
        engine="hosts.cycles.CyclesHost",
        scenes=(SIDE, BACK),
        front_lit=("qon",),
    ),
    Row("testrender", "osl", "rendered", engine="hosts.testrender.TestrenderHost", surfaces=True),
    Row("msl", "msl", needs="Metal, which macOS alone has"),
    Row("mdl", "mdl", needs="a renderer that compiles MDL"),
)


# Renderers with their own materials. `mxeon.survey` defines their classes, nodes and checks.
RENDERERS = (
    Row("cycles-native", "", "native", engine="survey.cycles_native.CyclesNativeHost"),
    Row("three", "", "exact", engine="survey.browser.three.ThreeHost", scenes=(SIDE, BACK)),
    Row("babylon", "", "exact", engine="survey.browser.babylon.BabylonHost", scenes=(SIDE, BACK)),
    Row(
        "three-gpu-pathtracer",
        "",
        "facet pairs",
        engine="survey.browser.pathtracer.GpuPathTracerHost",
    ),
    Row("mitsuba", "", "facet pairs", engine="survey.polyhedron.mitsuba.MitsubaHost"),
    Row("eevee", "", "coarse facets", engine="survey.polyhedron.eevee.EeveeHost"),
)
ROWS = HOSTS + RENDERERS


def host_names() -> tuple[str, ...]:
    return tuple(row.name for row in ROWS)


def host_row(name: str, *others: Row) -> Row:
    """The row of a host in ROWS or `others`; otherwise InputError lists the known ones."""
    rows = {row.name: row for row in (*ROWS, *others)}
    assert_known("host", name, rows)
    return rows[name]


def front_lit_only(host: str, model: str) -> bool:
    """Whether a host supports a model only for s >= 0; False for hosts outside the table."""
    return any(row.name == host and model in row.front_lit for row in HOSTS)


def open_host(name: str, *others: Row) -> Host:
    """Start the host with this name; Unsupported for a renderer with only its own materials."""
    engine = open_engine(name, *others)
    if isinstance(engine, Host):
        return engine
    engine.close()
    raise Unsupported(f"{name}: this renderer only has its own materials; gl renders MaterialX's")


_OPENED: set[int] = set()  # ids of processes that opened an engine: this one and its ancestors


def open_engine(name: str, *others: Row) -> Engine:
    """Start the host or renderer with this name, or raise NotRun; `others` are additional rows."""
    from mxeon.shaders.generation import TARGETS

    row = host_row(name, *others)
    if _OPENED - {os.getpid()}:
        raise NotRun(
            f"{name}: this process was forked from one that had opened an engine, whose threads are "
            "missing here: pass workers=1, or start processes by the method spawn"
        )
    if row.needs:
        raise NotRun(f"{name}: running it needs {row.needs}; its text is checked")
    if row.target and row.target not in TARGETS:
        import MaterialX as mx

        from mxeon.shaders.library import TESTED

        raise NotRun(
            f"{name}: MaterialX must have a generator for {row.target}; {mx.__version__} has none: "
            f"pip install materialx=={TESTED[-1]}"
        )
    _OPENED.add(os.getpid())
    module, _, kind = row.engine.rpartition(".")
    engine: Engine = getattr(import_module(f"mxeon.{module}"), kind)()
    return engine
