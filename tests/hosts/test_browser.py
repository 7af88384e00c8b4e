# SPDX-License-Identifier: Apache-2.0
"""Renderers from npm match the models in a browser, once known defects are repaired."""

import pytest

from mxeon.errors import NotRun
from mxeon.hosts import open_engine
from mxeon.shaders.library import examples_folder
from mxeon.survey import browser
from mxeon.survey.browser import pathtracer, three
from tests.support.availability import available
from tests.support.documents import surface, written
from tests.support.verdicts import FAILED, NOT_RUN, PASSED, RENDERER_NODES, Verdicts, said
from tests.test_upstream import same_record
from tools.site import ledger
from tools.site.ledger import measure

QUARTIC = "EON with the paper's quartic"
DEFECTIVE = ("three", "babylon")  # hosts whose known defects are measured in this file
PAGE = """
export async function draw({ task }) {
    if (task === "hang") await new Promise(() => {});
    if (task === "throw") throw new Error("no such material");
    return { status: (await fetch("https://example.com/", { mode: "no-cors" })).status };
}
"""

PACKAGES = {
    "three": "three",
    "babylon": "@babylonjs/core",
    "three-gpu-pathtracer": "three-gpu-pathtracer",
}
EON, FON, LOBE = "WebGPUPathTracer, eonBrdf", "WebGPUPathTracer, fonBrdf", pathtracer.LOBE


@pytest.fixture
def own(judged):
    """Function that judges one check of a renderer's own shading node."""
    return lambda host, check, title: judged(check, title, host, RENDERER_NODES)


@pytest.mark.parametrize("renderer", ["WebGLRenderer", "WebGPURenderer"])
def test_three_has_eon_with_the_quartic(own, renderer):
    result = own("three", "value", f"MeshPhysicalMaterial, {renderer}")
    assert (result.verdict, result.model) == (PASSED, QUARTIC) and result.control.caught
    assert result.claimed == "energy-preserving Oren-Nayar (EON)"


@pytest.mark.parametrize("issue", [each for each in measure.CHECKED if each.host in DEFECTIVE])
def test_each_defect_is_as_its_page_says(own, issue):
    results = [own(issue.host, *row) for row in issue.rows]
    assert all(each.verdict == FAILED for each in results), f"{issue.page}.md is out of date"
    same_record(measure.record(issue, results, ""), ledger.measured()[issue.page])


@pytest.fixture(scope="module")
def repaired(tmp_path_factory):
    """Functions, by host, that judge checks with the repaired npm package of the renderer."""
    opened = {}
    pages = [each.page for each in measure.CHECKED if each.host == "babylon"]
    diffs = {
        "three": ledger.patches("three.js").values(),
        "babylon": [ledger.own_diff(page) for page in pages],
        "three-gpu-pathtracer": ledger.patches("three-gpu-pathtracer").values(),
    }
    for name, package in PACKAGES.items():
        with available(name), pytest.MonkeyPatch.context() as patch:
            installed = browser.modules_folder(package, name) / package
            modules = tmp_path_factory.mktemp(name)
            ledger.apply(ledger.linked(installed, modules / package), *diffs[name])
            # Link the npm packages that the repaired package requires.
            for other in browser.modules_folder(package, name).iterdir():
                if not (modules / other.name).exists():
                    (modules / other.name).symlink_to(other)
            patch.setenv(browser.MODULES, str(modules))
            opened[name] = open_engine(name)
    yield {name: Verdicts(opened.get) for name in opened}
    for host in opened.values():
        host.close()


@pytest.mark.parametrize("issue", [each for each in measure.CHECKED if each.host in PACKAGES])
def test_a_repair_makes_the_checks_pass_that_show_the_defect(repaired, issue):
    for check, title in issue.rows:
        result = repaired[issue.host](check, title, issue.host, RENDERER_NODES)
        assert result.verdict == PASSED and result.control.caught, said(result)


def test_a_page_that_throws_goes_on_and_one_that_hangs_is_ended(tmp_path):
    script = tmp_path / "page.js"
    script.write_text(PAGE)
    with available("three"):
        page = three.ThreeHost()
    page._script = script
    with pytest.raises(NotRun, match="^three: no such material$"):
        page.ask({"task": "throw"})
    # The host itself answers every request of the page, so nothing reaches the network.
    assert page.ask({"task": "fetch"})["status"] in (0, 404)
    page._limit = 1000.0  # milliseconds, enough because the browser has started
    with pytest.raises(NotRun, match="^three: the browser failed; .*1000ms"):
        page.ask({"task": "hang"})
    assert page._page is None


@pytest.fixture
def tracer(hosts):
    return hosts("three-gpu-pathtracer")


@pytest.mark.parametrize("check", ["value", "black", "reciprocity", "inputs", "density", "samples"])
def test_the_webgpu_lobe_is_eon_with_the_papers_sampling(own, tracer, check):
    result = own(tracer.name, check, EON)
    assert result.verdict == PASSED and result.control.caught


def test_the_webgpu_lobe_has_the_quartic_and_beside_it_fon(own, tracer):
    assert own(tracer.name, "value", EON).model == "EON with the paper's quartic"
    assert own(tracer.name, "value", FON).verdict == PASSED


def test_pictures_are_not_run_and_say_why(own, tracer):
    result = own(tracer.name, "environment", EON)
    assert result.verdict == NOT_RUN and "wavefront kernels do not compile" in result.reason


@pytest.mark.parametrize("name", ["three", "babylon"])
def test_documents_are_judged_by_the_input_at_fault(judged, tmp_path, name):
    matte = {"coat_roughness": 0.4, "specular_weight": 0.0}
    verdicts = {}
    for weight in (0.0, 1.0):
        path = written(tmp_path, surface("open_pbr_surface", coat_weight=weight, **matte))
        [verdicts[weight]] = judged.document(path, name, RENDERER_NODES).results
    assert verdicts[0.0].verdict == PASSED
    assert verdicts[1.0].verdict == FAILED and "mostly its coat_weight" in said(verdicts[1.0])


def test_a_document_that_a_renderer_ignores_in_part_is_not_judged(judged, tmp_path):
    path = written(tmp_path, surface("open_pbr_surface", subsurface_weight=0.5))
    [result] = judged.document(path, "three", RENDERER_NODES).results
    assert result.check == "finite" and "it ignores subsurface_weight" in said(result)


@pytest.mark.parametrize("name", ["three", "babylon"])
def test_surfaces_that_a_renderer_lacks_are_not_run(judged, name):
    [result] = judged.document(examples_folder() / "plaster.mtlx", name, RENDERER_NODES).results
    assert result.verdict == NOT_RUN and "surface" in result.reason
