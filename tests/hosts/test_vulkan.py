# SPDX-License-Identifier: Apache-2.0
"""Vulkan and WGSL: uniform blocks, and a text that reaches naga unchanged, with booleans again."""

import struct

import numpy as np
import pytest

from mxeon.hosts import fragment, vulkan
from mxeon.hosts.base import TURN
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text

PAIR, BEHIND = np.array([[[0.6, 0.0, 0.8]], [[-0.6, 0.0, 0.8]]])
BLOCK = """
    mat4 u_envMatrix;
    bool flag;
    vec3 view;
    float u_envLightIntensity;
    structure last;
"""


@pytest.fixture(scope="module")
def host(hosts):
    return hosts("wgsl")


def test_the_text_is_evaluated_as_it_was_generated():
    shader = generate(material_text(OREN_NAYAR, {FLAG: True}), "wgsl")[0]
    text, _ = fragment.bsdf_evaluation(shader, PAIR, PAIR, {}, "direct")
    head, body = shader.stages["pixel"].split("\n", 1)
    assert text.startswith(head) and body in text


def test_an_integer_of_the_text_is_the_boolean_that_it_was(host):
    shader = generate(material_text(OREN_NAYAR, {FLAG: True}), "wgsl")[0]
    inputs = {"color": np.ones((1, 3)), "roughness": np.ones(1)}
    on, off = (
        host.evaluate(shader, PAIR, BEHIND, {**inputs, FLAG: flag}, "direct")
        for flag in (True, False)
    )
    assert (on > off + 0.01).all()


def test_members_of_a_block_lie_where_std140_has_them():
    data = vulkan._std140(BLOCK)
    np.testing.assert_array_equal(struct.unpack_from("<16f", data), TURN.ravel())
    assert struct.unpack_from("<f", data, offset=64 + 16 + 12) == (1.0,)
    assert sum(data[64 + 16 + 16 :]) == 0
