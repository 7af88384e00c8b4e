# SPDX-License-Identifier: Apache-2.0
"""Albedo inversion as MaterialX nodes: on every target, and right where it runs."""

import re

import MaterialX as mx
import numpy as np
import pytest

from mxeon.models.diffuse.formulas import C1, C2
from mxeon.models.diffuse.inversion import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal
from mxeon.shaders.generation import TARGETS, generate
from mxeon.shaders.library import documents_folder, examples_folder
from mxeon.shaders.scene import FURNACE, Scene
from tests.support.documents import material
from tests.support.tolerances import INVERSION_NODE

NODES = {
    "eon_rho_from_albedo_normal": eon_rho_from_albedo_normal,
    "eon_rho_from_albedo_avg": eon_rho_from_albedo_avg,
}
FRONT = Scene("front", light=(0.0, 0.0, 1.0), size=9)


def smooth_surface(node, color, roughness):
    """A Lambertian that shows what the node gives."""
    channels = ", ".join(map(str, color))
    return material(f"""<{node} name="rho" type="color3">
        <input name="color" type="color3" value="{channels}"/>
        <input name="roughness" type="float" value="{roughness}"/></{node}>
      <eon_diffuse_bsdf name="lobe" type="BSDF">
        <input name="color" type="color3" nodename="rho"/></eon_diffuse_bsdf>""")


@pytest.fixture(scope="module", params=["gl", "cycles", "reference"])
def host(request, hosts):
    return hosts(request.param)


@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("color", [(0.8, 0.4, 0.1), (0.0, 0.5, 1.0)], ids=str)
@pytest.mark.parametrize("node", NODES)
def test_the_node_is_the_function(host, node, color, roughness):
    text = smooth_surface(node, color, roughness)
    options = {"profile": host.profile, "lights": host.target == "glsl"}
    shader = generate(text, host.target, **options)[0]
    centre = host.picture(shader, FRONT)[4, 4]
    assert np.abs(centre - NODES[node](color, roughness)).max() <= INVERSION_NODE


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("node", NODES)
def test_the_node_reaches_the_lobe_on_every_target(node, target):
    text = generate(smooth_surface(node, (0.5, 0.5, 0.5), 0.5), target)[0].stages["pixel"]
    assert len(re.findall(r"\brho_out\b", text)) >= 2


def test_the_decimals_are_the_constants():
    text = (documents_folder("diffuse") / "eonlib_ng.mtlx").read_text(encoding="utf-8")
    decimals = {float(value) for value in re.findall(r'value="(0\.\d{6,})"', text)}
    assert decimals == {C1, C2, C1 - C2, 4.0 * C2}


def test_the_graphs_hold_standard_nodes_alone():
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(documents_folder("diffuse") / "eonlib_ng.mtlx"))
    found = {node.getCategory() for graph in document.getNodeGraphs() for node in graph.getNodes()}
    assert found <= {"add", "convert", "divide", "invert", "multiply", "sqrt"}


def test_the_example_keeps_its_color_while_roughness_grows(gl):
    shaders = generate(examples_folder() / "constant_color.mtlx", "glsl", lights=True)
    scene = Scene("furnace", environment=FURNACE.environment, size=9)
    seen = [gl.picture(shader, scene)[4, 4] for shader in shaders]
    assert len(seen) == 3
    assert np.abs(np.array(seen) - [0.62, 0.28, 0.16]).max() <= INVERSION_NODE
