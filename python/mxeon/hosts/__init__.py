# SPDX-License-Identifier: Apache-2.0
"""The table of hosts, which are engines that execute shaders. Each host has one row."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mxeon.errors import NotRun, Unsupported, assert_known
from mxeon.hosts.base import Engine, Host
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene


def start(name: str) -> Engine:
    """Start the engine of a row of `HOSTS`. The engine's module is imported only here."""
    match name:
        case "gl":
            from mxeon.hosts.gl import GlHost

            return GlHost()
        case "webgl":
            from mxeon.hosts.webgl import WebGlHost

            return WebGlHost()
        case "vulkan" | "wgsl":
            from mxeon.hosts import vulkan

            return vulkan.HOSTS[name]()
        case "hlsl" | "dxc" | "naga":
            from mxeon.hosts import translated

            return translated.HOSTS[name]()
        case "slang":
            from mxeon.hosts.slang import SlangHost

            return SlangHost()
        case "osl":
            from mxeon.hosts.osl import OslHost

            return OslHost()
        case "materialx":
            from mxeon.hosts.materialx import MaterialXHost

            return MaterialXHost()
        case "storm":
            from mxeon.hosts.storm import StormHost

            return StormHost()
        case "shadewire":
            from mxeon.hosts.shadewire import ShadewireHost

            return ShadewireHost()
        case "cycles":
            from mxeon.hosts.cycles import CyclesHost

            return CyclesHost()
        case _:
            from mxeon.hosts.testrender import TestrenderHost

            return TestrenderHost()


@dataclass(frozen=True)
class Row:
    """A host and the checks that run on the host.

    - `nodes`: Function that returns the specs of a renderer's own nodes, and registers the backends
      and checks of the renderer.
    """

    name: str
    target: str  # shading language; "" for a renderer that only has its own materials
    way: str = ""  # key of `mxeon.conformance.backends.BACKENDS`, or ""
    needs: str = ""  # what is missing to run shaders, for hosts that only check source code
    scenes: tuple[Scene, ...] = ()  # scenes in which a document's materials are rendered
    surfaces: bool = False  # whether surface shaders are checked on the host
    rounding: float = 0.0  # relative rounding error of pixels, beyond the error of float32
    # Models that the host computes correctly only for s = dot(wo, wi) - mu_o mu_i >= 0.
    front_lit: tuple[str, ...] = ()
    start: Callable[[str], Engine] = start
    nodes: Callable[[str], Sequence[Any]] | None = None


# Pictures of a white environment take long, because each pixel is a sum over many directions. The
# pictures are smooth, so half the usual width is enough.
WHITE_LIGHT = replace(FURNACE, size=128)

HOSTS = (
    Row("gl", "glsl", "pairs", scenes=(SIDE, BACK, WHITE_LIGHT), surfaces=True),
    Row("webgl", "essl", "pairs", scenes=(SIDE, BACK, WHITE_LIGHT)),
    Row("vulkan", "vulkan", "pairs"),
    Row("hlsl", "vulkan", "pairs"),
    Row("dxc", "vulkan", "pairs"),
    Row("naga", "vulkan", "pairs"),
    Row("wgsl", "wgsl", "pairs"),
    Row("slang", "slang", "pairs"),
    Row("osl", "osl", "closures"),
    Row(
        "materialx",
        "glsl",
        "drawn pictures",
        scenes=(SIDE, BACK, WHITE_LIGHT),
        surfaces=True,
    ),
    # The scene WHITE_LIGHT is left out, because Storm chooses the directions in which it samples an
    # environment.
    Row(
        "storm",
        "glsl",
        "half pictures",
        scenes=(SIDE, BACK),
        surfaces=True,
        rounding=2.0**-10,  # pixels are truncated to half floats
    ),
    Row("shadewire", "glsl", "functions", scenes=(SIDE, BACK)),
    # The scene WHITE_LIGHT is left out, because Cycles renders environments with noise. No closure
    # of Cycles agrees with QON for s < 0.
    Row("cycles", "osl", "pictures", scenes=(SIDE, BACK), front_lit=("qon",)),
    Row("testrender", "osl", "rendered", surfaces=True),
    Row("msl", "msl", needs="Metal, which only macOS has"),
    Row("mdl", "mdl", needs="a renderer that compiles MDL"),
)


_REGISTERED: dict[str, Row] = {}


def register(*rows: Row) -> None:
    """Add rows for renderers that have their own materials, as `mxeon.survey` does."""
    _REGISTERED.update({row.name: row for row in rows})


def registered() -> tuple[Row, ...]:
    """The rows that `register` has added, which worker processes need, too."""
    return tuple(_REGISTERED.values())


def host_rows() -> tuple[Row, ...]:
    """The rows of `HOSTS`, followed by the rows that `register` has added."""
    return HOSTS + registered()


def host_names() -> tuple[str, ...]:
    return tuple(row.name for row in host_rows())


def host_row(name: str, *additional: Row) -> Row:
    """The row of a host in `host_rows` or `additional`. Raises InputError for an unknown name."""
    rows = {row.name: row for row in (*host_rows(), *additional)}
    assert_known("host", name, rows)
    return rows[name]


def front_lit_only(host: str, model: str) -> bool:
    """Whether `HOSTS` has a row for a host that lists the model in `front_lit`."""
    return any(row.name == host and model in row.front_lit for row in HOSTS)


def open_host(name: str, *additional: Row) -> Host:
    """Start the host with this name, or raise Unsupported if the renderer runs no shaders."""
    engine = open_engine(name, *additional)
    if isinstance(engine, Host):
        return engine
    engine.close()
    raise Unsupported(f"{name}: this renderer only has its own materials; gl renders MaterialX's")


# Ids of the processes that opened an engine. A forked process has a copy of its parent's ids.
_OPENED: set[int] = set()


def open_engine(name: str, *additional: Row) -> Engine:
    """Start the host or renderer of a row in `host_rows` or `additional`, or raise NotRun."""
    from mxeon.shaders.generation import TARGETS

    row = host_row(name, *additional)
    if _OPENED - {os.getpid()}:
        raise NotRun(
            f"{name}: this process was forked from one that had opened an engine, whose threads are "
            "missing here: pass workers=1, or use the start method spawn"
        )
    if row.needs:
        raise NotRun(f"{name}: running it needs {row.needs}; only its source is checked")
    if row.target and row.target not in TARGETS:
        import MaterialX as mx

        from mxeon.shaders.library import TESTED

        raise NotRun(
            f"{name}: MaterialX must have a generator for {row.target}; {mx.__version__} has none: "
            f"pip install materialx=={TESTED[-1]}"
        )
    _OPENED.add(os.getpid())
    return row.start(name)
