# SPDX-License-Identifier: Apache-2.0
"""Pictures of documents: what their bounds carry, and what a failure says."""

import pytest

from mxeon.conformance.pictures import judge_document
from mxeon.conformance.reference import Host as Reference
from mxeon.hosts import open_host
from mxeon.shaders.nodes import SURFACE, document_text

FILM = """<generalized_schlick_bsdf name="lobe" type="BSDF">
  <input name="color0" type="color3" value="0.04, 0.04, 0.04"/>
  <input name="roughness" type="vector2" value="0, 0"/>
  <input name="thinfilm_thickness" type="float" value="550"/>
  <input name="thinfilm_ior" type="float" value="1.5"/>
</generalized_schlick_bsdf>"""
# A nodegraph with a color, by its own name and the name of its node.
COLOR = """<nodegraph name="{graph}">
  <multiply name="{node}" type="color3">
    <input name="in1" type="color3" value="{color}"/>
    <input name="in2" type="float" value="0.5"/>
  </multiply>
  <output name="out" type="color3" nodename="{node}"/>
</nodegraph>"""
SUM = """<oren_nayar_diffuse_bsdf name="lobe1" type="BSDF">
  <input name="weight" type="float" value="0.5"/>
  <input name="color" type="color3" nodegraph="red" output="out"/>
</oren_nayar_diffuse_bsdf>
<oren_nayar_diffuse_bsdf name="lobe2" type="BSDF">
  <input name="weight" type="float" value="0.5"/>
  <input name="color" type="color3" nodegraph="green" output="out"/>
</oren_nayar_diffuse_bsdf>
<add name="lobe" type="BSDF">
  <input name="in1" type="BSDF" nodename="lobe1"/>
  <input name="in2" type="BSDF" nodename="lobe2"/>
</add>"""


def colors(first, second):
    """Two lobes with colors from two nodegraphs, whose nodes have these names."""
    red = COLOR.format(graph="red", node=first, color="1, 0, 0")
    green = COLOR.format(graph="green", node=second, color="0, 1, 0")
    return document_text(red + green + SUM + SURFACE)


@pytest.fixture(scope="module")
def host():
    with open_host("gl") as engine:
        yield engine


def judged(host, tmp_path, text):
    path = tmp_path / "shown.mtlx"
    path.write_text(text)
    results, _, notes = judge_document(path, host, Reference(), "eonlib")
    [result] = results
    return result, notes


def test_a_film_of_the_index_of_its_schlick_substrate_has_one_phase(host, tmp_path):
    result, _ = judged(host, tmp_path, document_text(FILM + SURFACE))
    assert result.verdict == "passed"
    assert result.error < 1e-4  # the phase of a denser film is off by 0.17


def test_a_truth_value_is_drawn_white_or_black(host, tmp_path):
    text = """<materialx version="1.39"><nodegraph name="logic">
      <and name="both" type="boolean">
        <input name="in1" type="boolean" value="true"/><input name="in2" type="boolean" value="true"/>
      </and><output name="shown" type="boolean" nodename="both"/></nodegraph></materialx>"""
    result, _ = judged(host, tmp_path, text)
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("shown",))


def test_nodes_of_one_name_in_two_nodegraphs_are_named(host, tmp_path):
    result, notes = judged(host, tmp_path, colors("tint", "tint"))
    assert result.verdict == "failed"
    assert 'nodes "red/tint" and "green/tint" have the values of one' in result.diagnosis
    assert any("must have different names" in text for text, _ in notes)
