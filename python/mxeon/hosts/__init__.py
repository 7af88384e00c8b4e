# SPDX-License-Identifier: Apache-2.0
"""The table of hosts: engines that execute shaders, one module and one row each."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import cast

from mxeon.errors import NotRun, Unsupported, assert_known
from mxeon.hosts.base import Host, RendererHost
from mxeon.shaders.scene import BACK, FURNACE, SIDE, Scene


@dataclass(frozen=True)
class OwnNode:
    """A node of a renderer's own, with the model that its documentation claims."""

    title: str  # in reports and in requests to the renderer
    model: str  # a row of `mxeon.models.table`
    inputs: tuple[str, ...] = ("color", "roughness")
    forms: tuple[str, ...] = ()  # published; the nearest to what is measured is judged
    others: bool = False  # whether lobes that ignore the color lie beside the diffuse one
    sampled: bool = False  # whether the function that draws its directions can be called


@dataclass(frozen=True)
class Row:
    name: str
    target: str  # of its shaders; "" for a renderer of its own materials alone
    module: str = ""  # with its class `Host`; "" where only the text of the target is checked
    probe: str = ""  # how it is asked: a key of `mxeon.conformance.backends.BACKENDS`; "" for none
    needs: str = ""  # what running it would take, where only its text is checked
    scenes: tuple[Scene, ...] = ()  # lights under which it renders the materials of documents
    surfaces: bool = False  # whether surface shaders are judged on it
    rounding: float = 0.0  # relative, of its pixels beyond float32's
    front_lit: tuple[str, ...] = ()  # models that it has for s >= 0 alone
    nodes: tuple[OwnNode, ...] = ()


COLOR = ("color",)  # input of a Lambert node
PUBLISHED = ("eon", "eon_fitted")  # the paper prints EON with the exact albedo, and with a quartic
BROWSER = ("WebGL2", "WebGPU")

HOSTS = (
    # Its pictures are exact and take no time.
    Row("gl", "glsl", "mxeon.hosts.gl", "pairs", scenes=(SIDE, BACK, FURNACE), surfaces=True),
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
    Row("cycles", "osl", "mxeon.hosts.cycles", "pictures", scenes=(SIDE, BACK), front_lit=("qon",)),
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
    return tuple(row.name for row in HOSTS)


def host_row(name: str, *others: Row) -> Row:
    """The row of a host, from the table or from `others`; InputError lists the known ones."""
    rows = {row.name: row for row in (*HOSTS, *others)}
    assert_known("host", name, rows)
    return rows[name]


def front_lit_only(host: str, model: str) -> bool:
    """Whether a host has a model for s >= 0 alone; what is not in the table has all of it."""
    return any(row.name == host and model in row.front_lit for row in HOSTS)


def open_host(name: str, *others: Row) -> Host:
    """The host of a name, started; Unsupported for a renderer of its own materials alone."""
    engine = open_engine(name, *others)
    if isinstance(engine, Host):
        return engine
    engine.close()
    raise Unsupported(f"{name}: this renderer only has its own materials; gl renders MaterialX's")


def open_engine(name: str, *others: Row) -> Host | RendererHost:
    """The host or renderer of a name, started, or NotRun; `others` are rows beside the table's."""
    from mxeon.shaders.generation import TARGETS

    row = host_row(name, *others)
    if not row.module:
        raise NotRun(f"{name}: running it needs {row.needs}; its text is checked")
    if row.target and row.target not in TARGETS:
        import MaterialX as mx

        from mxeon.shaders.library import TESTED

        raise NotRun(
            f"{name}: MaterialX must have a generator for {row.target}; {mx.__version__} has none: "
            f"pip install materialx=={TESTED[-1]}"
        )
    return cast(Host | RendererHost, import_module(row.module).Host())
