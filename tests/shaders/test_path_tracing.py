# SPDX-License-Identifier: Apache-2.0
"""Shaders for path tracers: values match the rasterizer, and densities match the samples.

`mxeon check` judges every node by the checks `pdf`, `sample`, `path_value` and `path_inside`. These
tests use more samples than `mxeon check`, and cover edge cases and surface shaders.
"""

import shutil
from functools import partial

import numpy as np
import pytest

from mxeon.conformance.checks.paths import deviation, paths, random, refracted
from mxeon.errors import InputError, InterfaceError
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import connection_text, document_text, material_text, node_text
from tests.support.availability import program
from tests.support.cases import direction
from tests.support.command import output
from tests.support.documents import material, surface
from tests.support.verdicts import PASSED
from tests.support.wrong_libraries import copy_of_eonlib
from tools.benchmarks import glass

DEVIATION = 5.0  # standard deviations, exceeded by chance once in 3.5 million tests
COLOR = {"color": (0.8, 0.4, 0.2)}
ROUGH, DARK = {"roughness": (0.5, 0.3)}, (0.1, 0.05, 0.02)
FIBER = {"roughness_R": (0.3, 0.4), "roughness_TT": (0.1, 0.3), "roughness_TRT": (0.5, 0.6)}
FIBER |= {"cuticle_angle": 0.7, "absorption_coefficient": (0.1, 0.3, 0.5)}
# Nodes of every kind. `mxeon check` tests no samples of films, of retroreflection, or of an index
# of refraction below 1.
NODES = {
    "diffuse": ("oren_nayar_diffuse_bsdf", COLOR | {"roughness": 0.7, "energy_compensation": True}),
    "zeltner": ("sheen_bsdf", COLOR | {"roughness": 0.4, "mode": "zeltner"}),
    "glass": ("dielectric_bsdf", ROUGH | {"scatter_mode": "T"}),
    "soap": ("dielectric_bsdf", ROUGH | {"scatter_mode": "RT", "thinfilm_thickness": 400.0}),
    "bubble": ("dielectric_bsdf", ROUGH | {"scatter_mode": "RT", "ior": 0.7}),
    "reflector": ("dielectric_bsdf", ROUGH | {"retroreflective": True}),
    "steel": ("conductor_bsdf", ROUGH | {"thinfilm_thickness": 400.0}),
    "schlick": ("generalized_schlick_bsdf", ROUGH | {"scatter_mode": "RT", "color0": DARK}),
    "hair": ("chiang_hair_bsdf", FIBER),
}
BASE, WARM, COOL = (0.8, 0.5, 0.3), (1.0, 0.9, 0.8), (0.5, 0.6, 1.0)
GREEN, YELLOW = (0.6, 0.9, 0.8), (0.9, 0.95, 0.7)
SURFACES = {
    "standard_surface": {
        "base_color": BASE, "diffuse_roughness": 0.4, "metalness": 0.3, "specular": 0.9, "specular_color": WARM,
        "specular_roughness": 0.35, "specular_anisotropy": 0.4, "specular_rotation": 0.1, "transmission": 0.3,
        "transmission_color": GREEN, "transmission_extra_roughness": 0.1, "subsurface": 0.3, "sheen": 0.5,
        "sheen_color": COOL, "sheen_roughness": 0.4, "coat": 0.5, "coat_color": YELLOW, "coat_roughness": 0.25,
        "coat_anisotropy": 0.2, "thin_film_thickness": 400.0, "emission": 0.2, "opacity": (0.8, 0.8, 0.8),
    },
    "open_pbr_surface": {
        "base_color": BASE, "base_diffuse_roughness": 0.5, "base_metalness": 0.3, "specular_weight": 0.9,
        "specular_color": WARM, "specular_roughness": 0.5, "specular_roughness_anisotropy": 0.4,
        "transmission_weight": 0.3, "transmission_color": GREEN, "subsurface_weight": 0.3, "fuzz_weight": 0.5,
        "fuzz_color": COOL, "coat_weight": 0.5, "coat_color": YELLOW, "coat_roughness": 0.4,
        "coat_roughness_anisotropy": 0.2, "thin_film_weight": 0.5, "emission_luminance": 0.2, "geometry_opacity": 0.8,
    },
    "gltf_pbr": {
        "base_color": BASE, "metallic": 0.3, "roughness": 0.5, "transmission": 0.3, "specular": 0.9,
        "specular_color": WARM, "sheen_color": COOL, "sheen_roughness": 0.5, "clearcoat": 0.5,
        "clearcoat_roughness": 0.4, "emissive": (0.2, 0.1, 0.0), "iridescence": 0.5, "iridescence_thickness": 400.0,
        "anisotropy_strength": 0.4, "alpha": 0.8, "alpha_mode": "2",
    },
    "UsdPreviewSurface": {
        "diffuseColor": BASE, "emissiveColor": (0.1, 0.1, 0.0), "metallic": 0.3, "roughness": 0.5, "clearcoat": 0.5,
        "clearcoatRoughness": 0.4, "opacity": 0.8,
    },
}  # fmt: skip


