# SPDX-License-Identifier: Apache-2.0
"""Figures of pages on pbrlib's text and on MaterialX that no check of the suite measures."""

import warnings
from xml.parsers import expat

import MaterialX as mx
import numpy as np

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.probes.bsdf import MicrofacetProbe
from mxeon.conformance.samples.batch import Batch
from mxeon.hosts import open_host
from mxeon.models import conductor_brdf
from mxeon.models.diffuse.burley import burley_albedo_dir
from mxeon.models.hair import chiang_hair_bcsdf
from mxeon.models.hair.formulas import longitudinal
from mxeon.models.microfacet.albedo import conductor_albedo_dir, ggx_albedo_dir_anisotropic
from mxeon.models.microfacet.fresnel import fresnel_schlick
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.shaders.document.notes import DocumentWarning
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import generate
from mxeon.shaders.library import load_library

HEAD = "| quantity | measured | expected |\n|---|---|---|\n"
STOCK = "stock"
BRUSHED, MU = (0.01, 0.3), 0.1  # alpha along tangent and bitangent, and cosine of the view
GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)  # index and extinction

STRUCT = """<?xml version="1.0"?>
<materialx version="1.39">
  <typedef name="pair"><member name="b" type="color3" value="0.1,0.2,0.3"/></typedef>
  <nodedef name="ND_tint" node="tint">
    <input name="in" type="pair" value="{0.1,0.2,0.3}"/><output name="out" type="color3"/>
  </nodedef>
  <implementation name="IM_tint" nodedef="ND_tint" target="genglsl" sourcecode="{{in}}.b"/>
  <tint name="tint1" type="color3"/>
  <oren_nayar_diffuse_bsdf name="lobe" type="BSDF">
    <input name="color" type="color3" nodename="tint1"/>
  </oren_nayar_diffuse_bsdf>
  <surface name="surface1" type="surfaceshader">
    <input name="bsdf" type="BSDF" nodename="lobe"/>
  </surface>
  <surfacematerial name="material1" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="surface1"/>
  </surfacematerial>
</materialx>"""

# Two nodes of one name, each in a nodegraph of its own.
NAMES = """<materialx version="1.39">
  <nodegraph name="red"><invert name="tint" type="color3">
    <input name="in" type="color3" value="1, 0, 0"/>
  </invert><output name="out" type="color3" nodename="tint"/></nodegraph>
  <nodegraph name="green"><invert name="tint" type="color3">
    <input name="in" type="color3" value="0, 1, 0"/>
  </invert><output name="out" type="color3" nodename="tint"/></nodegraph>
  <mix name="both" type="color3">
    <input name="fg" type="color3" nodegraph="red" output="out"/>
    <input name="bg" type="color3" nodegraph="green" output="out"/>
    <input name="mix" type="float" value="0.5"/>
  </mix>
  <output name="shown" type="color3" nodename="both"/>
</materialx>"""

# A material by a definition.
MATERIAL = """<materialx version="1.39">
  <nodedef name="ND_clay" node="clay"><output name="out" type="material"/></nodedef>
  <nodegraph name="NG_clay" nodedef="ND_clay">
    <oren_nayar_diffuse_bsdf name="lobe" type="BSDF"/>
    <surface name="shading" type="surfaceshader">
      <input name="bsdf" type="BSDF" nodename="lobe"/>
    </surface>
    <surfacematerial name="look" type="material">
      <input name="surfaceshader" type="surfaceshader" nodename="shading"/>
    </surfacematerial>
    <output name="out" type="material" nodename="look"/>
  </nodegraph>
  <clay name="clay1" type="material"/>
</materialx>"""


def anisotropic_environment_block():
    """White albedo of a brushed lobe in stock GLSL's environment branch, and of its values."""
    host = open_host("gl")
    try:
        [subject] = [each for each in BSDFS if each.node == "generalized_schlick_bsdf"]
        probe = MicrofacetProbe(host, subject, STOCK)
        rows = [
            (f"white albedo seen {name}", *_brushed_albedos(probe, azimuth))
            for name, azimuth in (("along the tangent", 0.0), ("across it", 0.5 * np.pi))
        ]
    finally:
        host.close()
    return _table(rows, "{:.2f}")


def _brushed_albedos(probe, azimuth):
    """Albedos of the environment branch, and of the values of the direct branch."""
    wo = _direction(MU, azimuth)[np.newaxis]
    ones = np.ones((1, 3))
    inputs = dict.fromkeys(("color0", "color82", "color90"), ones)
    inputs |= {"exponent": np.array([5.0]), "roughness": np.array([BRUSHED])}
    environment = probe.albedo(Batch(wo, wo, inputs))[0, 0]
    values = conductor_albedo_dir(wo[0], BRUSHED, np.zeros(3), np.zeros(3))  # F = 1 at index 0
    return environment, values[0]


def anisotropic_masking_block():
    """Albedo of a brushed lobe at unit Fresnel reflectance, by the text."""
    rows = [
        (
            f"albedo at F = 1, alpha {alpha}, mu {mu}, seen across",
            ggx_albedo_dir_anisotropic(_direction(mu, 0.5 * np.pi), alpha),
            "at most 1",
        )
        for alpha, mu in ((BRUSHED, MU), ((0.001, 1.0), 0.001))
    ]
    return _table(rows, "{:.2f}")


