# SPDX-License-Identifier: Apache-2.0
"""The OSL host evaluates closure trees, supports the profile for Cycles, and reports errors."""

import re
from dataclasses import replace

import numpy as np
import pytest

from mxeon import models
from mxeon.errors import ShaderError
from mxeon.models.media import conical_edf
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import connection_text, document_text, material_text, node_text
from tests.support.cases import directions

WO = np.tile([0.6, 0.0, 0.8], (5, 1))
COLORS = np.linspace(0.0, 1.0, 15).reshape(5, 3).astype(np.float32).astype(np.float64)


def shader(node="burley_diffuse_bsdf", **inputs):
    [made] = generate(material_text(node, inputs, node), "osl")
    return made


def altered(made, old, new):
    text = made.stages["pixel"]
    assert old in text
    return replace(made, stages={"pixel": text.replace(old, new)})


def names(tree):
    if tree is None:
        return []
    return [tree.name, *(each for part in tree.parts for each in names(part))]


@pytest.fixture
def host(hosts):
    return hosts("osl")


def test_it_names_the_versions_of_osl_and_of_blender(host):
    version = host.identity().version
    assert re.fullmatch(r"OSL 1\.\d+\.\d+ in Blender 5\.\d+\.\d+", version)


def test_the_arguments_of_a_closure_are_those_of_the_document_to_the_last_bit(host):
    inputs = {"color": COLORS, "roughness": np.float32(0.1), "weight": np.float32(1.0 / 3.0)}
    [points] = host.trees(shader(), WO, inputs)
    closures = "add mul add mul burley_diffuse_bsdf mul transparent"
    assert names(points.tree) == closures.split()
    weighed = points.tree.parts[0].parts[0].parts[0]
    assert np.array_equal(weighed.arguments["factor"], np.full(5, np.float32(1.0 / 3.0)))
    assert np.array_equal(weighed.parts[0].arguments["color"], COLORS)
    assert np.array_equal(weighed.parts[0].arguments["roughness"], np.full(5, np.float32(0.1)))


def test_points_whose_closures_differ_have_trees_of_their_own(host):
    many = host.trees(shader("dielectric_bsdf"), WO, {"ior": np.array([0.0, 1.5, 1.5, 0.0, 1.5])})
    rows = {names(points.tree)[4]: points.rows.tolist() for points in many}
    assert rows == {"generalized_schlick_bsdf": [0, 3], "dielectric_bsdf": [1, 2, 4]}


FILM = "keyword of burley_diffuse_bsdf must be one of label; got 'film'"
UNMATCHED = "osl: .*(No matching function call|lobe_out = unknown)"
OTHER = r"closure must be one of .*; got '\(1, 1, 1\) \* diffuse"


@pytest.mark.parametrize(
    "new, message", [(', "film", 1.0)', FILM), (", 1.0)", UNMATCHED), (") + diffuse(N)", OTHER)]
)
def test_what_no_closure_takes_fails_with_its_words(host, new, message):
    with pytest.raises(ShaderError, match=message):
        host.trees(altered(shader(), "lobe_roughness)", f"lobe_roughness{new}"), WO, {})


# --- closures of the profile for Cycles, as Cycles evaluates them --------------------------------

COUNT = 256


def weighed(tree, factor=1.0):
    """Closures of a tree that scatter or emit, each with the product of the weights above."""
    if tree is None or tree.name == "transparent":
        return []
    if not tree.parts:
        return [(factor, tree)]
    own = np.asarray(tree.arguments.get("factor", 1.0))
    factor = factor * (own.reshape(-1, 1) if own.ndim == 1 else own)
    return [each for part in tree.parts for each in weighed(part, factor)]


def for_cycles(host, node, wo, inputs, old="", new=""):
    kind = "EDF" if node.endswith("edf") else "BSDF"
    bound = connection_text(kind.lower(), kind, "lobe")
    surface = node_text("surface", "surfaceshader", "shading", bound)
    text = document_text(node_text(node, kind, "lobe") + surface)
    [made] = generate(text, "osl", profile="cycles")
    found = host.trees(altered(made, old, new) if old else made, wo, inputs)
    return [(each.rows, *leaf) for each in found for leaf in weighed(each.tree)]


