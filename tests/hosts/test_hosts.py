# SPDX-License-Identifier: Apache-2.0
"""Hosts that evaluate direction pairs match the models, identify themselves, and edit no shader."""

import os
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import calls, fragment, open_host
from mxeon.hosts.base import Query
from mxeon.jobs import pool
from mxeon.models import ggx_albedo_dir
from mxeon.models import table as reference
from mxeon.shaders.generation import generate
from mxeon.shaders.methods import UNTABLED, Methods
from mxeon.shaders.nodes import EON, FLAG, OREN_NAYAR, material_text
from tests.support.cases import direction, pairs
from tests.support.documents import lobe, material
from tests.support.tolerances import SUMMED_DIRECTIONS, TWIN_ALBEDO, TWIN_VALUE
from tests.support.wrong_libraries import GLSL, wrong_stock

HOSTS = ("gl", "webgl", "vulkan", "wgsl", "slang")
COUNT = 20_000
PAIR = np.array([[0.6, 0.0, 0.8]])
# SAMPLES_64 is the weight of a sample in an albedo from 64 samples. BETWEEN_TEXELS has the errors
# of interpolated albedos on most hosts, and on slang, which reads the nearest texel.
SAMPLES_64, BETWEEN_TEXELS = 1.0 / 64.0, (1e-3, 0.01)


@pytest.fixture(scope="module", params=HOSTS)
def host(request, hosts):
    return hosts(request.param)


LOBES = (("eon", OREN_NAYAR, {FLAG: True}), ("qon", OREN_NAYAR, {FLAG: False}), ("eon", EON, {}))


def drawn(count=COUNT):
    wo, wi, rho, roughness = (each.astype("f4") for each in pairs(count, 1))
    return wo, wi, {"color": rho, "roughness": roughness}


def of_eon(host):
    [shader] = generate(material_text(EON), host.target, lights=True)
    return shader


def test_the_identity_names_a_version_and_a_device_after_work_too(host):
    host.call("fon_albedo_dir", np.array([0.5]), np.array([0.0]))
    identity = host.identity()
    assert identity.name == host.name and identity.version and identity.device


@pytest.mark.parametrize("model, node, fixed", LOBES)
def test_the_generated_bsdf_is_the_model(host, model, node, fixed):
    [shader] = host.compile(material_text(node, fixed))
    (wo, wi, inputs), row = drawn(), reference.diffuse_model(model)
    rho, roughness = inputs.values()
    values = np.pi * host.evaluate(shader, wo, wi, inputs, "direct")
    expected = np.pi * row.brdf(wo, wi, rho, roughness) * wi[:, 2:]
    np.testing.assert_allclose(values, expected, rtol=0.0, atol=TWIN_VALUE)
    if node == EON:
        twin = np.pi * host.call("eon_brdf", wo, wi, *inputs.values()) * wi[:, 2:]
        np.testing.assert_allclose(twin, expected, rtol=0.0, atol=TWIN_VALUE)
    albedo = host.evaluate(shader, wo, wi, inputs, "environment")
    expected = row.albedo_dir(wo[:, 2], rho, roughness)
    np.testing.assert_allclose(albedo, expected, rtol=0.0, atol=TWIN_ALBEDO)


def test_a_call_may_have_more_elements_than_a_texture_has_rows(host):
    number, count = 13, 1_300_000  # the arguments share a texture of 13 layers with 1,270 rows
    names = [f"a{index}" for index in range(number)]
    source = f"float total({', '.join(f'float {each}' for each in names)}) {{ return {' + '.join(names)}; }}"
    rows = np.arange(count, dtype=np.float64)[:, np.newaxis]
    values = host.execute(source, "total", rows, *[np.ones((1, 1))] * (number - 1))
    np.testing.assert_array_equal(values, np.broadcast_to(rows + number - 1, values.shape))


def test_what_the_compiler_refuses_is_a_shader_error_and_the_host_works_on(host):
    good = of_eon(host)
    wrong = good.stages["pixel"].replace("eon_brdf_mu", "no_such_function", 1)
    bad = replace(good, stages={**good.stages, "pixel": wrong})
    # The error message of naga contains no line number.
    place = "(.|\n)*" if host.name == "wgsl" else ", in oren_nayar_lobe: '.*"
    for flag in (0.25, 0.5):
        words = f"^{host.name}: the shader does not compile{place}eon_brdf_mu"
        with pytest.raises(ShaderError, match=words):
            host.evaluate(bad, PAIR, PAIR, {"weight": flag}, "direct")
    third = replace(good, stages={**good.stages, "pixel": good.stages["pixel"] + "\n"})
    assert host.evaluate(third, PAIR, PAIR, {}, "direct").any()


@pytest.mark.parametrize("branch", calls.CLOSURES)
def test_an_opaque_lobe_lets_no_light_through_in_any_branch(host, branch):
    shader = of_eon(host)
    assert not host.evaluate(shader, PAIR, PAIR, {}, branch, output="throughput").any()
    leaks = shader.stages["pixel"].replace("bsdf.throughput = ", "bsdf.response = ")
    leaky = replace(shader, stages={**shader.stages, "pixel": leaks})
    assert (host.evaluate(leaky, PAIR, PAIR, {}, branch, output="throughput") == 1.0).all()


