# SPDX-License-Identifier: Apache-2.0
"""Shaders list inputs of every type as plain Python values, which hosts can change."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import TARGETS, generate
from mxeon.shaders.scene import FURNACE
from tests.support.documents import connected, material

STRUCTURES = """<typedef name="pair"><member name="x" type="float" value="0.5"/>
    <member name="y" type="float" value="0.25"/></typedef>
  <typedef name="nest"><member name="p" type="pair" value="{0.5;0.5}"/>
    <member name="z" type="float" value="1"/></typedef>
  <nodedef name="ND_pick" node="pick"><input name="in" type="nest" value="{{0;0};0}"/>
    <output name="out" type="float" value="0"/></nodedef>"""
STRUCTURES += "".join(
    f'<implementation name="IM_{each}" nodedef="ND_pick" target="gen{each}" '
    'sourcecode="{{in}}.p.y"/>'
    for each in ("glsl", "msl", "osl", "mdl", "slang")
)
PICK = f"""{STRUCTURES}<pick name="pick" type="float">
    <input name="in" type="nest" value="{{{{0.75;0.5}};2}}"/></pick>"""
PICK += connected(weight='nodename="pick"')
NODE = """<transformmatrix name="t" type="vector{size}">
    <input name="in" type="vector{size}" value="{vector}"/>
    <input name="mat" type="matrix{size}{size}" value="{matrix}"/></transformmatrix>
  <separate{size} name="s" type="multioutput">
    <input name="in" type="vector{size}" nodename="t"/></separate{size}>"""
NODE += connected(weight='nodename="s" output="outy"')
MATRICES = {
    size: NODE.format(
        size=size,
        vector=", ".join(["0.1", "0.2", "0.3", "0.4"][:size]),
        matrix=", ".join(str(each / 32) for each in range(size * size)),
    )
    for size in (3, 4)
}
TRUSTED = Policy(code=True)
pytestmark = pytest.mark.filterwarnings("ignore:.*contains its own code")


@pytest.mark.parametrize("target", TARGETS)
def test_a_public_structure_is_the_tuple_of_its_members(target):
    [shader] = generate(material(PICK), target, policy=TRUSTED)
    assert {each.path: each.value for each in shader.inputs}["pick/in"] == ((0.75, 0.5), 2.0)


@pytest.mark.parametrize("size", MATRICES)
@pytest.mark.parametrize("target", TARGETS)
def test_a_public_matrix_is_its_numbers_row_after_row(target, size):
    [shader] = generate(material(MATRICES[size]), target)
    expected = tuple(each / 32 for each in range(size * size))
    assert {each.path: each.value for each in shader.inputs}["t/mat"] == expected


@pytest.fixture(scope="module", params=["gl", "webgl"])
def host(request, hosts):
    return hosts(request.param)


def brightness(host, nodes, **values):
    """Brightness of a material in a white furnace. `values` maps paths of inputs to values."""
    found = generate(material(nodes), host.target, lights=True, policy=TRUSTED)[0]
    inputs = (replace(each, value=values.get(each.path, each.value)) for each in found.inputs)
    shader = replace(found, inputs=tuple(inputs))
    return float(host.picture(shader, replace(FURNACE, size=16))[8, 8, 0]) / 0.18


@pytest.mark.parametrize("size", MATRICES)
def test_a_host_sets_a_matrix(host, size):
    matrix = np.arange(size * size).reshape(size, size) / 32
    vector = np.array([0.1, 0.2, 0.3, 0.4])[:size]
    assert brightness(host, MATRICES[size]) == pytest.approx((vector @ matrix)[1], rel=1e-5)
    other = {"t/mat": tuple(matrix.T.ravel())}
    transposed = brightness(host, MATRICES[size], **other)
    assert transposed == pytest.approx((matrix @ vector)[1], rel=1e-5)


def test_a_host_sets_the_members_of_a_structure(host):
    assert brightness(host, PICK) == pytest.approx(0.5, rel=1e-5)
    other = {"pick/in": ((0.75, 0.25), 2.0)}
    assert brightness(host, PICK, **other) == pytest.approx(0.25, rel=1e-5)