@pytest.mark.filterwarnings("ignore::mxeon.shaders.generation.ApproximationWarning")
@pytest.mark.parametrize(
    ("node", "flag", "model", "largest"),
    [
        ("eon_diffuse_bsdf", None, models.eon_brdf, 1.0),
        ("oren_nayar_diffuse_bsdf", 1, models.eon_brdf, 1.0),
        ("oren_nayar_diffuse_bsdf", 0, models.qon_brdf, 0.5 * np.pi),
    ],
)
def test_the_closures_for_cycles_are_the_model_to_the_roundings(host, node, flag, model, largest):
    """Cycles' EON has one factor of albedo too many. Cycles' QON is correct only for s >= 0."""
    rng = np.random.default_rng(1)
    wo, wi = directions((2, COUNT), rng)
    wi[:, :2] *= np.where((wo[:, :2] * wi[:, :2]).sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
    inputs = {"weight": rng.random(COUNT), "color": rng.random((COUNT, 3))}
    inputs["roughness"] = largest * rng.random(COUNT) ** 2
    inputs = {name: np.float64(np.float32(each)) for name, each in inputs.items()}
    if flag is not None:
        inputs["energy_compensation"] = np.full(COUNT, flag)
    total = np.zeros((COUNT, 3))
    for rows, factor, closure in for_cycles(host, node, wo, inputs):
        color, rough = closure.arguments["color"], closure.arguments["roughness"]
        inputs_here = wo[rows], wi[rows], color, rough
        fon, eon = models.fon_brdf(*inputs_here), models.eon_brdf(*inputs_here)
        total[rows] += factor * (fon + color * (eon - fon))
    expected = inputs["weight"][:, np.newaxis] * model(wo, wi, inputs["color"], inputs["roughness"])
    error = np.pi * wi[:, 2:] * np.abs(total - expected)
    assert error.max() <= 4 * 2.0**-24


@pytest.mark.parametrize("soft", [True, False])
def test_the_cone_for_cycles_is_the_model_on_both_sides(host, soft):
    """In Cycles, unlike in OSL, `I` points to the viewer and the normal faces the viewer."""
    rng = np.random.default_rng(1)
    wo, inner = directions(COUNT, rng), 170.0 * rng.random(COUNT)
    wo[::2, 2] *= -1.0
    outer = inner + 60.0 * rng.random(COUNT) + 1.0 if soft else inner * rng.random(COUNT)
    inputs = {"color": rng.random((COUNT, 3)), "inner_angle": inner, "outer_angle": outer}
    inputs = {name: np.float64(np.float32(each)) for name, each in inputs.items()}
    turned = {**inputs, "normal": np.sign(wo[:, 2:]) * [[0.0, 0.0, 1.0]]}
    total = np.zeros((COUNT, 3))
    change = "backfacing()", "(dot(vector(0.0, 0.0, 1.0), I) < 0.0)"
    for rows, factor, closure in for_cycles(host, "conical_edf", -wo, turned, *change):
        total[rows] += factor * closure.arguments["color"]
    angles = (inputs["inner_angle"], inputs["outer_angle"])
    assert np.abs(total - conical_edf(wo, inputs["color"], *angles)).max() <= 1e-5


def test_the_walk_for_cycles_has_the_albedo_in_its_weight(host):
    """The weight must contain the albedo, because Cycles divides the light by the albedo."""
    rng = np.random.default_rng(1)
    inputs = {"weight": rng.random(COUNT), "color": rng.random((COUNT, 3))}
    inputs |= {"radius": rng.random((COUNT, 3)), "anisotropy": 2.0 * rng.random(COUNT) - 1.0}
    inputs = {name: np.float64(np.float32(each)) for name, each in inputs.items()}
    inputs["normal"] = np.float64(np.float32(directions(COUNT, rng)))
    [(rows, factor, closure)] = for_cycles(host, "subsurface_bsdf", directions(COUNT, rng), inputs)
    assert closure.name == "subsurface_bssrdf" and len(rows) == COUNT
    for name in ("color", "radius", "anisotropy", "normal"):
        assert np.array_equal(closure.arguments[name], inputs[name][rows]), name
    expected = (inputs["weight"][:, np.newaxis] * inputs["color"])[rows]
    assert np.abs(factor - expected).max() <= 2.0**-24
