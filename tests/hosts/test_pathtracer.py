# SPDX-License-Identifier: Apache-2.0
"""three-gpu-pathtracer: its diffuse functions, its sampling, and its defects repaired."""

import numpy as np
import pytest

from mxeon.conformance.checks.application import judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.renderer_nodes import renderer_nodes
from mxeon.conformance.probes.polyhedron import FacetPairProbe
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.conformance.results.known_issues.issue import RENDERER_NODES
from mxeon.errors import NotRun
from mxeon.hosts import browser
from mxeon.hosts.browser import pathtracer
from mxeon.models.sampling.cltc import eon_cltc_sample
from tests.support.availability import available
from tools.site.upstream import repairs

NAME = "three-gpu-pathtracer"
EON, FON, LOBE = "WebGPUPathTracer, eonBrdf", "WebGPUPathTracer, fonBrdf", pathtracer.LOBE
SHORTER = f"{LOBE}, shorter wh"
ISSUES_HERE = [each for each in ISSUES if each.host == NAME]


def judged(host, check, title):
    """Result of a check of one of the package's functions."""
    [subject] = [each for each in renderer_nodes(NAME) if each.title == title]
    [row] = [each for each in CHECKS if each.key == check]
    return judge_check(row, FacetPairProbe(host, subject, RENDERER_NODES).nearest_form())


@pytest.fixture(scope="module")
def host():
    with available(NAME), pathtracer.Host() as host:
        host.identity()
        yield host


@pytest.mark.parametrize("check", ["value", "black", "reciprocity", "inputs", "density", "samples"])
def test_the_webgpu_lobe_is_eon_with_the_papers_sampling(host, check):
    result = judged(host, check, EON)
    assert result.verdict == PASSED and result.control.caught


def test_the_webgpu_lobe_has_the_quartic_and_beside_it_fon(host):
    assert judged(host, "value", EON).model == "EON with the paper's quartic"
    assert judged(host, "value", FON).verdict == PASSED


def test_directions_are_those_of_the_papers_listing_for_the_same_numbers(host):
    rng = np.random.default_rng(3)
    mu = 0.2 + 0.8 * rng.random(500)
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    u, roughness = rng.random((500, 2)), rng.random(500)
    expected, _ = eon_cltc_sample(wo, u, roughness)
    error = np.abs(host.sample(wo, u, roughness) - expected).max(axis=1)
    assert np.median(error) < 1e-3  # a root at the edge of the disk loses half of the digits


def test_the_webgl_lobe_is_no_model_that_is_known_but_its_own(host):
    result = judged(host, "value", SHORTER)
    name = "Burley with Schlick's weight for the cosine of retro-reflection"
    assert result.verdict == FAILED and f"nearest known model: {name}" in result.diagnosis
    assert result.distances[name] < 1e-6


def test_the_webgl_lobe_is_not_finite_in_retro_reflection(host):
    result = judged(host, "value", LOBE)
    assert "not finite in exact retro-reflection" in result.diagnosis


def test_pictures_are_not_run_and_say_why(host):
    result = judged(host, "environment", EON)
    assert result.verdict == NOT_RUN and "wavefront kernels do not compile" in result.reason


@pytest.fixture(scope="module")
def repaired(tmp_path_factory):
    """A host of a copy of the package with the repairs."""
    with available(NAME):
        browser.modules_folder(repairs.PATHTRACER, NAME)
    modules = repairs.copied(repairs.PATHTRACER, tmp_path_factory.mktemp("repaired"))
    for change in repairs.PATHTRACER_REPAIRS:
        repairs.repair(modules, change)
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv(browser.MODULES, str(modules))
        host = pathtracer.Host()
    with host:
        yield host


@pytest.mark.parametrize("issue", ISSUES_HERE, ids=lambda each: each.page)
def test_a_repair_makes_the_checks_pass_that_show_the_defect(repaired, issue):
    for check, title in issue.rows:
        result = judged(repaired, check, title)
        assert result.verdict == PASSED and result.control.caught


def test_a_package_with_other_texts_is_not_run(tmp_path):
    (tmp_path / "a.js").write_text("no template")
    with pytest.raises(NotRun, match="no shader text in"):
        pathtracer._template(tmp_path / "a.js")
    with pytest.raises(NotRun, match="no float diffuseEval"):
        pathtracer._cut("text", "float diffuseEval(", "vec3 diffuseDirection(")
