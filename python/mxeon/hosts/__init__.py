# SPDX-License-Identifier: Apache-2.0
"""The table of hosts: engines that execute shaders, one module and one row each."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import cast

from mxeon.errors import InputError, NotRun, Unsupported
from mxeon.hosts.base import Host
from mxeon.hosts.renderer import RendererHost
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene


@dataclass(frozen=True)
class Row:
    """One host of the table.

    Attributes
    ----------
    name : str
        On the command line.
    target : str
        Target of the shaders that it executes; "" for a renderer of its own materials alone.
    module : str
        Module with its class `Host`; "" where only the text of the target is checked.
    probe : str
        How checks ask it: for "pairs" of directions, for "pictures" of a sphere, for pictures of
        "planes", for pictures of "native" nodes of its own, for "exact" ones, without noise and with
        the points of float32, for those of "facets" of a polyhedron, "coarse" ones or not,
        for these and for "facet pairs" of directions, or "" for nothing.
    needs : str
        What running it would take, where only its text is checked.
    scenes : tuple of Scene
        Lights under which it shows the materials of documents.
    surfaces : bool
        Whether surface shaders are judged on it.
    front_lit : tuple of str
        Models that it has for s >= 0 alone.
    """

    name: str
    target: str
    module: str = ""
    probe: str = ""
    needs: str = ""
    scenes: tuple[Scene, ...] = ()
    surfaces: bool = False
    front_lit: tuple[str, ...] = ()


HOSTS = (
    # Its pictures are exact and take no time.
    Row(
        "gl",
        "glsl",
        "mxeon.hosts.gl",
        "pairs",
        scenes=(SIDE, BACK, FURNACE),
        surfaces=True,
    ),
    Row("webgl", "essl", "mxeon.hosts.webgl", "pairs", scenes=(SIDE, BACK, FURNACE)),
    Row("vulkan", "vulkan", "mxeon.hosts.vulkan", "pairs"),
    Row("wgsl", "wgsl", "mxeon.hosts.wgsl", "pairs"),
    Row("slang", "slang", "mxeon.hosts.slang", "pairs"),
    # Its environment has noise. No closure of Cycles is QON for s < 0.
    Row(
        "cycles",
        "osl",
        "mxeon.hosts.cycles",
        "pictures",
        scenes=(SIDE, BACK),
        front_lit=("qon",),
    ),
    Row("cycles-native", "", "mxeon.hosts.cycles.native", "native"),
    Row("three", "", "mxeon.hosts.browser.three", "exact"),
    Row("babylon", "", "mxeon.hosts.browser.babylon", "exact"),
    Row("three-gpu-pathtracer", "", "mxeon.hosts.browser.pathtracer", "facet pairs"),
    Row("mitsuba", "", "mxeon.hosts.polyhedron.mitsuba", "facet pairs"),
    Row("eevee", "", "mxeon.hosts.polyhedron.eevee", "coarse facets"),
    Row("luxcore", "", "mxeon.hosts.polyhedron.luxcore", "facets"),
    Row("testrender", "osl", "mxeon.hosts.testrender", "planes", surfaces=True),
    Row("msl", "msl", needs="Metal, which macOS alone has"),
    Row("mdl", "mdl", needs="a renderer that compiles MDL"),
)


def host_names() -> tuple[str, ...]:
    """Names of all hosts, in the order of the table."""
    return tuple(row.name for row in HOSTS)


def host_row(name: str, *others: Row) -> Row:
    """The row of a host, from the table or from `others`.

    Raises
    ------
    ValueError
        If there is no such host; lists the known ones.
    """
    rows = {row.name: row for row in (*HOSTS, *others)}
    if name not in rows:
        raise InputError(f"host must be one of {', '.join(rows)}; got {name!r}")
    return rows[name]


def front_lit_only(host: str, model: str) -> bool:
    """Whether a host has a model for s >= 0 alone; what is not in the table has all of it."""
    return any(row.name == host and model in row.front_lit for row in HOSTS)


def open_host(name: str, *others: Row) -> Host:
    """The host of a name, started; arguments and errors are those of `open_engine`.

    Raises
    ------
    Unsupported
        If it is a renderer that shows materials of its own alone.
    """
    engine = open_engine(name, *others)
    if isinstance(engine, Host):
        return engine
    engine.close()
    raise Unsupported(f"{name}: this renderer shows materials of its own alone; gl has others")


def open_engine(name: str, *others: Row) -> Host | RendererHost:
    """The host or renderer of a name, started.

    Parameters
    ----------
    name : str
    *others : Row
        Hosts beside those of the table.

    Raises
    ------
    ValueError
        If there is no such host; lists the known ones.
    NotRun
        If it cannot run on this machine.
    """
    from mxeon.shaders.generation import TARGETS

    row = host_row(name, *others)
    if not row.module:
        raise NotRun(f"{name}: running it needs {row.needs}; its text is checked")
    if row.target and row.target not in TARGETS:
        raise NotRun(_no_generator(row))
    return cast(Host | RendererHost, import_module(row.module).Host())


def _no_generator(row: Row) -> str:
    import MaterialX as mx

    from mxeon.shaders.library import TESTED

    return (
        f"{row.name}: MaterialX must have a generator for {row.target}; {mx.__version__} has none: "
        f"pip install materialx=={TESTED[-1]}"
    )
