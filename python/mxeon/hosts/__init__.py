# SPDX-License-Identifier: Apache-2.0
"""The table of hosts: engines that execute shaders, one module and one row each."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import cast

from mxeon.errors import NotRun, Unsupported, assert_known
from mxeon.hosts.base import Host
from mxeon.hosts.renderer import RendererHost
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene


@dataclass(frozen=True)
class OwnNode:
    """A node of a renderer's own, with the model that its documentation claims.

    Attributes
    ----------
    title : str
        Name in reports, by which the renderer is asked for it.
    model : str
        Name of a row of `mxeon.models.table`.
    inputs : tuple of str
    forms : tuple of str
        Forms of the model that its paper publishes, if there are several. The one that is nearest to
        what is measured is judged.
    others : bool
        Whether other lobes lie beside the diffuse one, which do not depend on the color.
    sampled : bool
        Whether its renderer draws directions for it by a function that can be called.
    """

    title: str
    model: str
    inputs: tuple[str, ...] = ("color", "roughness")
    forms: tuple[str, ...] = ()
    others: bool = False
    sampled: bool = False


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
        How checks ask it: for "pairs" of directions, for "rendered" ones, with its own closures and
        what a camera shows, for "pictures" of a sphere, for the "closures" of a shader, for "drawn
        pictures" of a sphere whose points are exact,
        for "half pictures", the same in half floats, for pictures of "native" nodes of its own, for
        "exact" ones, without noise and with the points of float32, for those of "facets" of a
        polyhedron, "coarse" ones or not, for these and for "facet pairs" of directions, or "" for
        nothing.
    needs : str
        What running it would take, where only its text is checked.
    scenes : tuple of Scene
        Lights under which it shows the materials of documents.
    surfaces : bool
        Whether surface shaders are judged on it.
    rounding : float
        Of the pixels of its pictures beyond float32's, relative to their values.
    front_lit : tuple of str
        Models that it has for s >= 0 alone.
    nodes : tuple of OwnNode
        Materials of a renderer's own that are judged.
    """

    name: str
    target: str
    module: str = ""
    probe: str = ""
    needs: str = ""
    scenes: tuple[Scene, ...] = ()
    surfaces: bool = False
    rounding: float = 0.0
    front_lit: tuple[str, ...] = ()
    nodes: tuple[OwnNode, ...] = ()


COLOR = ("color",)  # input of a Lambert node
PUBLISHED = ("eon", "eon_fitted")  # the paper prints EON with the exact albedo, and with a quartic
BROWSER = ("WebGL2", "WebGPU")

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
    Row("osl", "osl", "mxeon.hosts.osl", "closures"),
    Row(
        "materialx",
        "glsl",
        "mxeon.hosts.materialx",
        "drawn pictures",
        scenes=(SIDE, BACK, FURNACE),
        surfaces=True,
    ),
    # Its furnace has another sum of directions for microfacets.
    Row(
        "storm",
        "glsl",
        "mxeon.hosts.storm",
        "half pictures",
        scenes=(SIDE, BACK),
        surfaces=True,
        rounding=2.0**-10,  # half floats, cut off
    ),
    # Its environment has noise. No closure of Cycles is QON for s < 0.
    Row(
        "cycles",
        "osl",
        "mxeon.hosts.cycles",
        "pictures",
        scenes=(SIDE, BACK),
        front_lit=("qon",),
    ),
    Row(
        "cycles-native",
        "",
        "mxeon.hosts.cycles.native",
        "native",
        nodes=(OwnNode("Diffuse BSDF", "eon"), OwnNode("Principled BSDF", "eon")),
    ),
    # OpenPBR asks for EON, Standard Surface for Oren-Nayar.
    Row(
        "three",
        "",
        "mxeon.hosts.browser.three",
        "exact",
        nodes=(
            OwnNode("MeshPhysicalMaterial, WebGLRenderer", "eon", forms=PUBLISHED),
            OwnNode("MeshPhysicalMaterial, WebGPURenderer", "eon", forms=PUBLISHED),
            OwnNode("open_pbr_surface, MaterialXLoader", "eon", forms=PUBLISHED),
            OwnNode("standard_surface, MaterialXLoader", "qon"),
        ),
    ),
    Row(
        "babylon",
        "",
        "mxeon.hosts.browser.babylon",
        "exact",
        nodes=(
            *(
                OwnNode(f"PBRMaterial E_OREN_NAYAR, {each}", "eon", forms=PUBLISHED)
                for each in BROWSER
            ),
            *(OwnNode(f"OpenPBRMaterial, {each}", "eon", forms=PUBLISHED) for each in BROWSER),
            *(OwnNode(f"PBRMaterial BURLEY, {each}", "burley") for each in BROWSER),
            *(OwnNode(f"PBRMaterial LEGACY, {each}", "burley_lambert") for each in BROWSER),
            *(OwnNode(f"PBRMaterial LAMBERT, {each}", "lambert", COLOR) for each in BROWSER),
        ),
    ),
    Row(
        "three-gpu-pathtracer",
        "",
        "mxeon.hosts.browser.pathtracer",
        "facet pairs",
        nodes=(
            OwnNode("WebGPUPathTracer, eonBrdf", "eon", forms=PUBLISHED, sampled=True),
            OwnNode("WebGPUPathTracer, fonBrdf", "fon"),
            OwnNode("WebGLPathTracer, diffuseEval", "burley"),
            OwnNode("WebGLPathTracer, diffuseEval, shorter wh", "burley"),
        ),
    ),
    Row(
        "mitsuba",
        "",
        "mxeon.hosts.polyhedron.mitsuba",
        "facet pairs",
        nodes=(
            OwnNode("diffuse", "lambert", COLOR),
            OwnNode("principled", "burley"),
            *(OwnNode(f"{each} of mxeon.mitsuba", each) for each in ("eon", "fon", "qon")),
            OwnNode("dielectric_over_eon of mxeon.mitsuba", "eon_coated"),
            OwnNode("openpbr_base of mxeon.mitsuba", "openpbr_half_metal"),
        ),
    ),
    # Its manual has the roughness of both nodes for Cycles only.
    Row(
        "eevee",
        "",
        "mxeon.hosts.polyhedron.eevee",
        "coarse facets",
        nodes=(
            OwnNode("Diffuse BSDF", "lambert", COLOR),
            OwnNode("Principled BSDF", "lambert", COLOR),
        ),
    ),
    Row(
        "luxcore",
        "",
        "mxeon.hosts.polyhedron.luxcore",
        "facets",
        nodes=(
            OwnNode("matte", "lambert", COLOR),
            OwnNode("roughmatte", "qon"),
            OwnNode("roughmatte, sigma in degrees", "qon"),
            OwnNode("disney", "burley", others=True),
        ),
    ),
    Row("testrender", "osl", "mxeon.hosts.testrender.renderer", "rendered", surfaces=True),
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
    assert_known("host", name, rows)
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

    from mxeon.shaders.versions import TESTED

    return (
        f"{row.name}: MaterialX must have a generator for {row.target}; {mx.__version__} has none: "
        f"pip install materialx=={TESTED[-1]}"
    )
