# SPDX-License-Identifier: Apache-2.0
"""White lobes that are mixed above a white base reflect all light."""

import numpy as np
import pytest

from mxeon.shaders import generation
from mxeon.shaders.nodes import Node, connection_text, input_text, network_text
from tests.support.cases import direction
from tests.support.documents import material

FIT = 5.1e-3  # error of the fitted albedo of a dielectric, see docs/loading.md
OPAQUE = ("oren_nayar_diffuse_bsdf", "translucent_bsdf", "subsurface_bsdf")


def lobes(opaque):
    """Nodes to combine: white opaque lobes, dielectrics, and the mix weights `half` and `third`."""
    white = input_text("color", "color3", np.ones(3))
    rough = input_text("roughness", "vector2", (0.3, 0.3))
    return {
        **{f"white{number}": Node(opaque, "BSDF", text=white) for number in range(4)},
        **{f"clear{number}": Node("dielectric_bsdf", "BSDF", text=rough) for number in range(2)},
        "half": Node("multiply", "float", text=input_text("in1", "float", 0.5)),
        "third": Node("multiply", "float", text=input_text("in1", "float", 0.3)),
    }


def mix(first, second, share="half"):
    return Node("mix", "BSDF", (first, second), connection_text("mix", "float", share))


def layer(top, base):
    return Node("layer", "BSDF", (top, base))


SCALED = Node("multiply", "BSDF", ("mask",), input_text("in2", "float", 0.4))
MASK = {"mask": mix("white0", "clear0")}
NESTED = {
    "layer(mix(white, clear), white)": {**MASK, "lobe": layer("mask", "white1")},
    "layer(mix(clear, white), white)": {"mask": mix("clear0", "white0"), "lobe": layer("mask", "white1")},
    "layer(mix(mix(white, clear), white), white)": {
        **MASK, "both": mix("mask", "white1", "third"), "lobe": layer("both", "white2"),
    },
    "layer(mix(layer(clear, white), clear), white)": {
        "in": layer("clear0", "white0"), "mask": mix("in", "clear1"), "lobe": layer("mask", "white1"),
    },
    "mix(layer(mix(white, clear), white), white)": {
        **MASK, "in": layer("mask", "white1"), "lobe": mix("in", "white2", "third"),
    },
    "layer(multiply(mix(white, clear)), white)": {**MASK, "scaled": SCALED, "lobe": layer("scaled", "white1")},
    "layer(mix(white, clear), mix(white, layer(clear, white)))": {
        **MASK, "in": layer("clear1", "white1"), "below": mix("white2", "in", "third"), "lobe": layer("mask", "below"),
    },
}  # fmt: skip


def furnace(gl, monkeypatch, library, folded, opaque, nodes):
    """Light reflected in a white environment. `folded` sets MaterialX's premultipliedBsdfAdd."""
    context_of = generation.context_of

    def context(*arguments):
        made = context_of(*arguments)
        made.getOptions().premultipliedBsdfAdd = folded
        return made

    monkeypatch.setattr(generation, "context_of", context)
    [shader] = gl.compile(material(network_text(lobes(opaque) | nodes)), library=library)
    assert ("lobe_add" in shader.stages["pixel"] or "mask_add" in shader.stages["pixel"]) == folded
    wo = direction([0.05, 0.2, 0.5, 0.9])
    return gl.evaluate(shader, wo, wo, {}, "environment")


CASES = [(name, OPAQUE[0], folded) for name in NESTED for folded in (True, False)]
CASES += [(next(iter(NESTED)), each, True) for each in OPAQUE[1:]]


@pytest.mark.parametrize("name, opaque, folded", CASES)
def test_white_masks_over_white_reflect_all_light(gl, monkeypatch, name, opaque, folded):
    total = furnace(gl, monkeypatch, "eonlib", folded, opaque, NESTED[name])
    np.testing.assert_allclose(total, 1.0, atol=2 * FIT)  # each case has at most two dielectrics


def test_of_stock_they_lose_light_where_the_generator_folds(gl, monkeypatch):
    nodes = next(iter(NESTED.values()))
    assert np.all(furnace(gl, monkeypatch, "stock", True, OPAQUE[0], nodes) < 0.6)
    assert np.all(furnace(gl, monkeypatch, "stock", False, OPAQUE[0], nodes) > 0.97)
