# SPDX-License-Identifier: Apache-2.0
"""The table of hosts: engines that execute shaders, one module and one row each."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from importlib import import_module
from typing import cast

from mxeon.errors import NotRun, Unsupported, assert_known
from mxeon.hosts.base import Engine, Host
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene


@dataclass(frozen=True)
class Row:
    name: str
    target: str  # of its shaders; "" for a renderer that only has its own materials
    module: str = ""  # with its class `Host`; "" where only the text of the target is checked
    way: str = ""  # its backends: a key of `mxeon.conformance.backends.BACKENDS`; "" for none
    needs: str = ""  # what running it would take, where only its text is checked
    scenes: tuple[Scene, ...] = ()  # lights under which it renders the materials of documents
    surfaces: bool = False  # whether surface shaders are checked on it
    rounding: float = 0.0  # relative, of its pixels, in addition to float32's
    front_lit: tuple[str, ...] = ()  # models that it only has for s >= 0


# A sum over the environment for each pixel: half as wide as the others, as all of it is smooth.
WHITE = replace(FURNACE, size=128)

HOSTS = (
    # Its pictures are exact and take no time.
    Row("gl", "glsl", "mxeon.hosts.gl", "pairs", scenes=(SIDE, BACK, WHITE), surfaces=True),
    Row("webgl", "essl", "mxeon.hosts.webgl", "pairs", scenes=(SIDE, BACK, WHITE)),
    Row("vulkan", "vulkan", "mxeon.hosts.vulkan", "pairs"),
    Row("wgsl", "wgsl", "mxeon.hosts.wgsl", "pairs"),
    Row("slang", "slang", "mxeon.hosts.slang", "pairs"),
    Row("osl", "osl", "mxeon.hosts.osl", "closures"),
    Row(
        "materialx",
        "glsl",
        "mxeon.hosts.materialx",
        "drawn pictures",
        scenes=(SIDE, BACK, WHITE),
        surfaces=True,
    ),
    # Its furnace sums microfacets over other directions.
    Row(
        "storm",
        "glsl",
        "mxeon.hosts.storm",
        "half pictures",
        scenes=(SIDE, BACK),
        surfaces=True,
        rounding=2.0**-10,  # half floats, truncated
    ),
    # Its environment has noise. No closure of Cycles is QON for s < 0.
    Row("cycles", "osl", "mxeon.hosts.cycles", "pictures", scenes=(SIDE, BACK), front_lit=("qon",)),
    Row("testrender", "osl", "mxeon.hosts.testrender", "rendered", surfaces=True),
    Row("msl", "msl", needs="Metal, which macOS alone has"),
    Row("mdl", "mdl", needs="a renderer that compiles MDL"),
)


def host_rows() -> tuple[Row, ...]:
    """The table, and the rows of `mxeon.survey`: renderers with their own materials."""
    renderers: tuple[Row, ...] = import_module("mxeon.survey").ROWS
    return HOSTS + renderers


def host_names() -> tuple[str, ...]:
    return tuple(row.name for row in host_rows())


def host_row(name: str, *others: Row) -> Row:
    """The row of a host in `host_rows` or `others`; otherwise InputError lists the known ones."""
    rows = {row.name: row for row in (*host_rows(), *others)}
    assert_known("host", name, rows)
    return rows[name]


def front_lit_only(host: str, model: str) -> bool:
    """Whether a host only has a model for s >= 0; hosts outside the table have all of it."""
    return any(row.name == host and model in row.front_lit for row in HOSTS)


def open_host(name: str, *others: Row) -> Host:
    """Start the host of a name; Unsupported for a renderer that only has its own materials."""
    engine = open_engine(name, *others)
    if isinstance(engine, Host):
        return engine
    engine.close()
    raise Unsupported(f"{name}: this renderer only has its own materials; gl renders MaterialX's")


_OPENED: set[int] = set()  # processes that opened an engine: this one, and those it was forked from


def open_engine(name: str, *others: Row) -> Engine:
    """Start the host or renderer of a name, or raise NotRun; `others` are additional rows."""
    from mxeon.shaders.generation import TARGETS

    row = host_row(name, *others)
    if _OPENED - {os.getpid()}:
        raise NotRun(
            f"{name}: this process was forked from one that had opened an engine, whose threads are "
            "missing here: pass workers=1, or start processes by the method spawn"
        )
    if not row.module:
        raise NotRun(f"{name}: running it needs {row.needs}; its text is checked")
    if row.target and row.target not in TARGETS:
        import MaterialX as mx

        from mxeon.shaders.library import TESTED

        raise NotRun(
            f"{name}: MaterialX must have a generator for {row.target}; {mx.__version__} has none: "
            f"pip install materialx=={TESTED[-1]}"
        )
    _OPENED.add(os.getpid())
    return cast(Engine, import_module(row.module).Host())
