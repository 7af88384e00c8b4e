# SPDX-License-Identifier: Apache-2.0
"""Nodes, with their modes, that a run finds in documents, nodegraphs and surface shaders."""

import pytest

from mxeon import check
from mxeon.shaders.nodes import connection_text, document_text, input_text, node_text
from tests.support.documents import lobe, material, surface, written
from tests.support.plans import keep_checks

EON, QON = (f"oren_nayar_diffuse_bsdf, energy_compensation {flag}" for flag in ("true", "false"))
GRAPH = """<nodegraph name="graph">
    <eon_diffuse_bsdf name="inner" type="BSDF"/>
    <output name="out" type="BSDF" nodename="inner"/>
  </nodegraph>
  <surface name="shading" type="surfaceshader">
    <input name="bsdf" type="BSDF" nodegraph="graph" output="out"/>
  </surface>
"""


@pytest.fixture(autouse=True)
def nothing_else(monkeypatch):
    """Let runs read documents without checking nodes."""
    keep_checks(monkeypatch, "host")


def titles(text, tmp_path):
    file = written(tmp_path, text)
    return check([file], ["msl"]).contents[str(file)]


@pytest.mark.parametrize(
    "text, expected",
    [
        (material(lobe(energy_compensation=True)), (EON,)),
        (material(lobe()), (QON,)),
        (material(lobe(weight=0.0)), ()),
        (material(lobe("sheen_bsdf")), ("sheen_bsdf, mode conty_kulla",)),
        (material(lobe("sheen_bsdf", mode="zeltner")), ("sheen_bsdf, mode zeltner",)),
        (document_text(GRAPH), ("eon_diffuse_bsdf",)),
    ],
    ids=["flag", "no flag", "no weight", "default mode", "mode", "nodegraph"],
)
def test_a_document_has_its_nodes_in_their_modes(text, expected, tmp_path):
    assert titles(text, tmp_path) == expected


@pytest.mark.parametrize(("thickness", "film"), [(0.0, False), (500.0, True)])
def test_a_film_is_judged_where_there_is_one(thickness, film, tmp_path):
    found = titles(material(lobe("conductor_bsdf", thinfilm_thickness=thickness)), tmp_path)
    assert ("conductor_bsdf, thin film" in found) == film and "conductor_bsdf" in found


def test_lobes_inside_a_surface_shader_count_where_they_have_weight(tmp_path):
    for weight in (0.0, 0.5):
        found = titles(surface("standard_surface", sheen=weight), tmp_path)
        assert {"standard_surface", QON, "dielectric_bsdf, scatter_mode R"} <= set(found)
        assert ("sheen_bsdf, mode conty_kulla" in found) == (weight > 0.0)


EMISSIONS = {
    "standard_surface": {"emission": 1.0},
    "open_pbr_surface": {"emission_luminance": 1.0},
    "gltf_pbr": {"emissive": (1.0, 0.0, 0.0)},
}


@pytest.mark.parametrize("category", EMISSIONS)
@pytest.mark.parametrize("lit", [False, True])
def test_an_emission_counts_where_it_is_not_black(category, lit, tmp_path):
    found = titles(surface(category, **EMISSIONS[category] if lit else {}), tmp_path)
    assert ("surface, a BSDF and an EDF" in found) == ("uniform_edf" in found) == lit
    assert "surface, an EDF alone" not in found


@pytest.mark.parametrize(
    "index, reached",
    [
        (input_text("ior", "float", 1.5), False),
        (input_text("ior", "float", 0.0), True),
        (connection_text("ior", "float", "varies"), True),
    ],
    ids=["constant", "zero", "computed"],
)
def test_a_constant_input_that_a_document_does_not_have_is_not_reached(index, reached, tmp_path):
    varies = '<texcoord name="uv" type="vector2"/><extract name="varies" type="float"><input name="in" type="vector2" nodename="uv"/></extract>'
    glass = node_text("dielectric_bsdf", "BSDF", "lobe", index)
    file = written(tmp_path, material(varies + glass))
    found = check([file], ["msl"]).unreached[str(file)]
    regions = {each.name for each in found["dielectric_bsdf, scatter_mode R"]}
    assert ("index_zero" in regions) != reached
    assert "weight_zero" in regions and "occlusion_not_1" not in regions
