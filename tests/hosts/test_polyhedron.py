# SPDX-License-Identifier: Apache-2.0
"""Mitsuba, LuxCoreRender and EEVEE: their own nodes, and what may go wrong."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.accuracy.diffuse import COARSE_FACETS, FACET_PAIRS, FACETS
from mxeon.conformance.checks.application import judge_check, judge_subject
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.renderer_nodes import renderer_nodes
from mxeon.conformance.probes.families import HOST_PROBES
from mxeon.conformance.probes.renderer_nodes import FacetPairProbe, facet_pairs
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import with_pages
from mxeon.conformance.results.known_issues.issue import RENDERER_NODES
from mxeon.conformance.run import check
from mxeon.errors import NotRun
from mxeon.hosts import host_row, open_engine
from mxeon.hosts.polyhedron import eevee, luxcore, mitsuba
from mxeon.shaders.facets import facet_points
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import BACK, FRONT, SIDE
from tests.support.availability import available, required

EXAMPLE = examples_folder() / "plaster.mtlx"
HOSTS = {"mitsuba": mitsuba.Host, "luxcore": luxcore.Host}
SMALL = replace(SIDE, size=64)
COLOR = (0.8, 0.4, 0.1)


def judged(name):
    """Results of a host, by check and subject."""
    with available(name), open_engine(name) as host:
        host.identity()
        probe = HOST_PROBES[host_row(name).probe]
        results = [
            with_pages(result)
            for subject in renderer_nodes(name)
            for result in judge_subject(probe(host, subject, RENDERER_NODES))
        ]
    return {(each.check, each.subject): each for each in results}


@pytest.fixture(scope="module", params=HOSTS)
def host(request):
    with available(request.param), HOSTS[request.param]() as host:
        host.identity()
        yield host


@pytest.fixture(scope="module")
def of_mitsuba():
    return judged("mitsuba")


@pytest.fixture(scope="module")
def of_luxcore():
    return judged("luxcore")


def test_mitsuba_has_the_models_that_it_documents(of_mitsuba):
    documented = {each.node for each in renderer_nodes("mitsuba")}
    assert {subject for _, subject in of_mitsuba} == documented
    assert {each.verdict for each in of_mitsuba.values()} == {PASSED}
    assert all(each.control.caught for each in of_mitsuba.values())


def test_a_base_with_another_metalness_fails(monkeypatch):
    [subject] = [each for each in renderer_nodes("mitsuba") if each.node.startswith("openpbr")]
    wrong = mitsuba.Host.nodes[subject.node] | {"base_metalness": 0.49}
    monkeypatch.setitem(mitsuba.Host.nodes, subject.node, wrong)
    [value] = [each for each in CHECKS if each.key == "value"]
    with available("mitsuba"), mitsuba.Host() as host:
        result = judge_check(value, FacetPairProbe(host, subject, RENDERER_NODES))
    assert result.verdict == FAILED and result.control.caught


def test_luxcore_has_qon_with_sigma_in_radian(of_luxcore):
    failed = {key for key, each in of_luxcore.items() if each.verdict == FAILED}
    assert ("value", "roughmatte") not in failed and ("environment", "roughmatte") not in failed
    result = of_luxcore["value", "roughmatte, sigma in degrees"]
    assert "best match: QON that takes degrees for radians" in result.diagnosis
    assert result.distances["QON that takes degrees for radians"] < 1e-6
    assert all(each.control.caught for each in of_luxcore.values())


def test_luxcores_disney_squares_the_roughness_and_applies_the_cosine_twice(of_luxcore):
    result = of_luxcore["value", "disney"]
    name = "Burley with squared roughness, times the cosine once more"
    assert f"best match: {name}" in result.diagnosis and result.distances[name] < 1e-6
    assert "luxcore_disney_cosine" in result.pages
    assert ("black", "disney") not in of_luxcore  # what is left of another lobe is taken off


def test_eevee_is_lambert_whatever_the_roughness():
    if "eevee" not in required():
        pytest.skip("a minute on a software driver: MXEON_REQUIRE=eevee runs it")
    _, wi, mask = facet_pairs(SMALL)
    with eevee.Host(limit=300.0) as host:
        for title in host.nodes:
            pictures = [host.node(title, COLOR, roughness, SMALL) for roughness in (0.0, 1.0)]
            np.testing.assert_array_equal(*pictures)
            values = pictures[0][facet_points(SMALL.size).mask][mask]
            assert np.abs(values - wi[mask][:, 2:] * COLOR).max() <= COARSE_FACETS.value


@pytest.mark.parametrize("scene", [FRONT, SIDE, BACK], ids=lambda each: each.name)
def test_pictures_are_linear_and_have_float_precision(host, scene):
    """A dark color beside a bright one: 8 bits or a tone curve would be off by far more."""
    scene = replace(scene, size=64)
    title = renderer_nodes(host.name)[0].node
    picture = host.node(title, (1.0, 0.02, 1e-4), 0.0, scene)[facet_points(64).mask]
    _, wi, mask = facet_pairs(scene)
    expected = wi[mask][:, 2:] * np.array([1.0, 0.02, 1e-4])
    relative = np.abs(picture[mask] / expected - 1.0) * wi[mask][:, 2:]
    assert relative.max() <= FACETS.value


def test_a_surface_in_no_light_is_black(host):
    dark = replace(SMALL, light=(0.0, 0.0, -1.0))
    assert host.node(renderer_nodes(host.name)[0].node, COLOR, 0.0, dark).max() == 0.0


def test_a_picture_agrees_with_the_values_of_mitsubas_own_function():
    with available("mitsuba"), mitsuba.Host() as host:
        picture = host.node("principled", COLOR, 0.7, SMALL)[facet_points(64).mask]
        wo, wi, mask = facet_pairs(SMALL)
        count = np.count_nonzero(mask)
        color, roughness = np.broadcast_to(COLOR, (count, 3)), np.full(count, 0.7)
        values = np.pi * host.pairs("principled", wo[mask], wi[mask], color, roughness)
    assert np.abs(picture[mask] - values).max() <= FACETS.value + FACET_PAIRS.value


def test_a_missing_package_names_the_remedy(monkeypatch, tmp_path):
    script = tmp_path / "absent_worker.py"
    script.write_text("import a_package_that_is_absent\n")
    with mitsuba.Host() as host:
        host.worker._command[-1] = script
        with pytest.raises(NotRun, match=r"^mitsuba: not installed: pip install '\.\[mitsuba\]'"):
            host.identity()


def test_checks_of_a_missing_renderer_are_not_run(monkeypatch):
    monkeypatch.setenv("MXEON_LUXCORE_PYTHON", "/nowhere/python")
    run = check([EXAMPLE], ["luxcore"], ["eonlib"], nodes=["common"])
    results = [each for each in run.results if each.host == "luxcore" and each.check != "document"]
    assert {each.verdict for each in results} == {NOT_RUN}
    assert all("pip install '.[luxcore]'" in each.reason for each in results)