DOCUMENTS = {name: material_text(*row) for name, row in NODES.items()}
DOCUMENTS |= {name: surface(name, **inputs) for name, inputs in SURFACES.items()}
view = partial(direction, phi=0.3)
# Graphics drivers take seconds to compile a surface shader.
SURFACE_NAMES = [pytest.param(name, marks=pytest.mark.whole) for name in SURFACES]
every_document = pytest.mark.parametrize("name", [*NODES, *SURFACE_NAMES])


def uniforms(count, seed=1):
    return random(count, np.random.default_rng(seed))


def directions(rng, count):
    w = rng.normal(size=(count, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)


@pytest.fixture(scope="module")
def materials(gl):
    """Function that compiles the material of a named document. Each material is compiled once."""
    known = {}
    return lambda name: known.setdefault(name, paths(gl, DOCUMENTS[name]))


@pytest.mark.parametrize("mu, count", [(0.1, 1 << 16), (0.9, 1 << 18)])
@pytest.mark.parametrize("name", SURFACE_NAMES)
def test_draws_have_their_density(materials, name, mu, count):
    material, wo = materials(name), view(mu)
    drawn = material.values("wi", wo, u=uniforms(count))
    # Light that passes straight through the surface has no density, so its samples are not counted.
    if material.values("opacity", wo)[0, 0] < 1.0:
        drawn = drawn * (np.linalg.norm(drawn + wo, axis=1, keepdims=True) >= 1e-6)
    apart = deviation(
        drawn,
        lambda w: material.values("pdf", wo, w)[:, 0],
        refracted(wo, 1.5),
        wo * [-1.0, -1.0, 1.0],
    )
    assert apart < DEVIATION


# Errors of the rasterizer's albedo, in addition to the noise of 2^16 samples. The albedos of films
# are fits, and tilted hair fibers have no closed form.
ALBEDO_ERRORS = {"soap": 0.07, "bubble": 0.05, "steel": 0.08, "hair": 0.2}


@pytest.mark.whole
@every_document
def test_a_furnace_by_sampling_is_the_albedo(gl, materials, name):
    wo = view(0.8)
    [shader] = generate(DOCUMENTS[name], "glsl")
    branches = ("environment", "transmission")
    pair = np.float32([wo]), np.float32([wo])
    albedo = sum(gl.evaluate(shader, *pair, {}, each)[0] for each in branches)
    opacity = materials(name).values("opacity", wo)[0, 0]
    weights = materials(name).values("weight", wo, u=uniforms(1 << 16))
    noise = 5.0 * weights.std(axis=0) / 2.0**8
    error = abs(weights.mean(axis=0) - (1.0 - opacity) - opacity * albedo)
    assert (error < noise + ALBEDO_ERRORS.get(name, 5e-3)).all()


@pytest.mark.whole
@pytest.mark.parametrize("angle", [0.3, 0.7, 0.95])
def test_draws_of_hair_find_the_light_that_tilted_cuticles_fold(gl, angle):
    material = paths(gl, material_text("chiang_hair_bsdf", FIBER | {"cuticle_angle": angle}))
    wo = np.array([-0.64, 0.1, np.sqrt(1.0 - 0.64**2 - 0.1**2)])
    w = directions(np.random.default_rng(2), 1 << 18)
    values, densities = (4.0 * np.pi * material.values(what, wo, w) for what in ("evaluate", "pdf"))
    weights = material.values("weight", wo, u=uniforms(1 << 16))
    noise = 5.0 * np.hypot(values.std(axis=0) / 2.0**9, weights.std(axis=0) / 2.0**8)
    assert (abs(values.mean(axis=0) - weights.mean(axis=0)) < noise).all()
    assert (abs(densities.mean(axis=0) - 1.0) < 5.0 * densities.std(axis=0) / 2.0**9).all()


# Random walks through a glass ball: variance divided by the squared mean, and largest weight.
VARIANCES = {
    "dielectric_bsdf, 0.1": (0.036, 1.83),
    "dielectric_bsdf, 0.4": (0.21, 1.8),
    "dielectric_bsdf, 1.0": (0.3, 2.1),
    "generalized_schlick_bsdf, 0.4": (0.21, 1.8),
    "standard_surface, 0.4": (0.5, 2.43),
    "open_pbr_surface, 0.4": (0.5, 2.28),
}


@pytest.mark.whole
@pytest.mark.parametrize("name", VARIANCES)
def test_walks_through_rough_glass_vary_little(gl, name):
    total, largest = glass.walks(paths(gl, glass.ROWS[name]), np.random.default_rng(1))
    variance, weight = VARIANCES[name]
    assert total.var() < 1.05 * variance * total.mean() ** 2
    assert largest < 1.05 * weight


@pytest.mark.parametrize("inside", [False, True])
@every_document
def test_no_answer_is_nan(materials, name, inside):
    for mu in (1.0, 1e-3, 1e-7):
        ask = partial(materials(name).values, wo=view(mu), inside=inside)
        for what in ("wi", "weight", "density"):
            assert np.isfinite(ask(what, u=uniforms(2048))).all()
        w = directions(np.random.default_rng(5), 2048)
        w[:2] = view(mu), -view(mu)
        for what in ("pdf", "evaluate", "emission"):
            assert np.isfinite(ask(what, wi=w)).all()


@pytest.mark.whole
def test_no_edge_of_an_input_is_nan(gl):
    roughnesses = {"roughness": (0.0, 0.0)}, {"roughness": (1.0, 1e-5)}
    for each in (*roughnesses, {"ior": 0.0}, {"ior": 1.0}, {"weight": 0.0}):
        material = paths(gl, material_text("dielectric_bsdf", {"scatter_mode": "RT"} | each))
        for what in ("wi", "weight", "density"):
            assert np.isfinite(material.values(what, view(0.5), u=uniforms(2048))).all()


def test_other_text_does_not_change(tmp_path):
    documents = copy_of_eonlib(tmp_path)
    shutil.rmtree(tmp_path / "genglsl" / "path")
    for document in map(DOCUMENTS.get, SURFACES):
        [with_path] = generate(document, "glsl")
        [without] = generate(document, "glsl", library=str(documents))
        assert with_path.stages == without.stages


MAIN = """
void main()
{
    Point p = Point(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), vec2(0.0), false);
    vec3 wi;
    vec3 weight;
    float pdf;
    material_sample(p, p.normal, vec3(0.5), wi, weight, pdf);
    color = vec4(weight + material_evaluate(p, wi, wi) + material_emitted(p, wi), pdf + material_pdf(p, wi, wi));
}
"""
VERSIONS = {
    "essl": "#version 300 es\nprecision highp float;\nout vec4 color;\n",
    "vulkan": "#version 450\nlayout (location = 0) out vec4 color;\n",
}


@pytest.mark.parametrize("target", VERSIONS)
@pytest.mark.parametrize("name", SURFACES)
def test_the_text_compiles_for_other_targets(tmp_path, target, name):
    [shader] = generate(DOCUMENTS[name], target, profile="path")
    file = tmp_path / "path.frag"
    file.write_text(VERSIONS[target] + shader.stages["pixel"] + MAIN, encoding="utf-8")
    options = ["-V", "-o", tmp_path / "path.spv"] if target == "vulkan" else []
    output(program("glslangValidator"), *options, file)


@pytest.mark.parametrize("host", ["gl", "vulkan", "webgl", "slang"])
def test_hosts_draw_by_their_density(judged, host):
    result = judged("pdf", "dielectric_bsdf, scatter_mode RT", host)
    assert result.verdict == PASSED and result.control.caught


def test_mixed_surfaces_are_refused():
    nodes, ports = "", ""
    for name in ("fg", "bg"):
        nodes += node_text("standard_surface", "surfaceshader", name)
        ports += connection_text(name, "surfaceshader", name)
    nodes += node_text("mix", "surfaceshader", "shading", ports)
    with pytest.raises(InterfaceError, match="one surface"):
        generate(document_text(nodes), "glsl", profile="path")


OWN = """<materialx version="1.39">
  <nodedef name="ND_own" node="own"><output name="out" type="BSDF"/></nodedef>
  <implementation name="IM_own" nodedef="ND_own" target="genglsl" file="own.glsl" function="own"/>
  <nodedef name="ND_outer" node="outer"><output name="out" type="BSDF"/></nodedef>
  <nodegraph name="NG_outer" nodedef="ND_outer">
    <own name="inner" type="BSDF"/><output name="out" type="BSDF" nodename="inner"/>
  </nodegraph>
</materialx>"""


@pytest.mark.parametrize("category", ["own", "outer"])
def test_a_bsdf_whose_code_has_no_sampler_is_refused(category, tmp_path):
    (tmp_path / "own.mtlx").write_text(OWN)
    code = "void own(ClosureData closureData, inout BSDF bsdf)\n{\n}\n"
    (tmp_path / "own.glsl").write_text(
        f'#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"\n\n{code}'
    )
    text, policy = (
        material(node_text(category, "BSDF", "lobe")),
        Policy(definitions=(str(tmp_path),)),
    )
    generate(text, "glsl", policy=policy)
    with pytest.raises(InterfaceError, match="the BSDF own must be a graph"):
        generate(text, "glsl", profile="path", policy=policy)


@pytest.mark.parametrize(("target", "library"), [("osl", "eonlib"), ("glsl", "stock")])
def test_what_lacks_the_interface_is_refused(target, library):
    with pytest.raises(InputError, match="path"):
        generate(DOCUMENTS["diffuse"], target, profile="path", library=library)