def energy_block():
    """Figures at which the text's equations leave what its own rules allow."""
    mu = np.linspace(0.0, 1.0, 2001)
    dip = fresnel_schlick(mu, np.zeros(1), np.zeros(1), np.ones(1), 5.0)
    there, back = _conductor_pair()
    rows = [
        ("albedo of Conty-Kulla, roughness 0.05, mu 0.02", conty_kulla_albedo_dir(0.02, 0.05), 1),
        ("albedo of Burley, color 1, roughness 1, mu 0", burley_albedo_dir(0.0, [1.0], 1.0)[0], 1),
        ("least F of Schlick, color0 0, color82 0, color90 1, exponent 5", dip.min(), 0),
        ("f(wo, wi) / f(wi, wo) of gold, alpha 0.5, cosines 0.1 and 0.9", there / back, 1),
    ]
    return _table(rows, "{:.3f}")


def _conductor_pair():
    """Red value of gold for a pair of directions, and for the exchanged pair."""
    pair = _direction(0.1, 0.0), _direction(0.9, 2.0)
    values = [conductor_brdf(*each, (0.5, 0.5), *GOLD)[0] for each in (pair, pair[::-1])]
    return tuple(values)


def hair_block():
    """Light that white hair returns, by the text, and that of its lobes with a tilted cuticle."""
    x, w = np.polynomial.legendre.leggauss(400)
    view, tilt = 1.4, np.radians(2.0)
    rows = [("light that a white fiber returns", _white_hair(), 1)]
    for lobe, name in enumerate(("R", "TT", "TRT")):
        theta = np.arcsin(x) + (2.0 - 3.0 * lobe) * tilt
        for side in (1.0, -1.0):
            inclined = np.sin(theta), np.cos(theta), side * np.sin(view), np.cos(view)
            M = longitudinal(*inclined, np.array(0.01))
            title = (
                f"light of {name}, variance 0.01, seen at {side * view} radian, tilted by 2 degrees"
            )
            rows.append((title, (w * M).sum(), 1))
    return _table(rows, "{:.3f}")


def _white_hair():
    """Integral of the values of the default node over all lights, for a view along the normal."""
    x, w = np.polynomial.legendre.leggauss(200)
    phi = 2.0 * np.pi * (np.arange(800) + 0.5) / 800
    sine, angle = (each.ravel() for each in np.meshgrid(x, phi))
    cosine = np.sqrt(1.0 - sine * sine)
    wi = np.stack([sine, cosine * np.cos(angle), cosine * np.sin(angle)], axis=-1)
    values = chiang_hair_bcsdf([0.0, 0.0, 1.0], wi)[:, 0]
    return (np.tile(w, 800) * values).sum() * 2.0 * np.pi / 800


def tables_block():
    """Defaults of the node definitions, and those that the text has."""
    library = load_library(STOCK)
    printed = (
        ("artistic_ior", "reflectivity", "0.947, 0.776, 0.371"),
        ("artistic_ior", "edge_color", "1.0, 0.982, 0.753"),
        ("glossiness_anisotropy", "glossiness", "0.0"),
    )
    rows = []
    for node, port, default in printed:
        [definition] = library.getMatchingNodeDefs(node)
        rows.append(
            (f"default of {node}.{port}", definition.getInput(port).getValueString(), default)
        )
    return _table(rows, "{}")


def less_than_block():
    """Whether an XML parser reads the name of a tiled image that MaterialX has written."""
    document = mx.createDocument()
    document.addNode("image", "tiles", "color3").setInputValue("file", "a.<UDIM>.png", "filename")
    try:
        expat.ParserCreate().Parse(mx.writeToXmlString(document), True)
        read = 1
    except expat.ExpatError:
        read = 0
    return _table([("documents, of 1, that another XML parser reads", read, 1)], "{}")


def struct_block():
    """Whether a color of a struct has GLSL's word of type."""
    [shader] = generate(STRUCT, "glsl", library=STOCK, policy=Policy(code=True))
    right = int("struct pair { vec3 b; " in shader.stages["pixel"])
    return _table([("members, of 1, with a type that GLSL has", right, 1)], "{}")


def names_block():
    """Whether two nodes of one name have their own values in a shader."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DocumentWarning)
        [shader] = generate(NAMES, "glsl", library=STOCK, element="shown")
    values = {port.value for port in shader.inputs if port.name.startswith("tint_in")}
    return _table([("values, of 2, of two nodes `tint`", len(values), 2)], "{}")


def material_block():
    """Whether the shader of a material that a nodegraph defines has its lobe."""
    [shader] = generate(MATERIAL, "glsl", library=STOCK)
    lobes = int("void mx_oren_nayar_diffuse_bsdf(" in shader.stages["pixel"])
    return _table([("lobes of the material, of 1, in its shader", lobes, 1)], "{}")


def _direction(mu, azimuth):
    """A unit vector by its cosine and azimuth."""
    radius = np.sqrt(1.0 - mu * mu)
    return np.array([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])


def _table(rows, form):
    """The block of a page, from quantities with measured and expected numbers."""
    lines = []
    for name, *values in rows:
        text = [each if isinstance(each, str) else form.format(each) for each in values]
        lines.append(f"| {name} | {text[0]} | {text[1]} |\n")
    return HEAD + "".join(lines)


OF_PBRLIB = {
    "genglsl_anisotropic_environment": anisotropic_environment_block,
    "material_graphs": material_block,
    "pbrlib_anisotropic_masking": anisotropic_masking_block,
    "pbrlib_energy": energy_block,
    "pbrlib_hair_energy": hair_block,
    "pbrlib_tables": tables_block,
    "same_names": names_block,
    "struct_members": struct_block,
    "xml_less_than": less_than_block,
}
