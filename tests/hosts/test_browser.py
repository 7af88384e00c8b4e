# SPDX-License-Identifier: Apache-2.0
"""three.js and Babylon.js in a browser: their pictures, their models, and their defects repaired."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.accuracy import diffuse as tolerances
from mxeon.conformance.checks.application import judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.renderer_nodes import renderer_nodes
from mxeon.conformance.probes.renderer_nodes import ExactProbe
from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.conformance.results.known_issues.issue import RENDERER_NODES
from mxeon.errors import NotRun
from mxeon.hosts import browser, open_engine
from mxeon.shaders.nodes import material_text
from mxeon.shaders.scene import SIDE, sphere
from tests.support.availability import available
from tests.support.tolerances import PRINTED
from tools.site.upstream import repairs
from tools.site.upstream import update as ledger

QUARTIC = "EON with the paper's quartic"
# The nodes whose pictures are looked at: one for each engine of a host.
TITLES = {
    "three": ("MeshPhysicalMaterial, WebGLRenderer", "MeshPhysicalMaterial, WebGPURenderer"),
    "babylon": ("PBRMaterial E_OREN_NAYAR, WebGL2", "OpenPBRMaterial, WebGPU"),
}
PAGE = """
export async function draw({ task }) {
    if (task === "hang") await new Promise(() => {});
    if (task === "throw") throw new Error("no such material");
    return { status: (await fetch("https://example.com/", { mode: "no-cors" })).status };
}
"""

of_each_issue = pytest.mark.parametrize(
    "issue", [each for each in ISSUES if each.host in TITLES], ids=lambda each: each.page
)


def judged(host, check, title):
    """Result of a check of a node of a host's own."""
    [subject] = [each for each in renderer_nodes(host.name) if each.title == title]
    [row] = [each for each in CHECKS if each.key == check]
    return judge_check(row, ExactProbe(host, subject, RENDERER_NODES).nearest_form())


@pytest.mark.parametrize("renderer", ["WebGLRenderer", "WebGPURenderer"])
def test_three_has_eon_with_the_quartic(hosts, renderer):
    result = judged(hosts("three"), "value", f"MeshPhysicalMaterial, {renderer}")
    assert (result.verdict, result.model) == (PASSED, QUARTIC) and result.control.caught
    assert result.claimed == "energy-preserving Oren-Nayar (EON)"


@pytest.mark.parametrize(
    "check, title",
    [
        ("value", "PBRMaterial BURLEY, WebGL2"),
        ("lobe", "PBRMaterial LAMBERT, WebGPU"),
    ],
)
def test_babylon_has_its_other_models(hosts, check, title):
    result = judged(hosts("babylon"), check, title)
    assert result.verdict == PASSED and result.control.caught


@pytest.mark.parametrize("name", ["three", "babylon"])
def test_pictures_are_linear_and_finer_than_bytes(hosts, name):
    host, scene, color = hosts(name), replace(SIDE, size=32), (0.02, 0.5, 1.0)
    points = sphere(scene.size)
    cosine = np.clip(points.normal @ np.array(scene.light), 0.0, None)
    for title in TITLES[name]:
        picture = host.node(title, color, 0.0, scene)
        error = np.abs(picture - cosine[..., np.newaxis] * color)[points.mask]
        coarse = np.abs(np.round(255.0 * picture) / 255.0 - picture)[points.mask]
        assert error.max() <= tolerances.EXACT.value < coarse.max()
        assert not picture[~points.mask].any()


def test_bright_light_is_not_compressed(hosts):
    host = hosts("three")
    for backend in ("webgl", "webgpu"):
        job = {"backend": backend, "color": [1.0] * 3, "roughness": 0.0, "size": 16}
        answer = host._browser.ask(job | {"light": [0, 0, 1], "irradiance": 1e4 * math.pi})
        values = browser.pixels(answer, 16)[sphere(16).mask][:, 1]
        expected = 1e4 * sphere(16).normal[sphere(16).mask][:, 2]
        assert np.abs(values / expected - 1.0).max() <= tolerances.EXACT.value


def test_three_refuses_a_material_of_a_bsdf_node(hosts):
    job = {"backend": "webgpu", "size": 16, "document": material_text("oren_nayar_diffuse_bsdf")}
    with pytest.raises(NotRun, match='Unsupported MaterialX node category "surface"'):
        hosts("three")._browser.ask(job)


@pytest.fixture(scope="module")
def shown(hosts):
    """The block of the page of an issue, as it is measured here."""

    def block(issue):
        host = hosts(issue.host)
        results = [judged(host, *row) for row in issue.rows]
        assert all(each.verdict == FAILED for each in results), f"{issue.page}.md is out of date"
        identity = host.identity()
        return ledger.block(results, f"{identity.device}, {identity.version}")

    return block


@of_each_issue
def test_the_figures_of_each_page_are_those_of_the_suite(shown, issue):
    text, written = shown(issue), ledger.written(issue.page)
    np.testing.assert_allclose(ledger.figures(text), ledger.figures(written), rtol=PRINTED)
    assert ledger.without_figures(text)[0] == ledger.without_figures(written)[0]
    assert text.split("The suite says")[1] == written.split("The suite says")[1]


@pytest.fixture(scope="module")
def repaired(tmp_path_factory):
    """Hosts with all repairs, by their names."""
    folder, opened = tmp_path_factory.mktemp("repaired"), {}
    with available("three"), available("babylon"), pytest.MonkeyPatch.context() as patch:
        for name, package in (("three", repairs.THREE), ("babylon", repairs.BABYLON)):
            browser.modules_folder(package, name)
            modules = repairs.copied(package, folder)
            patch.setenv(browser.MODULES, str(modules))
            opened[name] = open_engine(name)
            patch.delenv(browser.MODULES)
        for change in repairs.REPAIRS:
            repairs.repair(modules, change)
    yield opened
    for host in opened.values():
        host.close()


@of_each_issue
def test_a_repair_makes_the_checks_pass_that_show_the_defect(repaired, issue):
    for check, title in issue.rows:
        result = judged(repaired[issue.host], check, title)
        assert result.verdict == PASSED, result.explanation


def test_a_page_that_throws_goes_on_and_one_that_hangs_is_ended(tmp_path):
    script = tmp_path / "page.js"
    script.write_text(PAGE)
    with available("three"):
        page = browser.Browser("three", script, {}, tmp_path, limit=3.0)
    with pytest.raises(NotRun, match="^three: no such material$"):
        page.ask({"task": "throw"})
    assert page.ask({"task": "fetch"})["status"] in (0, 404)  # of this browser, not of the network
    with pytest.raises(NotRun, match="^three: the browser fails; .*3000ms"):
        page.ask({"task": "hang"})
    assert page._page is None
