# SPDX-License-Identifier: Apache-2.0
"""Hosts that evaluate pairs: each is the model, on every host alike, and says who it is."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.bsdf import BsdfProbe
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.errors import ShaderError
from mxeon.hosts import calls
from mxeon.models import table as reference
from mxeon.shaders.generation import generate
from tests.support.tolerances import SUMMED_DIRECTIONS, TWIN_ALBEDO, TWIN_VALUE

HOSTS = ("gl", "webgl", "vulkan", "wgsl", "slang")
COUNT = 20_000
PAIR = np.array([[0.6, 0.0, 0.8]])


@pytest.fixture(scope="module", params=HOSTS)
def host(request, hosts):
    return hosts(request.param)


@pytest.fixture(params=SUBJECTS, ids=lambda subject: subject.title)
def probe(host, request):
    return PairProbe(host, request.param, "eonlib")


def test_the_identity_names_a_version_and_a_device_after_work_too(host):
    host.call("fon_albedo_dir", np.array([0.5]), np.array([0.0]))
    identity = host.identity()
    assert identity.name == host.name and identity.version and identity.device


def test_the_generated_bsdf_is_the_model(probe):
    batch = probe.few[0].first(COUNT)
    np.testing.assert_allclose(
        probe.direct(batch), batch.expected(probe.subject.model), rtol=0.0, atol=TWIN_VALUE
    )


def test_the_environment_branch_is_the_albedo(probe):
    batch = probe.few[0].first(COUNT).altered(weight=1.0)
    row = reference.model(probe.subject.model)
    expected = row.albedo_dir(batch.wo[:, 2], batch.inputs["color"], batch.inputs["roughness"])
    np.testing.assert_allclose(probe.albedo(batch), expected, rtol=0.0, atol=TWIN_ALBEDO)


def test_a_function_of_the_twins_is_the_model(host):
    batch = PairProbe(host, SUBJECTS[0], "eonlib").few[0].first(COUNT)
    batch = batch.altered(weight=1.0, occlusion=1.0)
    rho, roughness = batch.inputs["color"], batch.inputs["roughness"]
    brdf = host.call("eon_brdf", batch.wo, batch.wi, rho, roughness)
    np.testing.assert_allclose(
        np.pi * brdf * batch.wi[:, 2:], batch.expected("eon"), rtol=0.0, atol=TWIN_VALUE
    )


def test_a_scalar_fills_three_columns_and_one_row_serves_all(host):
    values = host.call("fon_albedo_dir", np.array([0.25, 0.5, 1.0]), np.array([0.0]))
    assert values.shape == (3, 3) and (values == 1.0).all()


def test_inputs_that_are_not_given_have_the_documents_values(host):
    shader = generate(SUBJECTS[2].document({"weight": 0.25}), host.target)[0]
    white = {"color": np.ones((1, 3)), "roughness": np.zeros(1)}
    values = host.evaluate(shader, PAIR, PAIR, white, "direct")
    np.testing.assert_allclose(np.pi * values, 0.25 * 0.8, rtol=0.0, atol=TWIN_VALUE)


def test_what_the_compiler_refuses_is_a_shader_error_and_the_host_works_on(host):
    good = generate(SUBJECTS[2].document(), host.target)[0]
    wrong = good.stages["pixel"].replace("eon_brdf_mu", "no_such_function", 1)
    bad = replace(good, stages={**good.stages, "pixel": wrong})
    for flag in (0.25, 0.5):
        with pytest.raises(ShaderError, match=f"^{host.name}: (.|\n)*eon_brdf_mu"):
            host.evaluate(bad, PAIR, PAIR, {"weight": flag}, "direct")
    third = replace(good, stages={**good.stages, "pixel": good.stages["pixel"] + "\n"})
    assert host.evaluate(third, PAIR, PAIR, {}, "direct").any()


@pytest.mark.parametrize("word", ["branch", "output"])
def test_an_unknown_branch_or_output_is_refused(host, word):
    shader = generate(SUBJECTS[2].document(), host.target)[0]
    options = {"branch": "direct", word: "both"}
    with pytest.raises(ValueError, match=f"{word} must be one of .*; got 'both'"):
        host.evaluate(shader, PAIR, PAIR, {}, **options)


@pytest.mark.parametrize("branch", calls.CLOSURES)
def test_an_opaque_lobe_lets_no_light_through_in_any_branch(host, branch):
    shader = generate(SUBJECTS[2].document(), host.target, lights=True)[0]
    assert not host.evaluate(shader, PAIR, PAIR, {}, branch, output="throughput").any()
    leaks = shader.stages["pixel"].replace("bsdf.throughput = ", "bsdf.response = ")
    leaky = replace(shader, stages={**shader.stages, "pixel": leaks})
    assert (host.evaluate(leaky, PAIR, PAIR, {}, branch, output="throughput") == 1.0).all()


def test_the_environment_is_looked_up_at_the_normal(host):
    shader = generate(SUBJECTS[2].document(), host.target, lights=True)[0]
    rows = np.linspace(0.0, 1.0, 8)[:, np.newaxis, np.newaxis]
    sky = np.broadcast_to(rows, (8, 16, 3)).astype(np.float32)  # brighter downwards
    inputs = {"color": np.ones((1, 3)), "roughness": np.zeros(1)}
    for up, expected in ((0.9, slice(0.0, 0.25)), (-0.9, slice(0.75, 1.0))):
        normal = np.array([[np.sqrt(1.0 - up * up), up, 0.0]])
        values = host.evaluate(
            shader, normal, normal, {**inputs, "normal": normal}, "environment", irradiance=sky
        )
        assert (expected.start <= values).all() and (values <= expected.stop).all()


@pytest.mark.parametrize(
    "subject", [each for each in BSDFS if each.anisotropic][:1], ids=lambda each: each.model
)
def test_a_lobe_of_microfacets_sums_as_many_directions_on_every_host(host, gl, subject):
    ours, theirs = (BsdfProbe(each, subject, "stock") for each in (host, gl))
    batch = ours.cosines[0]
    np.testing.assert_allclose(
        ours.albedo(batch), theirs.albedo(batch), rtol=0.0, atol=SUMMED_DIRECTIONS
    )


def test_an_unknown_function_is_refused(host):
    with pytest.raises(ValueError, match="function must be one of .*; got 'no_such_function'"):
        host.call("no_such_function", PAIR)