def test_the_environment_is_looked_up_at_the_normal(host):
    shader = of_eon(host)
    rows = np.linspace(0.0, 1.0, 8)[:, np.newaxis, np.newaxis]
    sky = np.broadcast_to(rows, (8, 16, 3)).astype(np.float32)  # brighter towards the bottom
    inputs = {"color": np.ones((1, 3)), "roughness": np.zeros(1)}
    for up, low, high in ((0.9, 0.0, 0.25), (-0.9, 0.75, 1.0)):
        normal = np.array([[np.sqrt(1.0 - up * up), up, 0.0]])
        turned = {**inputs, "normal": normal}
        values = host.evaluate(shader, normal, normal, turned, "environment", irradiance=sky)
        assert (low <= values).all() and (values <= high).all()


def test_a_lobe_of_microfacets_sums_as_many_directions_on_every_host(host, gl):
    wo, wi, _ = drawn(1 << 10)
    rough = {"roughness": np.linspace(0.05, 1.0, 2 << 10).reshape(-1, 2)}
    values = []
    for each in (host, gl):
        [shader] = each.compile(material_text("dielectric_bsdf"))
        values.append(each.evaluate(shader, wo, wi, rough, "environment"))
    np.testing.assert_allclose(*values, rtol=0.0, atol=SUMMED_DIRECTIONS)


@pytest.mark.parametrize("node", [OREN_NAYAR, "dielectric_bsdf"])
def test_the_text_is_evaluated_as_it_was_generated_by_one_program_for_all_branches(node):
    shader = generate(material_text(node), "wgsl")[0]
    lit = {calls.LIGHTS: 2.0, calls.SKY: True}
    asked = product((*calls.CLOSURES, calls.LIT), calls.OUTPUTS[:2])
    queries = (Query(shader, PAIR, PAIR, lit, *each, None) for each in asked)
    [text] = {fragment.bsdf_evaluation(each)[0] for each in queries}
    functions, main = shader.stages["pixel"].rsplit("void main", 1)
    version, functions = functions.split("\n", 1)
    assert text.startswith(version) and functions in text and f"void main{main}" in text


def test_an_integer_of_the_text_is_the_boolean_that_it_was(hosts):
    shader = generate(material_text(OREN_NAYAR, {FLAG: True}), "wgsl")[0]
    inputs, behind = (
        {"color": np.ones((1, 3)), "roughness": np.ones(1)},
        np.array([[-0.6, 0.0, 0.8]]),
    )
    evaluate = partial(hosts("wgsl").evaluate, shader, PAIR, behind, branch="direct")
    assert (evaluate({**inputs, FLAG: True}) > evaluate({**inputs, FLAG: False}) + 0.01).all()


def tabled(host, library):
    """Compile a metal with a table of albedos, and return the shader and the table."""
    text = material(lobe("conductor_bsdf", roughness=(0.6, 0.6)))
    [shader] = host.compile(text, library=library, methods=Methods("prefilter", albedo="table"))
    [texels] = host.table(shader).values()
    return shader, texels


@pytest.mark.parametrize("name", ("gl", "vulkan", "slang", "webgl"))
def test_a_table_of_albedos_is_the_model_and_is_read_as_it_was_drawn(hosts, tmp_path, name):
    """The library includes the repair that WebGL2 needs, as docs/upstream describes."""
    host, repair = hosts(name), ("/ $albedoTableSize", "/ float($albedoTableSize)")
    library = wrong_stock(tmp_path, f"{GLSL}/lib/mx_generate_albedo_table.glsl", repair)
    shader, texels = tabled(host, library)
    places = (np.arange(64) + 0.5) / 64
    albedo = ggx_albedo_dir(*np.meshgrid(places, places))
    assert np.abs(texels[..., :2].sum(axis=-1) - albedo).max() <= SAMPLES_64
    methods = Methods("prefilter", albedo="monteCarlo")
    [sampled] = host.compile(shader.document, library=library, methods=methods)
    wo = direction(np.linspace(0.0, 1.0, 64))
    found, expected = (host.evaluate(e, wo, wo, {}, "environment") for e in (shader, sampled))
    assert np.abs(found - expected).max() <= BETWEEN_TEXELS[name == "slang"]


@pytest.mark.parametrize(
    "name, words", [("webgl", "wrong operand types"), ("wgsl", "UnknownVariable")]
)
def test_a_text_whose_table_does_not_compile_is_not_run(hosts, monkeypatch, name, words):
    host = hosts(name)
    with pytest.raises(NotRun, match=f"docs/upstream/gen{host.target}_albedo_table.md"):
        tabled(host, "stock")
    monkeypatch.delitem(UNTABLED, host.target)
    with pytest.raises(ShaderError, match=words):
        shader, _ = tabled(host, "stock")
        host.evaluate(shader, PAIR, PAIR, {}, "environment")


def kernels(_):
    """Generated kernel files that Slang has mapped into this process."""
    kept.append(open_host("slang"))
    kept[-1].call("fon_af", np.array([0.5]))
    maps = Path("/proc/self/maps").read_text().split()
    return {word for word in maps if "slang-generated" in word}


kept = []


def test_a_worker_that_is_ended_leaves_no_file_of_slang(hosts):
    hosts("slang")
    [(_, outcome)] = pool.run(kernels, [0], 1, 300.0)
    assert outcome.value and not any(map(os.path.exists, outcome.value))
